// Cards over the arena: one that belongs to the run (before it, after it), and one that this page has opened.
(page) => {
  const FOLLOW_MS = 150;
  const NARROW_PX = 620; // in a narrower arena a card takes the whole width
  const ROOM = 16; // to the edges of the arena [CSS px]
  const GAP = 8; // below the tools [CSS px]
  const BELOW = 104; // for the STOP button and the first steps [CSS px]

  const overlay = page.overlay(
    `<style>
      :host { font: calc(14px * var(--hg-size, 1))/1.45 var(--mantine-font-family, sans-serif); }
      * { box-sizing: border-box; }
      .card { position: absolute; display: none; flex-direction: column; pointer-events: auto; border-radius: 12px;
        color: var(--hg-text, #d5dbe2); background: var(--hg-card, #161b21); font-variant-numeric: tabular-nums;
        border: 1px solid var(--hg-card_rule, #343c46); box-shadow: 0 8px 32px rgba(0, 0, 0, 0.35); }
      .card.open { display: flex; }
      header { display: flex; align-items: center; gap: 10px; padding: 12px 10px 8px 18px; }
      h2 { flex: 1; margin: 0; font-size: 1.2em; font-weight: 650; line-height: 1.3; }
      h3 { margin: 14px 0 6px; font-size: 1em; font-weight: 600; }
      p { margin: 0 0 8px; }
      .body { overflow: auto; padding: 0 18px 4px; overscroll-behavior: contain; }
      .folded .body, .folded footer { display: none; }
      .folded header { padding-bottom: 12px; }
      footer { display: flex; flex-wrap: wrap; gap: 8px; padding: 12px 18px 16px; }
      .dim { color: var(--hg-dim, #9aa5b1); }
      .good { color: var(--hg-progress, #5ff0c0); }
      .alarm { color: var(--hg-alarm, #ff6b6b); font-weight: 600; }
      .warn { color: var(--hg-warning, #e69f00); font-weight: 600; }
      button { font: inherit; cursor: pointer; touch-action: manipulation; color: inherit; border: 0; }
      button:focus-visible { outline: 2px solid var(--hg-text, #fff); outline-offset: 2px; }
      .act { min-height: 36px; padding: 0 16px; border-radius: 8px; font-weight: 600; background: var(--hg-key, #2b323c);
        box-shadow: inset 0 0 0 1px var(--hg-card_rule, #343c46); }
      .act.first { color: #fff; background: var(--hg-brand, #3a86b4); box-shadow: none; }
      .act:hover { filter: brightness(1.1); }
      .act:disabled { cursor: not-allowed; filter: none; background: none; color: var(--hg-dim, #9aa5b1);
        box-shadow: inset 0 0 0 1px var(--hg-card_rule, #343c46); }
      .idle { flex: 1 1 100%; margin: 0; color: var(--hg-dim, #9aa5b1); }
      .fold { width: 32px; height: 32px; border-radius: 7px; background: none; color: var(--hg-dim, #9aa5b1); font-size: 18px; }
      .fold:hover { background: var(--hg-key, #2b323c); color: var(--hg-text, #d5dbe2); }
      ul { margin: 0 0 8px; padding-left: 1.2em; }
      li { margin-bottom: 3px; }
      .sees { padding: 8px 12px; border-radius: 8px; background: var(--hg-key, #2b323c); margin: 10px 0 4px; }
      .sees h3 { margin: 0 0 4px; }
      .sees ul { margin: 0; }
      .note { padding: 10px 12px; border-radius: 8px; margin-bottom: 10px;
        box-shadow: inset 0 0 0 1px var(--hg-warning, #e69f00); display: flex; flex-wrap: wrap; gap: 8px; align-items: center; }
      .note span { flex: 1 1 180px; }
      table { width: 100%; border-collapse: collapse; }
      th { font-weight: 500; color: var(--hg-dim, #9aa5b1); }
      th, td { text-align: right; padding: 3px 0 3px 10px; }
      th:first-child, td:first-child { text-align: left; padding-left: 0; }
      tbody td, tfoot td { border-top: 1px solid var(--hg-card_rule, #343c46); }
      tfoot td { font-weight: 600; }
      dl { display: grid; grid-template-columns: max-content 1fr; gap: 3px 14px; margin: 10px 0 0; }
      dt { color: var(--hg-dim, #9aa5b1); }
      dd { margin: 0; }
      .actions { display: grid; grid-template-columns: 4em 1fr; gap: 2px 8px; }
      .choices { display: grid; grid-template-columns: repeat(auto-fill, minmax(190px, 1fr)); gap: 12px; }
      .choice { display: flex; flex-direction: column; gap: 4px; padding: 8px; border-radius: 10px; text-align: left;
        background: none; box-shadow: inset 0 0 0 1px var(--hg-card_rule, #343c46); }
      .choice:hover, .choice:focus-visible { background: var(--hg-key, #2b323c); }
      .choice[aria-current="true"] { box-shadow: inset 0 0 0 2px var(--hg-robot, #56b4e9); }
      .choice svg { display: block; width: 100%; height: 104px; border-radius: 6px; background: var(--hg-surround, #111418); }
      .choice b { font-weight: 600; line-height: 1.3; }
      .choice span { font-size: 0.9em; line-height: 1.35; }
      .veil { position: absolute; inset: 0; display: none; pointer-events: auto; background: rgba(0, 0, 0, 0.35); }
      .veil.open { display: block; }
      @media (pointer: coarse) { .act, .fold { min-height: 42px; } }
    </style>
    <section class="card" id="run" aria-live="polite"></section>
    <div class="veil"><section class="card" id="own" role="dialog" aria-modal="true"></section></div>`,
    2147483644,
  );
  const $ = (selector) => overlay.shadowRoot.querySelector(selector);
  const [run, own, veil] = [$("#run"), $("#own"), $(".veil")];
  let kind = "";
  let idle = ""; // why the buttons of the run's card do nothing on this page; empty = they work

  function place() {
    const rect = page.canvas()?.getBoundingClientRect();
    if (!rect?.width) return;
    const narrow = rect.width < NARROW_PX;
    const tools = document.querySelector(".hg-tools")?.shadowRoot.querySelector(".tools")?.getBoundingClientRect();
    const top = Math.max((tools?.bottom ?? 0) + GAP, rect.top + ROOM);
    const bottom = Math.min(rect.bottom, window.innerHeight);
    const width = Math.min(kind === "ended" ? 600 : 520, rect.width - 2 * ROOM);
    run.style.width = `${narrow ? rect.width - ROOM : width}px`;
    run.style.left = `${rect.left + (narrow ? ROOM / 2 : (rect.width - width) / 2)}px`;
    run.style.maxHeight = `${Math.max(bottom - top - BELOW, 120)}px`;
    // Where there is room below, the card stands there, and the arena is seen above it.
    run.style.top = narrow || kind === "ended" ? `${top}px` : "auto";
    run.style.bottom = narrow || kind === "ended" ? "auto" : `${window.innerHeight - bottom + BELOW}px`;
    const page_width = window.innerWidth;
    own.style.width = `${Math.min(920, page_width - ROOM)}px`;
    own.style.left = `${(page_width - Math.min(920, page_width - ROOM)) / 2}px`;
    own.style.top = `${top}px`; // the tools stand above the veil
    own.style.maxHeight = `${window.innerHeight - top - ROOM - (narrow ? 130 : 84)}px`;
  }

  function act(event) {
    const button = event.target.closest("button");
    if (!button) return;
    if (button.dataset.fold !== undefined) return fold(!run.classList.contains("folded"));
    if (button.dataset.close !== undefined) return close();
    page.send("card", { act: button.dataset.act, value: button.dataset.value ?? "" });
    if (own.contains(button)) close();
  }

  function fold(folded) {
    run.classList.toggle("folded", folded);
    const button = run.querySelector("[data-fold]");
    if (!button) return;
    button.textContent = folded ? "+" : "–";
    button.title = folded ? "Unfold" : "Fold";
    button.setAttribute("aria-label", button.title);
  }

  function hold() {
    for (const button of run.querySelectorAll(".act")) button.disabled = idle !== "";
    run.querySelector(".idle")?.remove();
    if (!idle) return;
    const line = document.createElement("p");
    [line.className, line.textContent] = ["idle", idle];
    (run.querySelector("footer") ?? run.querySelector(".body"))?.append(line);
  }

  function close() {
    veil.classList.remove("open");
    own.classList.remove("open");
    own.replaceChildren();
  }

  const onKey = (event) => {
    if (event.key !== "Escape" || !veil.classList.contains("open")) return;
    event.stopImmediatePropagation();
    close();
  };

  for (const card of [run, own]) card.addEventListener("click", act);
  veil.addEventListener("click", (event) => event.target === veil && close());
  const forget = page.listen({ keydown: onKey });
  const following = setInterval(place, FOLLOW_MS);

  return {
    // The card of the run; an empty one goes away.
    show(card) {
      const folded = run.classList.contains("folded") && card.kind === kind;
      const scrolled = run.querySelector(".body")?.scrollTop ?? 0;
      const same = card.kind === kind;
      kind = card.kind;
      run.innerHTML = card.html;
      run.classList.toggle("open", card.html !== "");
      run.dataset.kind = kind;
      fold(folded);
      hold();
      place();
      if (same && run.querySelector(".body")) run.querySelector(".body").scrollTop = scrolled;
    },

    // Why a page that watches cannot use the card of the run; empty = it steers.
    watches(reason) {
      if (reason === idle) return;
      idle = reason;
      hold();
      place();
    },

    // A card of this page alone.
    open(html) {
      own.innerHTML = html;
      own.classList.add("open");
      veil.classList.add("open");
      place();
      own.querySelector("button.choice, button")?.focus({ preventScroll: true });
    },

    remove() {
      clearInterval(following);
      forget();
      overlay.remove();
    },
  };
}

// The strip of tools at the top of the arena, with undo and redo.
(page, config) => {
  const FOLLOW_MS = 150;
  const LEAST_ROOM = 620; // [px]; in a narrower arena the strip has no gaps

  const UNDO = '<path d="M9 7 4 12l5 5"/><path d="M4 12h10a6 6 0 0 1 0 12" transform="translate(0 -3)"/>';
  const REDO = '<path d="m15 7 5 5-5 5"/><path d="M20 12H10a6 6 0 0 0 0 12" transform="translate(0 -3)"/>';

  const overlay = page.overlay(
    `<style>
      .tools { position: absolute; display: flex; flex-wrap: wrap; gap: 10px; padding: 4px;
        box-sizing: border-box; border-radius: 9px; background: var(--hg-card, #161b21);
        box-shadow: 0 0 0 1px var(--hg-card_rule, #343c46); pointer-events: auto; }
      .tools.tight { gap: 2px; }
      .group { display: flex; gap: 2px; }
      button { width: 30px; height: 30px; padding: 0; border: 0; border-radius: 6px; cursor: pointer; background: none;
        color: var(--hg-text, #c9d1d9); touch-action: manipulation; display: grid; place-items: center; }
      button:hover:not(:disabled) { background: rgba(148, 163, 184, 0.22); }
      button:focus-visible { outline: 2px solid currentColor; outline-offset: 1px; }
      button:disabled svg { opacity: 0.35; }
      button:disabled { cursor: default; }
      button[aria-pressed="true"], button[aria-pressed="true"]:hover:not(:disabled) { background: var(--hg-operator, #f0e442); color: var(--hg-badge_text, #14171c); }
      svg { width: 20px; height: 20px; fill: none; stroke: currentColor; stroke-width: 1.8; stroke-linecap: round;
        stroke-linejoin: round; }
      .tip { position: absolute; top: calc(100% + 6px); left: 0; display: none; max-width: 340px; padding: 6px 10px;
        border-radius: 7px; font: calc(13px * var(--hg-size, 1))/1.4 var(--mantine-font-family, sans-serif);
        color: var(--hg-text, #d5dbe2); background: var(--hg-card, #161b21); pointer-events: none;
        box-shadow: 0 0 0 1px var(--hg-card_rule, #343c46), 0 4px 14px rgba(0, 0, 0, 0.35); }
      .tip.open { display: block; }
      .tip b { font-weight: 600; }
      .tip span { display: block; color: var(--hg-dim, #9aa5b1); }
      @media (pointer: coarse) { button { width: 38px; height: 38px; } }
    </style>
    <div class="tools" role="toolbar" aria-label="Tools"></div>`,
    2147483645,
  );
  overlay.classList.add("hg-tools");
  const strip = overlay.shadowRoot.querySelector(".tools");
  const looks = new Map(config.tools.map((tool) => [tool.name, tool]));
  const buttons = new Map();
  const groups = new Map();

  const tip = strip.appendChild(Object.assign(document.createElement("div"), { className: "tip" }));

  function name(button, title, text) {
    button.dataset.title = title;
    button.dataset.text = text;
    button.setAttribute("aria-label", `${title}. ${text}`);
  }

  // At once, and for the keyboard too; a browser's own hint comes late and not at all on focus.
  function showTip({ target }) {
    const button = target.closest?.("button");
    tip.classList.toggle("open", Boolean(button));
    if (!button) return;
    tip.replaceChildren(Object.assign(document.createElement("b"), { textContent: button.dataset.title }));
    tip.append(Object.assign(document.createElement("span"), { textContent: button.dataset.text }));
    tip.style.left = `${Math.max(0, Math.min(button.offsetLeft, strip.parentNode.host.clientWidth - 360))}px`;
  }
  const hideTip = () => tip.classList.remove("open");

  function make(group, tool, icon, title, text) {
    if (!groups.has(group)) groups.set(group, strip.appendChild(Object.assign(document.createElement("div"), { className: "group" })));
    const button = document.createElement("button");
    button.type = "button";
    button.innerHTML = `<svg viewBox="0 0 24 24" aria-hidden="true">${icon}</svg>`;
    name(button, title, text);
    button.dataset.tool = tool;
    button.addEventListener("click", () => page.send("tool", { name: tool }));
    groups.get(group).append(button);
    buttons.set(tool, button);
    return button;
  }

  for (const { name, group, icon, title, text, key } of config.tools) make(group, name, icon, `${title} (${key})`, `${text}.`);
  const undo = make("history", "undo", UNDO, "Undo (Ctrl+Z)", "");
  const redo = make("history", "redo", REDO, "Redo (Ctrl+Y)", "");
  for (const type of ["pointerover", "focusin"]) strip.addEventListener(type, showTip);
  for (const type of ["pointerleave", "focusout", "pointerdown"]) strip.addEventListener(type, hideTip);
  strip.addEventListener("mousedown", (event) => event.preventDefault()); // the focus stays where it is

  function show(name) {
    for (const [tool, button] of buttons) if (looks.has(tool)) button.setAttribute("aria-pressed", String(tool === name));
    page.part("pointer")?.ink(looks.get(name).inks);
  }

  function history(texts) {
    for (const [button, text, word, keys] of [
      [undo, texts.undo, "Undo", "Ctrl+Z"],
      [redo, texts.redo, "Redo", "Ctrl+Y"],
    ]) {
      button.disabled = !text;
      name(button, `${word} (${keys})`, text || `Nothing to ${word.toLowerCase()}`);
    }
  }

  function place() {
    const rect = page.canvas()?.getBoundingClientRect();
    if (!rect) return;
    strip.style.left = `${rect.left + 8}px`;
    strip.style.top = `${rect.top + 8}px`;
    strip.style.maxWidth = `${rect.width - 16}px`;
    strip.classList.toggle("tight", rect.width < LEAST_ROOM);
  }

  history({ undo: "", redo: "" });
  show(config.tools[0].name);
  place();
  const following = setInterval(place, FOLLOW_MS);

  return {
    show,
    history,

    // Of the arena's upper edge, down to the end of the strip [CSS px].
    reach: () => strip.offsetHeight + 8,

    remove() {
      clearInterval(following);
      overlay.remove();
    },
  };
}

// Three steps for the first run, beside the STOP button; each is ticked when this page has tried it and it has happened.
(page, config) => {
  const KEY = "higvf-hints"; // the steps that are done, and "away" once the strip was put away
  const FOLLOW_MS = 200;
  const LEFT = 290; // of the canvas, right of the STOP button and its "?", in text of the usual size [CSS px]
  const ROOM = 18; // to the edges of the canvas [CSS px]
  const LEAST = 150; // width of a step [CSS px]
  const STAY_MS = 2500; // after the last tick
  const ANSWERED_MS = 5000; // what happens so long after this page has tried it is its doing

  const overlay = page.overlay(
    `<style>
      :host { font: calc(13px * var(--hg-size, 1))/1.35 var(--mantine-font-family, sans-serif); }
      * { box-sizing: border-box; }
      .strip { position: absolute; display: none; align-items: stretch; height: 72px; padding: 0 6px 0 14px;
        border-radius: 12px; pointer-events: auto; color: var(--hg-text, #d5dbe2); background: var(--hg-card, #161b21);
        border: 1px solid var(--hg-card_rule, #343c46); }
      .strip.open { display: flex; }
      ol { display: flex; flex: 1; min-width: 0; gap: 16px; margin: 0; padding: 0; list-style: none; }
      li { display: grid; flex: 1; min-width: 0; grid-template-columns: 22px 1fr; column-gap: 9px; align-content: center; }
      li i { grid-row: 1 / 3; width: 22px; height: 22px; border-radius: 50%; text-align: center; font-size: calc(12px * var(--hg-size, 1)); font-style: normal;
        font-weight: 600; line-height: 20px; border: 1px solid var(--hg-dim, #9aa5b1); color: var(--hg-dim, #9aa5b1); }
      li b { font-weight: 600; }
      li span { color: var(--hg-dim, #9aa5b1); font-size: 0.92em; }
      li.done i { border-color: var(--hg-progress, #5ff0c0); background: var(--hg-progress, #5ff0c0);
        color: var(--hg-badge_text, #0d1117); }
      li.done b { color: var(--hg-dim, #9aa5b1); }
      li.spare { display: none; }
      button { align-self: flex-start; width: 26px; height: 26px; margin-top: 6px; border: 0; border-radius: 6px;
        cursor: pointer; font: inherit; font-size: calc(16px * var(--hg-size, 1)); color: var(--hg-dim, #9aa5b1); background: none; }
      button:hover { color: var(--hg-text, #d5dbe2); background: var(--hg-key, #2b323c); }
      button:focus-visible { outline: 2px solid var(--hg-robot, #56b4e9); }
    </style>
    <div class="strip" role="note" aria-label="First steps"><ol></ol>
      <button type="button" title="Put away; the key list (?) shows it again" aria-label="Put away">×</button></div>`,
    2,
  );
  const strip = overlay.shadowRoot.querySelector(".strip");
  const items = new Map();

  function remembered() {
    try {
      return new Set(JSON.parse(localStorage.getItem(KEY) ?? "[]"));
    } catch {
      return new Set(); // no storage here, or something else in it
    }
  }

  function remember() {
    try {
      localStorage.setItem(KEY, JSON.stringify([...done]));
    } catch {
      // Without storage the steps are shown again next time.
    }
  }

  const TRIES = { stroke: "draw", click: "pick" }; // by topic
  const tried = new Map(); // when, by step
  let done = remembered();
  let closing = null;

  config.steps.forEach(([name, title, text], index) => {
    const item = document.createElement("li");
    for (const [tag, words] of [["i", index + 1], ["b", title], ["span", text]])
      item.append(Object.assign(document.createElement(tag), { textContent: words }));
    strip.querySelector("ol").append(item);
    items.set(name, item);
  });

  const finished = () => config.steps.every(([name]) => done.has(name));

  function show(open) {
    strip.classList.toggle("open", open);
    let number = 1;
    for (const [name, item] of items) {
      item.classList.toggle("done", done.has(name));
      item.querySelector("i").textContent = done.has(name) ? "✓" : number;
      number += 1;
    }
    place();
  }

  // Between the STOP button and the panel; where there is not room for all, the next step alone.
  function place() {
    const rect = page.canvas()?.getBoundingClientRect();
    if (!rect) return;
    const beside = LEFT * (Number(getComputedStyle(document.documentElement).getPropertyValue("--hg-size")) || 1);
    const width = rect.width - beside - ROOM;
    strip.style.left = `${rect.left + beside}px`;
    strip.style.bottom = `${Math.max(window.innerHeight - rect.bottom, 0) + ROOM - 2}px`;
    strip.style.width = `${Math.min(width, 700)}px`;
    const all = width >= config.steps.length * LEAST;
    const next = config.steps.find(([name]) => !done.has(name))?.[0];
    for (const [name, item] of items) item.classList.toggle("spare", !all && name !== next);
  }

  function tick(name) {
    if (done.has(name)) return;
    done.add(name);
    remember();
    if (!strip.classList.contains("open")) return;
    show(true);
    if (finished()) closing = setTimeout(() => show(false), STAY_MS);
  }

  function putAway() {
    done.add("away");
    remember();
    show(false);
  }

  strip.querySelector("button").addEventListener("click", putAway);
  show(!done.has("away") && !finished());
  const following = setInterval(place, FOLLOW_MS);

  return {
    // Called with what the page sends to the server.
    sent(topic, body) {
      const name = topic === "key" ? { pick: "pick", stop: "stop" }[body.name.split("_")[0]] : TRIES[topic];
      if (name) tried.set(name, performance.now());
    },

    // Hears what has come of it.
    happened(name) {
      if (performance.now() - (tried.get(name) ?? -Infinity) < ANSWERED_MS) tick(name);
    },

    // Shows all steps again, none of them done.
    reopen() {
      clearTimeout(closing);
      done = new Set();
      remember();
      show(true);
    },

    remove() {
      clearInterval(following);
      clearTimeout(closing);
      overlay.remove();
    },
  };
}

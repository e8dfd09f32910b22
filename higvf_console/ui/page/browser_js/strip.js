// The strip over the arena: state, clock, the run's buttons, alarms, who steers, the latest message, the team's facts.
// It is a row of the page, not an overlay: viser's page begins below it, and above the panel of a page in portrait.
(page, config) => {
  const CHECK_MS = 200;
  const NOTE_MS = 4000;
  const FOLDING_MS = 3000; // in which a panel has folded or unfolded, also on a busy page
  const LOG_MS = 20000; // for which the log is tried to be shown
  // viser's handles that unfold a docked panel.
  const FOLDED = ":is([data-dock-minimize-all], [data-dock-minimize])[aria-expanded=false]";
  // The title of viser's notice that a processor draws the page; the console is fit for it, so it stays unsaid.
  const SOFTWARE_DRAWING = "Software WebGL rendering detected";
  const root = document.documentElement.style;

  const ICONS = {
    pause: '<path d="M8 5v14M16 5v14" stroke-width="3.4"/>',
    resume: '<path d="M7 4.5v15L19 12z" fill="currentColor"/>',
    freeze: '<circle cx="12" cy="12" r="8.5"/><path d="M12 7v5l3.5 2"/>',
    step: '<path d="M6 5v14L15 12z" fill="currentColor"/><path d="M18.5 5v14" stroke-width="2.6"/>',
    reset: '<path d="M5 12a7 7 0 1 0 2.4-5.3"/><path d="M8 2.5 7 7l4.4.8"/>',
  };
  const icon = (name) => `<svg viewBox="0 0 24 24" aria-hidden="true">${ICONS[name]}</svg>`;
  const button = (act, short, rest) =>
    `<button type="button" data-act="${act}">${icon(act)}<span>${short}<em>${rest}</em></span></button>`;

  const overlay = page.overlay(
    `<style>
      :host { font: calc(13px * var(--hg-size, 1))/1.35 var(--mantine-font-family, sans-serif); }
      * { box-sizing: border-box; }
      .status { position: absolute; top: 0; left: 0; right: 0; padding: 5px 10px 4px; pointer-events: auto;
        color: var(--hg-text, #d5dbe2); background: var(--hg-panel, #242424); font-variant-numeric: tabular-nums;
        border-bottom: 1px solid var(--hg-card_rule, #343c46); }
      .main { display: flex; flex-wrap: wrap; align-items: center; gap: 5px 8px; min-height: 34px; }
      .states { display: flex; gap: 5px; }
      .states b { padding: 3px 10px; border-radius: 6px; min-width: 7.4em; text-align: center; font-weight: 700;
        letter-spacing: 0.05em; color: var(--hg-badge_text, #0d1117); }
      .clock { font-size: 1.5em; font-weight: 600; min-width: 4.1em; letter-spacing: -0.01em; }
      .run { display: flex; gap: 6px; }
      .gap { flex: 1; }
      button, select { height: 2.3em; border: 0; border-radius: 6px; font: inherit; font-weight: 600; cursor: pointer;
        color: inherit; background: var(--hg-key, #2b323c); box-shadow: inset 0 0 0 1px var(--hg-card_rule, #343c46);
        touch-action: manipulation; white-space: nowrap; }
      button { display: inline-flex; align-items: center; justify-content: center; gap: 6px; padding: 0 10px; }
      select { padding: 0 4px; font-weight: 400; }
      button:hover:not(:disabled) { filter: brightness(1.12); }
      button:disabled { opacity: 0.45; cursor: default; }
      :is(button, select):focus-visible { outline: 2px solid var(--hg-text, #fff); outline-offset: 1px; }
      svg { width: 1.15em; height: 1.15em; flex: none; fill: none; stroke: currentColor; stroke-width: 2;
        stroke-linecap: round; stroke-linejoin: round; }
      em { font-style: normal; }
      [data-act=pause] { min-width: 6.9em; box-shadow: inset 0 0 0 1.5px var(--hg-warning, #e69f00); }
      [data-act=freeze] { min-width: 9.6em; box-shadow: inset 0 0 0 1.5px var(--hg-robot, #56b4e9); }
      [data-act=pause] svg { color: var(--hg-warning, #e69f00); }
      [data-act=freeze] svg { color: var(--hg-robot, #56b4e9); }
      [data-act=pause].on { color: var(--hg-badge_text, #0d1117); background: var(--hg-warning, #e69f00); }
      [data-act=freeze].on { color: var(--hg-badge_text, #0d1117); background: var(--hg-robot, #56b4e9); }
      .on svg { color: inherit !important; }
      .asked { color: #fff; background: #b91c1c; }
      .alarms { color: var(--hg-badge_text, #0d1117); background: var(--hg-alarm, #ff6b6b); box-shadow: none; }
      .alarms:empty, .returned:empty { display: none; }
      .sub { display: flex; align-items: center; gap: 18px; height: 1.8em; white-space: nowrap; }
      .message { display: flex; align-items: center; gap: 8px; flex: 1; min-width: 0; }
      .message i { flex: none; width: 4px; height: 1.1em; border-radius: 2px; }
      .message span { overflow: hidden; text-overflow: ellipsis; }
      .message time { color: var(--hg-dim, #9aa5b1); }
      .message time:empty { display: none; }
      .message button { flex: none; height: 1.6em; padding: 0 8px; font-size: 0.92em; }
      .message:not(.unread) button { display: none; }
      :is(.gone .message, .message.unread, .message.noted) { flex: none; max-width: 70%; } /* before the facts, which may be cut off */
      .message.unread span { font-weight: 600; color: var(--hg-alarm, #ff6b6b); }
      .facts { display: flex; gap: 18px; overflow: hidden; }
      .facts > span { flex: none; }
      .facts > span:nth-child(1) { min-width: 14.5em; }
      .facts > span:nth-child(2) { min-width: 16em; }
      .facts i { margin-right: 7px; font-style: normal; color: var(--hg-dim, #9aa5b1); }
      .facts .dim { color: var(--hg-dim, #9aa5b1); }
      .facts .operator { color: var(--hg-operator, #f0e442); font-weight: 600; }
      .facts .alarm { color: var(--hg-alarm, #ff6b6b); font-weight: 600; }
      .facts .warn { color: var(--hg-warning, #e69f00); font-weight: 600; }
      .facts .mark { display: inline-block; width: 1.15em; }
      .facts .channel { margin-right: 8px; }
      .watches :is(.run, .returned) { opacity: 0.45; }
      .gone .states b { background: var(--hg-dim, #9aa5b1) !important; }
      .gone :is(.clock, .facts) { opacity: 0.55; }
      @media (max-width: 1439px) { .facts > span:nth-child(5) { display: none; } }
      @media (max-width: 1199px) {
        .run { order: 2; flex-basis: 100%; }
        .sub { flex-wrap: wrap; height: auto; gap: 0; }
        .message, .facts { flex: 0 0 100% !important; max-width: none !important; height: 1.75em; }
      }
      @media (max-width: 700px) {
        .facts > span:nth-child(n + 3) { display: none; }
        .facts > span { min-width: 0 !important; }
        .facts i { display: none; }
      }
      @media (max-width: 520px) {
        .run button em { display: none; }
        .run { gap: 4px; }
        .run button, .run select { min-width: 0 !important; flex: 1; padding: 0 4px; }
        .states b { min-width: 0; padding: 3px 7px; letter-spacing: 0; }
        .clock { min-width: 0; font-size: 1.25em; }
      }
      @media (pointer: coarse) { button, select { min-height: 34px; } .message button { min-height: 0; } }
    </style>
    <div class="status">
      <div class="main">
        <span class="states"></span><span class="clock"></span>
        <span class="run">
          ${button("pause", "Pause", "")}${button("freeze", "Freeze", " clock")}${button("step", "Step", " once")}
          <select aria-label="Speed"></select>${button("reset", "Reset", " run")}
        </span>
        <span class="gap"></span>
        <button type="button" class="returned"></button>
        <button type="button" class="alarms" title="Show them in the log"></button>
        <slot></slot>
      </div>
      <div class="sub">
        <div class="message" role="status"><i></i><time></time><span></span><button type="button">Read</button></div>
        <div class="facts"></div>
      </div>
    </div>`,
    2147483640,
  );
  overlay.classList.add("hg-strip");
  const $ = (selector) => overlay.shadowRoot.querySelector(selector);
  const [strip, states, message, speed] = [$(".status"), $(".states"), $(".message"), $("select")];
  const acts = Object.fromEntries([...strip.querySelectorAll("[data-act]")].map((found) => [found.dataset.act, found]));
  const send = (act, value = "") => page.send("run", { act, value });

  speed.append(...config.speeds.map((name) => new Option(name)));
  speed.title = config.hints.speed;
  for (const [act, found] of Object.entries(acts)) {
    found.title = config.hints[act];
    found.addEventListener("click", () => send(act));
  }
  speed.addEventListener("change", () => {
    send("speed", speed.value);
    speed.blur();
  });
  $(".returned").addEventListener("click", () => send("acknowledge"));
  $(".alarms").addEventListener("click", openLog);
  message.querySelector("button").addEventListener("click", () => page.send("read", { text: told.text }));
  strip.addEventListener("mousedown", (event) => event.target === speed || event.preventDefault()); // keeps the focus

  let run = { states: [], speed: "", paused: false, stopped: false, frozen: false };
  let told = { time: "", text: "", colour: "", unread: false };
  let note = ""; // what the page itself has to say, until the server says something new, but long enough to be read
  let noted = 0; // when it began to say so [ms]
  let fresh = false; // whether the server has said something since
  let met = false; // the server has answered
  let gone = false; // it does not answer any more
  let since = 0;
  let below = false; // the panel stands below the arena
  let asked = 0; // when a folded panel was last asked to unfold [ms]: a second click must not fold it again

  function face(act, name, words, rest, on) {
    const found = acts[act];
    found.classList.toggle("on", on);
    found.innerHTML = `${icon(name)}<span>${words}<em>${rest}</em></span>`;
  }

  function show() {
    strip.classList.toggle("gone", gone);
    states.replaceChildren(
      ...run.states.map(({ word, colour, text }) => {
        const badge = document.createElement("b");
        badge.textContent = word;
        badge.title = text;
        badge.style.background = `var(--hg-${colour})`;
        return badge;
      }),
    );
    face("pause", run.paused ? "resume" : "pause", run.paused ? "Resume" : "Pause", "", run.paused);
    face("freeze", "freeze", run.frozen ? "Run" : "Freeze", " clock", run.frozen);
    acts.pause.disabled = run.stopped || gone;
    for (const act of ["freeze", "step", "reset"]) acts[act].disabled = gone;
    speed.disabled = gone;
    if (document.activeElement !== overlay) speed.value = run.speed;
    tell();
  }

  function tell() {
    const lost = `Last known state, as of ${new Date(since).toLocaleTimeString()}: the server does not answer.`;
    const { time, text, colour, unread } = gone ? { time: "", text: lost, colour: "var(--hg-alarm)" } : told;
    const words = !gone && note ? note : text;
    message.classList.toggle("unread", Boolean(unread) && !note);
    message.classList.toggle("noted", Boolean(note) && !gone);
    message.querySelector("i").style.background = note && !gone ? "var(--hg-warning)" : colour;
    message.querySelector("time").textContent = note ? "" : time;
    const line = message.querySelector("span");
    line.textContent = line.title = words;
  }

  // A folded panel is unfolded first, which takes it a moment, or is folding just now: it must stay open for a while.
  function openLog() {
    const end = Date.now() + LOG_MS;
    let seen = 0;
    const look = () => {
      const now = Date.now();
      const tab = [...document.querySelectorAll("[role=tab]")].find((found) => found.textContent.trim() === "Log");
      const open = tab?.checkVisibility() ?? false;
      if (open && !seen) page.part("tabs")?.open("Log");
      if (!open && now - asked > FOLDING_MS) {
        asked = now;
        (document.querySelector(FOLDED) ?? sheet()?.querySelector("[style*=pointer]"))?.click();
      }
      seen = open ? seen || now : 0;
      if (now < end && !(seen && now - seen > FOLDING_MS)) setTimeout(look, 100);
    };
    look();
  }

  // viser's bottom sheet, in portrait and on a phone.
  const sheet = () => document.querySelector('.mantine-Paper-root[style*="position: fixed"]');

  function place() {
    const tall = (node) => Math.ceil(node?.getBoundingClientRect().height ?? 0);
    const height = tall(sheet());
    root.setProperty("--hg-strip-height", `${tall(strip)}px`);
    root.setProperty("--hg-sheet-height", `${height}px`);
    if (below && !height) page.send("landscape", {}); // viser docks the panel anew, without its width
    below = height > 0;
  }

  // What viser itself has to say is told in the line, too, rather than over the arena.
  function takeToasts() {
    for (const toast of document.querySelectorAll(".mantine-Notification-root")) {
      const parts = [".mantine-Notification-title", ".mantine-Notification-description"];
      const [title, text] = parts.map((part) => toast.querySelector(part)?.textContent ?? "");
      toast.querySelector("button")?.click();
      if (title === SOFTWARE_DRAWING) continue;
      [noted, fresh] = [Date.now(), false];
      note = [title, text].filter(Boolean).join(": ");
      tell();
    }
  }

  // A new message of the server takes the line from a note that could be read, an alarm at once.
  function endNote() {
    if (!note || !fresh || (Date.now() - noted < NOTE_MS && !told.unread)) return;
    note = "";
    tell();
  }

  function check() {
    const answers = page.part("keys")?.connected() ?? false;
    met ||= answers;
    if (met && gone === answers) {
      [gone, since] = [!answers, Date.now()];
      show();
    }
    takeToasts();
    endNote();
    place();
  }

  const sized = new ResizeObserver(place);
  sized.observe(strip);
  const checking = setInterval(check, CHECK_MS);
  show();
  place();

  return {
    host: overlay,

    clock(text) {
      $(".clock").textContent = text;
    },

    run(latest) {
      run = latest;
      show();
    },

    facts(html) {
      $(".facts").innerHTML = html; // made and escaped by the server
    },

    alarms(text) {
      $(".alarms").textContent = text;
    },

    message(latest) {
      fresh ||= latest.time !== told.time || latest.text !== told.text;
      told = latest;
      endNote();
      tell();
    },

    watches(does) {
      strip.classList.toggle("watches", does);
    },

    returned(names) {
      $(".returned").textContent = names.length ? `Acknowledge: ${names.join(", ")}` : "";
    },

    asked(latest) {
      acts.reset.classList.toggle("asked", latest);
      acts.reset.querySelector("span").innerHTML = latest ? "Press again<em> to reset the run</em>" : "Reset<em> run</em>";
    },

    remove() {
      clearInterval(checking);
      sized.disconnect();
      root.removeProperty("--hg-strip-height");
      root.removeProperty("--hg-sheet-height");
      overlay.remove();
    },
  };
}

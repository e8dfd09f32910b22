// Space and a red button that stop the team whatever has the focus, the other keys, and the list of them.
(page, config) => {
  const ALIVE_EVERY_MS = 1000;
  const ALIVE_FOR_MS = 3000;
  const RESEND_MS = 150;
  const CONFIRM_MS = 5000; // time for the second step of a reset
  const DOUBLE_MS = 400; // a hasty second press of the same click is none
  const PHONE_PX = 600; // on a page this narrow the red button stands left of the panel
  const NOTE_MS = 2500;
  const TYPED_MS = 900; // without a further digit, after which the number of a robot is meant
  const UNCONFIRMED_MS = 2000; // an accepted STOP must show as stopped by then

  // Space types a blank only here; everywhere else it stops the team.
  const TYPES_SPACE =
    "textarea, input:not([inputmode]):not([role=combobox]):not([type=checkbox]):not([type=range])";
  const TYPES_LETTERS = "textarea, select, [contenteditable=true], input:not([type=checkbox]):not([type=range])";
  const ENDS_TYPING = "[role=option], .mantine-NumberInput-control"; // a click there has given the field its value
  const TAKES_ENTER = "button, a, summary, [role=button], [role=tab], [role=option], [role=menuitem]";

  const overlay = page.overlay(
    `<style>
      :host { font: calc(14px * var(--hg-size, 1))/1.45 var(--mantine-font-family, sans-serif); }
      * { box-sizing: border-box; }
      .bar { position: absolute; display: flex; gap: 10px; align-items: flex-end; }
      button { pointer-events: auto; cursor: pointer; font: inherit; border: 0; touch-action: manipulation;
        user-select: none; -webkit-user-select: none; -webkit-tap-highlight-color: transparent; }
      button:focus-visible { outline: 3px solid var(--hg-text, #fff); outline-offset: 2px; }
      .stop { width: calc(196px * var(--hg-size, 1)); min-height: 68px; padding: 8px 10px; border-radius: 12px; color: #fff; background: #c81e1e;
        box-shadow: 0 0 0 2px rgba(255, 255, 255, 0.85), 0 4px 16px rgba(0, 0, 0, 0.45); line-height: 1.2; }
      .stop:hover { background: #dc2626; }
      .stop:active { filter: brightness(0.85); }
      .stop b { display: block; font-size: calc(17px * var(--hg-size, 1)); font-weight: 700; letter-spacing: 0.02em; }
      .stop.ready b { font-size: calc(22px * var(--hg-size, 1)); font-weight: 800; letter-spacing: 0.06em; }
      .stop span { display: block; font-size: calc(12.5px * var(--hg-size, 1)); opacity: 0.95; }
      .stop.sending, .stop.accepted { background: #7f1d1d; }
      .stop.stopped, .stop.asked { color: #991b1b; background: #fff;
        box-shadow: 0 0 0 4px #dc2626, 0 4px 16px rgba(0, 0, 0, 0.45); }
      .stop.asked { color: #7c2d12; background: #fde68a; }
      .stop.offline { background: #3f1d1d; box-shadow: 0 0 0 3px #f59e0b, 0 4px 16px rgba(0, 0, 0, 0.45); }
      .ask { width: 34px; height: 34px; border-radius: 50%; color: var(--hg-text, #cbd5e1);
        background: var(--hg-card, #161b21); font-size: calc(16px * var(--hg-size, 1)); font-weight: 600;
        box-shadow: 0 0 0 1px var(--hg-border, #4b5563); }
      .note { padding: 5px 12px; border-radius: 8px; font-weight: 600; color: var(--hg-badge_text, #0d1117);
        background: var(--hg-operator, #f0e442); }
      .note:empty { display: none; }
      .ask:hover { background: var(--hg-key, #2b323c); }
      .veil { position: absolute; inset: 0; display: none; pointer-events: auto; align-items: center;
        padding: 24px 16px 108px; /* the last row ends above the red button */
        justify-content: center; background: rgba(0, 0, 0, 0.35); }
      .veil.open { display: flex; }
      .card { width: min(860px, 92vw); max-height: 100%; overflow: auto; padding: 22px 26px 18px; border-radius: 14px;
        color: var(--hg-text, #dbe2ea); background: var(--hg-card, #161b21);
        box-shadow: 0 12px 48px rgba(0, 0, 0, 0.5); border: 1px solid var(--hg-card_rule, #343c46); }
      h2 { margin: 0 0 12px; font-size: calc(17px * var(--hg-size, 1)); font-weight: 600; }
      h3 { margin: 16px 0 8px; font-size: calc(12px * var(--hg-size, 1)); font-weight: 600; color: var(--hg-dim, #8d99a8); letter-spacing: 0.08em;
        text-transform: uppercase; }
      dl { display: grid; grid-template-columns: max-content 1fr max-content 1fr; gap: 8px 14px; margin: 0;
        align-items: baseline; }
      dt { justify-self: end; min-width: 76px; text-align: right; }
      @media (min-width: 1200px) {
        .card { width: min(1220px, 95vw); padding: 18px 24px 16px; }
        dl { grid-template-columns: repeat(3, max-content 1fr); gap: 5px 12px; }
        .card h3 { margin: 12px 0 6px; }
        .card p { display: inline-block; margin: 12px 18px 0 0; }
        .card .again { margin-top: 12px; }
      }
      dd { margin: 0; }
      kbd { display: inline-block; white-space: nowrap; min-width: 26px; padding: 1px 8px; border-radius: 6px; text-align: center;
        font: 600 calc(13px * var(--hg-size, 1))/1.6 ui-monospace, "DejaVu Sans Mono", monospace; color: var(--hg-text, #f1f5f9);
        background: var(--hg-key, #2b323c); box-shadow: 0 0 0 1px var(--hg-card_rule, #343c46); }
      .stops kbd { color: #fff; background: #b91c1c; }
      p { margin: 14px 0 0; font-size: calc(12.5px * var(--hg-size, 1)); color: var(--hg-dim, #98a4b3); }
      .again { margin-top: 14px; padding: 5px 12px; border-radius: 6px; color: var(--hg-text, #dbe2ea);
        background: var(--hg-key, #2b323c); box-shadow: 0 0 0 1px var(--hg-card_rule, #343c46); }
      @media (max-width: ${PHONE_PX}px) {
        .bar { flex-direction: column-reverse; align-items: flex-start; }
        .stop { width: calc(100px * var(--hg-size, 1)); padding: 8px 4px; }
        .veil { padding: 12px 8px 142px; } /* above the "?", too */
        .card { padding: 16px 14px; }
        dl { grid-template-columns: max-content 1fr; }
      }
    </style>
    <div class="veil"><div class="card" role="dialog" aria-label="Keys"></div></div>
    <div class="bar">
      <button class="stop" type="button" aria-live="assertive"><b></b><span></span></button>
      <button class="ask" type="button" title="Keys" aria-label="Keys">?</button>
      <span class="note" role="status"></span>
    </div>`,
    2147483647,
  );
  const $ = (selector) => overlay.shadowRoot.querySelector(selector);
  const [bar, button, veil] = [$(".bar"), $(".stop"), $(".veil")];

  const stop = {
    number: 0, // of the last press
    waiting: false, // until the server has acknowledged that number
    acceptedAt: -Infinity,
    unconfirmed: false, // accepted, and not yet shown as stopped
    latched: false, // what the server says
    latchedAt: -Infinity,
    askedAt: -Infinity,
  };
  const typed = { digits: "", timer: null, robots: 9 }; // the number of a robot that is being typed
  const alive = { connection: null, heardAt: -Infinity, askedAt: -Infinity, askedOf: null };

  const now = () => performance.now();
  const since = (moment) => now() - moment;
  const connected = () => alive.connection === page.connection() && since(alive.heardAt) < ALIVE_FOR_MS;

  function sendKey(name, number = 0) {
    page.send("key", { name, number });
  }

  function pressStop() {
    stop.number = Math.max(stop.number + 1, Date.now());
    stop.waiting = true;
    stop.askedAt = -Infinity;
    sendKey("stop", stop.number);
    show();
  }

  // The button stops; once stopped, two unhurried presses reset.
  function pressButton() {
    if (!stop.latched) return pressStop();
    if (!connected() || since(stop.latchedAt) < DOUBLE_MS || since(stop.askedAt) < DOUBLE_MS) return;
    const confirmed = since(stop.askedAt) < CONFIRM_MS;
    sendKey(confirmed ? "reset_stop" : "ask_reset");
    stop.askedAt = confirmed ? -Infinity : now();
    show();
  }

  function face() {
    if (!connected()) {
      const text = stop.waiting ? "STOP waits for the server" : "STOP cannot reach the server";
      return ["offline", "No connection", text];
    }
    if (stop.waiting) return ["sending", "STOP sent", "not acknowledged yet …"];
    if (stop.latched && since(stop.askedAt) < CONFIRM_MS) {
      const seconds = Math.ceil((CONFIRM_MS - since(stop.askedAt)) / 1000);
      return ["asked", `Reset? (${seconds} s)`, "press again to confirm"];
    }
    if (stop.latched) return ["stopped", "STOPPED", "Reset …"];
    if (stop.unconfirmed && since(stop.acceptedAt) < UNCONFIRMED_MS) return ["accepted", "STOP received", "stopping …"];
    if (stop.unconfirmed) return ["offline", "Not confirmed", "press STOP again"];
    return ["ready", "STOP", "Space"];
  }

  let shown = "";
  function show() {
    const rect = page.canvas()?.getBoundingClientRect();
    bar.style.left = `${(rect?.left ?? 0) + (window.innerWidth > PHONE_PX ? 18 : 10)}px`;
    bar.style.bottom = `${Math.max(window.innerHeight - (rect?.bottom ?? window.innerHeight), 0) + 18}px`;
    const [state, title, text] = face();
    if (shown === state + title + text) return;
    shown = state + title + text;
    button.className = `stop ${state}`;
    button.querySelector("b").textContent = title;
    button.querySelector("span").textContent = text;
  }

  // Asks the server for a sign of life; a STOP that it has not acknowledged is sent again.
  function beat() {
    const connection = page.connection();
    if (stop.waiting || since(alive.heardAt) > 1.5 * ALIVE_EVERY_MS) page.readNow();
    if (stop.waiting && connected()) sendKey("stop", stop.number);
    if (since(alive.askedAt) > ALIVE_EVERY_MS || alive.askedOf !== connection) {
      [alive.askedAt, alive.askedOf] = [now(), connection];
      page.send("alive", {});
    }
    if (!document.hidden) show();
  }

  function fillCard() {
    const entry = ([key, text]) => {
      const [dt, kbd, dd] = ["dt", "kbd", "dd"].map((tag) => document.createElement(tag));
      kbd.textContent = key;
      dd.textContent = text;
      dt.append(kbd);
      return [dt, dd];
    };
    const list = (entries) => {
      const dl = document.createElement("dl");
      dl.append(...entries.flatMap(entry));
      return dl;
    };
    const heading = (tag, text) => Object.assign(document.createElement(tag), { textContent: text });
    const keys = list(config.keys);
    keys.firstElementChild.className = "stops";
    $(".card").append(
      heading("h2", "Keys"),
      keys,
      heading("h3", "Pointer in the arena"),
      list(config.pointer),
      heading("p", config.note),
    );
    const again = Object.assign(document.createElement("button"), { className: "again", type: "button" });
    again.textContent = "Show the first steps again";
    again.addEventListener("click", () => {
      toggleHelp(false);
      page.part("hints")?.reopen();
    });
    $(".card").append(again);
  }

  function toggleHelp(open = !veil.classList.contains("open")) {
    // In portrait the buttons stand in the arena, with room for the list below them.
    const end = bar.getBoundingClientRect().bottom;
    veil.style.padding = end < 0.75 * innerHeight ? `${end + 12}px 8px 12px` : "";
    veil.classList.toggle("open", open);
  }

  // A Latin letter as printed on the key; on a keyboard without Latin letters, the one at that place. What a Latin
  // layout prints there, punctuation and accented letters included, is never another key.
  function letterOf({ key, code }) {
    const printed = key.toLowerCase();
    if (/^[a-z]$/.test(printed)) return printed;
    const foreign = /^[\p{L}\p{M}]$/u.test(key) && !/[\p{Script=Latin}\p{Script=Common}]/u.test(key);
    return foreign && /^Key[A-Z]$/.test(code) ? code[3].toLowerCase() : undefined;
  }

  // A digit as printed; of the row of digits also where a layout prints it with Shift only.
  function digitOf({ key, code, shiftKey }) {
    if (/^[0-9]$/.test(key)) return key;
    return [...key].length === 1 && !shiftKey ? /^Digit([0-9])$/.exec(code)?.[1] : undefined;
  }

  const hotkey = (event) => config.names[letterOf(event) ?? event.key.toLowerCase()];

  // The number of a robot, digit by digit: it is complete when no robot has a longer one, on Enter or after a pause.
  function typeDigit(digit) {
    clearTimeout(typed.timer);
    typed.digits = `${typed.digits}${digit}`.replace(/^0+/, "");
    if (!typed.digits) return showTyped();
    if (10 * Number(typed.digits) > typed.robots) return pickTyped();
    typed.timer = setTimeout(pickTyped, TYPED_MS);
    showTyped();
  }
  function pickTyped() {
    const { digits } = typed;
    forgetTyped();
    if (digits) sendKey(`pick_${digits}`);
  }
  function forgetTyped() {
    clearTimeout(typed.timer);
    typed.digits = "";
    showTyped();
  }
  function showTyped() {
    showNote(typed.digits && `Robot ${typed.digits} …`);
  }

  let noteTimer = null;
  function showNote(text, milliseconds = 0) {
    clearTimeout(noteTimer);
    $(".note").textContent = text;
    if (milliseconds) noteTimer = setTimeout(() => showNote(""), milliseconds);
  }

  const endsTyping = ({ key, isComposing }, field) =>
    !isComposing && (key === "Escape" || (key === "Enter" && !field.matches("textarea")));

  // A field that kept the focus would keep the letters; what the key or the click means to it comes first, and the
  // next key after it, however busy the page is.
  let left; // the field to take the focus from
  function leave(field) {
    if (!field.matches(TYPES_LETTERS) || field.closest("[role=dialog]")) return;
    left = field;
    setTimeout(takeFocus);
  }
  function takeFocus() {
    left?.blur();
    left = undefined;
  }

  function onKeyDown(event) {
    takeFocus();
    const target = document.activeElement === document.body ? document.body : event.composedPath()[0];
    if (event.code === "Space") {
      if (target.matches?.(TYPES_SPACE)) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      if (!event.repeat) pressStop();
      return;
    }
    if (event.key === "Escape" && veil.classList.contains("open")) {
      event.stopImmediatePropagation();
      toggleHelp(false);
      return;
    }
    if (target.matches?.(TYPES_LETTERS)) {
      if (endsTyping(event, target)) leave(target);
      return;
    }
    if (event.altKey || event.isComposing || event.getModifierState("AltGraph")) return;
    if (event.ctrlKey || event.metaKey) {
      const turn = { z: event.shiftKey ? "redo" : "undo", y: "redo" }[letterOf(event)];
      if (!turn) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      sendKey(turn);
      return;
    }
    const digit = digitOf(event);
    const name = digit ? "pick" : hotkey(event);
    if (!name || (event.key === "Enter" && target.matches?.(TAKES_ENTER))) return;
    if (event.key !== "Escape") {
      event.preventDefault(); // what else Escape closes may hear it too
      event.stopImmediatePropagation();
    }
    if (event.repeat) return;
    if (digit) return typeDigit(digit);
    if (typed.digits) {
      const ends = event.key === "Escape" ? forgetTyped : pickTyped;
      ends();
      if (event.key === "Escape" || event.key === "Enter") return event.stopImmediatePropagation();
    }
    if (name === "help") toggleHelp();
    else if (name === "fit_view") page.part("camera")?.fit();
    else sendKey(name);
  }

  // A browser may press the focused button when Space is released.
  function onKeyUp(event) {
    if (event.code !== "Space" || event.composedPath()[0].matches?.(TYPES_SPACE)) return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }

  function onClick(event) {
    if (event.target.closest?.(ENDS_TYPING)) leave(document.activeElement);
  }

  // Pressed at once by a pointer, and by a click where there is none: Enter, assistive technology.
  button.addEventListener("pointerdown", (event) => {
    event.stopPropagation();
    if (event.button === 0) pressButton();
  });
  button.addEventListener("click", (event) => event.detail === 0 && pressButton());
  bar.addEventListener("mousedown", (event) => event.preventDefault()); // the focus stays where it is
  $(".ask").addEventListener("click", () => toggleHelp());
  veil.addEventListener("click", (event) => event.target === veil && toggleHelp(false));

  fillCard();
  show();
  const beating = setInterval(beat, RESEND_MS);
  const forget = page.listen({ keydown: onKeyDown, keyup: onKeyUp, click: onClick });

  return {
    beat,
    connected,

    alive() {
      [alive.connection, alive.heardAt] = [page.connection(), now()];
      if (stop.waiting) sendKey("stop", stop.number);
      show();
    },

    acknowledged(number) {
      if (!stop.waiting || number !== stop.number) return;
      stop.waiting = false;
      [stop.acceptedAt, stop.unconfirmed] = [now(), !stop.latched];
      show();
    },

    // A few words for a moment.
    note(text) {
      forgetTyped();
      showNote(text, NOTE_MS);
    },

    // How many robots there are.
    robots(count) {
      typed.robots = count;
    },

    // This page may not reset.
    refused() {
      stop.askedAt = -Infinity;
      show();
    },

    stopped(latched) {
      if (latched !== stop.latched) [stop.askedAt, stop.latchedAt] = [-Infinity, now()];
      stop.latched = latched;
      if (latched) stop.unconfirmed = false;
      show();
    },

    remove() {
      clearInterval(beating);
      clearTimeout(typed.timer);
      clearTimeout(noteTimer);
      forget();
      overlay.remove();
    },
  };
}

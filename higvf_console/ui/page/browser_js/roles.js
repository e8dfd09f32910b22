// Who steers and who watches, in the strip over the arena; one click asks for control, grants, takes or releases it.
(page) => {
  const SEND_EVERY_MS = 1000;
  const CHECK_MS = 150;
  const NOTE_MS = 4000;
  const STORE = "higvf identity";
  const WANTED = new Set(["Grant", "Request", "Take control"]); // the gentle way; the others are drawn quietly

  // Kept by the tab from one load to the next, and by nobody meanwhile: a copy of the tab finds none and makes its own.
  const fresh = () =>
    [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
  const putAway = () => sessionStorage.setItem(STORE, identity);
  const takeOut = () => sessionStorage.removeItem(STORE);
  let identity = sessionStorage.getItem(STORE) ?? fresh();
  takeOut();

  const host = document.createElement("div");
  host.style.minWidth = "0";
  host.attachShadow({ mode: "open" }).innerHTML = `<style>
      :host { font: calc(13px * var(--hg-size, 1))/1.4 var(--mantine-font-family, sans-serif); }
      .roles { display: flex; align-items: center; gap: 8px; box-sizing: border-box; height: 2.3em;
        padding: 0 4px 0 10px; border-radius: 6px; white-space: nowrap; color: var(--hg-text, #d5dbe2);
        background: var(--hg-card, #161b21); box-shadow: inset 0 0 0 1px var(--hg-card_rule, #343c46); }
      .roles.asks { box-shadow: 0 0 0 2px var(--hg-operator, #f0e442); }
      .roles.note { box-shadow: 0 0 0 2px var(--hg-warning, #e69f00); }
      .mark { flex: none; width: 8px; height: 8px; border-radius: 50%; box-shadow: 0 0 0 2px var(--hg-dim, #9aa5b1); }
      .steers .mark { background: var(--hg-operator, #f0e442); box-shadow: 0 0 0 2px var(--hg-operator, #f0e442); }
      .text { overflow: hidden; text-overflow: ellipsis; margin-right: 4px; }
      .acts { display: flex; gap: 6px; }
      button { pointer-events: auto; cursor: pointer; flex: none; min-height: 26px; padding: 0 10px; border: 0;
        border-radius: 6px; font: inherit; font-weight: 600; color: inherit; background: var(--hg-key, #2b323c);
        box-shadow: inset 0 0 0 1px var(--hg-card_rule, #343c46); touch-action: manipulation; }
      button.first { color: var(--hg-badge_text, #0d1117); background: var(--hg-operator, #f0e442); box-shadow: none; }
      button:hover { filter: brightness(1.12); }
      button:focus-visible { outline: 2px solid var(--hg-text, #fff); outline-offset: 1px; }
      @media (pointer: coarse) { button { min-height: 38px; padding: 0 14px; } }
    </style>
    <div class="roles" role="status">
      <span class="mark"></span><span class="text"></span><span class="acts"></span>
    </div>`;

  const $ = (selector) => host.shadowRoot.querySelector(selector);
  const [strip, text, acts] = [$(".roles"), $(".text"), $(".acts")];

  const now = () => performance.now();
  const sent = { connection: null, at: -Infinity };
  let role = null; // as the server last reported
  let note = { text: "", until: -Infinity };

  const who = (role) => (role.holder ? `${role.holder} steers` : "Nobody steers");

  // Text, mark, and buttons as [label, act, page].
  function face() {
    if (role.steers && role.waiting.length) {
      const [asker, ...more] = role.waiting;
      const others = more.length ? ` (and ${more.length} more)` : "";
      const answers = [["Grant", "grant", asker], ["Refuse", "refuse", asker]];
      return [`${asker} asks for control${others}`, "steers asks", answers];
    }
    if (alone()) return ["You steer", "steers", []];
    if (role.steers) {
      const watch = role.others === 1 ? "watches" : "watch";
      return [`You steer, ${role.others} ${watch}`, "steers", [["Release", "release"]]];
    }
    if (role.role === "observer") return [`${who(role)}, you observe`, "", []];
    if (!role.holder) return ["Nobody steers", "", [["Take control", "take"]]];
    const ask = role.asked ? [] : [["Request", "ask"]];
    const rest = role.asked ? "you asked" : role.waiting.length ? `${role.waiting[0]} asked` : "you watch";
    return [`${who(role)}, ${rest}`, "", [...ask, ["Take over", "take"]]];
  }

  // What the cards say of their buttons.
  function idle() {
    if (role.steers) return "";
    if (role.holder) return `${role.holder} steers: only that page can use these buttons.`;
    if (role.role === "observer") return "Nobody steers: only a page that does can use these buttons.";
    return "Nobody steers: take control to use these buttons.";
  }

  const noted = () => now() < note.until;
  const alone = () => role.steers && role.others === 0 && !noted();

  let shown = "";
  function show() {
    const bar = page.part("strip")?.host;
    if (bar && host.parentElement !== bar) bar.append(host);
    if (!role) return;
    page.part("strip")?.watches(!role.steers);
    page.part("cards")?.watches(idle());
    const [says, look, buttons] = face();
    const key = JSON.stringify([says, look, buttons, noted() && note.text]);
    if (key === shown) return;
    shown = key;
    strip.className = `roles ${alone() ? "" : "open"} ${look} ${noted() ? "note" : ""}`;
    strip.title = `This page is ${role.you}`;
    text.textContent = noted() ? note.text : says;
    acts.replaceChildren(
      ...buttons.map(([label, act, asker]) => {
        const button = document.createElement("button");
        [button.type, button.textContent] = ["button", label];
        if (WANTED.has(label)) button.className = "first";
        button.addEventListener("click", () => page.send("control", { act, page: asker ?? "" }));
        return button;
      }),
    );
  }

  function say(words) {
    note = { text: words, until: now() + NOTE_MS };
    show();
  }

  function sendPresence() {
    [sent.connection, sent.at] = [page.connection(), now()];
    page.send("hello", { identity });
  }

  function check() {
    if (page.connection() !== sent.connection || now() - sent.at > SEND_EVERY_MS) sendPresence();
    show();
  }

  // viser reads what has arrived when it draws a frame, and a hidden page draws none.
  function checkHidden() {
    if (!document.hidden) return;
    page.readNow();
    check();
    page.part("keys")?.beat();
  }

  strip.addEventListener("mousedown", (event) => event.preventDefault()); // the focus stays where it is
  const checking = setInterval(check, CHECK_MS);
  const stopCheckingHidden = page.steadily(SEND_EVERY_MS / 2, checkHidden);
  const forget = page.listen({
    pagehide: putAway,
    pageshow: (event) => event.persisted && takeOut(),
  });
  check();

  return {
    show(latest) {
      const before = role;
      role = latest;
      note.until = -Infinity;
      document.body.classList.toggle("hg-watches", !role.steers);
      if (before?.steers && !role.steers) {
        page.part("pointer")?.cancel();
        if (role.holder) say(`${role.holder} steers now`);
      } else if (before?.asked && !role.asked && !role.steers && role.holder === before.holder) {
        say(`${role.holder} refused your request`);
      }
      show();
    },

    // What this page tried is for the one that steers.
    refused() {
      if (role) say(`${who(role)}: you cannot do that here`);
      page.part("pointer")?.cancel();
      page.part("keys")?.refused();
    },

    lacks([wanted, has]) {
      say(`This needs the role ${wanted}; this page has the role ${has}`);
      page.part("pointer")?.cancel();
      page.part("keys")?.refused();
    },

    slowed(count) {
      if (role) say(`This page sends too much: ${count} messages were dropped`);
    },

    // Another page goes by this identity.
    renew() {
      identity = fresh();
      sendPresence();
    },

    remove() {
      putAway();
      document.body.classList.remove("hg-watches");
      clearInterval(checking);
      stopCheckingHidden();
      forget();
      host.remove();
    },
  };
}

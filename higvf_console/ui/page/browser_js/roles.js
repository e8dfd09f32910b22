// Who steers and who watches: a strip above the arena, at its right; one click asks for control, grants, takes or releases it.
(page) => {
  const SEND_EVERY_MS = 1000;
  const CHECK_MS = 150;
  const NOTE_MS = 4000;
  const BESIDE_PX = 900; // narrower, and the strip goes below that of the tools
  const GAP = 8; // below a strip [CSS px]
  const STORE = "higvf identity";
  const WANTED = new Set(["Grant", "Request", "Take control"]); // the gentle way; the others are drawn quietly

  // Kept by the tab from one load to the next, and by nobody meanwhile: a copy of the tab finds none and makes its own.
  const fresh = () =>
    [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
  const putAway = () => sessionStorage.setItem(STORE, identity);
  const takeOut = () => sessionStorage.removeItem(STORE);
  let identity = sessionStorage.getItem(STORE) ?? fresh();
  takeOut();

  const overlay = page.overlay(
    `<style>
      :host { font: calc(13px * var(--hg-size, 1))/1.4 var(--mantine-font-family, sans-serif); }
      .roles { position: absolute; transform: translateX(-100%); display: none; align-items: center; gap: 8px;
        box-sizing: border-box; padding: 4px 5px 4px 12px; border-radius: 8px; white-space: nowrap;
        color: var(--hg-text, #d5dbe2); background: var(--hg-card, #161b21);
        box-shadow: 0 0 0 1px var(--hg-border, #4b5563); }
      .roles.open { display: flex; }
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
    </div>`,
    2147483646,
  );

  const $ = (selector) => overlay.shadowRoot.querySelector(selector);
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

  const noted = () => now() < note.until;
  const alone = () => role.steers && role.others === 0 && !noted();

  let shown = "";
  function show() {
    const rect = page.canvas()?.getBoundingClientRect();
    const tools = page.part("tools")?.bottom() ?? 0;
    if (rect?.width) {
      strip.style.left = `${rect.right - 8}px`;
      strip.style.top = `${rect.width < BESIDE_PX ? tools + GAP : 8}px`;
      strip.style.maxWidth = `${rect.width - 16}px`;
    }
    const open = role !== null && !alone();
    strip.classList.toggle("open", open);
    const end = open ? strip.getBoundingClientRect().bottom : tools;
    document.documentElement.style.setProperty("--hg-strips-end", `${end + GAP}px`);
    if (!open) return;
    const [says, look, buttons] = face();
    const key = JSON.stringify([says, look, buttons, noted() && note.text]);
    if (key === shown) return;
    shown = key;
    strip.className = `roles open ${look} ${noted() ? "note" : ""}`;
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

  strip.addEventListener("mousedown", (event) => event.preventDefault()); // the focus stays where it is
  const checking = setInterval(check, CHECK_MS);
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
      forget();
      document.documentElement.style.removeProperty("--hg-strips-end");
      overlay.remove();
    },
  };
}

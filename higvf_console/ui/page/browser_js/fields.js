// What is typed into a field counts when it is complete: on Enter, or when the field is left; Esc takes it back. viser
// would send every key stroke, so it hears of none before.
(page, config) => {
  const ADOPT_MS = 300;
  const TEXT = ".mantine-TextInput-input";
  const NUMBER = ".mantine-NumberInput-input"; // viser's own, beside its sliders
  const CONTROL = ".mantine-NumberInput-control";
  const native = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value");

  let draft = null; // what is being typed: its field, and how React writes there
  let passing = false; // whether an input event is one of ours, for viser

  const fieldOf = ({ target }) => (target.matches?.(`${TEXT}, ${NUMBER}`) ? target : null);

  // viser gives a text field no name that its label knows. `inputmode` marks a field in which Space is no character: all
  // but those that hold words.
  function adopt(field) {
    let root = field;
    while (root && !root.querySelector("label[for]")) root = root.parentElement;
    const uuid = root?.querySelector("label[for]").htmlFor;
    if (!uuid) return;
    field.id = uuid;
    if (!config.words.includes(uuid)) field.inputMode = "text";
  }

  // While a draft is there, React's writes wait: they would take the typed characters away.
  function begin(field) {
    if (draft?.field === field) return;
    commit();
    const own = Object.getOwnPropertyDescriptor(field, "value");
    draft = { field, own };
    Object.defineProperty(field, "value", { configurable: true, get: () => native.get.call(field), set() {} });
  }

  // Ends the draft; the field shows again what React wants, which it also writes as the attribute.
  function end() {
    const { field, own } = draft;
    const [typed, base] = [native.get.call(field), field.defaultValue];
    draft = null;
    delete field.value;
    if (own) Object.defineProperty(field, "value", own);
    field.value = base;
    return { field, typed, base };
  }

  function give(field, text) {
    native.set.call(field, text);
    passing = true;
    field.dispatchEvent(new InputEvent("input", { bubbles: true }));
    passing = false;
  }

  function commit() {
    if (!draft) return;
    const { field, typed, base } = end();
    if (typed === base || !typed.trim()) return;
    if (field.matches(TEXT)) return give(field, typed);
    const [low, high] = limits(field);
    const number = Number(typed.trim().replace(",", "."));
    if (number >= low && number <= high) return give(field, plain(number));
    const range = Number.isFinite(low) ? ` from ${low} to ${high}` : "";
    page.part("keys")?.note(`${typed.slice(0, 20)} is not a number${range}: ${base} stays`);
  }

  // Of the slider that a number stands beside.
  function limits(field) {
    const thumb = field.closest(".mantine-NumberInput-root")?.parentElement?.querySelector("[role=slider]");
    const limit = (name, otherwise) => Number(thumb?.getAttribute(name) ?? otherwise);
    return [limit("aria-valuemin", -Number.MAX_VALUE), limit("aria-valuemax", Number.MAX_VALUE)];
  }

  const plain = (number) => number.toLocaleString("en", { useGrouping: false, maximumFractionDigits: 20 });

  // An arrow adds a tenth of the number's order of magnitude.
  function step(field, sign) {
    const number = Number(field.value);
    if (!field.value.trim() || !Number.isFinite(number)) return false;
    const size = 10 ** (Math.floor(Math.log10(Math.abs(number) || 1)) - 1);
    begin(field);
    native.set.call(field, plain(Number((number + sign * size).toPrecision(12))));
    return true;
  }

  function onBeforeInput(event) {
    const field = fieldOf(event);
    if (field) begin(field);
  }

  function onInput(event) {
    const field = fieldOf(event);
    if (!field || passing) return;
    if (event.type === "input") begin(field);
    event.stopImmediatePropagation();
  }

  function onKeyDown(event) {
    const field = fieldOf(event);
    if (!field || event.isComposing) return;
    if (event.key === "Enter") commit();
    else if (event.key === "Escape" && draft) end();
    else if (event.key === "ArrowUp" || event.key === "ArrowDown") {
      if (field.matches(NUMBER)) commit(); // viser steps it itself
      else if (step(field, event.key === "ArrowUp" ? 1 : -1)) event.preventDefault();
    }
  }

  const forget = page.listen({
    focusin: (event) => fieldOf(event)?.matches(TEXT) && adopt(event.target),
    beforeinput: onBeforeInput,
    input: onInput,
    change: onInput, // before a field is left, and on Enter
    keydown: onKeyDown,
    keyup: (event) => event.key.startsWith("Arrow") && fieldOf(event)?.matches(TEXT) && commit(),
    focusout: (event) => draft?.field === event.target && commit(),
    pointerdown: (event) => event.target.closest?.(CONTROL) && commit(),
  });

  const adopting = setInterval(() => document.querySelectorAll(TEXT).forEach(adopt), ADOPT_MS);

  return {
    remove() {
      clearInterval(adopting);
      if (draft) end();
      forget();
    },
  };
}

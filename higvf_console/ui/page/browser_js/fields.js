// What is typed into a field counts when it is complete: on Enter, or when the field is left; Esc takes it back. viser
// would send every key stroke, so it hears of none before.
(page, config) => {
  const ADOPT_MS = 300;
  const TEXT = ".mantine-TextInput-input";
  const NUMBER = ".mantine-NumberInput-input"; // viser's own: it drops what it does not expect
  const native = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value");

  let draft = null; // what is being typed: its field, and how React writes there
  let passing = false; // whether an input event is one of ours, for viser

  const fieldOf = ({ target }) => (target.matches?.(TEXT) ? target : null);

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

  // The number beside a slider shows its value; `1e-1` typed there would become -11.
  function makeReadOnly(field) {
    const beside = field.closest(".mantine-NumberInput-root")?.parentElement;
    if (beside?.querySelector("[role=slider]")) field.readOnly = true;
  }

  function adoptAll() {
    document.querySelectorAll(TEXT).forEach(adopt);
    document.querySelectorAll(NUMBER).forEach(makeReadOnly);
  }

  // While a draft is there, React's writes are dropped: they would take the typed characters away.
  function begin(field) {
    if (draft?.field === field) return;
    commit();
    draft = { field, own: Object.getOwnPropertyDescriptor(field, "value") };
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

  function commit() {
    if (!draft) return;
    const { field, typed, base } = end();
    if (typed === base || !typed.trim()) return;
    native.set.call(field, typed);
    passing = true;
    field.dispatchEvent(new InputEvent("input", { bubbles: true }));
    passing = false;
  }

  // An arrow adds a tenth of the number's order of magnitude.
  function step(field, sign) {
    const number = Number(field.value);
    if (!field.value.trim() || !Number.isFinite(number)) return false;
    const size = 10 ** (Math.floor(Math.log10(Math.abs(number) || 1)) - 1);
    begin(field);
    native.set.call(field, String(Number((number + sign * size).toPrecision(12))));
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
    const sign = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (event.key === "Enter") commit();
    else if (event.key === "Escape" && draft) end();
    else if (sign && step(field, sign)) event.preventDefault();
  }

  const forget = page.listen({
    focusin: (event) => fieldOf(event) && adopt(event.target),
    beforeinput: onBeforeInput,
    input: onInput,
    change: onInput, // before a field is left, and on Enter
    keydown: onKeyDown,
    keyup: (event) => event.key.startsWith("Arrow") && fieldOf(event) && commit(),
    focusout: (event) => draft?.field === event.target && commit(),
  });
  const adopting = setInterval(adoptAll, ADOPT_MS);

  return {
    remove() {
      clearInterval(adopting);
      if (draft) end();
      forget();
    },
  };
}

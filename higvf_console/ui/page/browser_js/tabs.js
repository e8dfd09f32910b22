// Opens a tab of the panel: docked tabs take the key, those of a phone the click.
() => ({
  open(name) {
    const tab = [...document.querySelectorAll("[role=tab]")].find((tab) => tab.textContent.trim() === name);
    if (!tab || tab.getAttribute("aria-selected") === "true") return;
    tab.focus({ preventScroll: true }); // Enter is a tab's own only there
    tab.dispatchEvent(new KeyboardEvent("keydown", { key: "Enter", code: "Enter", bubbles: true, cancelable: true }));
    tab.click();
    tab.blur();
  },
  remove() {},
})

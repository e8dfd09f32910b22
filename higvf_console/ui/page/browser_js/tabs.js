// Opens a tab of the panel, as a click on it does.
() => ({
  open(name) {
    const tabs = [...document.querySelectorAll("[role=tab]")];
    tabs.find((tab) => tab.textContent.trim() === name)?.click();
  },
  remove() {},
})

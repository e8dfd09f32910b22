// Runs in the page's head, ahead of viser: a page in portrait has the panel below the arena, as viser gives it a phone.
(() => {
  const PHONE = "(max-width: 36em)"; // viser's own question
  const ask = window.matchMedia.bind(window);
  window.matchMedia = (query) => ask(query === PHONE ? `${PHONE}, (max-aspect-ratio: 1/1)` : query);
})();

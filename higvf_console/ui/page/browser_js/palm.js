// A pen rules out fingers: what touches the arena while a pen is near is a palm, and stays one until it is lifted.
(page) => {
  const NEAR_MS = 1000; // after a pen was last felt; one that hovers is felt all the time

  let felt = -Infinity; // when
  const palms = new Set(); // pointers

  function hear(event) {
    if (event.pointerType === "pen") felt = performance.now();
    if (event.pointerType !== "touch") return;
    const starts = event.type === "pointerdown";
    if (starts) palms.delete(event.pointerId); // browsers use numbers again
    if (starts && event.target === page.canvas() && performance.now() - felt < NEAR_MS) palms.add(event.pointerId);
    if (!palms.has(event.pointerId)) return;
    event.stopImmediatePropagation();
    if (event.type === "pointerup" || event.type === "pointercancel") palms.delete(event.pointerId);
  }

  const heard = ["pointerover", "pointerdown", "pointermove", "pointerup", "pointercancel"];
  return { remove: page.listen(Object.fromEntries(heard.map((type) => [type, hear]))) };
}

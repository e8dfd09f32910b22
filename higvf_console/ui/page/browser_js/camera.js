// A camera that stays straight above the arena: the wheel zooms to the cursor, the right button or two fingers pan.
(page, config) => {
  const { arena, padding } = config; // [m], [CSS px]
  const halfHeight = Math.tan(config.fov / 2); // of the view, per metre of distance
  const CLOSEST = 1 / 200; // scale limits, relative to the view that fits the arena
  const FARTHEST = 3;

  // The truth about the view; whatever else moves the camera is put back to it.
  const view = { x: 0, y: 0, scale: 1, fitted: true };
  let controls = null;
  let placing = false;

  const between = (low, value, high) => Math.min(Math.max(value, low), high);

  const top = () => Math.max(padding.top, (page.part("tools")?.reach() ?? 0) + 14);

  const fitScale = (rect) =>
    Math.max(
      (arena.x_max - arena.x_min) / Math.max(rect.width - padding.left - padding.right, 1),
      (arena.y_max - arena.y_min) / Math.max(rect.height - top() - padding.bottom, 1),
    );

  function place() {
    const { camera, nodeRefFromName, requestRender } = page.viewer() ?? {};
    const root = nodeRefFromName?.[""];
    const height = page.canvas()?.getBoundingClientRect().height;
    if (!controls || !camera || !root || !height) return;
    root.updateWorldMatrix(true, false);
    const Vector = camera.position.constructor;
    const distance = (height * view.scale) / (2 * halfHeight);
    const target = root.localToWorld(new Vector(view.x, view.y, 0));
    const position = root.localToWorld(new Vector(view.x, view.y, distance));
    placing = true;
    camera.fov = (config.fov * 180) / Math.PI;
    camera.near = distance * 0.2;
    camera.far = distance * 2;
    camera.updateProjectionMatrix();
    camera.up.copy(root.localToWorld(new Vector(0, 1, 0)).sub(root.localToWorld(new Vector()))).normalize();
    controls.updateCameraUp();
    controls.setPosition(position.x, position.y, position.z, false);
    controls.setTarget(target.x, target.y, target.z, false);
    controls.update(0);
    placing = false;
    requestRender();
  }

  function fit() {
    const rect = page.canvas()?.getBoundingClientRect();
    if (!rect?.width) return;
    view.fitted = true;
    view.scale = fitScale(rect);
    view.x = (arena.x_min + arena.x_max) / 2 + ((padding.right - padding.left) / 2) * view.scale;
    view.y = (arena.y_min + arena.y_max) / 2 + ((top() - padding.bottom) / 2) * view.scale;
    place();
  }

  // Puts the ground point (x, y) under the given page point, at the given scale.
  function hold(x, y, clientX, clientY, scale) {
    const rect = page.canvas().getBoundingClientRect();
    const best = fitScale(rect);
    view.fitted = false;
    view.scale = between(best * CLOSEST, scale, best * FARTHEST);
    const right = clientX - rect.left - rect.width / 2;
    const down = clientY - rect.top - rect.height / 2;
    view.x = between(arena.x_min, x - right * view.scale, arena.x_max);
    view.y = between(arena.y_min, y + down * view.scale, arena.y_max);
    place();
  }

  const ground = (clientX, clientY) =>
    page.toGround({ ...view, rect: page.canvas().getBoundingClientRect() }, clientX, clientY);

  function onWheel(event) {
    if (event.target !== page.canvas()) return;
    event.preventDefault();
    event.stopPropagation();
    const pixels = event.deltaY * [1, 16, 400][event.deltaMode];
    // A pinch on a touch pad arrives as a wheel with Ctrl and small steps.
    const factor = Math.exp(between(-240, event.ctrlKey ? pixels * 6 : pixels, 240) * 0.0015);
    hold(...ground(event.clientX, event.clientY), event.clientX, event.clientY, view.scale * factor);
  }

  // What is being panned: the ground point that was grasped, or the ground points under two fingers.
  let pan = null;
  const fingers = new Map();

  function onDown(event) {
    if (event.target !== page.canvas()) return;
    if (event.pointerType === "touch") fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const pinching = fingers.size === 2;
    if (!pinching && event.button !== 1 && event.button !== 2) return;
    event.stopPropagation();
    pan = { pointer: event.pointerId, ...(grip() ?? { x: event.clientX, y: event.clientY }) };
    [pan.groundX, pan.groundY] = ground(pan.x, pan.y);
    pan.scale = view.scale;
    if (!pinching) capture(event);
  }

  // Middle of two fingers and their distance; null while there are not two.
  function grip() {
    if (fingers.size !== 2) return null;
    const [a, b] = [...fingers.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, spread: Math.max(Math.hypot(a.x - b.x, a.y - b.y), 1) };
  }

  function capture(event) {
    try {
      page.canvas().setPointerCapture(event.pointerId);
    } catch {
      // A pointer that has gone already cannot be captured: its pan ends with it.
    }
  }

  function onMove(event) {
    if (fingers.has(event.pointerId)) fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (!pan) return;
    const two = grip();
    if (!two && event.pointerId !== pan.pointer) return;
    event.stopPropagation();
    if (two) hold(pan.groundX, pan.groundY, two.x, two.y, (pan.scale * pan.spread) / two.spread);
    else hold(pan.groundX, pan.groundY, event.clientX, event.clientY, view.scale);
  }

  function onUp(event) {
    const pinched = fingers.delete(event.pointerId);
    if (pan && (pinched || event.pointerId === pan.pointer)) pan = null;
  }

  // The context menu would open at the end of every pan.
  function onContextMenu(event) {
    if (event.target === page.canvas()) event.preventDefault();
  }

  function onCameraUpdate() {
    if (!placing) place();
  }

  const resized = new ResizeObserver(() => (view.fitted ? fit() : place()));

  // viser makes its camera controls late, and may make them again.
  function adopt() {
    const current = page.viewer()?.cameraControl;
    if (!current || current === controls) return;
    controls?.removeEventListener("update", onCameraUpdate);
    controls = current;
    for (const button of ["left", "middle", "right", "wheel"]) controls.mouseButtons[button] = 0;
    for (const touch of ["one", "two", "three"]) controls.touches[touch] = 0;
    controls.addEventListener("update", onCameraUpdate);
    window.__viserTestpoints?.devSettings.set({ enableOrbitCrosshair: false });
    resized.disconnect();
    resized.observe(page.canvas());
    view.fitted ? fit() : place();
  }

  adopt();
  const adopting = setInterval(adopt, 100);
  const forget = page.listen({
    pointerdown: onDown,
    pointermove: onMove,
    pointerup: onUp,
    pointercancel: onUp,
    contextmenu: onContextMenu,
  });
  const forgetWheel = page.listen({ wheel: onWheel }, { passive: false });

  return {
    fit,
    remove() {
      clearInterval(adopting);
      controls?.removeEventListener("update", onCameraUpdate);
      resized.disconnect();
      forget();
      forgetWheel();
    },
  };
}

// The page's end of `ui/page/page.py`: one instance of each script, however often the server replays it.
() => {
  if (window.higvf) return;

  const parts = new Map();
  const viewer = () => window.__viserMutable;
  const canvas = () => viewer()?.canvas ?? null;

  // viser reconnects only a page that has the focus; a display on the wall never has it.
  document.hasFocus = () => true;

  const page = {
    viewer,
    canvas,

    // Identity of the connection: viser replaces its sender whenever the socket opens or closes.
    connection: () => viewer()?.sendMessage,

    // Any script may hear what the others send, by a method of that name.
    send(topic, body) {
      for (const { part } of parts.values()) part.sent?.(topic, body);
      viewer()?.sendMessage({ type: "PageMessage", topic, body });
    },

    // viser reads what has arrived when it draws a frame; a slow graphics card must not hold up an answer.
    readNow: () => viewer()?.drainMessageQueue?.(),

    part: (name) => parts.get(name)?.part,

    // How the canvas lies over the ground z = 0: its rectangle [CSS px], ground centre [m] and scale [m/CSS px].
    view() {
      const { camera, nodeRefFromName } = viewer() ?? {};
      const root = nodeRefFromName?.[""];
      const rect = canvas()?.getBoundingClientRect();
      if (!camera || !root || !rect?.width || !rect.height) return null;
      camera.updateMatrixWorld();
      root.updateWorldMatrix(true, false);
      const Vector = camera.position.constructor;
      const eye = root.worldToLocal(camera.position.clone());
      const groundAt = (x) => {
        const ray = root.worldToLocal(new Vector(x, 0, 0.5).unproject(camera)).sub(eye);
        return eye.clone().addScaledVector(ray, -eye.z / ray.z);
      };
      const centre = groundAt(0);
      const scale = (2 * (groundAt(1).x - centre.x)) / rect.width;
      return Number.isFinite(scale) && scale > 0 ? { rect, x: centre.x, y: centre.y, scale } : null;
    },

    toGround: (view, clientX, clientY) => [
      view.x + (clientX - view.rect.left - view.rect.width / 2) * view.scale,
      view.y - (clientY - view.rect.top - view.rect.height / 2) * view.scale,
    ],

    // Listeners on the window, ahead of viser's own, which stopPropagation keeps out; the result removes them.
    listen(handlers, options = {}) {
      const settings = { capture: true, ...options };
      for (const [type, handler] of Object.entries(handlers)) window.addEventListener(type, handler, settings);
      return () => {
        for (const [type, handler] of Object.entries(handlers)) window.removeEventListener(type, handler, settings);
      };
    },

    // Calls back in time also while the tab is hidden, where the browser holds back the page's own timers.
    steadily(milliseconds, callback) {
      const source = URL.createObjectURL(new Blob([`setInterval(() => postMessage(0), ${milliseconds})`]));
      const worker = new Worker(source);
      worker.onmessage = callback;
      return () => {
        worker.terminate();
        URL.revokeObjectURL(source);
      };
    },

    // An overlay above everything of viser's, out of reach of its style sheet.
    overlay(html, zIndex) {
      const host = document.createElement("div");
      host.style.cssText = `position:fixed;inset:0;pointer-events:none;z-index:${zIndex}`;
      host.attachShadow({ mode: "open" }).innerHTML = html;
      document.body.appendChild(host);
      return host;
    },
  };

  // viser drops all other messages of a packet when one of them raises: the scene would stay incomplete.
  function guarded(name, act) {
    try {
      act();
    } catch (error) {
      console.error(`higvf ${name}:`, error);
    }
  }

  window.higvf = {
    install(name, version, make, config) {
      const old = parts.get(name);
      if (old?.version === version) return;
      guarded(name, () => {
        old?.part.remove();
        parts.set(name, { version, part: make(page, config) });
      });
    },

    call(name, method, argument) {
      guarded(name, () => parts.get(name)?.part[method](argument));
    },
  };
}

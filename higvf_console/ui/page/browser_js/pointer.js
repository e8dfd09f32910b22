// Strokes and clicks in the arena at the pointer's full resolution, and how the page lies over the ground.
(page, config) => {
  const LEFT = 1; // of a mouse's buttons; the tip of a pen and a finger too
  const CLICK_PX = 4; // a press that moves less is a click
  const FLUSH_MS = 33;
  const REPORT_MS = 200;
  const CHUNK = 1000; // points a message

  const style = `<style>
    svg { position: absolute; overflow: hidden; }
    polyline { fill: none; stroke-linecap: round; stroke-linejoin: round; vector-effect: non-scaling-stroke; }
    .casing { stroke: var(--hg-surround, #0b0d10); stroke-width: 6px; opacity: 0.55; }
    .line { stroke: ${config.colour}; stroke-width: 3px; }
    g { transition: opacity 0.35s; }
    g.done { opacity: 0; }
  </style>`;
  const overlay = page.overlay(`${style}<svg><g><polyline class="casing"/><polyline class="line"/></g></svg>`, 1);
  const svg = overlay.shadowRoot.querySelector("svg");
  const group = svg.querySelector("g");
  const lines = [...svg.querySelectorAll("polyline")];

  let stroke = null;
  let lastId = 0;
  let origin = [0, 0]; // of the echo's coordinates [m]; keeps its numbers small
  let following = false;
  let inks = true; // whether a drag leaves a line

  // The echo is drawn in metres, so that zooming and panning only change its transform.
  function follow() {
    const view = page.view();
    if (view) {
      const { left, top, width, height } = view.rect;
      svg.style.cssText = `left:${left}px;top:${top}px;width:${width}px;height:${height}px`;
      const x = width / 2 + (origin[0] - view.x) / view.scale;
      const y = height / 2 - (origin[1] - view.y) / view.scale;
      group.setAttribute("transform", `matrix(${1 / view.scale} 0 0 ${-1 / view.scale} ${x} ${y})`);
    }
    following = lines[0].points.numberOfItems > 0;
    if (following) requestAnimationFrame(follow);
  }

  function showEcho(point) {
    if (!inks && !stroke.group) return;
    for (const line of lines) {
      const item = svg.createSVGPoint();
      item.x = point[0] - origin[0];
      item.y = point[1] - origin[1];
      line.points.appendItem(item);
    }
    if (!following) follow();
  }

  function clearEcho() {
    group.classList.remove("done");
    for (const line of lines) line.points.clear();
  }

  function send(phase, points) {
    const { id, group } = stroke;
    page.send("stroke", { id, sequence: stroke.sequence++, phase, points: points.flat(), group });
  }

  function flush(phase) {
    clearTimeout(stroke.timer);
    stroke.timer = null;
    while (stroke.waiting.length > CHUNK) send("update", stroke.waiting.splice(0, CHUNK));
    send(phase, stroke.waiting.splice(0));
  }

  function add(event, view) {
    const point = page.toGround(view, event.clientX, event.clientY);
    stroke.last = [event.clientX, event.clientY];
    stroke.reach = Math.max(stroke.reach, Math.hypot(event.clientX - stroke.down[0], event.clientY - stroke.down[1]));
    stroke.waiting.push(point);
    if (stroke.drawn) showEcho(point);
  }

  function begin(event, view) {
    lastId = Math.max(lastId + 1, Date.now());
    stroke = {
      id: lastId,
      pointer: event.pointerId,
      connection: page.connection(),
      group: event.shiftKey, // it is about a group of robots
      down: [event.clientX, event.clientY],
      last: null,
      reach: 0, // farthest from where it was pressed [CSS px]
      drawn: false, // becomes true once the press has moved like a stroke
      sequence: 0,
      waiting: [],
      timer: null,
    };
    add(event, view);
  }

  function draw() {
    clearEcho();
    stroke.drawn = true;
    origin = stroke.waiting[0];
    stroke.waiting.forEach(showEcho);
    send("start", stroke.waiting.splice(0, 1));
    flush("update");
  }

  function cancel() {
    if (!stroke) return;
    if (stroke.drawn && stroke.connection === page.connection()) {
      stroke.waiting = [];
      flush("cancel");
    }
    clearTimeout(stroke.timer);
    stroke = null;
    clearEcho();
  }

  function finish() {
    if (stroke.drawn) {
      flush("end");
      group.classList.add("done");
      setTimeout(() => group.classList.contains("done") && clearEcho(), 400);
    } else {
      page.send("click", { point: stroke.waiting[0], group: stroke.group });
    }
    stroke = null;
  }

  function onDown(event) {
    if (event.target !== page.canvas()) return;
    document.activeElement?.blur();
    if (stroke) cancel(); // a second finger pans and zooms
    const view = page.view();
    if (event.button !== 0 || !event.isPrimary || !view) return;
    event.stopPropagation();
    try {
      event.target.setPointerCapture(event.pointerId);
    } catch {
      // A pointer that has gone already cannot be captured: its stroke ends with it.
    }
    begin(event, view);
  }

  function onMove(event) {
    if (event.pointerId !== stroke?.pointer) return;
    // While another button is held, the left one ends with a move; what follows belongs to no stroke.
    if (!(event.buttons & LEFT)) return onUp(event);
    event.stopPropagation();
    if (stroke.connection !== page.connection()) return cancel();
    const view = page.view();
    const samples = event.getCoalescedEvents();
    for (const sample of samples.length ? samples : [event]) add(sample, view);
    if (stroke.drawn) stroke.timer ??= setTimeout(() => flush("update"), FLUSH_MS);
    else if (stroke.reach >= CLICK_PX) draw();
  }

  function onUp(event) {
    if (event.pointerId !== stroke?.pointer) return;
    event.stopPropagation();
    if (stroke.connection !== page.connection()) return cancel();
    const view = page.view();
    if (event.clientX !== stroke.last[0] || event.clientY !== stroke.last[1]) add(event, view);
    finish();
  }

  function onCancel(event) {
    if (event.pointerId === stroke?.pointer) cancel();
  }

  function onKey(event) {
    if (event.key !== "Escape" || !stroke) return;
    event.stopImmediatePropagation(); // it discards nothing else
    cancel();
  }

  // Dragging must not select the text of the panel.
  function onMouseDown(event) {
    if (event.target === page.canvas()) event.preventDefault();
  }

  let reported = "";
  function report() {
    const view = page.view();
    if (!view || !page.connection()) return;
    const { left, top, width, height } = view.rect;
    const body = {
      page: [window.innerWidth, window.innerHeight],
      canvas: [left, top, width, height],
      pixel_ratio: window.devicePixelRatio,
      centre: [view.x, view.y],
      metres_per_px: view.scale,
    };
    const text = JSON.stringify(body);
    if (text === reported && page.connection() === report.connection) return;
    [reported, report.connection] = [text, page.connection()];
    page.send("viewport", body);
  }

  const reporting = setInterval(report, REPORT_MS);
  const forget = page.listen({
    pointerdown: onDown,
    pointermove: onMove,
    pointerup: onUp,
    pointercancel: onCancel,
    lostpointercapture: onCancel,
    mousedown: onMouseDown,
    keydown: onKey,
  });

  return {
    cancel,
    ink(on) {
      inks = on;
    },
    remove() {
      cancel();
      clearInterval(reporting);
      forget();
      overlay.remove();
    },
  };
}

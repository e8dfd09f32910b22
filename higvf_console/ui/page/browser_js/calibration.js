// What the operator looks at while gaze is calibrated: one target after the other, on a calm ground.
(page, config) => {
  const RING_PX = 26; // radius of the ring, which closes as gaze rests
  const LENGTH = 2 * Math.PI * RING_PX;

  const overlay = page.overlay(
    `<style>
      .ground { position: absolute; display: none; background: ${config.ground}; }
      .ground.open { display: block; }
      svg { position: absolute; inset: 0; width: 100%; height: 100%; }
      .back { fill: none; stroke: ${config.faint}; stroke-width: 3px; }
      .fill { fill: none; stroke: ${config.colour}; stroke-width: 5px; stroke-linecap: round; }
      .dot { fill: ${config.colour}; }
      .middle { fill: ${config.ground}; }
      p { position: absolute; left: 0; right: 0; top: 33%; margin: 0; text-align: center; color: ${config.text};
        font: calc(15px * var(--hg-size, 1))/1.5 system-ui, "Segoe UI", sans-serif; }
    </style>
    <div class="ground" role="status">
      <svg><g><circle class="back" r="${RING_PX}"/><circle class="fill" r="${RING_PX}" transform="rotate(-90)"/>
        <circle class="dot" r="9"/><circle class="middle" r="2.5"/></g></svg>
      <p></p>
    </div>`,
    2,
  );
  const $ = (selector) => overlay.shadowRoot.querySelector(selector);
  const ground = $(".ground");
  let target = null;

  // The target stays over its ground point, however the page changes.
  function follow() {
    if (!target) return;
    const view = page.view();
    if (view) {
      const { left, top, width, height } = view.rect;
      ground.style.cssText = `left:${left}px;top:${top}px;width:${width}px;height:${height}px`;
      const x = width / 2 + (target.point[0] - view.x) / view.scale;
      const y = height / 2 - (target.point[1] - view.y) / view.scale;
      $("g").setAttribute("transform", `translate(${x} ${y})`);
    }
    requestAnimationFrame(follow);
  }

  function show(next) {
    const opening = next && !target;
    target = next;
    ground.classList.toggle("open", !!next);
    if (!next) return;
    $(".fill").style.strokeDasharray = `${LENGTH * next.progress} ${LENGTH}`;
    $(".fill").style.opacity = next.progress > 0 ? 1 : 0; // a round cap would show at nothing
    $("p").textContent = `Look at the dot until its ring is full: ${next.number} of ${next.targets}. Esc gives up.`;
    if (!opening) return;
    page.part("camera")?.fit();
    follow();
  }

  function onKey(event) {
    if (event.key !== "Escape" || !target) return;
    event.stopImmediatePropagation(); // it discards nothing else
    page.send("calibration", {});
  }

  const forget = page.listen({ keydown: onKey });

  return {
    show,
    remove() {
      target = null;
      forget();
      overlay.remove();
    },
  };
}

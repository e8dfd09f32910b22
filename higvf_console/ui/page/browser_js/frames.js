// Frames that leave time for the operator. viser draws one after another while anything moves; where the processor has
// to draw them, strokes and answers would wait. There the page rests after a slow frame as long as that took.
(page) => {
  const SLOW_MS = 50;
  const LONGEST_REST_MS = 200;
  const NO_CARD = /swiftshader|llvmpipe|softpipe|software|basic render/i;

  const ask = window.requestAnimationFrame.bind(window);
  const callOff = window.cancelAnimationFrame.bind(window);
  const waiting = new Map(); // what is to be drawn, by the number that stands for it
  let last = 2 ** 31; // above the browser's own numbers, which some may still hold
  let drawsItself; // whether the processor draws; unknown until there is a canvas

  function processorDraws() {
    const gl = page.canvas()?.getContext("webgl2");
    const card = gl?.getExtension("WEBGL_debug_renderer_info")?.UNMASKED_RENDERER_WEBGL ?? gl?.RENDERER;
    if (card) drawsItself ??= NO_CARD.test(gl.getParameter(card));
    return drawsItself;
  }

  function draw(number, now) {
    const callback = waiting.get(number);
    waiting.delete(number);
    callback?.(now);
  }

  window.requestAnimationFrame = (callback) => {
    const [number, asked] = [++last, performance.now()];
    waiting.set(number, callback);
    ask((now) => {
      const took = performance.now() - asked;
      if (took < SLOW_MS || !processorDraws()) draw(number, now);
      else setTimeout(() => ask((later) => draw(number, later)), Math.min(took, LONGEST_REST_MS));
    });
    return number;
  };

  window.cancelAnimationFrame = (number) => {
    if (!waiting.delete(number)) callOff(number);
  };

  return {
    remove() {
      window.requestAnimationFrame = ask;
      window.cancelAnimationFrame = callOff;
    },
  };
}

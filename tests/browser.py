"""A real Chromium for tests: how it is started, a hand that draws in it, and a small server for it to show.

`page.mouse` takes 100 ms a move and more under software rendering, so what a hand does is dispatched as events inside
the page, strokes at the rate of a real device.
"""

import os
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic, sleep
from typing import Literal, TypeAlias, TypeVar

import numpy as np
import viser
from playwright.sync_api import Browser, Page

from higvf_console.core.arrays import Floats
from higvf_console.core.viewport import Arena, Viewport
from higvf_console.ui.interaction import camera, keys, pointer
from higvf_console.ui.page import guard
from higvf_console.ui.page import page as scripts
from higvf_console.ui.widgets.number import NumberField, NumberRange

# Dispatches one pointer event at every point; `rate` 0 = all at once, one event with the others coalesced into it.
_DRAW = """
([points, rate, kind, button, finish]) => new Promise((done) => {
  const canvas = window.__viserMutable.canvas;
  const make = (type, [x, y], more = {}) => new PointerEvent(type, {
    bubbles: true, composed: true, cancelable: true, clientX: x, clientY: y, pointerId: 77, isPrimary: true,
    pointerType: kind, button: type === "pointermove" ? -1 : button, buttons: type === "pointerup" ? 0 : 1, ...more,
  });
  const end = () => { if (finish) canvas.dispatchEvent(make(finish, points[points.length - 1])); done(); };
  canvas.dispatchEvent(make("pointerdown", points[0]));
  const rest = points.slice(1);
  if (!rate) {
    const coalescedEvents = rest.map((point) => make("pointermove", point));
    if (rest.length) canvas.dispatchEvent(make("pointermove", rest[rest.length - 1], { coalescedEvents }));
    return end();
  }
  const start = performance.now();
  let next = 0;
  const timer = setInterval(() => {
    while (next < rest.length && (performance.now() - start) * rate >= next * 1000)
      canvas.dispatchEvent(make("pointermove", rest[next++]));
    if (next === rest.length) { clearInterval(timer); end(); }
  }, 1);
})
"""

# A processor that draws all it can has no time for what is tested: few frames a second, and edges without smoothing.
_FRAME_REST_MS = 200
COARSE = 0.5  # pixels in a CSS pixel
SLOW_SCREEN = f"""
  const frame = window.requestAnimationFrame.bind(window);
  const later = (draw) => setTimeout(() => (window.higvfUnused ? later(draw) : frame(draw)), {_FRAME_REST_MS});
  window.requestAnimationFrame = later;
  window.cancelAnimationFrame = clearTimeout;
"""
_ROUGH_EDGES = """
  const context = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, options) {
    return context.call(this, kind, kind.startsWith("webgl") ? { ...options, antialias: false } : options);
  };
"""

_TURN = """
([[x, y], steps]) => steps.forEach((deltaY) => window.__viserMutable.canvas.dispatchEvent(
  new WheelEvent("wheel", { bubbles: true, composed: true, cancelable: true, clientX: x, clientY: y, deltaY })))
"""

_STOP_SHOWS = """
(states) => [...document.body.children].some((host) => states.some((state) =>
  host.shadowRoot?.querySelector(`button.stop.${state}`)))
"""

# Independent of the console's own geometry: what three.js' camera makes of ground points.
_TO_PAGE = """
(points) => {
  const { camera, canvas, nodeRefFromName } = window.__viserMutable;
  const rect = canvas.getBoundingClientRect();
  const Vector = camera.position.constructor;
  camera.updateMatrixWorld();
  return points.map(([x, y]) => {
    const ndc = nodeRefFromName[""].localToWorld(new Vector(x, y, 0)).project(camera);
    return [rect.left + (ndc.x + 1) / 2 * rect.width, rect.top + (1 - ndc.y) / 2 * rect.height];
  });
}
"""

ARENA = Arena(0.0, 0.0, 1200.0, 700.0)  # [m]
PATIENCE = 120.0  # [s], for a machine that is busy with other things
NO_NGINX = "no nginx or openssl: install the packages 'nginx-light' and 'openssl'"
Value = TypeVar("Value")
Points: TypeAlias = Sequence[Sequence[float]] | Floats


def open_console(
    browser: Browser,
    url: str,
    width: int = 1000,
    height: int = 640,
    *,
    hints: bool = False,
    touch: bool = False,
    smooth: bool = False,
    sharp: bool = False,
) -> Page:
    """A page of its own session that shows the console, ready to be used.

    Args:
        browser: where.
        url: login link of the console.
        width: of the page [CSS px].
        height: likewise.
        hints: whether it has those of a first run.
        touch: whether it has a touch screen.
        smooth: whether the edges in the arena are smoothed, as in pictures to be looked at.
        sharp: whether a CSS pixel is a pixel, as for tests of colours; else the processor draws a quarter of them.
    """
    scale = 1.0 if smooth or sharp else COARSE
    context = browser.new_context(
        viewport={"width": width, "height": height}, has_touch=touch, device_scale_factor=scale
    )
    context.add_init_script(SLOW_SCREEN)
    if not smooth:
        context.add_init_script(_ROUGH_EDGES)
    if not hints:
        context.add_init_script("localStorage.setItem('higvf-hints', '[\"away\"]')")
    page = context.new_page()
    page.set_default_timeout(PATIENCE * 1000)
    page.goto(url)
    wait_for_console(page)
    return page


def set_in_use(page: Page, used: bool) -> None:
    """Lets a page draw, or not while no test uses it: drawing takes half a processor."""
    page.evaluate("(unused) => { window.higvfUnused = unused; }", not used)


@contextmanager
def console_page(browser: Browser, url: str, tab_name: str | None = None, *, sharp: bool = False) -> Generator[Page]:
    """A page of 1280 x 720 that shows the console, and a tab of the panel; closed at the end."""
    page = open_console(browser, url, 1280, 720, sharp=sharp)
    if tab_name:
        tab(page, tab_name)
    yield page
    page.context.close()


def wait_for_console(page: Page) -> None:
    """Waits until the page has its scripts, a settled camera and a server that answers."""
    page.wait_for_function("() => window.higvf && window.__viserMutable?.cameraControl", polling=50)
    wait_for_stop(page, "ready", "stopped")


def wait_for_stop(page: Page, *states: str) -> None:
    """Waits until the STOP button shows one of these states."""
    page.wait_for_function(_STOP_SHOWS, arg=list(states), polling=50)


def draw(
    page: Page, points: Points, rate: float = 125.0, *, kind: str = "mouse", button: int = 0, finish: str = "pointerup"
) -> None:
    """Presses, drags and releases.

    Args:
        page: where.
        points: (n, 2) in CSS pixels of the page.
        rate: points a second; 0 sends them as one coalesced event.
        kind: mouse, pen or touch.
        button: 0 left, 1 middle, 2 right.
        finish: event at the end: pointerup, pointercancel, or "" to keep the button down.
    """
    page.evaluate(_DRAW, [np.asarray(points).tolist(), rate, kind, button, finish])


def turn_wheel(page: Page, place: Sequence[float], *steps: float) -> None:
    """Turns the wheel over a point of the page [CSS px]; negative steps [px] zoom in."""
    page.evaluate(_TURN, [list(place), list(steps)])


def press_stop(page: Page, times: int = 1) -> None:
    """Presses the red button, in haste when several times."""
    page.locator("button.stop").evaluate(
        "(button, times) => { while (times--) button.dispatchEvent(new PointerEvent('pointerdown', { button: 0 })); }",
        times,
    )


def to_page(page: Page, ground: Points) -> list[list[float]]:
    """Where ground points (n, 2) [m] are seen, in CSS pixels of the page."""
    return page.evaluate(_TO_PAGE, np.asarray(ground).tolist())


def wait_until(value: Callable[[], Value], seconds: float = PATIENCE) -> Value:
    """The first true answer of `value`.

    Raises:
        AssertionError: none came in time.
    """
    end = monotonic() + seconds
    while not (found := value()):
        assert monotonic() < end, f"waited {seconds} s for {value}"
        sleep(0.03)
    return found


@dataclass
class Stage:
    """The browser layer without an engine behind it: a guarded server that notes what its pages say."""

    server: viser.ViserServer
    url: str
    number: viser.GuiInputHandle[float]
    dropdown: viser.GuiDropdownHandle[Literal["first", "second"]]
    text: viser.GuiInputHandle[str]
    button: viser.GuiButtonHandle
    strokes: list[tuple[int, str, Floats]] = field(default_factory=lambda: [])
    clicks: list[Floats] = field(default_factory=lambda: [])
    groups: list[bool] = field(default_factory=lambda: [])  # whether each of these was about a group
    viewports: list[Viewport] = field(default_factory=lambda: [])
    pressed: list[str] = field(default_factory=lambda: [])
    typed: list[float] = field(default_factory=lambda: [])
    length: NumberField | None = None  # whose numbers these are
    hears_stop: bool = True

    def stroke(self, client_id: int, phase: pointer.Phase, points: Floats, *, group: bool) -> None:
        self.strokes.append((client_id, phase, points))
        self.groups.append(group)

    def click(self, client_id: int, point: Floats, *, group: bool) -> None:  # noqa: ARG002
        self.clicks.append(point)
        self.groups.append(group)

    def viewport(self, client_id: int, viewport: Viewport) -> None:  # noqa: ARG002
        self.viewports.append(viewport)

    def on_key(self, client_id: int, name: str) -> None:  # noqa: ARG002
        if not self.hears_stop:
            raise ValueError("the server is told to be deaf")
        self.pressed.append(name)

    def focus(self, page: Page, widget: "Literal['number', 'dropdown', 'text', 'button']") -> None:
        """Puts the focus into a widget, as a click there does; a dropdown opens."""
        handle = {"number": self.number, "dropdown": self.dropdown, "button": self.button}.get(widget)
        selector = f"[id='{handle._impl.uuid}']" if handle else "input[value^='words']"  # pyright: ignore[reportPrivateUsage]
        page.locator(selector).evaluate(f"(field) => {{ field.focus(); {'field.click();' * (widget == 'dropdown')} }}")

    def phases(self) -> list[str]:
        """Phases of what was drawn, repeated updates as one."""
        phases = [phase for _, phase, _ in self.strokes]
        return [phase for i, phase in enumerate(phases) if i == 0 or phase != "update" or phases[i - 1] != "update"]

    def drawn(self) -> Floats:
        """All points (n, 2) [m] of what was drawn."""
        return np.concatenate([points for _, _, points in self.strokes])


def open_stage(arena: Arena = ARENA, max_clients: int = 16) -> Stage:
    """A stage on a free port."""
    token = guard.new_token()
    server = guard.open_server("127.0.0.1", 0, token, "Stage", max_clients=max_clients)
    server.gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False)
    server.gui.main_panel.dock_right()
    corners = np.array([[x, y, 0.0] for x in (arena.x_min, arena.x_max) for y in (arena.y_min, arena.y_max)])
    server.scene.add_mesh_simple("/floor", corners, np.array([[0, 2, 3], [0, 3, 1]]), color=(28, 33, 39), side="double")
    stage = Stage(
        server=server,
        url=guard.login_url(server, token),
        number=server.gui.add_number("number", 1.0),
        dropdown=server.gui.add_dropdown("dropdown", ("first", "second")),
        text=server.gui.add_text("text", "words"),
        button=server.gui.add_button("button"),
    )
    scripts.install(server, "fields", {"words": [stage.text._impl.uuid]})  # pyright: ignore[reportPrivateUsage]
    server.gui.add_html("<style>.mantine-Notification-root { pointer-events: none !important }</style>")
    pointer.ignore_palms(server)
    camera.install(server, arena)
    stage.length = NumberField(server.gui, "Length", 25.0, NumberRange("m", 1.0, 500.0), stage.typed.append)
    pointer.install(server, stage)
    keys.install(server, stage.on_key)
    return stage


def screenshot(page: Page, name: str) -> None:
    """Keeps a picture of the page when HIGVF_SCREENSHOTS names a folder."""
    if folder := os.environ.get("HIGVF_SCREENSHOTS"):
        Path(folder).mkdir(parents=True, exist_ok=True)
        page.screenshot(path=Path(folder) / f"{name}.png")


def tab(page: Page, name: str) -> None:
    page.get_by_role("tab", name=name, exact=True).click()


def press(page: Page, label: str) -> None:
    page.get_by_role("button", name=label, exact=True).click()


def shown(page: Page, text: str) -> Callable[[], bool]:
    return lambda: any(text in found for found in page.locator("body, .status").all_inner_texts())


def told(page: Page, text: str) -> Callable[[], bool]:
    """Whether the line of the latest message says so."""
    return lambda: text in page.locator(".status .message").inner_text()


def visible(page: Page, node: str) -> bool:
    """Whether the page shows a scene node."""
    return page.evaluate("(node) => !!window.__viserMutable.nodeRefFromName[node]?.visible", node)

"""What the operator's pointer does in the arena: strokes, clicks, and how the page lies over the ground.

viser reports a drag at 20 points a second, the latest wins. `browser_js/pointer.js` therefore listens for itself: every
point that the device gave arrives here, in order and in metres on the ground z = 0, in packets of some 33 ms, while the
page draws an echo at once. A packet that is missing, out of order or out of range cancels its stroke.
"""

from collections.abc import Sequence
from typing import Literal, NamedTuple, Protocol, TypeAlias, cast, get_args

import viser

from higvf_console.core.arguments import one_of
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.viewport import Viewport
from higvf_console.ui.notice import telling
from higvf_console.ui.page import page

Phase: TypeAlias = Literal["start", "update", "end", "cancel"]

MAX_PACKET_POINTS = 1000
MAX_STROKE_POINTS = 200_000
MAX_COORDINATE = 1e6  # [m]
MAX_PIXELS = 1e5


class PointerEvents(Protocol):
    """Who wants to know. Called on viser's event loop, in order: a method must return at once, so it only enqueues."""

    def stroke(self, client_id: int, phase: Phase, points: Floats, *, group: bool) -> None:
        """A page's stroke starts, goes on, ends or is cancelled; `points` (n, 2) [m] are new, n = 0 when cancelled.

        `group`: it began with Shift held, so it goes round a group of robots.
        """
        ...

    def click(self, client_id: int, point: Floats, *, group: bool) -> None:
        """A short press at `point` (2,) [m]; with `group`, that is with Shift held, the robot there joins or leaves."""
        ...

    def viewport(self, client_id: int, viewport: Viewport) -> None:
        """How a page lies over the ground, in device pixels from its top left corner; at most five times a second."""
        ...


class _OpenStroke(NamedTuple):
    """What is known of a stroke that has not ended."""

    number: object
    packets: int
    points: int
    group: bool


def ignore_palms(server: viser.ViserServer) -> None:
    """Keeps the palm of a hand that holds a pen from drawing and moving the view; install it ahead of the camera."""
    page.install(server, "palm", {})


def install(server: viser.ViserServer, events: PointerEvents, colour: str = "#f7f2b0") -> None:
    """Sends every page's strokes, clicks and viewports to `events`.

    Args:
        server: whose pages shall be listened to.
        events: receives what was validated; what was not is logged and dropped.
        colour: of the stroke's echo, as CSS has it.
    """
    strokes: dict[int, _OpenStroke] = {}

    def cancel(client_id: int) -> None:
        if (known := strokes.pop(client_id, None)) is not None:
            events.stroke(client_id, "cancel", floats([], -1, 2), group=known.group)

    def on_stroke(client_id: int, body: page.Body) -> None:
        starting = body.get("phase") == "start"
        fresh = _OpenStroke(body.get("id"), 0, 0, body.get("group") is True)
        known = fresh if starting else strokes.get(client_id)
        if known is None:
            return  # the rest of a stroke that was cancelled here
        try:
            phase, points = _packet(body, known)
        except ValueError:
            cancel(client_id)
            raise
        if phase in ("start", "cancel"):
            cancel(client_id)
        if phase == "cancel":
            return
        strokes[client_id] = known._replace(packets=known.packets + 1, points=known.points + len(points))
        if phase == "end":
            del strokes[client_id]
        events.stroke(client_id, phase, points, group=known.group)

    def on_click(client_id: int, body: page.Body) -> None:
        events.click(client_id, _numbers(body, "point", 2, MAX_COORDINATE), group=body.get("group") is True)

    def on_viewport(client_id: int, body: page.Body) -> None:
        events.viewport(client_id, _viewport(body))

    page.listen(server, "stroke", telling(server, on_stroke))
    page.listen(server, "click", telling(server, on_click))
    page.listen(server, "viewport", on_viewport)
    page.on_leave(server, cancel)
    page.install(server, "pointer", {"colour": colour})


def _packet(body: page.Body, known: _OpenStroke) -> tuple[Phase, Floats]:
    """Phase and points (n, 2) [m] of a packet that continues `known`.

    Raises:
        ValueError: a packet that is malformed, out of order, out of range or too long.
    """
    phase, place = body.get("phase"), (body.get("id"), body.get("sequence"))
    one_of("phase", phase, get_args(Phase))
    if place != (known.number, known.packets):
        due = (known.number, known.packets)
        raise ValueError(
            f"a part of the stroke was lost, draw it again: packet {_short(place)} came where {due} was due"
        )
    points = _numbers(body, "points", None, MAX_COORDINATE)
    if len(points) % 2 or len(points) > 2 * MAX_PACKET_POINTS:
        raise ValueError(f"points: {len(points)} numbers are not at most {MAX_PACKET_POINTS} pairs")
    if known.points + len(points) // 2 > MAX_STROKE_POINTS:
        raise ValueError(f"a stroke has at most {MAX_STROKE_POINTS} points")
    return cast(Phase, phase), points.reshape(-1, 2)


def _viewport(body: page.Body) -> Viewport:
    """The page in device pixels, over the ground.

    Raises:
        ValueError: a number is missing, not finite or out of range.
    """
    width, height = _numbers(body, "page", 2, MAX_PIXELS).tolist()
    left, top, canvas_width, canvas_height = _numbers(body, "canvas", 4, MAX_PIXELS).tolist()
    ratio = _positive(body, "pixel_ratio", 32.0)
    scale = _positive(body, "metres_per_px", MAX_COORDINATE)
    x, y = _numbers(body, "centre", 2, MAX_COORDINATE).tolist()
    # From the middle of the canvas to the middle of the page [CSS px].
    right = width / 2 - (left + canvas_width / 2)
    down = height / 2 - (top + canvas_height / 2)
    return Viewport(width * ratio, height * ratio, x + right * scale, y - down * scale, scale / ratio)


def _positive(body: page.Body, name: str, limit: float) -> float:
    value = body.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value <= limit:
        raise ValueError(f"{name}: {value!r} is not a number in (0, {limit:g}]")
    return float(value)


def _numbers(body: page.Body, name: str, count: int | None, limit: float) -> Floats:
    """The finite numbers in `body[name]`, (count,) or any number of them.

    Raises:
        ValueError: not a list of finite numbers within +-limit, or another count.
    """
    values = body.get(name)
    if not isinstance(values, list) or (count is not None and len(cast(list[object], values)) != count):
        raise ValueError(f"{name}: {_short(values)} is not a list of {count or ''} numbers")
    numbers = cast(Sequence[object], values)
    for value in numbers:
        if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= limit:
            raise ValueError(f"{name}: {_short(value)} is not a finite number within +-{limit:g}")
    return floats(cast(Sequence[float], numbers))


def _short(value: object) -> str:
    return repr(value)[:60]

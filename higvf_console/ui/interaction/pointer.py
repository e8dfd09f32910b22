"""What the operator's pointer does in the arena: strokes, clicks, and how the page lies over the ground.

viser reports a drag at 20 points a second, the latest wins. `browser_js/pointer.js` therefore listens for itself: every
point that the device gave arrives here, in order and in metres on the ground z = 0, in packets of some 33 ms, while the
page draws an echo at once. A packet that is missing or out of order cancels its stroke.
"""

from typing import Literal, NamedTuple, Protocol, TypeAlias

import viser

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.viewport import Viewport
from higvf_console.ui.page import page
from higvf_console.ui.page.notice import telling

Phase: TypeAlias = Literal["start", "update", "end", "cancel"]

MAX_STROKE_POINTS = 200_000


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

    number: int
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
        events: receives what arrives whole; what does not is logged and dropped.
        colour: of the stroke's echo, as CSS has it.
    """
    strokes: dict[int, _OpenStroke] = {}

    def cancel(client_id: int) -> None:
        if (known := strokes.pop(client_id, None)) is not None:
            events.stroke(client_id, "cancel", floats([], -1, 2), group=known.group)

    def on_stroke(client_id: int, body: page.Body) -> None:
        phase: Phase = body["phase"]
        known = _OpenStroke(body["id"], 0, 0, body["group"]) if phase == "start" else strokes.get(client_id)
        if known is None:
            return  # the rest of a stroke that was cancelled here
        try:
            points = _packet(body, known)
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
        events.click(client_id, floats(body["point"]), group=body["group"])

    def on_viewport(client_id: int, body: page.Body) -> None:
        events.viewport(client_id, _viewport(body))

    page.listen(server, "stroke", telling(server, on_stroke))
    page.listen(server, "click", telling(server, on_click))
    page.listen(server, "viewport", on_viewport)
    page.on_leave(server, cancel)
    page.install(server, "pointer", {"colour": colour})


def _packet(body: page.Body, known: _OpenStroke) -> Floats:
    """The points (n, 2) [m] of a packet that continues `known`.

    Raises:
        ValueError: a packet that is out of order or too long, or a point of one number.
    """
    place, due, points = (body["id"], body["sequence"]), (known.number, known.packets), floats(body["points"])
    if place != due:
        raise ValueError(f"a part of the stroke was lost, draw it again: packet {place} came where {due} was due")
    if len(points) % 2:
        raise ValueError(f"points: {len(points)} numbers are no pairs")
    if known.points + len(points) // 2 > MAX_STROKE_POINTS:
        raise ValueError(f"a stroke has at most {MAX_STROKE_POINTS} points")
    return points.reshape(-1, 2)


def _viewport(body: page.Body) -> Viewport:
    """The page in device pixels, over the ground."""
    (width, height), (x, y) = body["page"], body["centre"]
    left, top, canvas_width, canvas_height = body["canvas"]
    ratio, scale = body["pixel_ratio"], body["metres_per_px"]
    # From the middle of the canvas to the middle of the page [CSS px].
    right = width / 2 - (left + canvas_width / 2)
    down = height / 2 - (top + canvas_height / 2)
    return Viewport(width * ratio, height * ratio, x + right * scale, y - down * scale, scale / ratio)

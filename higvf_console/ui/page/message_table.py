"""Every message of a page, each field with its type, range and size. What does not fit is refused at the door.

A message is MessagePack: either one of viser's own, named by its "type", or a `PageMessage` of ours, whose "topic" says
what its "body" holds. Strings are measured in characters. NaN and infinity are in no range.
"""

from typing import Annotated, Any, Literal, TypeAlias

import msgspec
from msgspec import Meta, Raw, Struct

from higvf_console.ui.page.refusals import RefusedError

PIECE_BYTES = 400_000  # of a file, in one message
MOST_POINTS = 1000  # of a stroke, in one message

_MOST_SAFE = 2**53  # largest number up to which a page counts without gaps

Count: TypeAlias = Annotated[int, Meta(ge=0, le=_MOST_SAFE)]
Metres: TypeAlias = Annotated[float, Meta(ge=-1e6, le=1e6)]
Pixels: TypeAlias = Annotated[float, Meta(ge=-1e5, le=1e5)]
Scale: TypeAlias = Annotated[float, Meta(gt=0, le=1e6)]  # [m/px]
Ratio: TypeAlias = Annotated[float, Meta(gt=0, le=32)]
View: TypeAlias = Annotated[float, Meta(ge=-1e12, le=1e12)]  # of viser's camera
Side: TypeAlias = Annotated[int, Meta(ge=0, le=100_000)]  # of a picture [px]
Finite: TypeAlias = Annotated[float, Meta(ge=-1e300, le=1e300)]
Word: TypeAlias = Annotated[str, Meta(pattern=r"^[a-z0-9_]{1,32}$")]
Name: TypeAlias = Annotated[str, Meta(max_length=80)]
Uuid: TypeAlias = Annotated[str, Meta(max_length=64)]
Text: TypeAlias = Annotated[str, Meta(max_length=4000)]


class _Fields(Struct, frozen=True, forbid_unknown_fields=True):
    """A body: exactly the fields that it lists."""


class Alive(_Fields, frozen=True):
    """Asks for a sign of life."""


class Calibration(_Fields, frozen=True):
    """Gives a calibration of gaze up."""


class Card(_Fields, frozen=True):
    """A button of a card, and what it chooses."""

    act: Word
    value: Name


class Click(_Fields, frozen=True):
    """A short press in the arena; `group` with Shift held."""

    point: tuple[Metres, Metres]
    group: bool


class Control(_Fields, frozen=True):
    """A button of the strip that says who steers."""

    act: Literal["ask", "take", "release", "grant", "refuse"]
    page: Name


class File(_Fields, frozen=True):
    """A piece of a file, in base64."""

    kind: Word
    name: Annotated[str, Meta(max_length=1024)]
    size: Count
    part: Count
    parts: Count
    content: Annotated[str, Meta(max_length=4 * -(-PIECE_BYTES // 3))]


class Hello(_Fields, frozen=True):
    """Who the page is; a sign of life."""

    identity: Annotated[str, Meta(min_length=16, max_length=64)]


class Key(_Fields, frozen=True):
    """A key; `number` tells one STOP from the next."""

    name: Word
    number: Count


class Landscape(_Fields, frozen=True):
    """The panel stands beside the arena again."""


class Read(_Fields, frozen=True):
    """An alarm that was read."""

    text: Text


class Run(_Fields, frozen=True):
    """A button of the strip that is about the run, and the speed that it chooses."""

    act: Literal["pause", "freeze", "step", "speed", "reset", "acknowledge"]
    value: Name


class Stroke(_Fields, frozen=True):
    """A packet of a stroke: x and y of its points in turn; `group` if it began with Shift held."""

    id: Count
    sequence: Count
    phase: Literal["start", "update", "end", "cancel"]
    points: Annotated[list[Metres], Meta(max_length=2 * MOST_POINTS)]
    group: bool


class Tool(_Fields, frozen=True):
    """A button of the strip of tools."""

    name: Word


class Viewport(_Fields, frozen=True):
    """How the page lies over the ground."""

    page: tuple[Pixels, Pixels]
    canvas: tuple[Pixels, Pixels, Pixels, Pixels]
    pixel_ratio: Ratio
    centre: tuple[Metres, Metres]
    metres_per_px: Scale


BODIES: dict[str, type[_Fields]] = {
    "alive": Alive,
    "calibration": Calibration,
    "card": Card,
    "click": Click,
    "control": Control,
    "file": File,
    "hello": Hello,
    "key": Key,
    "landscape": Landscape,
    "read": Read,
    "run": Run,
    "stroke": Stroke,
    "tool": Tool,
    "viewport": Viewport,
}


class _Message(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag=True):
    """A message as a whole; its "type" is the name of the class."""


class PageMessage(_Message, frozen=True):
    """What a script of ours sends."""

    topic: Name
    body: Raw


class CommandTriggerMessage(_Message, frozen=True):
    """A line of the command palette was chosen."""

    uuid: Uuid


class WidgetValue(_Fields, frozen=True):
    """Of a widget, a page sets the value alone; `page.gate` compares it with the widget."""

    value: bool | Finite | Text


class GuiUpdateMessage(_Message, frozen=True):
    """A widget was used."""

    uuid: Uuid
    updates: WidgetValue


class ViewerCameraMessage(_Message, frozen=True):
    """Where viser's camera is."""

    wxyz: tuple[View, View, View, View]
    position: tuple[View, View, View]
    fov: View
    near: View
    far: View
    image_height: Side
    image_width: Side
    look_at: tuple[View, View, View]
    up_direction: tuple[View, View, View]


Message: TypeAlias = PageMessage | CommandTriggerMessage | GuiUpdateMessage | ViewerCameraMessage

_MESSAGES = msgspec.msgpack.Decoder(Message)
_BODIES = {topic: msgspec.msgpack.Decoder(fields) for topic, fields in BODIES.items()}


def checked(frame: bytes | str) -> tuple[Message, _Fields | None]:
    """The message in a frame, and the body of a `PageMessage`.

    Raises:
        RefusedError: it is none of this table.
    """
    if isinstance(frame, str):
        raise RefusedError("text", "a text frame")
    message = _decoded(_MESSAGES, frame, "message")
    if not isinstance(message, PageMessage):
        return message, None
    if message.topic not in _BODIES:
        raise RefusedError("topic", f"topic {message.topic!r}; topics: {', '.join(_BODIES)}")
    return message, _decoded(_BODIES[message.topic], message.body, message.topic)


def _decoded(decoder: "msgspec.msgpack.Decoder[Any]", content: bytes | Raw, what: str) -> Any:
    try:
        return decoder.decode(content)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        text, _, place = str(error).partition(" - at ")
        place = place.strip("`$.")
        raise RefusedError(f"{what} {place.split('[')[0]}", f"{what}{place and ' ' + place}: {text}") from None

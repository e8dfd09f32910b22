"""EyeLink ASC text written by `edf2asc`: samples, messages and events, one per line.

    MSG     2095865 DISPLAY_COORDS 0 0 1279 1023          left, top, right, bottom; GAZE_COORDS alike
    SAMPLES GAZE LEFT RIGHT RATE 1000.00 TRACKING CR      one or two eyes; HREF, PUPIL: not screen coordinates
    2154556   139.6   132.1   784.0 ...                   time [ms]; x, y [px] and pupil per eye; flags; "." = missing
    SBLINK L 2154600 ... EBLINK L 2154600 2154700 100     samples between are invalid, even if finite

The bounds name the last pixel, so this screen is 1280 px wide. With a top above the bottom, y counts upwards. The flags
C (no corneal reflection) and I (interpolated) mark a point as not measured.
"""

import math
import re
from collections.abc import Iterator
from typing import NamedTuple

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.gaze.binocular import NO_EYE, Eye, both
from higvf_interfaces.formats.records import BOTTOM_LEFT, TOP_LEFT, Doubt, GazeStream, Row, Wanted, blocks_of
from higvf_interfaces.formats.text import TextFile, number

NAME = "eyelink-asc"
TITLE = "EyeLink ASC (edf2asc)"
_SIGNS = re.compile(rb"^(\*\* CONVERTED FROM|SAMPLES[ \t]+|START[ \t]+\d+[ \t]+(LEFT|RIGHT))", re.MULTILINE)
_COORDINATES = ("GAZE_COORDS", "DISPLAY_COORDS")
_NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?")
_UNMEASURED = frozenset("CI")
_EYES = {"L": 0, "R": 1}
_TIME = re.compile(r"\d+(\.\d)?")  # [ms]; with a decimal at 2000 Hz
_FLAGS = re.compile(r"[.CIR]{3}|[.CIR]{5}")
_PREAMBLE = b"** "  # start of a complete conversion, in which samples appear only between START and END
_HEADER_LINES = 100_000


class _Setting(NamedTuple):
    """State set by the lines before a sample."""

    recording: bool  # between START and END; numbers elsewhere belong to the calibration
    eyes: tuple[int, ...] = ()  # 0 left, 1 right, in the order of the columns
    shut: frozenset[int] = frozenset()  # eyes in a blink
    left: float = 0.0  # x of the left side [px]
    along: int = 1  # -1 if x counts from right to left
    low: float = 0.0  # y of the side from which y counts [px]
    origin: str = TOP_LEFT
    screen: tuple[float, float] | None = None
    unclear: str = ""  # bounds that are not understood


def matches(file: TextFile) -> bool:
    """Return whether the first bytes contain the line of the converter or the line that describes samples."""
    return _SIGNS.search(file.head) is not None


def stream(file: TextFile, _: Wanted) -> GazeStream:
    """Open the file.

    Raises:
        InputError: If the samples are not gaze on the screen, or there are none.
    """
    setting = _first_setting(file)
    notes: list[str] = []
    doubts: tuple[Doubt, ...] = ()
    if setting.screen is None and setting.unclear:
        doubts = (Doubt("screen", setting.unclear),)
    elif setting.screen is None:
        notes.append("the file does not specify the screen size (GAZE_COORDS or DISPLAY_COORDS)")
    columns = ("time [ms]", *(f"{axis} {'LR'[eye]} [px]" for eye in setting.eyes for axis in "xy"), "flags")
    return GazeStream(
        format=NAME,
        columns=columns,
        frame="screen",
        blocks=blocks_of(_rows(file, notes)),
        notes=notes,
        origin=setting.origin,
        screen=setting.screen,
        doubts=doubts,
    )


def _first_setting(file: TextFile) -> _Setting:
    setting = _before(file)
    for count, line in enumerate(file.lines()):
        cells = line.split()
        if _is_sample(setting, cells):
            return setting if setting.eyes else setting._replace(eyes=_counted_eyes(cells))
        setting = _updated(file, setting, cells)
        if count > _HEADER_LINES:
            break
    raise InputError(f"{file.path}: has no samples; convert the EDF with edf2asc without -e (events only)")


def _before(file: TextFile) -> _Setting:
    return _Setting(recording=not file.head.lstrip().startswith(_PREAMBLE))


def _rows(file: TextFile, notes: list[str]) -> Iterator[Row]:
    setting = _before(file)
    held: Row | None = None
    cells: list[str] = []
    for line in file.lines(notes):
        cells = line.split()
        if not _is_sample(setting, cells):
            setting = _updated(file, setting, cells)
            continue
        if held is not None:
            yield held
        held = _row(cells, setting)
    if not file.complete and _is_sample(setting, cells) and not _FLAGS.fullmatch(cells[-1]):
        notes.append("truncated last row dropped")
    elif held is not None:
        yield held


def _row(cells: list[str], setting: _Setting) -> Row:
    flags = next((cell for cell in cells[3:] if _FLAGS.fullmatch(cell)), "")
    x, y = both(
        NO_EYE if eye in setting.shut else _point(cells, 1 + 3 * place, setting)
        for place, eye in enumerate(setting.eyes or _counted_eyes(cells))
    )
    return number(cells[0]) * 1e-3, x, y, not _UNMEASURED & set(flags), math.nan


def _point(cells: list[str], place: int, setting: _Setting) -> Eye:
    if len(cells) < place + 2:
        return NO_EYE
    return setting.along * (number(cells[place]) - setting.left), number(cells[place + 1]) - setting.low


def _is_sample(setting: _Setting, cells: list[str]) -> bool:
    return setting.recording and len(cells) >= 3 and _TIME.fullmatch(cells[0]) is not None


def _counted_eyes(cells: list[str]) -> tuple[int, ...]:
    numbers = sum(1 for cell in cells[1:] if cell == "." or number(cell) == number(cell))
    return (0, 1) if numbers >= 6 else (0,)


def _updated(file: TextFile, setting: _Setting, cells: list[str]) -> _Setting:
    """Return the state after a line that is not a sample."""
    match cells:
        case ["SAMPLES", kind, *words]:
            if kind != "GAZE":
                raise InputError(
                    f"{file.path}: its samples are {kind[:20]}, not gaze on the screen; convert with edf2asc -sg"
                )
            return setting._replace(eyes=tuple(k for k, word in enumerate(("LEFT", "RIGHT")) if word in words))
        case ["START" | "END" | ">>>>>>>" as word, *_] | ["MSG", _, "!CAL" as word, *_]:  # a calibration ends it too
            return setting._replace(recording=word == "START", shut=frozenset())  # a blink may have no end
        case ["MSG", _, *words]:
            return _sized(file, setting, words)
        case ["SBLINK", eye, *_] if eye in _EYES:
            return setting._replace(shut=setting.shut | {_EYES[eye]})
        case ["EBLINK", eye, *_] if eye in _EYES:
            return setting._replace(shut=setting.shut - {_EYES[eye]})
        case _:
            return setting


def _sized(file: TextFile, setting: _Setting, words: list[str]) -> _Setting:
    """Return the state after a message, which may state the bounds: left, top, right, bottom.

    Raises:
        InputError: If y counts in the other direction than before.
    """
    name = next((word for word in words[:3] if word in _COORDINATES), None)
    if name is None:
        return setting
    said = " ".join(words[words.index(name) :])
    bounds = [float(value) for value in _NUMBER.findall(said)[:4]]
    if len(bounds) < 4 or bounds[0] == bounds[2] or bounds[1] == bounds[3]:
        return setting._replace(unclear=said[:60])
    left, top, right, bottom = bounds
    origin = BOTTOM_LEFT if top > bottom else TOP_LEFT
    if setting.screen is not None and origin != setting.origin:
        raise InputError(
            f"{file.path}: {said[:60]} contradicts the bounds before it: y counts from the other side; split the file, "
            "or delete the wrong message"
        )
    return setting._replace(
        left=left,
        along=1 if right > left else -1,
        low=min(top, bottom),
        origin=origin,
        screen=_size(abs(right - left), abs(bottom - top)),
    )


def _size(width: float, height: float) -> tuple[float, float]:
    """Return the screen size [px] from the span of its bounds.

    The bounds name the last pixel (0 to 1919), but some programs write the size (0 to 1920); screens have even sides.
    """
    written = width % 2 == 0 and height % 2 == 0
    return (width, height) if written else (width + 1, height + 1)

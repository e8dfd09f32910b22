"""BrainVision markers (.vmrk, or its .vhdr): `Mk2=Stimulus,S  1,487,1,0`, positions in samples from 1.

The label of a marker is its description; where two types share a description, it is TYPE/DESCRIPTION for both.
Only the header contains the sampling interval, so a marker file needs its header in the same folder, or a rate.
"""

from typing import NamedTuple

from higvf_console.core.arrays import floats
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.clock import event_times
from higvf_interfaces.formats.labels import told_apart
from higvf_interfaces.formats.records import CommandLog, Decision
from higvf_interfaces.formats.signals.records import SignalRequest
from higvf_interfaces.formats.text import TextFile, look, number

NAME = "brainvision-markers"
TITLE = "BrainVision markers (.vmrk or .vhdr)"
_HEADER, _MARKERS = "header file", "marker file"
_NO_EVENT = {"new segment"}
_Sections = dict[str, dict[str, str]]


class _Marker(NamedTuple):
    time: float
    type: str
    text: str


def matches(file: TextFile) -> bool:
    """Return whether the first line is that of a BrainVision header or marker file."""
    return _kind(file) != ""


def read_markers(file: TextFile, request: SignalRequest) -> CommandLog:
    """Read the markers; a marker without description has its type as label.

    Raises:
        InputError: If the marker file is missing, the sampling interval is unknown, or there is no event.
    """
    kind = _kind(file)
    notes: list[str] = []
    if kind == _HEADER:
        header = _sections(file)
        name = _value(header, "common infos", "markerfile")
        if not name:
            raise InputError(f"{file.path}: the BrainVision header names no marker file")
        named, own = file.path.with_name(_plain(name, file)), file.path.with_suffix(".vmrk")
        renamed = not named.is_file() and own.is_file()
        notes += [f"{named.name} is missing: {own.name}, which is named as the header, used"] if renamed else []
        marks = _sections(look(str(own if renamed else named)))
    else:
        marks = _sections(file)
        header = _header_of(file)
    interval = number(_value(header, "common infos", "samplinginterval")) * 1e-6
    period = 1 / request.rate if request.rate and not interval > 0 else interval
    if not period > 0:
        raise InputError(f"{file.path}: the sampling interval is unknown: put the .vhdr beside it, or give rate=HZ")
    entries = [_marker(text, period) for text in marks.get("marker infos", {}).values()]
    markers = [entry for entry in entries if entry is not None]
    if not markers:
        raise InputError(f"{file.path}: there is no event among the {len(entries)} BrainVision markers")
    described = [(marker.text or marker.type, marker.type if marker.text else "") for marker in markers]
    labels, apart = told_apart(described, "{kind}/{label}")
    order, times, epoch, repaired = event_times(floats([marker.time for marker in markers]), from_epoch=False)
    decisions = tuple(Decision(t, labels[k], None) for k, t in zip(order.tolist(), times.tolist(), strict=True))
    return CommandLog(decisions, epoch, NAME, (*notes, *apart, *repaired))


def _kind(file: TextFile) -> str:
    line = file.first_line.casefold().replace("brain vision", "brainvision")
    if "brainvision data exchange" not in line:
        return ""
    return next((kind for kind in (_HEADER, _MARKERS) if kind in line), "")


def _header_of(file: TextFile) -> _Sections:
    """Return the header of a marker file: the one named as it, or the only one that names it."""
    beside = file.path.with_suffix(".vhdr")
    if beside.is_file():
        return _sections(look(str(beside)))
    headers = [_sections(look(str(path))) for path in sorted(file.path.parent.glob("*.vhdr"))]
    naming = [header for header in headers if _value(header, "common infos", "markerfile") == file.path.name]
    return naming[0] if len(naming) == 1 else {}


def _sections(file: TextFile) -> _Sections:
    sections: _Sections = {}
    section: dict[str, str] = {}
    for line in file.lines():
        plain = line.strip()
        if plain.startswith("[") and plain.endswith("]"):
            section = sections.setdefault(plain[1:-1].casefold(), {})
        elif not plain.startswith(";") and "=" in plain:
            key, _, value = plain.partition("=")
            section[key.strip().casefold()] = value.strip()
    return sections


def _value(sections: _Sections, section: str, key: str) -> str:
    return sections.get(section, {}).get(key, "")


def _plain(name: str, file: TextFile) -> str:
    """Return the file name given in a header; `$b` stands for the header's own name without suffix."""
    base = name.replace("$b", file.path.stem).replace("\\", "/").rsplit("/", 1)[-1].strip("\0 ")
    if base in ("", ".", ".."):
        raise InputError(f"{file.path}: {name!r} is not the name of a marker file")
    return base


def _marker(text: str, period: float) -> _Marker | None:
    parts = [" ".join(part.replace("\\1", ",").split()) for part in text.split(",")]
    place = number(parts[2]) if len(parts) > 2 else float("nan")
    time = (place - 1) * period
    if not any(parts[:2]) or parts[0].casefold() in _NO_EVENT or not abs(time) < 1e9:
        return None
    return _Marker(time, parts[0], parts[1] if len(parts) > 1 else "")

"""BrainVision markers (.vmrk, or its .vhdr): `Mk2=Stimulus,S  1,487,1,0`, positions in samples from 1.

Only the header contains the sampling interval, so a marker file needs its header in the same folder, or a rate.
"""

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.records import CommandLog, Decision
from higvf_interfaces.formats.signals.records import SignalRequest
from higvf_interfaces.formats.text import TextFile, look, number

NAME = "brainvision-markers"
TITLE = "BrainVision markers (.vmrk or .vhdr)"
_HEADER, _MARKERS = "header file", "marker file"
_NO_EVENT = {"new segment"}
_Sections = dict[str, dict[str, str]]


def matches(file: TextFile) -> bool:
    """Return whether the first line is that of a BrainVision header or marker file."""
    return _kind(file) != ""


def read_markers(file: TextFile, request: SignalRequest) -> CommandLog:
    """Read the markers; the labels are their descriptions, or their types if the description is empty.

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
    entries = [_decision(text, period) for text in marks.get("marker infos", {}).values()]
    decisions = sorted((entry for entry in entries if entry is not None), key=lambda decision: decision.time)
    if not decisions:
        raise InputError(f"{file.path}: there is no event among the {len(entries)} BrainVision markers")
    return CommandLog(tuple(decisions), 0.0, NAME, tuple(notes))


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


def _decision(text: str, period: float) -> Decision | None:
    parts = [part.strip().replace("\\1", ",") for part in text.split(",")]
    place = number(parts[2]) if len(parts) > 2 else float("nan")
    label = (parts[1] if len(parts) > 1 else "") or parts[0]
    time = (place - 1) * period
    if not label or parts[0].casefold() in _NO_EVENT or not abs(time) < 1e9:
        return None
    return Decision(time, " ".join(label.split()), None)

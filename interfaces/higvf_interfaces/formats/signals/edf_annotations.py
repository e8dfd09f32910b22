"""Annotations of EDF+ and BDF+ files, read from the bytes: time-stamped lists `+ONSET[\\x15DURATION]\\x14TEXT\\x14...`.

The texts are UTF-8 by the standard; where a program wrote a byte that is not, its text is read as Latin-1. The first
list of each data record has the onset of the record itself.
"""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import IO, NamedTuple

_FIXED = 256  # bytes of the header before those of the signals
_LABEL, _BEFORE_COUNT = 16, 16 + 80 + 8 + 8 + 8 + 8 + 8 + 80  # bytes of a signal's label; of its header up to the count
_COUNT = 8  # bytes of the number of samples a data record
_LIST = re.compile(rb"([+-]\d+(?:\.\d*)?)(?:\x15[^\x14\x00]*)?\x14([^\x00]*)\x14\x00")
_SAME = 1e-3  # [s]


class Annotations(NamedTuple):
    """Content of the annotation signals.

    Attributes:
        texts: onset [s] from the first sample, and text, in order of time.
        continuous: whether each data record follows the one before.
        repaired: whether a text was not UTF-8.
    """

    texts: tuple[tuple[float, str], ...]
    continuous: bool
    repaired: bool


class _Layout(NamedTuple):
    begin: int  # of the first data record [bytes]
    size: int  # of a data record [bytes]
    duration: float  # of a data record [s]
    parts: tuple[tuple[int, int], ...]  # offset and length of each annotation signal in a data record [bytes]


def read_annotations(path: Path, sample_bytes: int) -> Annotations:
    """Read the annotations of a file; of a truncated one, those of its complete data records.

    Args:
        path: the file.
        sample_bytes: size of a sample: 2 in EDF, 3 in BDF.

    Raises:
        OSError: If the file cannot be read.
        ValueError: If its header is damaged.
    """
    with path.open("rb") as file:
        layout = _layout(file, sample_bytes)
        lists = list(_lists(file, layout, path.stat().st_size))
    onsets = [onset for leads, onset, _ in lists if leads]
    first = onsets[0] if onsets else 0.0
    texts = [(onset - first, *_decoded(text)) for _, onset, texts in lists for text in texts if text.strip()]
    return Annotations(
        texts=tuple(sorted((onset, text) for onset, text, _ in texts)),
        continuous=all(abs(onset - first - k * layout.duration) < _SAME for k, onset in enumerate(onsets)),
        repaired=any(latin for _, _, latin in texts),
    )


def _layout(file: IO[bytes], sample_bytes: int) -> _Layout:
    fixed = file.read(_FIXED)
    count = int(fixed[252:256])
    signals = file.read((_BEFORE_COUNT + _COUNT) * count)
    counts = signals[_BEFORE_COUNT * count :]
    lengths = [int(counts[_COUNT * k : _COUNT * (k + 1)]) * sample_bytes for k in range(count)]
    labels = [signals[_LABEL * k : _LABEL * (k + 1)].strip() for k in range(count)]
    parts = tuple((sum(lengths[:k]), lengths[k]) for k in range(count) if labels[k].endswith(b" Annotations"))
    return _Layout(int(fixed[184:192]), sum(lengths), float(fixed[244:252]), parts)


def _lists(file: IO[bytes], layout: _Layout, end: int) -> Iterator[tuple[bool, float, list[bytes]]]:
    """Yield each list: whether it leads its data record, its onset [s] and its texts."""
    if not layout.parts or layout.size <= 0:
        return
    for record in range(layout.begin, end - layout.size + 1, layout.size):
        for offset, length in layout.parts:
            file.seek(record + offset)
            for number, match in enumerate(_LIST.finditer(file.read(length))):
                leads = number == 0 and offset == layout.parts[0][0]
                yield leads, float(match[1]), match[2].split(b"\x14")


def _decoded(text: bytes) -> tuple[str, bool]:
    """Return a text, and whether it had to be read as Latin-1."""
    try:
        return text.decode().strip(), False
    except UnicodeDecodeError:
        return text.decode("latin-1").strip(), True

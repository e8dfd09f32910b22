"""Writer of small XDF files for tests."""

import struct
from collections.abc import Sequence
from typing import NamedTuple


class Stream(NamedTuple):
    """A stream to write: text if `rate` is 0, otherwise rows of numbers."""

    name: str
    type: str
    source: str
    rate: float
    times: Sequence[float]
    samples: Sequence[Sequence[float]] | Sequence[str] | Sequence[Sequence[str]]
    labels: Sequence[str] = ()
    closed: bool = True


def xdf(*streams: Stream) -> bytes:
    """The bytes of an XDF file with these streams, numbered from 1; a boundary follows each chunk of samples."""
    content = b"XDF:" + _chunk(1, b"<?xml version='1.0'?><info><version>1.0</version></info>")
    for number, stream in enumerate(streams, start=1):
        content += _chunk(2, struct.pack("<I", number) + _header(stream).encode())
    for number, stream in enumerate(streams, start=1):
        for start in range(0, len(stream.times), 100):
            samples = list(map(_sample, stream.times[start : start + 100], stream.samples[start : start + 100]))
            head = struct.pack("<I", number) + b"\x04" + struct.pack("<I", len(samples))
            content += _chunk(3, head + b"".join(samples)) + BOUNDARY
    for number, stream in enumerate(streams, start=1):
        if stream.closed:
            footer = f"<info><sample_count>{len(stream.times)}</sample_count></info>"
            content += _chunk(6, struct.pack("<I", number) + footer.encode())
    return content


def _header(stream: Stream) -> str:
    first = stream.samples[0] if stream.samples else [0.0]
    texts = isinstance(first, str) or isinstance(first[0], str)
    count = 1 if isinstance(first, str) else len(first)
    channels = "".join(f"<channel><label>{label}</label><unit>microvolts</unit></channel>" for label in stream.labels)
    return (
        f"<info><name>{stream.name}</name><type>{stream.type}</type><channel_count>{count}</channel_count>"
        f"<nominal_srate>{stream.rate}</nominal_srate>"
        f"<channel_format>{'string' if texts else 'double64'}</channel_format><source_id>{stream.source}</source_id>"
        f"<desc>{f'<channels>{channels}</channels>' if channels else ''}</desc></info>"
    )


def _sample(time: float, sample: Sequence[float] | Sequence[str] | str) -> bytes:
    values = [sample] if isinstance(sample, str) else sample
    return b"\x08" + struct.pack("<d", time) + b"".join(map(_value, values))


def _value(value: float | str) -> bytes:
    if not isinstance(value, str):
        return struct.pack("<d", value)
    text = value.encode()
    return b"\x04" + struct.pack("<I", len(text)) + text


def _chunk(tag: int, content: bytes) -> bytes:
    return b"\x04" + struct.pack("<IH", len(content) + 2, tag) + content


BOUNDARY = _chunk(5, bytes.fromhex("43a546dccbf5410fb30ed5467383cbe4"))

"""Writes the same eyes in every format of gaze, as the makers' software would: small generators for the tests."""

import gzip
import json
import struct
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

WIDTH, HEIGHT = 1600, 900  # of the screen, or of the camera's image [px]
EPOCH_NS = 1_760_676_788_219_000_000  # too long for a float
SHUT = (800.0, 450.0)  # what a tracker may write while it sees no eye [px]


class Eye(NamedTuple):
    """One sample: time [s], point [px from the top left corner], whether the eye is seen."""

    time: float
    x: float
    y: float
    seen: bool


def eyes(count: int = 40, rate: float = 100.0) -> list[Eye]:
    """Two rests with a blink between them."""
    return [
        Eye(k / rate, 400.0 + k if k < count // 2 else 1200.0 - k, 300.0 + 2 * k, not count // 3 <= k < count // 2)
        for k in range(count)
    ]


def _table(header: Sequence[str], rows: Iterable[Sequence[object]], delimiter: str = ",") -> bytes:
    lines = [delimiter.join(header), *(delimiter.join(map(str, row)) for row in rows)]
    return ("\n".join(lines) + "\n").encode()


def _shares(eye: Eye, bottom_left: bool = False) -> tuple[float, float]:
    x, y = (eye.x, eye.y) if eye.seen else SHUT
    return x / WIDTH, 1 - y / HEIGHT if bottom_left else y / HEIGHT


def gaze_csv(path: Path, samples: Sequence[Eye]) -> Path:
    """Plain table in pixels."""
    rows = [(e.time, e.x, e.y, 1) if e.seen else (e.time, "", "", 0) for e in samples]
    path.write_bytes(_table(("time", "x [px]", "y [px]", "valid"), rows))
    return path


def tobii_prolab(path: Path, samples: Sequence[Eye]) -> Path:
    """Pro Lab in a German locale, rows of the mouse interleaved, UTF-16."""
    header = (
        "Sensor", "Recording resolution width [px]", "Recording resolution height [px]", "Eyetracker timestamp [μs]",
        "Gaze point X [DACS px]", "Gaze point Y [DACS px]", "Validity left", "Validity right",
    )  # fmt: skip
    rows: list[Sequence[object]] = []
    for eye in samples:
        point = [f"{eye.x:.1f}".replace(".", ","), f"{eye.y:.1f}".replace(".", ",")] if eye.seen else ["", ""]
        word = "Valid" if eye.seen else "Invalid"
        rows.append(("Eye Tracker", WIDTH, HEIGHT, round(eye.time * 1e6), *point, word, word))
        rows.append(("Mouse", WIDTH, HEIGHT, "", "", "", "", ""))
    path.write_bytes(_table(header, rows, "\t").decode().encode("utf-16"))
    return path


def tobii_old(path: Path, samples: Sequence[Eye]) -> Path:
    """Old SDK: validity 0 is best, 4 is lost, and what is missing is -1; the right eye is never found."""
    header = ("Time", "LGazePos2dx", "LGazePos2dy", "LValidity", "RGazePos2dx", "RGazePos2dy", "RValidity")
    rows = [
        (round(e.time * 1e6), *(_shares(e) if e.seen else (-1.0, -1.0)), 0 if e.seen else 4, -1.0, -1.0, 4)
        for e in samples
    ]
    path.write_bytes(_table(header, rows, "\t"))
    return path


def tobii_research(path: Path, samples: Sequence[Eye]) -> Path:
    """As pandas writes the dictionaries of the callback: tuples in cells, 1 = valid."""
    header = (
        "device_time_stamp", "left_gaze_point_on_display_area", "left_gaze_point_validity",
        "right_gaze_point_on_display_area", "right_gaze_point_validity",
    )  # fmt: skip
    rows = [
        (round(e.time * 1e6), '"({}, {})"'.format(*(_shares(e) if e.seen else ("nan", "nan"))), int(e.seen),
         '"(nan, nan)"', 0)
        for e in samples
    ]  # fmt: skip
    path.write_bytes(_table(header, rows))
    return path


def pupil_core(path: Path, samples: Sequence[Eye]) -> Path:
    """In the scene, origin bottom left; what is not seen has no confidence."""
    header = ("gaze_timestamp", "world_index", "confidence", "norm_pos_x", "norm_pos_y", "base_data")
    rows = [
        (f"{5e5 + e.time:.6f}", 7, 0.97 if e.seen else 0.0, *_shares(e, bottom_left=True), "0.1-0 0.1-1")
        for e in samples
    ]
    path.write_bytes(_table(header, rows))
    return path


def pupil_surface(path: Path, samples: Sequence[Eye]) -> Path:
    """On a surface, origin bottom left."""
    header = ("world_timestamp", "world_index", "gaze_timestamp", "x_norm", "y_norm", "on_surf", "confidence")
    rows = [(0, 7, f"{5e5 + e.time:.6f}", *_shares(e, bottom_left=True), e.seen, 0.97) for e in samples]
    path.write_bytes(_table(header, rows))
    return path


def neon_csv(path: Path, samples: Sequence[Eye]) -> Path:
    """Neon's cloud table: finite in blinks, which have a number."""
    header = ("recording id", "timestamp [ns]", "gaze x [px]", "gaze y [px]", "worn", "fixation id", "blink id")
    rows = [
        ("a-b", EPOCH_NS + round(e.time * 1e9), *((e.x, e.y) if e.seen else SHUT), 1, "", "" if e.seen else 3)
        for e in samples
    ]
    path.write_bytes(_table(header, rows))
    return path


def neon_native(path: Path, samples: Sequence[Eye]) -> Path:
    """Neon's own folder: finite in blinks, which have a list."""
    path.mkdir(exist_ok=True)
    times = np.array([EPOCH_NS + round(e.time * 1e9) for e in samples], dtype="<i8")
    points = np.array([(e.x, e.y) if e.seen else SHUT for e in samples], dtype="<f4")
    shut = times[[not e.seen for e in samples]]
    (path / "gaze ps1.raw").write_bytes(points.tobytes())
    (path / "gaze ps1.time").write_bytes(times.tobytes())
    (path / "worn ps1.raw").write_bytes(bytes([255] * len(samples)))
    (path / "gaze.dtype").write_text('[\n("x", "float32"),\n("y", "float32"),\n]\n')
    (path / "blinks ps1.raw").write_bytes(struct.pack("<iqq", 0, shut[0], shut[-1]) if len(shut) else b"")
    (path / "info.json").write_text('{"module_serial_number": "578846"}')
    return path


def gazepoint(path: Path, samples: Sequence[Eye]) -> Path:
    """The last point repeated while the eyes are lost, with BPOGV = 0."""
    rows: list[Sequence[object]] = []
    last = (0.5, 0.5)
    for count, eye in enumerate(samples):
        last = _shares(eye) if eye.seen else last
        rows.append((count, f"{eye.time:.5f}", 0.1, 0.1, 0, *last, int(eye.seen), ""))
    header = ("CNT", "TIME(2016/11/09 10:05:22.333)", "FPOGX", "FPOGY", "FPOGV", "BPOGX", "BPOGY", "BPOGV", "USER")
    path.write_bytes(_table(header, rows))
    return path


def webgazer_json(path: Path, samples: Sequence[Eye]) -> Path:
    """JSON lines of a listener that writes null while it sees no face."""
    rows = [{"t": round(1e3 * e.time), "x": e.x if e.seen else None, "y": e.y if e.seen else None} for e in samples]
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
    return path


def eyelink_asc(path: Path, samples: Sequence[Eye]) -> Path:
    """Both eyes, the right one missing; the left one finite in a blink."""
    start = 2_154_556
    lines = [
        "** CONVERTED FROM sub_1.edf using edfapi 4.2.1", "** TYPE: EDF_FILE BINARY EVENT SAMPLE TAGGED", "**", "",
        f"MSG\t{start - 9} DISPLAY_COORDS 0 0 1279 1023", "  131 -1.5 153.4 -0.1",
        f"MSG\t{start - 1} GAZE_COORDS 0.00 0.00 {WIDTH - 1}.00 {HEIGHT - 1}.00",
        f"START\t{start} \tLEFT\tRIGHT\tSAMPLES\tEVENTS",
        "SAMPLES\tGAZE\tLEFT\tRIGHT\tRATE\t 100.00\tTRACKING\tCR\tFILTER\t2",
    ]  # fmt: skip
    shut = False
    for eye in samples:
        time = start + round(1e3 * eye.time)
        if not eye.seen and not shut:
            lines.append(f"SBLINK L {time}")
        if eye.seen and shut:
            lines.append(f"EBLINK L {time - 60}\t{time - 10}\t60")
        shut = not eye.seen
        x, y = (eye.x, eye.y) if eye.seen else SHUT
        lines.append(f"{time}\t {x:.1f}\t {y:.1f}\t 778.0\t   .\t   .\t   0.0\t.....")
        lines.append(f"MSG\t{time + 42} READING.STOP")
    path.write_text("\n".join([*lines, f"END\t{start + 9999} \tSAMPLES\tEVENTS\tRES\t  37.17\t  37.75"]) + "\n")
    return path


def bids(path: Path, samples: Sequence[Eye]) -> Path:
    """A packed table without header, and the JSON files that name its columns and the screen."""
    path = path.with_name("sub-01_task-look_recording-eye1_physio.tsv.gz")
    rows = [
        (round(1e3 * e.time), e.x, e.y, 700) if e.seen else (round(1e3 * e.time), "n/a", "n/a", "n/a") for e in samples
    ]
    path.write_bytes(gzip.compress(b"".join(("\t".join(map(str, row)) + "\n").encode() for row in rows)))
    sidecar = {
        "SamplingFrequency": 100,
        "PhysioType": "eyetrack",
        "Columns": ["timestamp", "x_coordinate", "y_coordinate", "pupil_size"],
        "timestamp": {"Units": "ms"},
        "x_coordinate": {"Units": "pixel"},
    }
    path.with_name("sub-01_task-look_recording-eye1_physio.json").write_text(json.dumps(sidecar))
    screen = {"StimulusPresentation": {"ScreenResolution": [WIDTH, HEIGHT], "ScreenOrigin": ["top", "left"]}}
    path.with_name("sub-01_task-look_events.json").write_text(json.dumps(screen))
    return path


def _chunk(tag: int, content: bytes) -> bytes:
    return b"\x04" + struct.pack("<IH", len(content) + 2, tag) + content


def xdf_stream(number: int, name: str, kind: str, labels: Sequence[str], rows: Sequence[Sequence[float]]) -> bytes:
    """Header, samples and footer of a stream; each row is a time and the channels' values."""
    channels = "".join(f"<channel><label>{label}</label><unit>pixels</unit></channel>" for label in labels)
    count = len(rows[0]) - 1
    header = (
        f"<?xml version='1.0'?><info><name>{name}</name><type>{kind}</type><channel_count>{count}</channel_count>"
        f"<nominal_srate>100</nominal_srate><channel_format>double64</channel_format><source_id>id-{number}</source_id>"
        f"<desc><channels>{channels}</channels></desc></info>"
    )
    packed = [b"\x08" + struct.pack(f"<{len(row)}d", *row) for row in rows]
    footer = f"<info><first_timestamp>{rows[0][0]}</first_timestamp><sample_count>{len(rows)}</sample_count></info>"
    head = struct.pack("<I", number)
    parts = [packed[first : first + 10] for first in range(0, len(packed), 10)]
    samples = b"".join(_chunk(3, head + b"\x04" + struct.pack("<I", len(part)) + b"".join(part)) for part in parts)
    return _chunk(2, head + header.encode()) + samples + _chunk(6, head + footer.encode())


def xdf(path: Path, samples: Sequence[Eye]) -> Path:
    """LabRecorder's file with gaze and another stream of the same name."""
    rows = [(7e5 + e.time, e.x if e.seen else np.nan, e.y if e.seen else np.nan, 700.0) for e in samples]
    head = _chunk(1, b"<?xml version='1.0'?><info><version>1.0</version></info>")
    other = xdf_stream(1, "Device", "Pupil", (), [(7e5, 1.0), (7e5 + 0.01, 2.0)])
    path.write_bytes(b"XDF:" + head + other + xdf_stream(2, "Device", "Gaze", ("x", "y", "pupil"), rows))
    return path


WRITERS: dict[str, Callable[[Path, Sequence[Eye]], Path]] = {
    "gaze-csv": gaze_csv,
    "tobii-prolab": tobii_prolab,
    "tobii-old": tobii_old,
    "tobii-research": tobii_research,
    "pupil-core": pupil_core,
    "pupil-surface": pupil_surface,
    "neon-csv": neon_csv,
    "neon-native": neon_native,
    "gazepoint": gazepoint,
    "eyelink-asc": eyelink_asc,
    "webgazer-json": webgazer_json,
    "bids": bids,
    "xdf": xdf,
}

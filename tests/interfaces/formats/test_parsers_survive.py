"""A parser reads any file or refuses it with an `InputError`."""

import contextlib
import json
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from higvf_console.core.errors import HigvfError, InputError, ScriptError
from higvf_console.core.interface import InputSpec
from higvf_interfaces.formats.reading import GAZE_FORMATS, read_gaze
from higvf_interfaces.formats.signals.reading import DECISION_FORMATS, read_decisions
from higvf_interfaces.formats.signals.records import SignalRequest
from higvf_interfaces.gaze.calibration import read_calibration
from higvf_interfaces.gaze.interface import open_gaze
from higvf_interfaces.inspect.inspection import inspect
from higvf_interfaces.recordings.plan import make_recordings
from higvf_interfaces.scripts.interface import open_script
from tests.gaze_files import WRITERS, eyes

TOBII = (
    "Recording timestamp [ms]\tSensor\tEyetracker timestamp [μs]\tGaze point X [DACS px]\tGaze point Y [DACS px]"
    "\tValidity left\tValidity right\n"
    "0\tEye Tracker\t0\t100,5\t200\tValid\tValid\n8\tEye Tracker\t8333\t101\t201\tValid\tInvalid\n"
    "9\tMouse\t\t\t\t\t\n17\tEye Tracker\t16667\t\t\tInvalid\tInvalid\n"
)
PLAIN = "time,x,y,confidence\n0,1,2,0.9\n0.01,1,2,0.9\n0.02,,,0\n"
LOG = "time,label,confidence\n1.5,fist,0.9\n2.5,open,\n"
LINES = '{"time": 1.5, "label": "fist", "confidence": 0.9}\n{"time": 2.5, "label": "open"}\n'
SCRIPT = "- when: {extinguished: 1}\n  after_s: 0.5\n  do: stroke\n  points_m: [[1, 2], [3, 4]]\n"
SEEDS = (TOBII, PLAIN, LOG, LINES, SCRIPT)
GAZE_NAMES = [None, *(known.name for known in GAZE_FORMATS)]
LOG_NAMES = [None, *(known.name for known in DECISION_FORMATS)]
hard = settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
cells = st.sampled_from(
    ["", "0", "1", "-1", "1e308", "-1e308", "1e-320", "nan", "inf", "1,5", "Valid", "Invalid", "Eye Tracker", "9" * 400,
     '"', "fist", "\x00", "time", "٣"]
)  # fmt: skip


def survive(file: Path) -> None:
    """Reads `file` with every reader; only `InputError`s may be raised."""
    for name in GAZE_NAMES:
        with contextlib.suppress(InputError):
            read_gaze(str(file), name)
    for name in LOG_NAMES:
        with contextlib.suppress(InputError):
            read_decisions(str(file), SignalRequest(format=name))
    with contextlib.suppress(InputError):
        open_gaze(InputSpec("gaze", str(file), options={"frame": "arena"}))
    with contextlib.suppress(InputError):
        inspect(InputSpec("inspect", str(file), options={"frame": "screen"}), steps=True)
    with contextlib.suppress(InputError):
        read_calibration(file)
    with contextlib.suppress(ScriptError):
        open_script(InputSpec("script", str(file)))
    with contextlib.suppress(HigvfError):
        make_recordings(file)


@hard
@given(content=st.binary(max_size=400))
def test_random_bytes(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "file").write_bytes(content)
    survive(tmp_path / "file")


@hard
@given(seed=st.sampled_from(SEEDS), encoding=st.sampled_from(["utf-8", "utf-16", "cp1252"]), data=st.data())
def test_truncations_and_overwritten_bytes(tmp_path: Path, seed: str, encoding: str, data: st.DataObject) -> None:
    content = bytearray(seed.encode(encoding, errors="replace"))
    for place in data.draw(st.lists(st.integers(0, len(content) - 1), max_size=4)):
        content[place] = data.draw(st.integers(0, 255))
    (tmp_path / "file").write_bytes(content[: data.draw(st.integers(0, len(content)))])
    survive(tmp_path / "file")


FILES = sorted(set(WRITERS) - {"neon-native", "bids"})


@hard
@given(name=st.sampled_from(FILES), data=st.data())
def test_truncations_and_overwritten_bytes_of_every_gaze_format(tmp_path: Path, name: str, data: st.DataObject) -> None:
    file = WRITERS[name](tmp_path / "file", eyes(12))
    content = bytearray(file.read_bytes())
    for place in data.draw(st.lists(st.integers(0, len(content) - 1), max_size=6)):
        content[place] = data.draw(st.integers(0, 255))
    file.write_bytes(content[: data.draw(st.integers(0, len(content)))])
    for named in (None, name):
        with contextlib.suppress(InputError):
            read_gaze(str(file), named)
    with contextlib.suppress(InputError):
        inspect(InputSpec("inspect", str(file), options={"frame": "screen"}), steps=True)


@settings(hard, max_examples=60)
@given(data=st.data())
def test_damaged_folders_and_sidecars(tmp_path: Path, data: st.DataObject) -> None:
    folder, table = WRITERS["neon-native"](tmp_path / "folder", eyes(12)), WRITERS["bids"](tmp_path / "file", eyes(12))
    for file in (*folder.iterdir(), *tmp_path.glob("sub-01*")):
        content = bytearray(file.read_bytes())
        for place in data.draw(st.lists(st.integers(0, len(content) - 1), max_size=2)):
            content[place] = data.draw(st.integers(0, 255))
        file.write_bytes(content[: data.draw(st.integers(0, len(content)))])
    for source in (folder, table):
        for named in (None, "neon-native", "bids"):
            with contextlib.suppress(InputError):
                read_gaze(str(source), named)


@pytest.mark.parametrize("kind", ["objects", "huge"])
def test_an_invalid_dtype_is_refused(tmp_path: Path, kind: str) -> None:
    folder = WRITERS["neon-native"](tmp_path / "folder", eyes(12))
    types = {"objects": '[("x", "O"), ("y", "O")]', "huge": '[("x", "f4"), ("y", "f4"), ("z", "S999999999")]'}[kind]
    (folder / "gaze.dtype").write_text(types)
    with pytest.raises(InputError, match=r"gaze\.dtype: has other types than numbers"):
        read_gaze(str(folder))


@hard
@given(
    header=st.sampled_from([text.splitlines()[0] for text in (TOBII, PLAIN, LOG)]),
    rows=st.lists(st.lists(cells, max_size=8), max_size=6),
)
def test_arbitrary_cells_below_a_valid_header(tmp_path: Path, header: str, rows: list[list[str]]) -> None:
    delimiter = "\t" if "\t" in header else ","
    (tmp_path / "file").write_text("\n".join([header, *(delimiter.join(row) for row in rows)]), encoding="utf-8")
    survive(tmp_path / "file")


@hard
@given(
    entries=st.lists(
        st.dictionaries(
            st.sampled_from(["time", "label", "confidence", "x"]),
            st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=5), st.just([1])),
        ),
        max_size=5,
    )
)
def test_arbitrary_json_objects(tmp_path: Path, entries: list[dict[str, object]]) -> None:
    (tmp_path / "file").write_text("".join(json.dumps(entry) + "\n" for entry in entries), encoding="utf-8")
    survive(tmp_path / "file")


@hard
@given(order=st.permutations(range(7)))
def test_shuffled_columns_read_the_same(tmp_path: Path, order: list[int]) -> None:
    rows = [line.split("\t") for line in TOBII.splitlines()]
    (tmp_path / "file").write_text("".join("\t".join(row[k] for k in order) + "\n" for row in rows), encoding="utf-8")
    gaze = read_gaze(str(tmp_path / "file"))
    assert gaze.points[:2].tolist() == [[100.5, 200], [101, 201]]
    assert gaze.valid.tolist() == [True, True, False]
    assert gaze.time.tolist() == pytest.approx([0, 0.008333, 0.016667])


@pytest.mark.parametrize(
    "content",
    [
        '{"time": ' + "[" * 100_000,
        '{"time": 1, "label": "a"}\n' + "[" * 100_000,
        '{"time": ' + "9" * 5000 + ', "label": "a"}\n',
        "time,label\n1," + "a" * 300_000 + "\n",
        'time,label\n1,"' + "a" * 300_000,
        "- " * 5000,
        "{" * 5000,
        "time,x,y\n" + "0,1,2\n" * 1000,
        "\ufeff",
    ],
    ids=["deep", "deep later", "long number", "long cell", "open quote", "nested list", "nested map", "doubled", "bom"],
)
def test_known_problem_files(tmp_path: Path, content: str) -> None:
    (tmp_path / "file").write_text(content, encoding="utf-8")
    survive(tmp_path / "file")

"""Inputs that people in this field have, rebuilt as files outside this repository, are read as they should be."""

import os
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec
from higvf_interfaces.inspect.inspection import inspect

Case = Callable[[str], str]


@pytest.fixture
def case() -> Case:
    """Finds a case file; skips the test where it is missing."""

    def found(name: str) -> str:
        root = os.environ.get("HIGVF_CASES") or Path(__file__).parents[4] / "shared" / "cases"
        path = Path(root) / name
        if not path.is_file():
            pytest.skip(f"case file {name} is missing; HIGVF_CASES names its folder")
        return str(path)

    return found


def described(file: str, **options: str) -> Mapping[str, object]:
    return inspect(InputSpec("inspect", file, options))


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("bids-origin-center/sub-01_task-a_recording-eye1_physio.tsv", {"origin": "center", "samples": 400}),
        ("pupil-on-srf/gaze_positions_on_surface_screen_1498.csv", {"format": "pupil-surface", "valid_share": 0.95}),
        ("pupil-confidence/gaze_positions.csv", {"valid_share": 0.95}),
        ("eyelink-gaze-coords/pygaze.asc", {"screen_px": [1920, 1080]}),
        ("bids-inheritance/ds/sub-01/func/sub-01_task-rest_run-01_recording-eye1_physio.tsv.gz",
         {"frame": "screen", "screen_px": [1919, 1079]}),
        ("openbci-ganglion/ganglion.txt", {"samples": 2010, "duration_s": 10.045, "rate_hz": 200, "warnings": []}),
        ("openbci-decimal-comma/comma.txt", {"samples": 600, "duration_s": 2.995, "warnings": []}),
        ("openbci-no-count/gui2.txt", {"columns": [f"EXG Channel {k} [uV]" for k in range(8)], "rate_hz": 250}),
        # Rows of 17 and 20 columns: OpenBCI's converter writes 9 and 12 for 8 channels, and the second 8 here differ.
        ("openbci-sd/obci_sd_converted.txt",
         {"samples": 1000, "rate_hz": 250, "columns": [f"EXG Channel {k} [uV]" for k in range(16)]}),
        ("brainflow-raw/brainflow_raw.csv", {"columns": [f"EXG Channel {k} [uV]" for k in range(8)], "rate_hz": 250}),
        ("edf-latin1-annotation/accent.edf", {"labels": {"fist": 1, "début": 1, "open": 1}, "samples": 2500}),
        ("edf-two-rates/trigno.edf", {"columns": ["EMG1 [uV]", "EMG2 [uV]"], "rate_hz": 1000}),
        ("edf-physical-range/flat.edf", {"columns": ["EMG1 [uV]"]}),
        ("bdf-status/biosemi.bdf", {"columns": ["A1 [uV]", "A2 [uV]"], "labels": {"1": 1, "2": 1}}),
    ],
)  # fmt: skip
def test_a_case_is_read_as_it_should_be(case: Case, name: str, expected: Mapping[str, object]) -> None:
    found = described(case(name))
    assert {key: found[key] for key in expected} == expected


@pytest.mark.parametrize("name", ["xdf-scene-gaze/companion.xdf", "tobii-glasses/glasses.tsv"])
def test_gaze_of_a_scene_camera_does_not_steer(case: Case, name: str) -> None:
    found = described(case(name))
    assert (found["frame"], found["becomes"]) == ("scene", {})
    assert "camera on the head" in str(found["warnings"])
    assert described(case(name), frame="screen")["frame"] == "screen"


def test_the_named_channels_of_a_case_decide_its_rate(case: Case) -> None:
    found = described(case("edf-two-rates/trigno.edf"), channels="ACC X+ACC Y")
    assert (found["columns"], found["rate_hz"]) == (["ACC X [g]", "ACC Y [g]"], 100)
    with pytest.raises(InputError, match="there is no channel 'emg9'"):
        described(case("edf-two-rates/trigno.edf"), channels="EMG9")

"""Sidecars of BIDS recordings are inherited from the folders above, up to the root of the dataset."""

import gzip
import json
from pathlib import Path

import edfio
import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.bids_files import merged_json, sidecars
from higvf_interfaces.formats.reading import read_gaze
from higvf_interfaces.formats.signals.reading import read_signals

NAME = "sub-01_task-rest_run-01_recording-eye1_physio"


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    """A table whose columns and screen stand at the root of the dataset, and whose start stands beside it."""
    folder = tmp_path / "ds" / "sub-01" / "func"
    folder.mkdir(parents=True)
    path = folder / f"{NAME}.tsv.gz"
    path.write_bytes(gzip.compress(b"".join(b"%d\t384\t272\n" % (100_000 + k) for k in range(40))))
    axes = {axis: {"Units": "pixel"} for axis in ("x_coordinate", "y_coordinate")}
    columns = {"Columns": ["timestamp", *axes], "timestamp": {"Units": "ms"}, **axes, "StartTime": 7}
    root = tmp_path / "ds"
    (root / "dataset_description.json").write_text("{}")
    (root / "task-rest_physio.json").write_text(json.dumps(columns))
    (root / "task-rest_events.json").write_text('{"StimulusPresentation": {"ScreenResolution": [1919, 1079]}}')
    (folder / f"{NAME}.json").write_text('{"StartTime": -45.446}')
    return path


def test_columns_and_screen_at_the_root_are_those_of_every_recording(recording: Path) -> None:
    gaze = read_gaze(str(recording))
    assert (gaze.format, gaze.frame, gaze.screen) == ("bids", "screen", (1919, 1079))
    assert gaze.time[0] == pytest.approx(-45.446), "the file beside the recording overrides the root"


def test_only_sidecars_whose_entities_are_those_of_the_recording_apply(recording: Path) -> None:
    root = recording.parents[2]
    for other in ("task-move_physio.json", "sub-02_physio.json", "recording-eye2_physio.json", "task-rest_eeg.json"):
        (root / other).write_text('{"StartTime": 99}')
    names = [path.name for path in sidecars(recording, "physio", "json")]
    assert names == ["task-rest_physio.json", f"{NAME}.json"]


def test_of_one_folder_the_more_specific_sidecar_overrides(recording: Path) -> None:
    for name in ("physio.json", "sub-01_physio.json"):
        (recording.parent / name).write_text(json.dumps({"Manufacturer": name}))
    assert (merged_json(recording, "physio") or {})["Manufacturer"] == "sub-01_physio.json"


def test_without_a_root_only_the_folder_of_the_recording_counts(recording: Path) -> None:
    (recording.parents[2] / "dataset_description.json").unlink()
    assert [path.name for path in sidecars(recording, "physio", "json")] == [f"{NAME}.json"]
    with pytest.raises(InputError, match=r"a BIDS table has no header"):
        read_gaze(str(recording), "bids")


def test_the_channel_table_of_signals_is_inherited(tmp_path: Path) -> None:
    folder = tmp_path / "ds" / "sub-01" / "emg"
    folder.mkdir(parents=True)
    (tmp_path / "ds" / "dataset_description.json").write_text("{}")
    (tmp_path / "ds" / "task-grip_channels.tsv").write_text("name\ttype\tunits\tstatus\nEMG1\tEMG\tuV\tbad\n")
    values = np.sin(np.arange(500) / 7)
    edfio.Edf([edfio.EdfSignal(values, 250, label="EMG1", physical_dimension="uV")]).write(
        folder / "sub-01_task-grip_emg.edf"
    )
    assert read_signals(str(folder / "sub-01_task-grip_emg.edf")).notes == ["marked bad in channels.tsv: EMG1"]

"""A file is inspected as the input of a channel, with its settings, and marker streams by their labels."""

import json
from collections.abc import Callable, Mapping
from typing import Any, cast

import pytest

from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec
from higvf_interfaces.inspect.inspection import inspect
from tests.interfaces.formats.xdf_files import Stream, xdf

Write = Callable[..., str]
LOG = "time,label,confidence\n1,point,0.9\n2,point,0.4\n3,robot9,0.9\n4,rest,0.9\n"
CONSOLE = Stream(
    "console", "Markers", "higvf-console console", 0, [10.0, 11.0, 12.5],
    [json.dumps({"label": label, "source": "bci", "time": 1.0}) for label in ("Pick", "Pick", "extinguished")],
)  # fmt: skip


def inspected(
    channel: str, file: str, settings: Mapping[str, object] | None = None, **options: str
) -> Mapping[str, Any]:
    spec = InputSpec(channel, file, options, settings or {}, robots=3)
    return cast(Mapping[str, Any], inspect(spec, None, False))


def test_a_log_becomes_the_commands_that_the_run_would_be_given(write: Write) -> None:
    settings = {"labels": {"point": "robot:2"}, "threshold": 0.6}
    told = inspected("bci", write(LOG), settings)
    assert told["becomes"]["bci"] == {"point": "robot:2", "robot9": "robot:9", "rest": "none"}
    assert told["becomes"]["commands"] == {"Pick": 1}  # one is below the threshold, and there is no robot 9
    assert told["warnings"] == []
    assert "emg" not in told["becomes"]
    shifted = inspected("bci", write(LOG), settings, start="-1.5")
    assert shifted["becomes"]["commands"] == {}


def test_without_a_channel_the_defaults_of_all_are_shown(write: Write) -> None:
    told = inspected("inspect", write(LOG))
    assert set(told["becomes"]) == {"emg", "bci"}
    assert any("unknown to all channels: point" in warning for warning in told["warnings"])


def test_the_option_of_a_live_stream_is_refused_for_a_file(write: Write) -> None:
    with pytest.raises(InputError, match="name chooses a live stream, and this is a file"):
        inspected("bci", write(LOG), None, name="Muse")
    assert inspected("bci", write(LOG), {"name": "Muse"})["kind"] == "commands"  # as in a run


def test_a_recorded_stream_of_the_console_is_shown_as_commands_with_its_labels(write: Write) -> None:
    told = inspected("inspect", write(xdf(CONSOLE)))
    assert (told["kind"], told["samples"], told["duration_s"]) == ("commands", 3, 2.5)
    assert told["labels"] == {"Pick": 2, "extinguished": 1}
    assert [stream["name"] for stream in told["streams"]] == ["console"]


def test_one_of_several_marker_streams_is_shown_by_its_name_else_all_are_listed(write: Write) -> None:
    eeg = Stream("Muse", "EEG", "m", 50, [10 + k / 50 for k in range(200)], [(1.0,)] * 200, ("A",))
    file = write(xdf(CONSOLE, Stream("Cues", "Markers", "c", 0, [11.0], ["fist"]), eeg))
    assert inspected("inspect", file, None, stream="Cues")["labels"] == {"fist": 1}
    assert inspected("inspect", file)["kind"] == "signals"
    listed = inspected("bci", file)
    assert (listed["kind"], len(listed["streams"])) == ("streams", 3)
    assert any("has 2 event streams; choose one by stream=" in warning for warning in listed["warnings"])
    assert inspected("bci", file, None, stream="Cues")["labels"] == {"fist": 1}


def test_a_signal_with_markers_is_to_a_channel_without_decoder_its_markers(write: Write) -> None:
    rows = "".join(f"{k / 50:.2f},{k % 7}.5,{2 if k == 90 else 0}\n" for k in range(300))
    file = write("timestamps,C3,Marker0\n" + rows)
    assert inspected("bci", file)["becomes"]["commands"] == {"Pick": 1}
    assert inspected("inspect", file)["kind"] == "signals"


def test_a_decoder_gives_the_commands_of_the_run(write: Write) -> None:
    rows = "".join(f"{k / 250:.4f},{(k * 7919) % 13}.5\n" for k in range(1500))
    told = inspected("bci", write("timestamps,Oz\n" + rows), None, decoder="ssvep", targets="robot1@20+robot2@30")
    assert told["kind"] == "signals"
    assert isinstance(told["becomes"]["commands"], dict)

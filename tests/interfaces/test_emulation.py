"""Emulated errors have the given sizes and are reproducible by the seed."""

from collections import Counter
from collections.abc import Callable

import numpy as np
import pytest

from higvf_console.core.arrays import bools, floats
from higvf_console.core.commands import OperatorCommand
from higvf_console.core.errors import InputError
from higvf_console.core.interface import ChannelState, InputSpec, OperatorContext
from higvf_interfaces.decisions.bci import open_bci
from higvf_interfaces.decisions.feeds import LogFeed
from higvf_interfaces.emulation import EmulatedFeed, ErrorModel, emulate, emulate_gaze
from higvf_interfaces.formats.records import CommandLog, Decision, GazeRecording
from higvf_interfaces.gaze.interface import open_gaze
from higvf_interfaces.scripts.interface import open_script

ContextAt = Callable[..., OperatorContext]
Write = Callable[..., str]
LABELS = ("left", "right", "feet")
MANY = [Decision(0.1 * k, LABELS[k % 3], 0.9) for k in range(1, 3001)]


def worse(model: ErrorModel) -> list[Decision | None]:
    return [emulate(decision, k, LABELS, model) for k, decision in enumerate(MANY)]


def test_an_emulated_decoder_has_the_given_accuracy_and_uniform_errors() -> None:
    said = [
        (true.label, given.label) for true, given in zip(MANY, worse(ErrorModel(confusion=0.7)), strict=True) if given
    ]
    assert np.mean([true == given for true, given in said]) == pytest.approx(0.7, abs=0.03)
    wrong = Counter(given for true, given in said if true == "left" != given)
    assert wrong["right"] / wrong.total() == pytest.approx(0.5, abs=0.08)


def test_a_confusion_matrix_is_kept_row_by_row() -> None:
    model = ErrorModel(confusion={"left": {"right": 0.25, "feet": 0.5}})
    said = [(true.label, given.label) for true, given in zip(MANY, worse(model), strict=True) if given]
    left = Counter(given for true, given in said if true == "left")
    assert [left[label] / left.total() for label in LABELS] == pytest.approx([0.25, 0.25, 0.5], abs=0.05)
    assert all(true == given for true, given in said if true != "left")


def test_latency_jitter_and_dropout_have_the_given_sizes() -> None:
    given = worse(ErrorModel(latency=0.4, jitter=0.2, dropout=0.3))
    late = [g.time - true.time for true, g in zip(MANY, given, strict=True) if g]
    assert len(late) / len(MANY) == pytest.approx(0.7, abs=0.03)
    assert min(late) >= 0.4
    assert np.mean(late) == pytest.approx(0.6, abs=0.02)


def test_the_delivery_of_a_feed_does_not_depend_on_the_polling_rate() -> None:
    model = ErrorModel(latency=0.3, jitter=0.5, dropout=0.2, confusion=0.8, seed=7)

    def played(period: float) -> list[Decision]:
        feed = EmulatedFeed(LogFeed(CommandLog(tuple(MANY[:300]), 0.0, "test", ()), 0.0), model)
        due = [due for k in range(round(60 / period)) for due in feed.due(k * period)]
        assert feed.ended
        assert all(due[k].decision.time <= due[k + 1].decision.time for k in range(len(due) - 1))
        return [d.decision for d in due]

    assert played(0.02) == played(1.0)


def commands(write: Write, at: ContextAt, **options: str) -> list[OperatorCommand]:
    text = "time,label,confidence\n" + "".join(f"{k / 2},robot{1 + k % 3},0.9\n" for k in range(1, 60))
    replay = open_bci(InputSpec("bci", write(text), options=options))
    return [command for k in range(4000) for command in replay.poll(at(0.01 * k))]


def test_the_same_seed_gives_the_same_commands_and_another_one_others(write: Write, at: ContextAt) -> None:
    errors = {"latency": "0.4", "jitter": "0.1", "confusion": "0.6", "dropout": "0.1"}
    first = commands(write, at, **errors, seed="3")
    assert first == commands(write, at, **errors, seed="3")
    assert first != commands(write, at, **errors, seed="4")
    assert first[0].time >= 0.9
    assert [command.sequence for command in first] == list(range(len(first)))


def test_an_emulated_channel_is_marked_as_such_and_replays_after_a_reset(write: Write, at: ContextAt) -> None:
    replay = open_bci(InputSpec("bci", write("time,label\n1,robot1\n"), options={"latency": "0.5", "confusion": "1"}))
    assert replay.poll(at(1.2)) == []
    assert replay.health(1.2).state is ChannelState.NEVER_SEEN
    assert [command.time for command in replay.poll(at(2.0))] == [1.5]
    assert replay.health(2.0).state is ChannelState.ENDED
    assert "emulated: latency=0.5" in replay.health(2.0).detail
    assert replay.poll(at(0.0)) == []
    assert [command.time for command in replay.poll(at(2.0))] == [1.5]


def test_a_reset_drops_delayed_commands(write: Write, at: ContextAt) -> None:
    replay = open_bci(InputSpec("bci", write("time,label\n1,robot1\n"), options={"latency": "5"}))
    assert replay.poll(at(3.0)) == []
    assert [replay.poll(at(time)) for time in (0.0, 0.5, 0.99)] == [[], [], []]
    assert len(replay.poll(at(6.0))) == 1


def test_a_script_can_be_delayed_and_lossy_but_its_strokes_stay_complete(write: Write, at: ContextAt) -> None:
    text = "- {at_s: 1, do: stroke, points_m: [[0, 0], [10, 0], [20, 5]]}\n- {at_s: 2, do: pause}\n"
    script = open_script(InputSpec("script", write(text), options={"latency": "0.3", "dropout": "1"}))
    assert script.poll(at(1.2)) == []
    late = [command for k in range(200) for command in script.poll(at(1.2 + 0.01 * k))]
    assert [(type(command).__name__, command.time) for command in late] == [("StrokeBegin", 1.3), ("StrokeEnd", 1.3)]
    assert "emulated: latency=0.3, dropout=1" in script.health(3.0).detail


def gaze() -> GazeRecording:
    time = floats(np.arange(0, 120, 0.01))
    points = floats(np.tile([900.0, 500.0], (len(time), 1)))
    return GazeRecording(
        time=time,
        points=points,
        valid=bools(np.ones(len(time))),
        confidence=None,
        frame="screen",
        screen=None,
        epoch=0.0,
        format="test",
        notes=(),
    )


def test_gaze_has_the_given_noise_and_drift() -> None:
    worse = emulate_gaze(gaze(), ErrorModel(noise_deg=0.5, drift_deg_per_min=1.5, seed=2), 38.0)
    off = (worse.points - [900.0, 500.0]) / 38.0
    assert np.linalg.norm(off[-1000:].mean(axis=0)) == pytest.approx(1.5 * 115 / 60, abs=0.1)
    assert off[:500].std() == pytest.approx(0.5, abs=0.05)
    assert np.array_equal(
        worse.points, emulate_gaze(gaze(), ErrorModel(noise_deg=0.5, drift_deg_per_min=1.5, seed=2), 38.0).points
    )


def test_gaze_is_lost_in_blackouts_and_delayed() -> None:
    worse = emulate_gaze(gaze(), ErrorModel(dropout=0.25, latency=0.1), 38.0)
    assert worse.valid.mean() == pytest.approx(0.75, abs=0.06)
    edges = np.count_nonzero(np.diff(worse.valid.astype(int)))
    assert edges < 600, "samples are lost in stretches, as in blinks"
    assert worse.time == pytest.approx(gaze().time + 0.1)


def test_emulated_gaze_is_opened_by_its_options(write: Write, at: ContextAt) -> None:
    file = write("time,x [px],y [px]\n" + "".join(f"{k / 100},900,500\n" for k in range(300)))
    replay = open_gaze(InputSpec("gaze", file, options={"noise_deg": "0.5", "drift_deg_per_min": "2", "seed": "1"}))
    replay.poll(at(1.0))
    assert "emulated: noise_deg=0.5, drift_deg_per_min=2, seed=1" in replay.health(1.0).detail


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"confusion": 1.5}, "confusion: 1.5 is not a number from 0 to 1"),
        (
            {"confusion": {"left": {"right": 1.2}}},
            "confusion: left: {'right': 1.2} is not a mapping from labels to probabilities",
        ),
        ({"confusion": {"left": 0.5}}, "confusion: left: 0.5 is not a mapping"),
        ({"latency": -1}, "latency: -1 is not a number from 0 to 60 s"),
        ({"dropout": "much"}, "dropout: 'much' is not a number from 0 to 1"),
        ({"seed": -1}, "seed: -1 is not a number from 0"),
    ],
)
def test_invalid_error_models_are_refused(write: Write, options: dict[str, object], message: str) -> None:
    with pytest.raises(InputError) as refusal:
        open_bci(InputSpec("bci", write("time,label\n1,robot1\n"), settings=options))
    assert message in str(refusal.value)

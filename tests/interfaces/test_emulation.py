"""Emulated errors have the given sizes and are reproducible by the seed."""

from collections import Counter
from collections.abc import Callable

import numpy as np
import pytest

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import OperatorCommand
from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec, OperatorContext
from higvf_interfaces.decisions.bci import open_bci
from higvf_interfaces.emulation import ErrorModel, GazeErrors, confuse
from higvf_interfaces.formats.records import Decision
from higvf_interfaces.gaze.interface import open_gaze

ContextAt = Callable[..., OperatorContext]
Write = Callable[..., str]
LABELS = ("left", "right", "feet")
MANY = [Decision(0.1 * k, LABELS[k % 3], 0.9) for k in range(1, 3001)]
TIME = floats(np.arange(0, 120, 0.01))


def confused(model: ErrorModel) -> list[tuple[str, str]]:
    """True and given label of each decision."""
    return [(decision.label, confuse(decision, k, LABELS, model).label) for k, decision in enumerate(MANY)]


def test_an_emulated_decoder_has_the_given_accuracy_and_uniform_errors() -> None:
    said = confused(ErrorModel(confusion=0.7))
    assert np.mean([true == given for true, given in said]) == pytest.approx(0.7, abs=0.03)
    wrong = Counter(given for true, given in said if true == "left" != given)
    assert wrong["right"] / wrong.total() == pytest.approx(0.5, abs=0.08)


def test_a_confusion_matrix_is_kept_row_by_row() -> None:
    said = confused(ErrorModel(confusion={"left": {"right": 0.25, "feet": 0.5}}))
    left = Counter(given for true, given in said if true == "left")
    assert [left[label] / left.total() for label in LABELS] == pytest.approx([0.25, 0.25, 0.5], abs=0.05)
    assert all(true == given for true, given in said if true != "left")


def commands(write: Write, at: ContextAt, seed: str) -> list[OperatorCommand]:
    text = "time,label,confidence\n" + "".join(f"{k / 2},robot{1 + k % 3},0.9\n" for k in range(1, 60))
    replay = open_bci(InputSpec("bci", write(text), options={"confusion": "0.6", "seed": seed}))
    return [command for k in range(400) for command in replay.poll(at(0.1 * k))]


def test_the_same_seed_gives_the_same_commands_and_another_one_others(write: Write, at: ContextAt) -> None:
    first = commands(write, at, "3")
    assert first == commands(write, at, "3")
    assert first != commands(write, at, "4")
    assert [command.sequence for command in first] == list(range(len(first)))


def test_a_link_of_the_channel_gives_its_seed_to_the_decoder(write: Write, at: ContextAt) -> None:
    file = write("time,label\n" + "".join(f"{k / 2},robot{1 + k % 3}\n" for k in range(1, 60)))

    def robots(options: dict[str, str], seed: int) -> list[int]:
        replay = open_bci(InputSpec("bci", file, {"confusion": "0.6", **options}, seed=seed))
        return [vars(command)["robot"] for command in replay.poll(at(99.0))]

    assert robots({}, 3) == robots({"seed": "3"}, 0)
    assert robots({}, 3) != robots({}, 0)


def test_an_emulated_decoder_is_marked_as_such(write: Write, at: ContextAt) -> None:
    replay = open_bci(InputSpec("bci", write("time,label\n1,robot1\n"), options={"confusion": "0.9"}))
    replay.poll(at(2.0))
    assert "emulated: confusion=0.9" in replay.health(2.0).detail


def worse(model: ErrorModel) -> Floats:
    """Points of steady gaze [px] with errors."""
    return GazeErrors(model, 38.0)(TIME, floats(np.tile([900.0, 500.0], (len(TIME), 1))))


def test_gaze_has_the_given_noise_and_drift() -> None:
    model = ErrorModel(noise_deg=0.5, drift_deg_per_min=1.5, seed=2)
    off = (worse(model) - [900.0, 500.0]) / 38.0
    assert np.linalg.norm(off[-1000:].mean(axis=0)) == pytest.approx(1.5 * 115 / 60, abs=0.1)
    assert off[:500].std() == pytest.approx(0.5, abs=0.05)
    assert np.array_equal(worse(model), worse(model))


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
        ({"seed": -1}, "seed: -1 is not a number from 0"),
    ],
)
def test_invalid_error_models_are_refused(write: Write, options: dict[str, object], message: str) -> None:
    with pytest.raises(InputError) as refusal:
        open_bci(InputSpec("bci", write("time,label\n1,robot1\n"), settings=options))
    assert message in str(refusal.value)


def test_a_seed_that_seeds_nothing_is_warned_of(write: Write) -> None:
    log, look = write("time,label\n1,robot1\n"), write("time,x [px],y [px]\n0,1,1\n0.1,2,2\n", "look.csv")
    (warning,) = open_bci(InputSpec("bci", log, {"seed": "3"})).warnings
    assert warning.endswith("seed changes nothing without latency, jitter, dropout, confusion")
    (warning,) = open_gaze(InputSpec("gaze", look, {"seed": "3"})).warnings
    assert warning.endswith("seed changes nothing without latency, jitter, dropout, noise_deg, drift_deg_per_min")
    assert open_bci(InputSpec("bci", log, {"seed": "3", "confusion": "0.9"})).warnings == ()
    assert open_bci(InputSpec("bci", log)).warnings == ()

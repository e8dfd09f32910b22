"""Trials in a file: a search that was interrupted goes on, and no trials of another fit are taken for its own."""

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from higvf_console.core.errors import HigvfError
from higvf_console.lab.fit import search as fit
from higvf_console.lab.fit.joint import FORM as JOINT_FORM
from higvf_console.lab.fit.joint import JointTrial
from higvf_console.lab.fit.kept import KeptTrials
from higvf_console.lab.fit.search import FORM, Trial, search
from higvf_console.lab.fit.space import SPACE, Sample, distance, on_grid

CENTRE = on_grid(np.array([(free.low + free.high) / 2 for free in SPACE]))
RUNS = 2 * fit.RESTARTS * fit.POPULATION


def bowl(sample: Sample) -> Trial:
    return Trial(sample, (0.01,) * 5, True, distance(sample, CENTRE))


class InterruptedSearchError(Exception):
    """Stands in for Ctrl-C."""


def searched(file: Path | None, most: int = RUNS) -> tuple[list[Trial], int]:
    """The trials of a search, and how many of them were run; interrupted after `most`."""
    kept, count = KeptTrials(FORM, file, bowl), 0

    def run(samples: Sequence[Sample]) -> list[Trial]:
        nonlocal count
        count += len(samples)
        if count > most:
            raise InterruptedSearchError
        return [bowl(sample) for sample in samples]

    return search(RUNS, 3, lambda samples: kept.trials(samples, run)), count


def test_an_interrupted_search_goes_on_to_the_same_end(tmp_path: Path) -> None:
    whole, runs = searched(None)
    file = tmp_path / "trials.jsonl"
    with pytest.raises(InterruptedSearchError):
        searched(file, most=runs // 2)
    done = len(file.read_text().splitlines()) - 1
    assert 0 < done <= runs // 2
    assert searched(file) == (whole, runs - done)
    assert searched(file) == (whole, 0)


def test_a_line_that_was_cut_off_is_made_again(tmp_path: Path) -> None:
    file = tmp_path / "trials.jsonl"
    whole, _ = searched(file)
    file.write_text(file.read_text()[:-20])
    assert searched(file) == (whole, 1)
    assert len(file.read_text().splitlines()) == len(whole) + 1


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("no trials\n", "not a file of trials that `higvf fit` wrote"),
        ('{"higvf_fit_trials": 1', "not a file of trials that `higvf fit` wrote"),
        ("[1]\n", "not a file of trials that `higvf fit` wrote"),
        ("{}", "not a file of trials that `higvf fit` wrote"),
        ('{"higvf_fit_trials": 1, "columns": "all", "parameters": []}\n', "give another file for --columns 1"),
    ],
)
def test_another_file_is_refused_and_left_alone(tmp_path: Path, text: str, reason: str) -> None:
    file = tmp_path / "trials.jsonl"
    file.write_text(text)
    with pytest.raises(HigvfError, match=reason):
        searched(file)
    assert file.read_text() == text


def test_trials_of_another_engine_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "trials.jsonl"
    searched(file)
    with pytest.raises(HigvfError, match="the engine has changed"):
        KeptTrials(FORM, file, lambda sample: bowl(sample)._replace(objective=-1.0))


def test_trials_of_the_other_fit_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "trials.jsonl"
    searched(file)
    with pytest.raises(HigvfError, match="of another fit; give another file for --columns all"):
        KeptTrials(JOINT_FORM, file, lambda sample: JointTrial(sample, 0.0, True, 0.0))


def test_a_folder_is_refused_with_the_option(tmp_path: Path) -> None:
    with pytest.raises(HigvfError, match=f"--keep {tmp_path}: "):
        KeptTrials(FORM, tmp_path, bowl)


def test_a_trial_of_all_columns_is_read_as_it_was_written() -> None:
    trial = JointTrial(CENTRE, 0.1 + 0.2, True, 1.02)
    assert JOINT_FORM.read(json.loads(json.dumps(trial))) == trial

"""Decoders are scored by trial, and a signal that is unusable for control is reported as such."""

import json
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.errors import InputError
from higvf_interfaces.decisions.debouncer import Evidence
from higvf_interfaces.decoding.__main__ import main
from higvf_interfaces.decoding.contract import Trial
from higvf_interfaces.decoding.evaluation import (
    Score,
    false_commands_per_minute,
    score,
    score_emg,
    verdict,
    wilson,
)
from higvf_interfaces.formats.records import Decision
from higvf_interfaces.formats.signals.records import SignalRecord, sliced

TRIALS = [Trial("ab"[k % 2], 10.0 * k, 10.0 * k + 4.0) for k in range(8)]


def said(labels: str, confidence: float = 1.0) -> list[list[Decision]]:
    """Ten decisions per trial, all with the letter of that trial."""
    return [
        [Decision(trial.start + 0.3 * (k + 1), label, confidence) for k in range(10)]
        for trial, label in zip(TRIALS, labels, strict=True)
    ]


def scored(labels: str) -> Score:
    return score("test", TRIALS, said(labels), said(labels))


def test_trials_windows_latency_and_wrong_commands_are_counted() -> None:
    result = scored("ababaaab")
    assert (result.trials, result.correct, result.windows, result.windows_correct) == (8, 7, 80, 70)
    assert result.confusion == {("a", "a"): 4, ("b", "a"): 1, ("b", "b"): 3}
    assert result.latency_s == pytest.approx(1.2), "the fourth of five votes reaches a support of 0.8"
    assert result.wrong_per_minute == pytest.approx(1 / (8 * 4 / 60))
    assert result.chance == 0.5


def test_the_interval_of_a_proportion_is_wilsons() -> None:
    assert wilson(9, 10) == pytest.approx((0.5958, 0.9821), abs=1e-3)
    assert wilson(0, 5)[0] == 0.0
    assert wilson(5, 5)[1] == 1.0


@pytest.mark.parametrize(
    ("labels", "words"),
    [
        ("aaaaaaaa", "unusable for control"),
        ("babababa", "unusable for control"),
        ("abababab", "Inconclusive"),
    ],
)
def test_the_verdict_is_one_sentence(labels: str, words: str) -> None:
    assert words in verdict(scored(labels))


def test_the_verdict_considers_commands_as_well_as_accuracy() -> None:
    result = scored("abababab")._replace(trials=80, correct=80, reached=70)
    assert verdict(result) == "The signal suffices for control."
    assert "only 30 of 80 trials gave their command" in verdict(result._replace(reached=30))
    assert "too weak for control" in verdict(result._replace(correct=52))


def test_trials_without_a_decision_are_refused() -> None:
    with pytest.raises(InputError, match="none of the 8 trials is long enough"):
        score("test", TRIALS, [[]] * 8, [[]] * 8)


def test_false_commands_are_counted_per_minute() -> None:
    idle = [Decision(0.5 * k, "a" if k % 40 < 10 else "idle", 0.9) for k in range(240)]
    assert false_commands_per_minute(idle, Evidence(votes=3, of=5, enter=0.8, leave=0.5)) == pytest.approx(3, abs=0.1)


def record(trials: Sequence[Trial], loud: Sequence[int]) -> SignalRecord:
    """Eight electrodes of noise; in each trial the electrode of that number has ten times the amplitude."""
    draw = np.random.default_rng(0)
    times = floats(np.arange(0.0, trials[-1].end, 1e-3))
    params = np.ones((len(times), 8))
    for trial, electrode in zip(trials, loud, strict=True):
        params[(times >= trial.start) & (times < trial.end), electrode] = 10.0
    values = floats(params * draw.normal(size=params.shape))
    names = tuple(f"EMG{k}" for k in range(8))
    return SignalRecord(names, ("uV",) * 8, 1000.0, 0.0, "test", [], lambda: sliced(times, values))


def test_cross_validation_does_not_leak_between_repetitions() -> None:
    trials = [Trial("ab"[k % 2], 2.0 * k, 2.0 * k + 1.5) for k in range(8)]
    assert score_emg(record(trials, [0, 1] * 4), trials, 50.0).accuracy == 1.0
    # An electrode of its own marks each trial: a split that put windows of it on both sides would be always right.
    result = score_emg(record(trials, range(8)), trials, 50.0)
    assert verdict(result) == "The signal is unusable for control: the accuracy is not above chance."


def test_the_figures_of_the_shared_recordings(
    sample: Callable[[str], Path], capsys: pytest.CaptureFixture[str]
) -> None:
    gestures = sample("xdf_emg8_gestures/test1.xdf")
    assert main([str(gestures), "decoder=lda,mains=60", "--json"]) == 0
    emg = json.loads(capsys.readouterr().out)
    assert 0.6 < emg["accuracy_by_trial"] < 0.95
    assert "rarely pass the debouncer" in emg["verdict"]
    assert "250 Hz covers only part of the EMG band" in emg["notes"][0]
    flicker = sample("eeg_ssvep_muse/data_2017-09-14-21.20.04.csv")
    assert main([str(flicker), "decoder=ssvep,targets=1@30+2@20,mains=60,trial_s=3", "--json"]) == 0
    eeg = json.loads(capsys.readouterr().out)
    assert eeg["accuracy_by_trial"] > 0.95
    assert eeg["wrong_commands_per_minute"] < 1
    idle = sample("openbci_gui_v6/OpenBCI_GUI-v6-blinks-jawClench-alpha_first60s.txt")
    assert main([str(idle), "decoder=ssvep,targets=1@30+2@20,mains=60", "--idle"]) == 0
    assert "false_commands_per_minute: " in capsys.readouterr().out


def test_an_undecodable_recording_is_refused_in_one_line(
    sample: Callable[[str], Path], capsys: pytest.CaptureFixture[str]
) -> None:
    myo = sample("emg_myo8/emg_data_myo.csv")
    assert main([str(myo), "decoder=lda,rate=200"]) == 2
    said_so = capsys.readouterr().err
    assert "not decisions; give decoder=" in said_so
    assert said_so.count("\n") == 1

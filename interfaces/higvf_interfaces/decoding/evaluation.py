"""Evaluation of decoders on labelled recordings: accuracy by trial with its interval, and the resulting commands.

Overlapping and neighbouring windows are correlated, so windows of one trial are never split between training and test:
the EMG model is trained on all repetitions of the gestures but one and tested on the one left out.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from higvf_console.core.errors import InputError
from higvf_interfaces.decisions.debouncer import Debounced, Evidence, Stage, judge, observe
from higvf_interfaces.decisions.evidence import STREAMING
from higvf_interfaces.decoding.contract import Decoder, Trial
from higvf_interfaces.decoding.emg_lda import EmgFrontEnd, decided, fit, label_at
from higvf_interfaces.decoding.ssvep import IDLE
from higvf_interfaces.formats.records import Decision
from higvf_interfaces.formats.signals.records import SignalRecord

STEERING = 0.7  # accuracy commonly required for control
_Z = 1.96  # normal quantile of a 95 % interval


class Score(NamedTuple):
    """Scores of a decoder.

    Attributes:
        decoder: name of the decoder.
        trials: number of trials.
        correct: number of trials with the correct label, decided by the summed confidence of their windows.
        windows: number of decisions within trials.
        windows_correct: number of correct decisions within trials.
        chance: share of trials of the most frequent label.
        latency_s: median time from the start of a trial to its correct command [s]; NaN without one.
        reached: number of trials that gave their correct command.
        wrong_commands: number of other commands within trials.
        minutes: total duration of the trials [min].
        confusion: number of trials by (cued, decided) label.
    """

    decoder: str
    trials: int
    correct: int
    windows: int
    windows_correct: int
    chance: float
    latency_s: float
    reached: int
    wrong_commands: int
    minutes: float
    confusion: dict[tuple[str, str], int]

    @property
    def accuracy(self) -> float:
        """Share of correct trials."""
        return self.correct / self.trials

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval of the accuracy by trial."""
        return wilson(self.correct, self.trials)

    @property
    def wrong_per_minute(self) -> float:
        """Wrong commands per minute of trials."""
        return self.wrong_commands / self.minutes


def score_emg(record: SignalRecord, trials: Sequence[Trial], mains: float) -> Score:
    """Cross-validate the EMG decoder, leaving out one repetition of every gesture at a time.

    Raises:
        InputError: If there are too few trials.
    """
    front = EmgFrontEnd(record.rate, mains)
    windows = [window for chunk in record.chunks() for window in front.windows(chunk)]
    repetition = _repetitions(trials)
    decisions: list[list[Decision]] = []
    models = {
        left_out: fit(windows, [t for t, r in zip(trials, repetition, strict=True) if r != left_out])
        for left_out in sorted(set(repetition))
    }
    for trial, left_out in zip(trials, repetition, strict=True):
        own = [window for window in windows if label_at(window, [trial]) is not None]
        decisions.append([decided(models[left_out], window) for window in own])
    return score("lda", trials, decisions, decisions)


def score_decoder(name: str, record: SignalRecord, trials: Sequence[Trial], decoder: Decoder, window: float) -> Score:
    """Evaluate a decoder that needs no calibration on the whole recording.

    Args:
        name: name of the decoder.
        record: the signal.
        trials: trials in the signal.
        decoder: decoder in its initial state.
        window: duration of a window [s]; only windows entirely within a trial decide the trial.
    """
    made = [decision for chunk in record.chunks() for decision in decoder.push(chunk)]
    during = [[d for d in made if t.start < d.time <= t.end] for t in trials]
    pure = [[d for d in own if d.time - window >= t.start] for t, own in zip(trials, during, strict=True)]
    return score(name, trials, pure, during)


def score(
    name: str, trials: Sequence[Trial], pure: Sequence[Sequence[Decision]], during: Sequence[Sequence[Decision]]
) -> Score:
    """Compute the scores of decisions by trial.

    Args:
        name: name of the decoder.
        trials: n trials.
        pure: for each trial, the decisions whose window lies entirely within it; they decide the trial.
        during: for each trial, all decisions made during it; the debouncer turns them into commands.

    Raises:
        InputError: If there are no trials, or no trial contains a decision.
    """
    if not any(pure):
        raise InputError(f"{name}: none of the {len(trials)} trials is long enough for a decision")
    verdicts = [_elected(own) for own in pure]
    commands = [_commands(own) for own in during]
    hits = [next((c.time - t.start for c in given if c.label == t.label), math.nan)
            for t, given in zip(trials, commands, strict=True)]  # fmt: skip
    cued = [trial.label for trial in trials]
    pairs = list(zip(cued, verdicts, strict=True))
    return Score(
        decoder=name,
        trials=len(trials),
        correct=sum(label == verdict for label, verdict in pairs),
        windows=sum(map(len, pure)),
        windows_correct=sum(d.label == t.label for t, own in zip(trials, pure, strict=True) for d in own),
        chance=max(cued.count(label) for label in cued) / len(cued),
        latency_s=float(np.nanmedian(hits)) if np.isfinite(hits).any() else math.nan,
        reached=int(np.isfinite(hits).sum()),
        wrong_commands=sum(c.label != t.label for t, given in zip(trials, commands, strict=True) for c in given),
        minutes=sum(trial.end - trial.start for trial in trials) / 60.0,
        confusion={pair: pairs.count(pair) for pair in sorted(set(pairs))},
    )


def false_commands_per_minute(decisions: Sequence[Decision], evidence: Evidence) -> float:
    """Return the commands per minute from `decisions`, in order of time, that contain no intended command."""
    if len(decisions) < 2:
        return math.nan
    return len(_commands(decisions, evidence)) / (decisions[-1].time - decisions[0].time) * 60.0


def wilson(successes: int, count: int) -> tuple[float, float]:
    """Return Wilson's 95 % interval of a proportion; it stays within [0, 1] for few trials too."""
    share, z2 = successes / count, _Z**2 / count
    centre = (share + z2 / 2) / (1 + z2)
    half = math.sqrt(share * (1 - share) * z2 + z2**2 / 4) / (1 + z2)
    return max(0.0, centre - half), min(1.0, centre + half)


def verdict(result: Score) -> str:
    """Summarise in one sentence whether the signal suffices for control."""
    low, _ = result.interval
    if low <= result.chance:
        return "The signal is unusable for control: the accuracy is not above chance."
    if result.accuracy < STEERING:
        return f"The signal is too weak for control, which commonly requires an accuracy of {100 * STEERING:.0f} %."
    if result.reached < STEERING * result.trials:
        given = f"only {result.reached} of {result.trials} trials gave their command"
        return f"The decisions are accurate but rarely pass the debouncer: {given}."
    if low < STEERING:
        return f"Inconclusive: with so few trials, an accuracy below {100 * STEERING:.0f} % cannot be ruled out."
    return "The signal suffices for control."


def _repetitions(trials: Sequence[Trial]) -> list[int]:
    seen: dict[str, int] = {}
    numbers: list[int] = []
    for trial in trials:
        numbers.append(seen.get(trial.label, 0))
        seen[trial.label] = numbers[-1] + 1
    return numbers


def _elected(decisions: Sequence[Decision]) -> str:
    """Return the label with the highest summed confidence, idle excluded; empty without one."""
    votes: dict[str, float] = {}
    for decision in decisions:
        if decision.label != IDLE:
            votes[decision.label] = votes.get(decision.label, 0.0) + (decision.confidence or 0.0)
    return max(votes, key=lambda label: votes[label]) if votes else ""


def _commands(decisions: Sequence[Decision], evidence: Evidence = STREAMING) -> list[Decision]:
    """Return the decisions that pass the debouncer."""
    state = Debounced()
    given: list[Decision] = []
    for decision in decisions:
        if decision.label == IDLE:
            state = observe(state, decision, lambda _: evidence)
            continue
        state, outcome = judge(state, decision, lambda _: evidence)
        if outcome.stage is Stage.PASSED:
            given.append(decision)
    return given

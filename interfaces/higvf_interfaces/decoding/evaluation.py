"""How well a decoder does on a labelled recording: by trial, with its interval, and as the commands it would give.

Windows overlap and neighbours in time are alike, so they are never split between fitting and testing: the EMG model is
fitted to all repetitions of the gestures but one and tested on that one.
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

STEERING = 0.7  # share of right decisions that control is usually said to need
_Z = 1.96  # 95 %


class Score(NamedTuple):
    """What a decoder did.

    Attributes:
        decoder: its name.
        trials: how many.
        correct: how many of them were decided right, by the confidence of their windows.
        windows: decisions within trials.
        windows_correct: how many of them were right.
        chance: share of trials that one constant answer would have right.
        latency_s: median time from a trial's start to its right command [s]; NaN where none was right.
        reached: trials that gave their right command at all.
        wrong_commands: commands within trials that were not the trial's own.
        minutes: of trials.
        confusion: (cued, decided) -> trials.
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
        """Share of trials decided right."""
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
    """Cross-validates the EMG decoder, leaving out one repetition of every gesture at a time.

    Raises:
        InputError: too few trials to leave one out.
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
    """Runs a decoder that needs no calibration over the whole recording.

    Args:
        name: of the decoder.
        record: with the signal.
        trials: in it.
        decoder: at its start.
        window: that each decision rests on [s]; only windows wholly within a trial decide it.
    """
    made = [decision for chunk in record.chunks() for decision in decoder.push(chunk)]
    during = [[d for d in made if t.start < d.time <= t.end] for t in trials]
    pure = [[d for d in own if d.time - window >= t.start] for t, own in zip(trials, during, strict=True)]
    return score(name, trials, pure, during)


def score(
    name: str, trials: Sequence[Trial], pure: Sequence[Sequence[Decision]], during: Sequence[Sequence[Decision]]
) -> Score:
    """The score of decisions by trial.

    Args:
        name: of the decoder.
        trials: n of them.
        pure: n lists of decisions that rest on the trial alone; they decide it.
        during: n lists of all decisions made during the trial; they go through the debouncer to become commands.

    Raises:
        InputError: there are no trials, or none holds a decision.
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
    """Commands per minute that a decoder gives where nobody means any; `decisions` in order of time."""
    if len(decisions) < 2:
        return math.nan
    return len(_commands(decisions, evidence)) / (decisions[-1].time - decisions[0].time) * 60.0


def wilson(successes: int, count: int) -> tuple[float, float]:
    """Wilson's 95 % interval of a share, which stays within [0, 1] also for few trials."""
    share, z2 = successes / count, _Z**2 / count
    centre = (share + z2 / 2) / (1 + z2)
    half = math.sqrt(share * (1 - share) * z2 + z2**2 / 4) / (1 + z2)
    return max(0.0, centre - half), min(1.0, centre + half)


def verdict(result: Score) -> str:
    """Whether the signal can carry the task, in a sentence."""
    low, _ = result.interval
    if low <= result.chance:
        return "The signal cannot carry the task: this is not better than guessing."
    if result.accuracy < STEERING:
        return f"The signal is too weak to steer with: control is usually said to need {STEERING:.0%} right."
    if result.reached < STEERING * result.trials:
        given = f"only {result.reached} of {result.trials} trials gave their command"
        return f"The signal tells the classes apart, but not firmly: {given}."
    if low < STEERING:
        return f"Promising, not shown: with so few trials, less than {STEERING:.0%} right cannot be ruled out."
    return "The signal carries the task."


def _repetitions(trials: Sequence[Trial]) -> list[int]:
    seen: dict[str, int] = {}
    numbers: list[int] = []
    for trial in trials:
        numbers.append(seen.get(trial.label, 0))
        seen[trial.label] = numbers[-1] + 1
    return numbers


def _elected(decisions: Sequence[Decision]) -> str:
    """The label with the most confidence behind it, idleness aside; empty where there is none."""
    votes: dict[str, float] = {}
    for decision in decisions:
        if decision.label != IDLE:
            votes[decision.label] = votes.get(decision.label, 0.0) + (decision.confidence or 0.0)
    return max(votes, key=lambda label: votes[label]) if votes else ""


def _commands(decisions: Sequence[Decision], evidence: Evidence = STREAMING) -> list[Decision]:
    """The decisions that come through the debouncer."""
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

"""Repeats a recording, and compares the digests."""

from collections.abc import Callable
from typing import NamedTuple

from higvf_console.core.arguments import instance
from higvf_console.core.commands import OperatorCommand
from higvf_console.core.errors import InputError
from higvf_console.runtime.compiling import announce
from higvf_console.runtime.interrupts import held_back
from higvf_console.runtime.recording.reading import Recording
from higvf_console.runtime.recording.recorder import versions
from higvf_console.runtime.run import Run, Tick, TrajectoryDigest
from higvf_console.team.state import TeamReport


class Replay(NamedTuple):
    """The result of repeating a recording.

    Attributes:
        ticks: control periods run.
        digest: of this run.
        expected: digest of the recording after as many ticks; None when it was cut before its first mark.
        differs_after: ticks up to which both agreed, when they do not; else None.
        complete: whether the recording has its end.
        changed_versions: "numpy 2.3.0 -> 2.4.6" and the like.
    """

    ticks: int
    digest: str
    expected: str | None
    differs_after: int | None
    complete: bool
    changed_versions: tuple[str, ...]

    @property
    def agrees(self) -> bool:
        """Whether every digest of the recording was met."""
        return self.differs_after is None and self.expected is not None


def replay(recording: Recording, each: Callable[[Tick], object] | None = None) -> Replay:
    """Repeats a recording as far as it goes, and compares the digests.

    Args:
        recording: from `read_recording`.
        each: called after every control period.

    Raises:
        ArgumentTypeError: no recording.
        InputError: a command cannot be applied, as it could in the session that was recorded.
    """
    instance("recording", recording, Recording)
    announce()
    scenario = recording.scenario
    run = Run(scenario.setup(recording.seed), scenario.filter, scenario, rules=recording.rules)
    digest = TrajectoryDigest()
    expected = {mark.ticks: mark.digest for mark in recording.marks}
    last = max([*expected, *recording.commands, 0])
    agreed, differs_after = 0, None
    with held_back() as give_interrupt:
        for tick in range(1, last + 1):
            give_interrupt()
            for command in recording.commands.get(tick - 1, ()):
                _repeat(run, command, tick - 1)
            run.step()
            digest.add(run.state.motion)
            if each is not None:
                each(Tick(run.time, run.state, run.trace, run.setup))
            if tick in expected and differs_after is None:
                if digest.hex() != expected[tick]:
                    differs_after = agreed
                agreed = tick
    here = versions()
    changed = [f"{name} {old} -> {here.get(name)}" for name, old in recording.versions.items() if here.get(name) != old]
    final = recording.marks[-1].digest if recording.marks else None
    return Replay(last, digest.hex(), final, differs_after, recording.complete, tuple(changed))


def _repeat(run: Run, command: OperatorCommand | TeamReport, tick: int) -> None:
    try:
        if isinstance(command, TeamReport):
            run.hear(command)
        else:
            run.apply(command)
    except Exception as error:  # a session does not record what it cannot apply, so the recording was changed
        name = type(command).__name__
        raise InputError(f"{name} at tick {tick} cannot be applied: {type(error).__name__}: {error}") from error

"""Makes a failing run smaller: fewer commands, and earlier, as long as the same thing goes wrong."""

from collections.abc import Iterator
from pathlib import Path

from higvf_console.lab.safety.play import Case, Given, Played, play

MOST_TICKS = 60_000  # control periods that may be run for it


def shrunk(found: Played, file: Path, most_ticks: int = MOST_TICKS) -> Played:
    """The smallest run found that fails in the same way.

    Args:
        found: a failing run.
        file: where recordings of tries are written.
        most_ticks: control periods that may be run.
    """
    assert found.failure is not None
    left = most_ticks
    best = found
    tried = True
    while tried:
        tried = False
        for case in _smaller(best.case):
            if case.ticks > left:
                break
            played = play(case, file)
            left -= played.case.ticks + played.replays * played.case.ticks + 1
            if played.failure is not None and played.failure.broken is found.failure.broken:
                best, tried = played, True
                break
    return best


def _smaller(case: Case) -> Iterator[Case]:
    """Runs that are smaller than a case: without a part of its commands, then with an earlier end of waiting."""
    commands = case.commands
    part = len(commands) // 2
    while part >= 1:
        for start in range(0, len(commands), part):
            yield case._replace(commands=commands[:start] + commands[start + part :])
        part //= 2
    for start, wait in _waits(commands, case.ticks):
        for cut in (wait, wait // 2):
            if cut > 0:
                yield case._replace(commands=_earlier(commands, start, cut), ticks=case.ticks - cut)


def _waits(commands: Given, ticks: int) -> list[tuple[int, int]]:
    """Before which command, and for how many ticks, nothing is given; the longest first."""
    times = [0, *(tick for tick, _ in commands)]
    waits = [(k, times[k + 1] - times[k]) for k in range(len(commands))]
    return sorted((wait for wait in waits if wait[1] > ticks // 50), key=lambda wait: -wait[1])


def _earlier(commands: Given, start: int, ticks: int) -> Given:
    """The commands, those from `start` on given so many ticks earlier."""
    return commands[:start] + tuple((tick - ticks, command) for tick, command in commands[start:])

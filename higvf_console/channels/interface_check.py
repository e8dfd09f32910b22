"""Holds an interface to its contract: what any adapter's author can run before a run does.

The interface is opened by its entry point and polled over a stretch of session time with made-up contexts (with and
without a viewport, clutch, pause and extinguished fires), then the session time goes back to 0 as at a reset.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from threading import Thread
from time import perf_counter, thread_time
from typing import Any, NamedTuple, cast, get_args

import numpy as np

from higvf_console.channels.channels import CrashedError, open_interface
from higvf_console.core.commands import Cursor, OperatorCommand, Pick, StrokePoints
from higvf_console.core.interface import ChannelHealth, ChannelState, InputSpec, Interface, OperatorContext
from higvf_console.core.viewport import fit

PERIOD = 0.02  # from poll to poll [s of session time]
PROMPT = 0.02  # what nine polls in ten may take [s]
LONGEST = 0.1  # what any poll may compute: five control periods without control [s of a core]
PATIENCE = 10.0  # one that takes longer hangs [s]
_KNOWN = get_args(OperatorCommand)
_GRAIN = 1e-6
_METHODS = ("poll", "health", "close")


class Finding(NamedTuple):
    """Whether the interface keeps a rule, and what was seen."""

    rule: str
    kept: bool
    detail: str


class _Polled(NamedTuple):
    """One poll: its context, how long it took [s], how long it had a core meanwhile [s], and what it gave."""

    context: OperatorContext
    took: float
    computed: float
    commands: list[object]


def check_interface(spec: InputSpec, seconds: float = 60.0) -> list[Finding]:
    """Opens and tries an interface; one finding for each rule that could be looked at.

    Args:
        spec: what to open it with.
        seconds: of session time over which it is polled, twice.

    Raises:
        InputError: it is not installed, does not load, or refuses its input.
    """
    opens = "opens, or refuses its input with InputError"
    try:
        interface = open_interface(spec)
    except CrashedError as crash:
        return [Finding(opens, False, str(crash))]
    missing = [name for name in _METHODS if not callable(getattr(interface, name, None))]
    named = getattr(interface, "name", None)
    findings = [
        Finding(opens, True, "it opened"),
        Finding(
            "has poll, health and close", not missing, f"missing: {', '.join(missing)}" if missing else "all there"
        ),
        Finding("is named as its channel", named == spec.channel, f"name {named!r}, channel {spec.channel!r}"),
    ]
    if missing:
        return findings
    return [*findings, *_check_polls(interface, spec, seconds), *_check_health(interface), *_check_close(interface)]


def _check_polls(interface: Interface, spec: InputSpec, seconds: float) -> Iterator[Finding]:
    """The first run, and the one after a reset."""
    before: list[_Polled] = []
    problem = _try(lambda: before.extend(_run(interface, spec, seconds)))
    yield Finding("poll does not fail", not problem, problem or f"{len(before)} polls over {seconds:g} s")
    if problem:
        return
    yield _check_times(before, "")
    yield from _check_commands(before, spec, "")
    after: list[_Polled] = []
    problem = _try(lambda: after.extend(_run(interface, spec, seconds)))
    given = sum(len(polled.commands) for polled in after)
    yield Finding("survives a reset of the time to 0", not problem, problem or f"{given} commands in the second run")
    if not problem:
        yield _check_times(after, " after a reset")
        yield from _check_commands(after, spec, " after a reset")


def _check_times(polls: Sequence[_Polled], when: str) -> Finding:
    usual = float(np.quantile([polled.took for polled in polls], 0.9))
    longest = max(polls, key=lambda polled: polled.computed)
    seen = f"nine in ten within {1e3 * usual:.2f} ms, the longest computes {1e3 * longest.computed:.2f} ms"
    kept = usual <= PROMPT and longest.computed <= LONGEST
    return Finding(f"poll returns at once{when}", kept, f"{seen} at {longest.context.time:g} s")


def _check_commands(polls: Sequence[_Polled], spec: InputSpec, when: str) -> Iterator[Finding]:
    given = [command for polled in polls for command in polled.commands]
    if not given:
        yield Finding(f"gives only known commands{when}", True, "it gave none, so nothing is shown of its commands")
        return
    foreign = [command for command in given if not isinstance(command, _KNOWN)]
    yield _finding(f"gives only known commands{when}", [repr(command)[:80] for command in foreign], len(given))
    for rule, wrong in (
        ("gives commands in order of time, none from the future", _out_of_time(polls)),
        ("signs commands with source, operator and a running number", _unsigned(polls, spec.channel)),
        ("gives a confidence of 0 to 1, or none", _unsure(given)),
        ("gives points (n, 2) and robots that are there", _misplaced(polls)),
    ):
        yield _finding(f"{rule}{when}", wrong, len(given))


def _check_health(interface: Interface) -> Iterator[Finding]:
    """Health is asked at any time, also before and after what the interface expects."""
    wrong: list[str] = []
    for now in (0.0, 1.0, 1e6, -1.0):
        problem = _try(lambda now=now: wrong.extend(_ill(interface.health(now), now)))
        wrong.extend([problem] if problem else [])
    yield _finding("health never fails, and reports a state and a detail", wrong, 4)


def _check_close(interface: Interface) -> Iterator[Finding]:
    problem = _try(interface.close) or _try(interface.close)
    yield Finding("close may be called twice", not problem, problem or "twice")
    wrong: list[str] = []
    problem = _try(lambda: wrong.extend(_ill(interface.health(0.0), 0.0)))
    yield _finding("health does not fail after close", [problem] if problem else wrong, 1)


def _run(interface: Interface, spec: InputSpec, seconds: float) -> Iterator[_Polled]:
    for tick in range(round(seconds / PERIOD) + 1):
        context = _context(tick, spec)
        started, computed = perf_counter(), thread_time()  # another program may hold the core for a while
        commands: Any = interface.poll(context)
        yield _Polled(context, perf_counter() - started, thread_time() - computed, list(commands))


def _context(tick: int, spec: InputSpec) -> OperatorContext:
    """A context as a run might have it: a viewport after a second, a clutch held by turns, fires that go out."""
    time = tick * PERIOD
    robots = spec.robots or 3
    viewport = fit(spec.arena, 1920.0, 1080.0) if time >= 1.0 else None
    burnt_out = tuple(range(min(3, int(time // 10))))
    return OperatorContext(
        time=time,
        operator="checker",
        viewport=viewport,
        clutch=int(time) % 8 >= 4,
        paused=int(time) % 16 >= 12,
        influenced=int(time) % robots,
        extinguished=burnt_out,
        robots=robots,
    )


def _try(call: Callable[[], object]) -> str:
    """What went wrong in a call, in words; a call that hangs is left behind on its thread."""
    caught: list[BaseException] = []

    def guarded() -> None:
        try:
            call()
        except Exception as error:  # whatever an adapter raises is a finding
            caught.append(error)

    thread = Thread(target=guarded, daemon=True, name="interface check")
    thread.start()
    thread.join(PATIENCE)
    if thread.is_alive():
        return f"did not come back within {PATIENCE:g} s"
    return f"{type(caught[0]).__name__}: {caught[0]}" if caught else ""


def _finding(rule: str, wrong: Sequence[str], count: int) -> Finding:
    return Finding(rule, not wrong, f"{len(wrong)} of {count} wrong, first: {wrong[0]}" if wrong else f"{count} seen")


def _commands(polls: Sequence[_Polled]) -> Iterator[tuple[OperatorContext, OperatorCommand]]:
    for polled in polls:
        for command in polled.commands:
            if isinstance(command, _KNOWN):
                yield polled.context, cast(OperatorCommand, command)


def _out_of_time(polls: Sequence[_Polled]) -> list[str]:
    wrong: list[str] = []
    latest = -math.inf
    for context, command in _commands(polls):
        if not latest <= command.time <= context.time + _GRAIN:
            wrong.append(f"{type(command).__name__} at {command.time:g} s, polled at {context.time:g} s")
        latest = max(latest, command.time)
    return wrong


def _unsigned(polls: Sequence[_Polled], channel: str) -> list[str]:
    wrong: list[str] = []
    latest = -1
    for context, command in _commands(polls):
        if command.source != channel or command.operator != context.operator or command.sequence <= latest:
            signature = f"source {command.source!r}, operator {command.operator!r}, sequence {command.sequence}"
            wrong.append(f"{type(command).__name__} with {signature}")
        latest = max(latest, command.sequence)
    return wrong


def _unsure(commands: Sequence[object]) -> list[str]:
    trusts = [getattr(command, "confidence", None) for command in commands]
    return [f"confidence {trust!r}" for trust in trusts if trust is not None and not 0 <= trust <= 1]


def _misplaced(polls: Sequence[_Polled]) -> list[str]:
    wrong: list[str] = []
    for context, command in _commands(polls):
        match command:
            case StrokePoints(points=points) if np.shape(points)[1:] != (2,) or not np.isfinite(points).all():
                wrong.append(f"StrokePoints of shape {np.shape(points)}, or not finite")
            case Cursor(point=point) if np.shape(point) != (2,):
                wrong.append(f"Cursor of shape {np.shape(point)}")
            case Pick(robot=robot) if not 0 <= robot < context.robots:
                wrong.append(f"robot index {robot} of {context.robots}")
            case _:
                pass
    return wrong


def _ill(health: object, now: float) -> list[str]:
    state: object = health.state if isinstance(health, ChannelHealth) else None
    return [] if isinstance(state, ChannelState) else [f"health({now:g}) gave {health!r}"]

"""Holds a team to its contract: what an adapter's author can run before the console drives with it.

The team is listened to, then sent commands to stand, many of them at once, and closed. Where its robots may move, the
check of arming is run as a console runs it, then STOP is tried while they move.
"""

import math
import time
from collections.abc import Callable, Iterator, Sequence
from threading import Thread
from typing import Any, NamedTuple, cast

import numpy as np

from higvf_console.core.state import Motion
from higvf_console.core.team import Drive, Poses, PoseSource, RobotLink, Team, TeamSpec, never_seen, standing
from higvf_console.team.arming import MOVE_S, SILENCE_S, asked_to_arm
from higvf_console.team.opening import TeamCrashedError, open_team
from higvf_console.team.state import Arming, TeamReport, TeamState, opened
from higvf_console.team.supervision import commanded, supervised
from higvf_console.team.tracking import Rules

LISTEN_S = 1.5  # to the robots at first [s]
PROMPT = 0.01  # what nine calls in ten may take [s]
LONG = 0.1  # what only one call in a hundred may exceed [s]
_ENOUGH = 20  # calls to judge by
BURST = 500  # commands without a pause
PATIENCE = 15.0  # a trial that takes longer hangs in a call [s]
CLOSES_WITHIN = 1.0  # [s]
CONFIRMED_WITHIN = 1.0  # the latest command [s]
_CHECK_S = 5.0  # that the check of arming may take [s]
_AHEAD = 0.05  # by which a pose may be in the future [s]


class Finding(NamedTuple):
    """Whether a team keeps a rule, and what was seen; None = it could not be tried."""

    rule: str
    kept: bool | None
    detail: str


class _Tried:
    """A team that is called as a console does, in real time; every answer is looked at."""

    def __init__(self, team: Team, poses: PoseSource, spec: TeamSpec, rules: Rules, motion: Motion) -> None:
        self.team, self.source, self.spec, self.rules, self.motion = team, poses, spec, rules, motion
        self.state: TeamState = opened(spec.robots)
        self.took: list[tuple[str, float]] = []  # call, duration [s]
        self.wrong_poses: list[str] = []
        self.wrong_links: list[str] = []
        self.told: list[str] = []
        self.links: tuple[RobotLink, ...] = (RobotLink(),) * spec.robots
        self._measured_at = np.full(spec.robots, -math.inf)

    def period(self, *, silent: bool = False) -> None:
        """One control period: a report, then a command if there is one to be sent."""
        now = time.monotonic()
        poses = self._called("poses", lambda: self.source.poses(now))
        links = self._called("links", lambda: self.team.links(now))
        self._look_at_poses(poses, time.monotonic())
        self._look_at_links(links)
        usable = poses if not self.wrong_poses else never_seen(self.spec.robots)
        report = TeamReport(now, usable, self.links)
        self.state, told = supervised(self.state, report, self.rules)
        self.told.extend(text for _, text, _ in told)
        if not silent:
            self.state, command = commanded(self.state, self.motion, self.rules, self.spec.period, drives=False)
            if command is not None:
                self.send(command)
        time.sleep(max(now + self.spec.period - time.monotonic(), 0.0))

    def send(self, command: Drive) -> None:
        """Sends a command."""
        self._called("drive", lambda: self.team.drive(command, time.monotonic()))

    def stop(self) -> None:
        """STOP."""
        self._called("stop", lambda: self.team.stop(time.monotonic()))

    def run(self, seconds: float, *, silent: bool = False, until: Callable[[], bool] = lambda: False) -> bool:
        """Control periods for a time, or until something holds; whether it does."""
        end = time.monotonic() + seconds
        while time.monotonic() < end and not until():
            self.period(silent=silent)
        return until()

    def _called(self, name: str, call: Callable[[], Any]) -> Any:
        started = time.perf_counter()
        answer = call()
        self.took.append((name, time.perf_counter() - started))
        return answer

    def _look_at_poses(self, poses: Any, now: float) -> None:
        robots = self.spec.robots
        shapes = [getattr(part, "shape", None) for part in poses] if isinstance(poses, Poses) else None
        if shapes != [(robots, 2), (robots,), (robots,)]:
            self.wrong_poses.append(f"{shapes or repr(poses)[:60]}; expected Poses of {robots} robots")
            return
        at, seen = poses.measured_at, np.isfinite(poses.measured_at)
        if (at[seen] > now + _AHEAD).any():
            self.wrong_poses.append(
                f"measured {float(np.max(at[seen])) - now:.2f} s in the future, by the clock of now"
            )
        if (at[seen] < self._measured_at[seen]).any():
            self.wrong_poses.append("older than the pose before")
        if np.isfinite(poses.position[~seen]).all(axis=1).any():
            self.wrong_poses.append("a place without the time when it was measured")
        if self.rules.look_ahead > 0.0 and np.isnan(poses.heading[seen]).any():
            self.wrong_poses.append("a pose without a heading, which this scenario's robots have")
        self._measured_at = np.where(seen, at, self._measured_at)

    def _look_at_links(self, links: Any) -> None:
        given: tuple[object, ...] = cast(tuple[object, ...], links) if isinstance(links, tuple) else ()
        if len(given) != self.spec.robots:
            self.wrong_links.append(f"{links!r:.60}; expected a tuple of {self.spec.robots}")
            return
        for robot, (link, before) in enumerate(zip(given, self.links, strict=True), 1):
            if not isinstance(link, RobotLink):
                self.wrong_links.append(f"{link!r:.60} is no RobotLink")
                return
            if not -1 <= link.acknowledged <= self.state.number:
                self.wrong_links.append(f"robot {robot} confirms command {link.acknowledged} of {self.state.number}")
            if link.acknowledged < before.acknowledged:
                self.wrong_links.append(f"robot {robot} confirms {link.acknowledged} after {before.acknowledged}")
            if not (math.isnan(link.battery) or 0.0 <= link.battery <= 1.0):
                self.wrong_links.append(f"battery {link.battery:g} is no share from 0 to 1")
        self.links = links


def check_team(
    spec: TeamSpec, rules: Rules, motion: Motion, poses: Callable[[], PoseSource] | None = None, *, drive: bool = False
) -> list[Finding]:
    """Opens and tries a team; one finding for each rule.

    Args:
        spec: what to open it with.
        rules: what its robots can do.
        motion: of the scenario at its start.
        poses: opens what tells where the robots are; None = the team does.
        drive: whether its robots may move: they turn on the spot, or move a little along x.

    Raises:
        InputError: it is not installed, does not load, or refuses its address or options.
    """
    opens = "opens, or refuses its address with InputError"
    try:
        team = open_team(spec)
    except TeamCrashedError as crash:
        return [Finding(opens, False, str(crash))]
    findings = [Finding(opens, True, "it opened")]
    named = getattr(team, "name", None)
    findings.append(Finding("is named as its entry point", named == spec.name, f"name {named!r}"))
    source: PoseSource = team
    try:
        source = team if poses is None else poses()
        tried = _Tried(team, source, spec, rules, motion)
        findings += _try_all(tried, drive)
    finally:
        if source is not team:
            source.close()
        findings.append(_closed(team))
    return findings


def _try_all(tried: _Tried, drive: bool) -> list[Finding]:
    moved: list[Finding] = []
    late: list[str] = []

    def listen_and_send() -> None:
        tried.run(LISTEN_S, silent=True)
        tried.run(0.5)
        for _ in range(BURST):
            tried.send(standing(tried.spec.robots, tried.state.number))
        latest = tried.state.number
        tried.run(CONFIRMED_WITHIN, until=lambda: not _unconfirmed(tried, latest))
        late.extend(_unconfirmed(tried, latest))

    problem = _problem(listen_and_send)
    confirming = sum(link.acknowledged >= 0 for link in tried.links)
    if not problem and drive and not tried.wrong_poses:
        problem = _problem(lambda: moved.extend(_moved(tried)))
    findings = [Finding("does not fail", not problem, problem or f"{len(tried.took)} calls, {BURST} of them at once")]
    if problem:
        return findings
    findings += [
        _times(tried),
        _verdict("poses have the shape, clock and order of the contract", tried.wrong_poses, "all of them"),
        _seen(tried),
        _verdict("links are there, and confirm what was sent, in order", tried.wrong_links, "all of them"),
        _confirms(late, confirming, tried.spec.robots),
    ]
    if moved:
        return findings + moved
    reason = "its robots may not move: add --drive" if not drive else "see above"
    return [*findings, Finding("silence stops every robot", None, reason), Finding("STOP stops them", None, reason)]


def _moved(tried: _Tried) -> Iterator[Finding]:
    """The check of arming, then STOP while the robots move."""
    rule, stops = "silence stops every robot", "STOP stops every robot"
    if not tried.state.track.seen.all():
        reason = "not every robot is seen, so that nobody knows whether it moves: give --poses"
        yield from (Finding(rule, None, reason), Finding(stops, None, reason))
        return
    tried.run(1.0, until=lambda: bool(tried.state.track.stands().all()))
    tried.state, refusal = asked_to_arm(tried.state, tried.rules)
    if refusal:
        yield from (Finding(rule, False, refusal), Finding(stops, None, refusal))
        return
    tried.told.clear()
    tried.run(_CHECK_S, until=lambda: tried.state.arming is not Arming.CHECKING)
    kept = tried.state.arming is Arming.CHECKED
    yield Finding(rule, kept, tried.told[-1].removesuffix(" Arm again to let the team drive.") if tried.told else "")
    if not kept:
        tried.stop()
        yield Finding(stops, None, "silence does not stop them")
        return
    began = time.monotonic()
    tried.state = tried.state._replace(arming=Arming.CHECKING, since=began)
    tried.run(MOVE_S / 2)
    stopped = time.monotonic()
    tried.stop()
    tried.state = tried.state._replace(arming=Arming.DISARMED)
    tried.run(SILENCE_S + 1.0, silent=True)
    track = tried.state.track
    took = float(np.max(track.anchored_at)) - stopped
    if not (track.anchored_at > began).all():
        yield Finding(stops, None, "they did not move before it")
    elif not track.stands().all():
        yield Finding(stops, False, "they drive on")
    else:
        yield Finding(stops, took <= SILENCE_S, f"they stood after {max(took, 0.0):.2f} s")


def _times(tried: _Tried) -> Finding:
    """Each kind of call for itself: one that waits must not hide behind many of another.

    A single late call says nothing of the team: another program may have had the core, or Python cleaned up its memory.
    """
    slow: list[str] = []
    for kind in dict.fromkeys(name for name, _ in tried.took):
        took = np.array([duration for name, duration in tried.took if name == kind])
        if len(took) < _ENOUGH:
            continue
        usual, late = float(np.quantile(took, 0.9)), int((took > LONG).sum())
        if usual > PROMPT or late > max(1.0, 0.01 * len(took)):
            slow.append(f"{kind}: nine in ten within {1e3 * usual:.2f} ms, {late} of {len(took)} took over {LONG:g} s")
    name, longest = max(tried.took, key=lambda call: call[1])
    return _verdict("calls return at once", slow, f"the longest, {name}, took {1e3 * longest:.2f} ms")


def _seen(tried: _Tried) -> Finding:
    rule = "every robot is seen, inside of the arena"
    track, arena = tried.state.track, tried.spec.arena
    if not track.seen.any():
        return Finding(rule, None, "no pose came: the team knows none, or the robots are off; see --poses")
    outside = [
        f"robot {robot} is at ({x:.2f}, {y:.2f}) m"
        for robot, (x, y) in enumerate(track.position, 1)
        if track.seen[robot - 1] and not (arena.x_min <= x <= arena.x_max and arena.y_min <= y <= arena.y_max)
    ]
    unseen = [f"robot {robot + 1} is not seen" for robot in (~track.seen).nonzero()[0]]
    return _verdict(rule, [*unseen, *outside], f"{len(track.seen)} robots")


def _unconfirmed(tried: _Tried, number: int) -> list[str]:
    """Robots that confirm commands, but none since `number`; all, until one confirms."""
    return [
        f"robot {robot} has confirmed {link.acknowledged} of {number}"
        for robot, link in enumerate(tried.links, 1)
        if 0 <= link.acknowledged < number
    ]


def _confirms(late: Sequence[str], confirming: int, robots: int) -> Finding:
    rule = "robots that confirm commands confirm the latest"
    if confirming == 0:
        return Finding(rule, None, "they confirm none, so that latency cannot be measured")
    return _verdict(rule, late, f"{confirming} of {robots} robots confirm")


def _closed(team: Team) -> Finding:
    started = time.perf_counter()
    problem = _problem(team.close)
    took = time.perf_counter() - started
    problem = problem or _problem(team.close)
    kept = not problem and took <= CLOSES_WITHIN
    return Finding("closes within a second, and twice", kept, problem or f"{took:.2f} s")


def _verdict(rule: str, wrong: Sequence[str], right: str) -> Finding:
    return Finding(rule, not wrong, f"{len(wrong)} wrong, first: {wrong[0]}" if wrong else right)


def _problem(call: Callable[[], object]) -> str:
    """What went wrong, in words; a call that hangs is left behind on its thread."""
    caught: list[BaseException] = []

    def guarded() -> None:
        try:
            call()
        except Exception as error:  # whatever an adapter raises is a finding
            caught.append(error)

    thread = Thread(target=guarded, daemon=True, name="team check")
    thread.start()
    thread.join(PATIENCE)
    if thread.is_alive():
        return f"a call did not come back within {PATIENCE:g} s"
    return f"{type(caught[0]).__name__}: {caught[0]}" if caught else ""

"""`higvf check-team` passes a team that keeps the contract and names what breaks it; an outside package is a team."""

import json
import re
import socket
import time
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from threading import Event, Thread
from typing import Any

import numpy as np
import pytest

from higvf_console.cli.main import main
from higvf_console.core.team import Drive, Poses, RobotLink, TeamSpec
from higvf_console.scenario.scenario import load_scenario
from higvf_console.team import check
from higvf_console.team.check import Finding, check_team
from higvf_console.team.simulated import SimulatedTeam
from higvf_console.team.tracking import Rules
from tests.mqtt import Robots, mosquitto

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "drive-your-robots.md"
SCENARIO = load_scenario("epucks")
MOTION = SCENARIO.setup(0).start.motion
ROBOTS = len(MOTION.position)


class Blocking(SimulatedTeam):
    def poses(self, now: float) -> Poses:
        time.sleep(2.0 * check.PROMPT)
        return super().poses(now)


class Hanging(SimulatedTeam):
    def drive(self, command: Drive, now: float) -> None:
        Event().wait()
        super().drive(command, now)


class Boastful(SimulatedTeam):
    """Confirms what was never sent."""

    def links(self, now: float) -> tuple[RobotLink, ...]:
        return tuple(link._replace(acknowledged=10**9) for link in super().links(now))


class Forgetful(SimulatedTeam):
    """Takes back what it has confirmed."""

    def links(self, now: float) -> tuple[RobotLink, ...]:
        number = max(link.acknowledged for link in super().links(now))
        return (RobotLink(number if int(now * 10) % 2 else 0),) * ROBOTS


class Slack(SimulatedTeam):
    """Confirms the first command alone."""

    def links(self, now: float) -> tuple[RobotLink, ...]:
        return tuple(link._replace(acknowledged=min(link.acknowledged, 1)) for link in super().links(now))


class Prophetic(SimulatedTeam):
    def poses(self, now: float) -> Poses:
        return super().poses(now)._replace(measured_at=np.full(ROBOTS, now + 1.0))


class Few(SimulatedTeam):
    def poses(self, now: float) -> Poses:
        return Poses(*(part[1:] for part in super().poses(now)))


class Elsewhere(SimulatedTeam):
    def poses(self, now: float) -> Poses:
        poses = super().poses(now)
        return poses._replace(position=1000.0 * poses.position)


class Failing(SimulatedTeam):
    def drive(self, command: Drive, now: float) -> None:
        if command.number > 3:
            raise OSError("cable unplugged")
        super().drive(command, now)


class DeafToStop(SimulatedTeam):
    """Goes on after STOP for as long as the last command holds, and longer."""

    def stop(self, now: float) -> None:
        moving = Drive(0, np.zeros((ROBOTS, 2)), np.zeros(ROBOTS), np.full(ROBOTS, 2.0), 60.0)
        super().drive(moving, now)


class ClosedOnce(SimulatedTeam):
    closed = False

    def close(self) -> None:
        if self.closed:
            raise OSError("already closed")
        self.closed = True


def found(kind: Callable[[TeamSpec], Any], monkeypatch: pytest.MonkeyPatch, *, drive: bool = False) -> list[Finding]:
    monkeypatch.setattr(check, "open_team", kind)
    monkeypatch.setattr(check, "LISTEN_S", 0.3)
    spec = TeamSpec(
        "simulated", "", {}, ROBOTS, SCENARIO.arena, MOTION.position.copy(), MOTION.heading.copy(), 0.024, 0.12, 0.037
    )
    return check_team(spec, Rules(0.12, 0.024, 0.037), MOTION, drive=drive)


def broken(findings: list[Finding]) -> dict[str, str]:
    return {finding.rule: finding.detail for finding in findings if finding.kept is False}


@pytest.mark.parametrize(
    ("kind", "rule", "detail"),
    [
        (Blocking, "calls return at once", "poses: nine in ten within "),
        (Boastful, "links are there, and confirm what was sent, in order", "robot 1 confirms command 1000000000 of"),
        (Forgetful, "links are there, and confirm what was sent, in order", "confirms 0 after"),
        (Slack, "robots that confirm commands confirm the latest", "robot 1 has confirmed 1 of"),
        (Prophetic, "poses have the shape, clock and order of the contract", "s in the future"),
        (Few, "poses have the shape, clock and order of the contract", "expected Poses of 5 robots"),
        (Elsewhere, "every robot is seen, inside of the arena", "robot 1 is at (6"),
        (Failing, "does not fail", "OSError: cable unplugged"),
        (ClosedOnce, "closes within a second, and twice", "OSError: already closed"),
    ],
)
def test_a_broken_rule_is_named_with_what_was_seen(
    kind: type[SimulatedTeam], rule: str, detail: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert detail in broken(found(kind, monkeypatch)).get(rule, "kept")


def assert_passes(team: str, capsys: pytest.CaptureFixture[str]) -> None:
    """All rules were tried and kept, at the third attempt at the latest: the check runs in real time, tests may not."""
    text = ""
    for _ in range(3):
        status = main(["check-team", team, "--drive"])
        text = capsys.readouterr().out
        if status == 0 and "not tried" not in text:
            return
    pytest.fail(text)


def test_a_call_that_hangs_does_not_hang_the_check(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(check, "PATIENCE", 2.0)
    assert broken(found(Hanging, monkeypatch)) == {"does not fail": "a call did not come back within 2 s"}


def test_robots_that_go_on_after_stop_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    assert broken(found(DeafToStop, monkeypatch, drive=True)) == {"STOP stops every robot": "they drive on"}


def test_robots_stand_unless_they_may_move(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check-team", "simulated", "--json"]) == 0
    findings = {one["rule"]: one for one in json.loads(capsys.readouterr().out)}
    silence = findings["silence stops every robot"]
    assert (silence["kept"], silence["detail"]) == (None, "its robots may not move: add --drive")


def test_the_simulated_team_passes_and_without_a_watchdog_it_fails(capsys: pytest.CaptureFixture[str]) -> None:
    assert_passes("simulated", capsys)
    assert main(["check-team", "simulated=:watchdog=0", "--drive"]) == 1
    assert "did not stand when nothing was sent any more" in capsys.readouterr().out


def test_robots_behind_a_broker_pass_and_those_that_disobey_fail(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    starts = [(float(x), float(y)) for x, y in SCENARIO.robots.points]
    with mosquitto(tmp_path) as broker:
        robots = Robots(broker, starts)
        try:
            assert main(["teams", f"mqtt={broker.address}"]) == 0
            assert "poses/s, stamped" in capsys.readouterr().out
            assert_passes(f"mqtt={broker.address}", capsys)
            robots.obeys = False
            assert main(["check-team", f"mqtt={broker.address}", "--drive"]) == 1
            assert "FAILED     silence stops every robot" in capsys.readouterr().out
        finally:
            robots.close()
        assert main(["teams", f"mqtt={broker.address}"]) == 2
        assert "no robot was heard" in capsys.readouterr().err


def test_teams_are_listed_with_their_options(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["teams"]) == 0
    text = capsys.readouterr().out
    assert "default robots: Where the topics are" in text and "latency_s  0 to 2 s, default 0: From a" in text
    assert main(["teams", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert {"mqtt", "simulated"} <= {one["name"] for one in listed["teams"]}
    assert main(["teams", "simulated="]) == 2
    assert "team 'simulated' cannot tell which robots there are" in capsys.readouterr().err


class UdpRobots:
    """What the page's adapter talks to: robots on UDP ports of the loopback."""

    def __init__(self, starts: list[tuple[float, float]]) -> None:
        self.sockets = self._bound(len(starts))
        self.port: int = self.sockets[0].getsockname()[1]
        self.places = [[x, y, 0.0] for x, y in starts]
        self.told: list[dict[str, float]] = [{"v": 0.0, "w": 0.0, "n": 0, "until": 0.0} for _ in starts]
        self.consoles: list[Any] = [None for _ in starts]
        self.ended = Event()
        self.thread = Thread(target=self._run, daemon=True)
        self.thread.start()

    def _bound(self, count: int) -> list[socket.socket]:
        """Sockets on ports that follow each other."""
        while True:
            sockets = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(count)]
            try:
                sockets[0].bind(("127.0.0.1", 0))
                first = sockets[0].getsockname()[1]
                for k, one in enumerate(sockets[1:], 1):
                    one.bind(("127.0.0.1", first + k))
            except (OSError, OverflowError):
                for one in sockets:
                    one.close()
                continue
            for one in sockets:
                one.setblocking(False)
            return sockets

    def _run(self) -> None:
        before = time.monotonic()
        while not self.ended.wait(0.01):
            now = time.monotonic()
            for k, one in enumerate(self.sockets):
                try:
                    while True:
                        raw, self.consoles[k] = one.recvfrom(1024)
                        command = json.loads(raw)
                        self.told[k] = {**command, "until": now + command["valid_s"]}
                except BlockingIOError:
                    pass
                if now < self.told[k]["until"]:
                    self.places[k][2] += self.told[k]["w"] * (now - before)
                if self.consoles[k] is not None:
                    x, y, theta = self.places[k]
                    one.sendto(
                        json.dumps({"x": x, "y": y, "theta": theta, "n": self.told[k]["n"]}).encode(), self.consoles[k]
                    )
            before = now

    def close(self) -> None:
        self.ended.set()
        self.thread.join()
        for one in self.sockets:
            one.close()


@pytest.fixture
def udp_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """The adapter of the page, laid out as an installer does: its module, and its metadata with the entry point."""
    module, project = (
        re.findall(rf"```{kind}\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)[0]
        for kind in ("python", "toml")
    )
    assert len(module.splitlines()) < 85
    described = tomllib.loads(project)["project"]
    site = tmp_path / "site-packages"
    metadata = site / "my_robots-1.0.dist-info"
    metadata.mkdir(parents=True)
    (site / "my_robots.py").write_text(module, encoding="utf-8")
    (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {described['name']}\nVersion: 1.0\n")
    lines = [
        f"[{group}]\n" + "".join(f"{name} = {place}\n" for name, place in points.items())
        for group, points in described["entry-points"].items()
    ]
    (metadata / "entry_points.txt").write_text("\n".join(lines))
    monkeypatch.syspath_prepend(site)
    robots = UdpRobots([(float(x), float(y)) for x, y in SCENARIO.robots.points])
    yield f"lab=127.0.0.1:port={robots.port}"
    robots.close()


def test_the_adapter_of_the_page_keeps_the_contract(udp_package: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert_passes(udp_package, capsys)
    assert main(["teams"]) == 0
    assert "lab  (my-robots 1.0)" in capsys.readouterr().out


def test_the_errors_of_the_adapter_reach_the_person(udp_package: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check-team", "lab=a+b"]) == 2
    assert "give one host, or one for each of 5 robots" in capsys.readouterr().err
    assert main(["check-team", udp_package.replace("port", "prt")]) == 2
    assert "did you mean 'port'" in capsys.readouterr().err

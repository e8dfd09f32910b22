"""Teams as they are opened and driven: refusals, adapters that lie or fail, what a recording holds of them."""

import logging
import math
from collections.abc import Callable
from importlib.metadata import EntryPoint
from typing import Any

import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_console.core.team import RobotLink, TeamSpec, never_seen, standing
from higvf_console.runtime.recording import team_lines
from higvf_console.runtime.teams import open_driver
from higvf_console.scenario.scenario import load_scenario, parse_scenario
from higvf_console.team import opening
from higvf_console.team.driver import TeamDriver
from higvf_console.team.opening import TeamCrashedError, open_team
from higvf_console.team.simulated import SimulatedTeam
from higvf_console.team.state import TeamReport
from higvf_console.team.tracking import Rules

RULES = Rules(0.12, 0.0, 0.037)


def opened(team: str, poses: str | None = None, scenario: str = "epucks", clock: Any = None) -> TeamDriver:
    loaded = load_scenario(scenario)
    return open_driver(team, poses, loaded, loaded.setup(), clock)


@pytest.mark.parametrize(
    ("team", "poses", "words"),
    [
        ("simulatd", None, "no team 'simulatd' (did you mean 'simulated'?); installed: "),
        ("simulated", "camra", "no source of poses 'camra'"),
        ("", None, "--team : give NAME, NAME=ADDRESS or NAME=ADDRESS:option=value,option=value"),
        ("simulated=:latency_s=3", None, "latency_s: 3.0 is not a number from 0 to 2 s"),
        ("simulated=:latency=1", None, "unknown key (did you mean 'latency_s'?)"),
        ("simulated=:latency_s=much", None, "latency_s: 'much' is not a number"),
        ("simulated=:loss=0.1,loss=0.2", None, "option 'loss' is given twice"),
        ("simulated=:dead=6", None, "dead=6 is no robot; choose 1 to 5, or 0"),
        ("simulated=:stale_s=2", None, "stale_s 2 must be less than lost_s 1"),
    ],
)
def test_what_cannot_be_used_is_refused_by_name(team: str, poses: str | None, words: str) -> None:
    with pytest.raises(InputError) as refusal:
        opened(team, poses)
    assert words in str(refusal.value)


def test_scenarios_that_cannot_be_driven_are_refused() -> None:
    with pytest.raises(InputError, match=r"a team needs .distributed."):
        scenario = parse_scenario(load_scenario("epucks").text + "filter: centralised\n", "t.yaml")
        open_driver("simulated", None, scenario, scenario.setup(), None)
    with pytest.raises(InputError, match=r"position_noise 0\.005 m, which is simulated"):
        text = load_scenario("epucks").text.replace("turn_rate_limit: 4", "turn_rate_limit: 4, position_noise: 0.005")
        scenario = parse_scenario(text, "t.yaml")
        open_driver("simulated", None, scenario, scenario.setup(), None)


def _entry_points(teams: list[EntryPoint]) -> Callable[[str], list[EntryPoint]]:
    def found(group: str) -> list[EntryPoint]:
        return teams if group == opening.TEAMS else []

    return found


def install(monkeypatch: pytest.MonkeyPatch, **openers: Any) -> None:
    """Installs teams for a test."""

    class Installed(EntryPoint):
        def load(self) -> Any:
            return openers[self.name]

    points: list[EntryPoint] = [Installed(name, "lab:open", opening.TEAMS) for name in openers]
    monkeypatch.setattr(opening, "entry_points", _entry_points(points))


def test_a_team_that_crashes_or_is_none_is_told_apart_from_one_that_refuses(monkeypatch: pytest.MonkeyPatch) -> None:
    def crash(_spec: TeamSpec) -> Any:
        raise KeyError("wheel")

    def refuse(spec: TeamSpec) -> Any:
        raise InputError(f"{spec.place}: no such port")

    def nothing(_spec: TeamSpec) -> object:
        return object()

    install(monkeypatch, crash=crash, refuse=refuse, nothing=nothing)
    with pytest.raises(TeamCrashedError, match="team 'crash' does not open: KeyError: 'wheel'"):
        open_team(TeamSpec("crash"))
    with pytest.raises(InputError, match="--team refuse: no such port"):
        open_team(TeamSpec("refuse"))
    with pytest.raises(TeamCrashedError, match="without poses, drive, stop, links, close"):
        open_team(TeamSpec("nothing"))
    with pytest.raises(InputError, match="drives in real time; only 'simulated' drives in a headless run"):
        opened("nothing")


class Liar(SimulatedTeam):
    """Tells of two robots where there is one."""

    def links(self, now: float) -> tuple[RobotLink, ...]:
        return super().links(now) * 2


def test_a_team_that_tells_of_another_number_of_robots_is_asked_no_more() -> None:
    driver = TeamDriver(Liar(TeamSpec("liar")), 1, RULES, None, 0.02)
    report = driver.report()
    assert report.failure == "team 'simulated' failed in links: ValueError: 2 links; expected 1, one of each robot"
    assert driver.report().failure == report.failure


class Stuck(SimulatedTeam):
    """Can neither be stopped nor closed."""

    def stop(self, now: float) -> None:
        raise OSError(f"gone at {now:g} s")

    def close(self) -> None:
        raise OSError("gone too")


def test_a_team_that_cannot_be_stopped_is_logged_and_closing_goes_on(caplog: pytest.LogCaptureFixture) -> None:
    source = Liar(TeamSpec("liar"))
    closed: list[str] = []
    source.close = lambda: closed.append("source")  # type: ignore[method-assign]
    with caplog.at_level(logging.ERROR), TeamDriver(Stuck(TeamSpec("stuck")), 1, RULES, None, 0.02, source):
        pass
    assert closed == ["source"]
    assert [record.message for record in caplog.records] == [
        "team 'simulated' could not be stopped", "team 'simulated' does not close",
    ]  # fmt: skip


def test_a_simulated_team_is_the_same_for_the_same_seed_and_stands_when_commands_cease() -> None:
    def run(seed: int) -> bytes:
        team = SimulatedTeam(TeamSpec("simulated", options={"loss": "0.3", "noise_m": "0.01", "seed": str(seed)}))
        for k in range(50):
            team.drive(standing(1, k + 1)._replace(velocity=np.array([[0.1, 0.0]])), 0.02 * k)
            team.poses(0.02 * k)
        return b"".join(part.tobytes() for part in team.poses(1.0))

    assert run(1) == run(1) != run(2)
    team = SimulatedTeam(TeamSpec("simulated"))
    team.poses(0.0)
    team.drive(standing(1, 1)._replace(velocity=np.array([[0.1, 0.0]])), 0.0)
    assert team.poses(5.0).position[0, 0] == pytest.approx(0.1 * 0.3, abs=0.1 * 0.005)


def test_a_report_is_read_back_as_it_was_written() -> None:
    poses = never_seen(2)
    poses.position[0], poses.heading[0], poses.measured_at[0] = (1.0, 1.0 / 3.0), 0.5, 7.0
    links = (RobotLink(4, 0.5, False, "weak"), RobotLink())
    report = TeamReport(7.02, poses, links, "cable")
    again = team_lines.read(team_lines.written(report), "line 3", 2)
    assert [part.tobytes() for part in again.poses] == [part.tobytes() for part in report.poses]
    assert (again.now, again.links[0], again.failure) == (7.02, links[0], "cable")
    assert again.links[1].acknowledged == -1
    assert math.isnan(again.links[1].battery)
    assert team_lines.rules_read(team_lines.rules_written(RULES), "line 1") == RULES


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("position", [[0, 0]], "is not a list of 2"),
        ("links", [[0, 0, 1, ""], [0, 0, True, ""]], "is not a link"),
        ("failure", 3, "is not text"),
        ("now", "late", "is not a number"),
    ],
)
def test_damaged_reports_are_one_clear_line(key: str, value: Any, words: str) -> None:
    entry = team_lines.written(TeamReport(1.0, never_seen(2), (RobotLink(),) * 2))
    with pytest.raises(InputError, match="line 3: team") as refusal:
        team_lines.read({**entry, key: value}, "line 3", 2)
    assert words in str(refusal.value)

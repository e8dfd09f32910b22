"""The suite of long runs: its scenario, its pages, a tiny headless run, its report."""

import itertools
import json
from typing import Any, ClassVar

import pytest

from higvf_console.cli.main import main
from higvf_console.core.commands import Pick, StrokeBegin, StrokeEnd, StrokePoints
from higvf_console.core.errors import HigvfError
from higvf_console.core.interface import OperatorContext
from higvf_console.lab.bench import endurance, live_pages
from higvf_console.lab.bench.endurance import Case, Operator, outline_of, scenario_of
from higvf_console.lab.bench.live_pages import LivePages
from higvf_console.lab.bench.usage import Trend, Trends
from higvf_console.runtime import history
from higvf_console.scenario.scenario import parse_scenario
from higvf_console.ui.page.message_table import BODIES


def trends(handles_flat: bool = True) -> Trends:
    flat = Trend(200.0, 0.5, 0.01, flat=True)
    return Trends(flat, flat._replace(flat=handles_flat), flat)


class FakePage:
    """Notes what a page says."""

    made: ClassVar["list[FakePage]"] = []

    def __init__(self, url: str, *, positions: bool) -> None:
        assert not positions
        self.url, self.closed, self.said = url, False, list[tuple[str, dict[str, Any]]]()
        FakePage.made.append(self)

    def say(self, topic: str, **body: Any) -> None:
        self.said.append((topic, body))

    def close(self) -> None:
        self.closed = True


@pytest.fixture
def pages(monkeypatch: pytest.MonkeyPatch) -> LivePages:
    monkeypatch.setattr(FakePage, "made", [])
    monkeypatch.setattr(live_pages, "ViserClient", FakePage)
    return LivePages("steer", "watch", 2)


def test_the_pages_say_what_honest_pages_say_and_reload_in_turn(pages: LivePages) -> None:
    strokes = iter([outline_of(10, turn) for turn in range(2)])
    for _ in range(live_pages.STROKE_EVERY + 1):
        pages.act(strokes)
    steering = FakePage.made[0]
    assert [page.url for page in FakePage.made] == ["steer", *["watch"] * (2 + 6)]
    assert [page.closed for page in FakePage.made] == [False, *[True] * 6, False, False]
    assert [topic for topic, _ in steering.said].count("hello") == 6
    assert [body["phase"] for topic, body in steering.said if topic == "stroke"] == ["start", "update", "end"] * 2
    for topic, body in steering.said:
        assert set(body) == set(BODIES[topic].__struct_fields__)
    pages.close()
    assert all(page.closed for page in FakePage.made)


def test_the_history_is_filled_with_strokes_ahead(pages: LivePages, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live_pages, "AHEAD_EVERY", 0.0)
    strokes = (outline_of(10, turn) for turn in itertools.count())
    pages.fill_history(strokes)
    pages.act(strokes)
    drawn = [body["id"] for topic, body in FakePage.made[0].said if topic == "stroke" and body["phase"] == "end"]
    assert drawn == list(range(live_pages.AHEAD + 1))
    assert live_pages.AHEAD > history.KEPT
    greetings = [topic for topic, _ in FakePage.made[0].said].count("hello")
    assert greetings == live_pages.AHEAD + 1, (
        "a console that still loads hears none; a page that is silent has no control"
    )


def test_a_page_that_the_console_closed_ends_the_measurement(pages: LivePages) -> None:
    FakePage.made[2].closed = True
    with pytest.raises(HigvfError, match="the console has closed 1 of 3 pages"):
        pages.act(iter([]))


@pytest.mark.parametrize("robots", [10, endurance.ROBOTS])
def test_the_scenario_never_ends_and_its_strokes_lie_in_it(robots: int) -> None:
    scenario = parse_scenario(scenario_of(robots), "the benchmark's scenario")
    assert len(scenario.setup().start.motion.position) == robots
    assert "when: never" in scenario.text
    for turn in range(10):
        outline = outline_of(robots, turn)
        assert outline.min() > 0.0
        assert (outline < (scenario.arena.width, scenario.arena.height)).all()


def test_the_operator_picks_all_the_time_and_draws_now_and_then() -> None:
    operator = Operator()
    context = OperatorContext(0.0, "operator", None, False, False, 0, (), 10)
    given = [type(command) for _ in range(1000) for command in operator.poll(context)]
    assert given.count(Pick) == 40
    assert given[-3:] == [StrokeBegin, StrokePoints, StrokeEnd]
    assert given.count(StrokeEnd) == 2


def test_a_tiny_headless_run_is_sampled() -> None:
    measured = endurance.headless(0.05, period=0.005)
    assert "9 000 control periods (0.05 h)".replace(" ", "\u202f", 1) in measured.title
    assert measured.samples >= 3
    assert measured.trends.memory.mean > 50.0
    assert measured.trends.threads.mean >= 1.0


def test_the_command_reports_a_table_or_json_and_fails_where_something_rises(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: list[object] = []

    def run(*arguments: object) -> list[Case]:
        asked.append(arguments)
        return [Case("headless", "4 h headless", 60.0, 61, trends(handles_flat=len(asked) == 1))]

    monkeypatch.setattr(endurance, "run", run)
    assert main(["bench", "--suite", "endurance", "--json", "--hours", "4"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert (report["flat"], report["cases"][0]["memory_mb"]["per_hour"]) == (True, 0.5)
    assert main(["bench", "--suite", "endurance", "--case", "headless", "--minutes", "3"]) == 1
    rule, title, memory, handles, _ = capsys.readouterr().out.splitlines()
    assert "least squares rises by less than 1 % of the mean" in rule
    assert title == "4 h headless: 61 samples in 60 s"
    assert memory.split()[-1] == "flat"
    assert handles.endswith("NOT FLAT")
    assert asked == [(2.0, 4.0, endurance.CASES), (3.0, 1.0, ["headless"])]


def test_an_unknown_case_is_refused_with_the_choices(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "--suite", "endurance", "--case", "sleep"]) == 2
    assert "case: 'sleep' is not one of robots, observers, headless" in capsys.readouterr().err
    assert main(["bench", "--suite", "tick", "--hours", "4"]) == 2
    assert "--hours is an option of --suite endurance" in capsys.readouterr().err

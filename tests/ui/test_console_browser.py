"""The whole console in a real browser: session, scene, panels, pointer and keys, as the operator meets them."""

from collections.abc import Callable, Iterator

import cv2
import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import (
    AskReset,
    EmergencyStop,
    Freeze,
    OperatorCommand,
    Pause,
    Pick,
    ResetEmergencyStop,
    ResetRun,
    SetSpeed,
    Step,
)
from higvf_console.core.interface import ChannelState
from higvf_console.core.state import PathKind
from higvf_console.ui.panels.status import StatusStrip
from higvf_console.ui.widgets.html import TIMES
from tests.browser import (
    console_page,
    draw,
    press,
    press_stop,
    screenshot,
    shown,
    tab,
    to_page,
    told,
    visible,
    wait_for_console,
    wait_until,
)
from tests.consoles import Running, console_at_work

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def running() -> Iterator[Running]:
    """The firefighting scenario, live."""
    with console_at_work("firefighting") as running:
        yield running


@pytest.fixture(scope="module")
def page(chromium: Browser, running: Running) -> Iterator[Page]:
    """A page that shows it."""
    with console_page(chromium, running.url, sharp=True) as page:
        yield page


@pytest.fixture(autouse=True)
def _from_the_start(running: Running, page: Page) -> None:
    """Each test begins with a run of its own, frozen at its start."""
    running.session.commands.clear()
    running.console.ui.update(field=None)
    running.start_again()
    wait_until(lambda: running.given(Pick) and running.state.motion.tick == 0)
    running.session.commands.clear()
    page.evaluate("document.activeElement.blur()")
    tab(page, "Steer")


def pixels(page: Page, ground: Floats, size: int = 3) -> np.ndarray:
    """Colours (n, 3) of the picture round ground points (n, 2) [m], brightest of a few pixels each."""
    picture = np.asarray(cv2.imdecode(np.frombuffer(page.screenshot(), np.uint8), cv2.IMREAD_COLOR))[..., ::-1]
    seen = []
    for x, y in to_page(page, ground):
        patch = picture[round(y) - size : round(y) + size + 1, round(x) - size : round(x) + size + 1]
        seen.append(patch.reshape(-1, 3)[patch.reshape(-1, 3).sum(axis=1).argmax()])
    return np.array(seen, np.int64)


def test_the_page_rests_between_slow_frames(page: Page) -> None:
    assert page.evaluate("requestAnimationFrame(() => {})") > 2**31


def test_the_arena_is_shown_with_fires_and_robots_where_they_are(page: Page, running: Running) -> None:
    wait_until(shown(page, "FROZEN"))
    beside_number = running.state.motion.fire_radius[:3, None] * np.array([0.6, -0.45])

    def as_painted() -> bool:
        fires = pixels(page, running.session.setup.world.fire_position[:3] + beside_number)
        robots = pixels(page, running.state.motion.position)
        orange = (fires[:, 0] > 180).all() and (fires[:, 2] < 100).all()
        blue = (np.abs(robots[1:] - [86, 180, 233]).max(axis=1) < 40).all()
        yellow = np.abs(robots[0] - [240, 228, 66]).max() < 60
        return bool(orange and blue and yellow)

    wait_until(as_painted)
    screenshot(page, "console-start")


def test_a_drawn_stroke_becomes_the_path_and_the_robot_follows_it(page: Page, running: Running) -> None:
    hand = np.stack([np.linspace(720, 1050, 120), 340 + 120 * np.sin(np.linspace(0, 3, 120))], axis=1)
    draw(page, to_page(page, hand))
    wait_until(lambda: running.state.intent.path.kind == PathKind.SPLINE)
    length = np.hypot(*np.diff(hand, axis=0).T).sum()
    assert running.state.intent.path.length == pytest.approx(length, rel=0.02)

    def yellow() -> bool:
        seen = pixels(page, floats(hand[[30, 60, 90]]))
        return bool((seen[:, :2].min(axis=1) > 150).all() and (seen[:, 2] < 140).all())

    wait_until(yellow)
    press(page, "Run clock")
    wait_until(lambda: running.state.motion.path_parameter > 0.2 * length, 60.0)
    screenshot(page, "console-stroke")


def test_a_click_picks_the_robot_under_it_and_the_panel_says_so(page: Page, running: Running) -> None:
    draw(page, to_page(page, running.state.motion.position[2:3] + np.array([6.0, 4.0])), rate=0)
    wait_until(lambda: running.state.intent.influenced == 2)
    wait_until(lambda: "robot 3" in page.locator(".facts .operator").inner_text())
    wait_until(lambda: page.get_by_role("combobox").nth(0).input_value() == "Robot 3")
    draw(page, to_page(page, [[100.0, 600.0]]), rate=0)
    page.wait_for_timeout(300)
    assert len(running.given(Pick)) == 1


def test_the_panel_and_the_number_keys_pick_too(page: Page, running: Running) -> None:
    page.get_by_role("combobox").nth(0).click()
    page.get_by_role("option", name="Robot 2").click()
    wait_until(lambda: running.state.intent.influenced == 1)
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("3")
    wait_until(lambda: running.state.intent.influenced == 2)


def test_pause_freeze_step_and_speed_follow_their_buttons(page: Page, running: Running) -> None:
    press(page, "Pause")
    wait_until(lambda: running.state.intent.paused)
    wait_until(lambda: page.get_by_role("button", name="Resume", exact=True).count())
    press(page, "Step once")
    wait_until(lambda: running.state.motion.tick == 1)
    press(page, "Run clock")
    wait_until(lambda: not running.session.snapshot.frozen)
    wait_until(shown(page, "PAUSED"))
    page.get_by_label("Speed").select_option(f"8{TIMES}")
    wait_until(lambda: running.session.snapshot.speed == 8.0)
    press(page, "Resume")
    wait_until(shown(page, "RUNNING"))
    assert len(running.given(Pause)) == 1
    assert len(running.given(Step)) == 1


def test_the_run_is_reset_in_two_steps(page: Page, running: Running) -> None:
    press(page, "Reset run")
    wait_until(lambda: page.get_by_role("button", name="Press again to reset the run").count())
    assert running.given(ResetRun) == []
    press(page, "Press again to reset the run")
    wait_until(lambda: running.given(ResetRun))


def test_a_shown_stroke_becomes_the_path_and_can_be_reversed_and_cleared(page: Page, running: Running) -> None:
    shipped = running.session.scenario.strokes[0]
    press(page, f"Show me: {shipped.name}")
    wait_until(lambda: running.state.intent.path.kind == PathKind.SPLINE)
    assert running.state.intent.influenced == shipped.robot
    press(page, "Reverse")
    wait_until(lambda: running.state.intent.path.direction == -1.0)
    press(page, "Clear")
    wait_until(lambda: running.state.intent.path.kind == PathKind.NONE)


def test_stop_is_latched_shown_and_survives_a_reload(page: Page, running: Running) -> None:
    press_stop(page)
    wait_until(lambda: running.state.intent.stopped)
    page.locator("button.stop.stopped").wait_for()
    wait_until(shown(page, "STOPPED"))
    assert page.get_by_role("button", name="Resume", exact=True).is_disabled()
    screenshot(page, "console-stopped")
    page.reload()
    wait_for_console(page)
    page.locator("button.stop.stopped").wait_for()
    wait_until(shown(page, "STOPPED"))
    page.wait_for_timeout(600)
    press_stop(page)
    page.locator("button.stop.asked").wait_for()
    page.wait_for_timeout(600)
    press_stop(page)
    wait_until(lambda: not running.state.intent.stopped)


@pytest.mark.parametrize("widget", ["dropdown", "number"])
def test_space_stops_whatever_has_the_focus(page: Page, running: Running, widget: str) -> None:
    field = (
        page.get_by_role("combobox").nth(0) if widget == "dropdown" else page.locator("input[inputmode]:visible").nth(0)
    )
    field.click()
    page.keyboard.press("Space")
    wait_until(lambda: running.state.intent.stopped)
    page.locator("button.stop.stopped").wait_for()
    for state in ("asked", "ready"):
        page.wait_for_timeout(600)
        press_stop(page)
        page.locator(f"button.stop.{state}").wait_for()


def test_a_stop_from_the_page_stands_the_team_still_within_two_ticks_of_its_arrival(
    page: Page, running: Running, monkeypatch: pytest.MonkeyPatch
) -> None:
    arrived: list[int] = []
    push = running.session.pointer.push

    def noted(command: OperatorCommand) -> None:
        if isinstance(command, EmergencyStop):
            arrived.append(running.state.motion.tick)
        push(command)

    monkeypatch.setattr(running.session.pointer, "push", noted)
    press(page, "Run clock")
    wait_until(lambda: bool(running.state.motion.velocity.any()))
    page.keyboard.press("Space")
    wait_until(lambda: running.state.intent.stopped)
    period = running.session.setup.params.safety.control_period
    applied = next(a.time for a in running.session.commands if isinstance(a.command, EmergencyStop))
    assert round(applied / period) - arrived[0] <= 1  # and the step of that tick has no velocity
    assert not running.state.motion.velocity.any()
    running.push(AskReset(), ResetEmergencyStop())
    wait_until(lambda: not running.state.intent.stopped)


def test_the_field_key_and_list_show_arrows(page: Page, running: Running) -> None:
    tab(page, "View")
    page.evaluate("document.activeElement.blur()")
    running.push(*running.shipped_stroke())
    wait_until(lambda: running.state.intent.path.kind == PathKind.SPLINE)
    assert not visible(page, "/field")
    page.keyboard.press("v")
    wait_until(lambda: visible(page, "/field"))
    field = page.get_by_role("combobox").nth(0)
    wait_until(lambda: field.input_value() == "Path")
    field.click()
    page.get_by_role("option", name="Blended").click()
    page.wait_for_timeout(700)
    screenshot(page, "console-field")
    field.click()
    page.get_by_role("option", name="Off").click()
    wait_until(lambda: not visible(page, "/field"))


def test_switches_hide_what_they_name(page: Page, running: Running) -> None:
    tab(page, "View")
    for label, name in (("Links", "/team/links"), ("Boundaries", "/ground/reactive"), ("Numbers", "/team/digit_1")):
        switch = page.get_by_role("checkbox", name=label)
        wait_until(lambda name=name: visible(page, name))
        switch.click()
        wait_until(lambda name=name: not visible(page, name))
        switch.click()
        wait_until(lambda name=name: visible(page, name))
    assert running.state.motion.tick == 0


def test_a_value_that_no_widget_offers_is_refused_and_the_widget_heals(page: Page, running: Running) -> None:
    ending = page.get_by_label("At its end", exact=True).first
    identifier = ending.get_attribute("id")
    for value in ("999", 7, None):
        page.evaluate(
            "([uuid, value]) =>"
            " window.__viserMutable.sendMessage({ type: 'GuiUpdateMessage', uuid, updates: { value } })",
            [identifier, value],
        )
    page.wait_for_timeout(500)
    assert running.console.ui.state.terms.ending == "release"
    assert ending.input_value() == "Go on by itself"
    press(page, "Pause")
    wait_until(lambda: running.state.intent.paused)


def test_a_fire_that_goes_out_is_told_logged_and_tabled(page: Page, running: Running) -> None:
    running.push(SetSpeed(2.0), Freeze(False))
    wait_until(lambda: running.session.snapshot.extinguished, 120.0)
    running.push(Freeze(True))
    first = running.session.snapshot.extinguished[0] + 1
    wait_until(told(page, f"Fire {first} is out"))
    tab(page, "Log")
    wait_until(lambda: page.locator(".hg .log", has_text=f"Fire {first} is out").count())
    tab(page, "Fires")
    assert "out" in page.locator(".hg tr.out").first.inner_text()
    wait_until(lambda: page.locator("svg.chart polyline[stroke-dasharray]").count())
    screenshot(page, "console-fires")


@pytest.mark.parametrize(("width", "height"), [(1280, 720), (1920, 1080)])
def test_nothing_overlaps_the_stop_button_or_leaves_the_arena_s_room(
    page: Page, running: Running, width: int, height: int
) -> None:
    page.set_viewport_size({"width": width, "height": height})
    page.wait_for_timeout(800)
    arena = running.session.setup.arena
    (left, bottom), (right, top) = to_page(page, [[arena.x_min, arena.y_min], [arena.x_max, arena.y_max]])
    canvas = page.evaluate(
        "(() => { const { right } = __viserMutable.canvas.getBoundingClientRect(); return right })()"
    )
    stop = page.locator("button.stop").bounding_box()
    assert stop is not None
    assert stop["y"] > bottom + 20
    assert left > 40
    assert top > 15
    assert right < canvas - 25
    screenshot(page, f"console-{width}x{height}")
    page.set_viewport_size({"width": 1280, "height": 720})


def test_two_pages_see_the_same_and_a_late_one_has_it_all(
    page: Page, running: Running, open_page: Callable[[str], Page]
) -> None:
    running.push(*running.shipped_stroke())
    late = open_page(running.url)
    for seen in (page, late):
        wait_until(lambda seen=seen: "its path" in seen.locator(".facts").inner_text())
    assert visible(late, "/hand/ahead")


def test_a_panel_that_fails_does_not_stop_the_scene(
    page: Page, running: Running, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    panels = running.console._panels  # pyright: ignore[reportPrivateUsage]
    status = next(panel for panel in panels if isinstance(panel, StatusStrip))
    monkeypatch.setattr(status, "update", {}.__delitem__)
    running.push(Pick(1))
    wait_until(lambda: page.get_by_role("combobox").nth(0).input_value() == "Robot 2")
    wait_until(lambda: [record for record in caplog.records if "StatusStrip" in record.getMessage()])


def test_an_open_page_keeps_the_channel_alive(running: Running, page: Page) -> None:  # noqa: ARG001 - it must be open
    def last_seen() -> bool:
        console = dict(running.session.snapshot.channels)["console"]
        return console.state is ChannelState.LIVE and console.last_seen is not None

    wait_until(last_seen)

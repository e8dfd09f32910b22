"""Two browsers on one console: one steers, the other watches, and control passes between them by a click."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from higvf_console.core.arrays import floats
from higvf_console.core.commands import (
    ControlChange,
    EmergencyStop,
    OperatorCommand,
    Pause,
    Pick,
    ResetEmergencyStop,
)
from higvf_console.core.edits import MoveEntity
from higvf_console.core.state import PathKind, PathStatus
from higvf_console.ui.page import control_lease
from higvf_console.ui.page.roles import Roles
from tests.browser import (
    draw,
    open_console,
    press_stop,
    screenshot,
    to_page,
    told,
    turn_wheel,
    wait_for_console,
    wait_until,
)
from tests.consoles import Running, console_at_work
from tests.roles import button, changes, click, patient_scenario, says, send, strip
from tests.teams import stroke

pytestmark = pytest.mark.browser

HAND = np.stack([np.linspace(720, 1050, 60), 340 + 120 * np.sin(np.linspace(0, 3, 60))], axis=1)  # [m]


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    """The firefighting scenario, live."""
    with console_at_work(patient_scenario(tmp_path_factory.mktemp("roles"))) as running:
        yield running


@pytest.fixture(scope="module")
def first(chromium: Browser, running: Running) -> Iterator[Page]:
    """The page that came first."""
    page = open_console(chromium, running.url, 1280, 720)
    yield page
    page.context.close()


@pytest.fixture(scope="module")
def second(chromium: Browser, running: Running, first: Page) -> Iterator[Page]:  # noqa: ARG001 - it must be the first
    """A page in another browser."""
    page = open_console(chromium, running.url, 1000, 640)
    yield page
    page.context.close()


@pytest.fixture(autouse=True)
def _from_the_start(running: Running, first: Page, second: Page) -> None:
    """Each test begins with a frozen run, the first page steering and nobody waiting."""
    for page, other in ((second, first), (first, second)):
        strip(page).wait_for()
        if button(page, "Take").count():
            click(page, "Take")
        wait_until(lambda page=page, other=other: says(page, "You steer") and button(other, "Take over").count())
    running.session.commands.clear()
    running.start_again()
    wait_until(lambda: running.given(Pick) and running.state.motion.tick == 0)
    running.session.commands.clear()


def logged(running: Running, text: str) -> bool:
    return any(event.kind == "control" and text in event.text for event in running.session.snapshot.events)


def kinds(running: Running) -> set[type[OperatorCommand]]:
    return {type(applied.command) for applied in running.session.commands}


def echoed(page: Page) -> bool:
    """Whether the page shows a stroke of its own hand."""
    hosts = "[...document.body.children].map((host) => host.shadowRoot?.querySelector('polyline'))"
    return page.evaluate(f"() => {hosts}.some((line) => line?.points.length)")


def opacities(page: Page) -> list[str]:
    """Of the tools, and of one widget of each sort."""
    sorts = [".hg-tools", *(f".mantine-{sort}" for sort in ("Button-root", "Input-wrapper", "Slider-root"))]
    found = """
    (sorts) => {
      const run = document.querySelector(".hg-strip").shadowRoot.querySelector(".run");
      return [run, ...sorts.map((sort) => document.querySelector(sort))].map((node) => getComputedStyle(node).opacity);
    }
    """
    return page.evaluate(found, sorts)


def test_the_first_page_steers_and_each_page_says_so(first: Page, second: Page) -> None:
    wait_until(lambda: says(first, "You steer, 1 watches"))
    wait_until(lambda: says(second, "Browser 1 steers, you watch"))
    screenshot(first, "roles-steers")
    screenshot(second, "roles-watches")


def test_what_a_page_that_watches_cannot_change_is_pale(first: Page, second: Page) -> None:
    for steers, watches in ((first, second), (second, first)):
        wait_until(lambda page=steers: says(page, "You steer") and set(opacities(page)) == {"1"})
        wait_until(lambda page=watches: set(opacities(page)) == {"0.45"})
        if steers is first:
            click(second, "Take over")


def test_a_page_that_watches_cannot_draw_pick_or_press_keys(first: Page, second: Page, running: Running) -> None:
    draw(second, to_page(second, HAND), rate=0)
    wait_until(lambda: says(second, "you cannot do that here"))
    screenshot(second, "roles-refused")
    draw(second, to_page(second, running.state.motion.position[2:3]), rate=0)
    for key in ("p", "2", "c", "z", "x", "v", "Enter"):
        second.keyboard.press(key)
    send(second, type="PageMessage", topic="key", body={"name": "reset_stop", "number": 0})
    first.keyboard.press("3")  # what was sent before it has been dealt with
    wait_until(lambda: running.state.intent.influenced == 2)
    second.wait_for_timeout(500)
    assert kinds(running) == {Pick}
    assert [pick.operator for pick in running.given(Pick)] == ["Browser 1"]
    assert running.state.intent.path.kind == PathKind.NONE
    assert not echoed(second)


def test_a_widget_moved_by_a_page_that_watches_shows_the_true_value_again(second: Page, running: Running) -> None:
    picker = second.get_by_role("combobox").nth(0)
    wait_until(lambda: picker.input_value() == "Robot 1")
    picker.click()
    second.get_by_role("option", name="Robot 2").click()
    wait_until(lambda: says(second, "you cannot do that here"))
    wait_until(lambda: picker.input_value() == "Robot 1")
    at_once = second.get_by_role("checkbox", name="Commit at once")
    before = at_once.is_checked()
    at_once.click()
    wait_until(lambda: at_once.is_checked() == before)
    smoothing = second.get_by_label("Smoothing (m)", exact=True)
    value = smoothing.input_value()
    smoothing.fill("77")
    smoothing.press("Enter")
    wait_until(lambda: smoothing.input_value() == value)
    second.get_by_role("button", name="Pause", exact=True).click()
    second.wait_for_timeout(500)
    assert not running.session.commands
    second.evaluate("document.activeElement.blur()")


def test_a_page_that_watches_zooms_and_opens_tabs(second: Page, first: Page) -> None:
    second.get_by_role("tab", name="Why").click()
    second.locator(".hg", has_text="Why robot 1 moves").first.wait_for()
    second.get_by_role("tab", name="Steer").click()
    elsewhere = to_page(second, HAND[:1])
    turn_wheel(second, [300, 300], -300)
    wait_until(lambda: to_page(second, HAND[:1]) != elsewhere)
    second.keyboard.press("f")
    assert says(first, "You steer")


def test_stop_is_obeyed_from_every_page_and_reset_by_the_one_that_steers(
    first: Page, second: Page, running: Running
) -> None:
    second.keyboard.press("Space")
    wait_until(lambda: running.state.intent.stopped)
    assert running.given(EmergencyStop)[0].operator == "Browser 2"
    second.locator("button.stop.stopped").wait_for()
    second.wait_for_timeout(600)
    press_stop(second)
    wait_until(lambda: says(second, "you cannot do that here"))
    second.locator("button.stop.stopped").wait_for()
    for state in ("asked", "ready"):
        first.wait_for_timeout(600)
        press_stop(first)
        first.locator(f"button.stop.{state}").wait_for()
    assert [reset.operator for reset in running.given(ResetEmergencyStop)] == ["Browser 1"]


def test_the_palette_stops_from_every_page_and_does_nothing_else_from_one_that_watches(
    second: Page, running: Running
) -> None:
    handles = running.server.gui._command_handle_from_uuid  # pyright: ignore[reportPrivateUsage]
    uuids = {handle.description: uuid for uuid, handle in handles.items()}
    send(second, type="CommandTriggerMessage", uuid=uuids["Key P"])
    send(second, type="CommandTriggerMessage", uuid=uuids["Key Space"])
    wait_until(lambda: running.state.intent.stopped)
    assert kinds(running) == {EmergencyStop}


def test_control_is_asked_for_refused_asked_for_and_granted(first: Page, second: Page, running: Running) -> None:
    click(second, "Request")
    wait_until(lambda: says(first, "Browser 2 asks for control"))
    wait_until(lambda: says(second, "you asked"))
    screenshot(first, "roles-asked")
    click(first, "Refuse")
    wait_until(lambda: says(second, "Browser 1 refused your request"))
    click(second, "Request")
    wait_until(lambda: says(first, "Browser 2 asks for control"))
    click(first, "Grant")
    wait_until(lambda: says(second, "You steer"))
    wait_until(lambda: says(first, "Browser 2 steers, you watch"))
    assert [how for how, _, _ in changes(running)] == [
        ControlChange.ASKED, ControlChange.REFUSED, ControlChange.ASKED, ControlChange.GRANTED,
    ]  # fmt: skip
    assert logged(running, "Browser 1 grants control to Browser 2")
    second.keyboard.press("3")
    wait_until(lambda: running.state.intent.influenced == 2)
    assert running.given(Pick)[0].operator == "Browser 2"
    first.keyboard.press("2")
    wait_until(lambda: says(first, "you cannot do that here"))
    assert running.state.intent.influenced == 2


def test_who_takes_over_has_the_pen_and_everybody_is_told(first: Page, second: Page, running: Running) -> None:
    draw(first, to_page(first, HAND[:30]), rate=0, finish="")
    wait_until(lambda: len(running.state.pointer_state.stroke))
    click(second, "Take over")
    wait_until(lambda: says(first, "Browser 2 steers"))
    wait_until(lambda: running.state.pointer_state.stroke_source == "")
    wait_until(lambda: not echoed(first))
    for page in (first, second):
        wait_until(told(page, "Browser 2 takes over control"))
    screenshot(first, "roles-taken")
    draw(second, to_page(second, HAND), rate=0)
    wait_until(lambda: running.state.intent.path.kind == PathKind.SPLINE)
    assert changes(running) == [(ControlChange.TAKEN, "Browser 2", "Browser 2")]


def test_released_control_is_anybody_s(first: Page, second: Page, running: Running) -> None:
    click(first, "Release")
    wait_until(lambda: says(second, "Nobody steers"))
    wait_until(lambda: says(first, "Nobody steers"))
    screenshot(second, "roles-nobody")
    second.keyboard.press("p")
    wait_until(lambda: says(second, "you cannot do that here"))
    click(second, "Take control")
    wait_until(lambda: says(second, "You steer"))
    assert Pause not in kinds(running)


def test_a_page_that_is_reloaded_keeps_its_control(first: Page, second: Page, running: Running) -> None:
    for page, words in ((first, "You steer"), (second, "Browser 1 steers, you watch")):
        page.reload()
        wait_for_console(page)
        wait_until(lambda page=page, words=words: says(page, words))
    assert changes(running) == []
    first.keyboard.press("2")
    wait_until(lambda: running.state.intent.influenced == 1)


def let_time_pass(roles: Roles, monkeypatch: pytest.MonkeyPatch) -> None:
    """Makes the last sign of life of the page that steers an old one; the others count as awake."""
    monkeypatch.setattr(control_lease, "AWAKE", 60.0)
    with roles._lock:  # pyright: ignore[reportPrivateUsage]
        control = roles._control  # pyright: ignore[reportPrivateUsage]
        pages = (page._replace(last_seen=0.0) if page.identity == control.holder else page for page in control.pages)
        roles._control = control._replace(pages=tuple(pages))  # pyright: ignore[reportPrivateUsage]


def test_when_the_page_that_steers_is_lost_its_path_ends_in_autonomy_and_the_next_in_line_steers(
    second: Page, running: Running, open_page: Callable[[str], Page], monkeypatch: pytest.MonkeyPatch
) -> None:
    third = open_page(running.url)
    click(third, "Take over")
    wait_until(lambda: says(third, "You steer"))
    running.push(*stroke(HAND, 0))
    wait_until(lambda: running.state.motion.path_status == PathStatus.FOLLOWING)
    click(second, "Request")
    wait_until(lambda: says(second, "you asked"))
    third.close()
    let_time_pass(running.console._roles, monkeypatch)  # pyright: ignore[reportPrivateUsage]
    wait_until(lambda: says(second, "You steer"))
    wait_until(lambda: running.state.motion.path_status == PathStatus.FINISHED)
    assert changes(running)[-1][:2] == (ControlChange.LOST, "Browser 2")
    assert logged(running, "is lost: Browser 2 steers")
    second.get_by_role("tab", name="Log").click()
    second.locator(".hg .log:visible", has_text="is lost: Browser 2 steers").wait_for()
    screenshot(second, "roles-lost")
    second.get_by_role("tab", name="Steer").click()


def test_what_a_hand_holds_is_let_go_where_it_was_when_its_page_vanishes(
    running: Running, open_page: Callable[[str], Page]
) -> None:
    third = open_page(running.url)
    click(third, "Take over")
    wait_until(lambda: says(third, "You steer"))
    third.keyboard.press("m")
    fire = running.session.setup.world.fire_position[0]
    draw(third, to_page(third, np.linspace(fire, fire + floats([40.0, 60.0]), 10)), finish="")
    ui = running.console.ui
    wait_until(lambda: ui.state.drag is not None)
    third.close()
    wait_until(lambda: ui.state.drag is None)
    assert not running.given(MoveEntity)
    assert (running.session.setup.world.fire_position[0] == fire).all()


@pytest.mark.parametrize(("width", "height"), [(1280, 720), (1000, 640)])
def test_the_strip_covers_neither_arena_nor_panel_nor_stop(
    first: Page, second: Page, running: Running, width: int, height: int
) -> None:
    click(second, "Request")
    wait_until(lambda: says(first, "asks for control"))
    arena = running.session.setup.arena
    for page in (first, second):
        before = page.viewport_size
        page.set_viewport_size({"width": width, "height": height})
        page.wait_for_timeout(800)
        box, stop = strip(page).bounding_box(), page.locator("button.stop").bounding_box()
        canvas = page.evaluate("__viserMutable.canvas.getBoundingClientRect().top")
        (_, top), _ = to_page(page, [[arena.x_min, arena.y_max], [arena.x_max, arena.y_max]])
        assert box is not None and stop is not None
        assert box["x"] > 0
        assert box["x"] + box["width"] <= width
        assert box["y"] + box["height"] <= canvas < min(top, stop["y"])
        screenshot(page, f"roles-{width}x{height}-{'steers' if page is first else 'watches'}")
        assert before is not None
        page.set_viewport_size(before)


def test_a_page_that_is_alone_is_not_told_that_it_steers(first: Page) -> None:
    role = {"you": "Browser 1", "steers": True, "holder": "Browser 1", "asked": False, "waiting": [], "others": 1}
    for others, shown in ((0, 0), (1, 1)):
        first.evaluate("(role) => window.higvf.call('roles', 'show', role)", role | {"others": others})
        assert strip(first).count() == shown

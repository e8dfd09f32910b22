"""Editing in a real browser: tools, handles, number fields, history, files, repairs of a path."""

from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from higvf_console.core.arrays import Floats
from higvf_console.core.commands import AskReset, EmergencyStop, Freeze, LoadScenario, Pick, ResetEmergencyStop
from higvf_console.core.edits import AddEntity, ChangeEntity, EntityKind, MoveEntity, SetArena, ToggleLink
from higvf_console.core.state import PathKind
from higvf_console.core.viewport import Arena
from higvf_console.scenario.scenario import load_scenario, parse_scenario
from tests.browser import (
    console_page,
    draw,
    press,
    screenshot,
    shown,
    tab,
    to_page,
    visible,
    wait_until,
)
from tests.consoles import Running, console_at_work

pytestmark = pytest.mark.browser

HAND = np.stack([np.linspace(720, 1050, 60), 340 + 120 * np.sin(np.linspace(0, 3, 60))], axis=1)


@pytest.fixture(scope="module")
def whole_console() -> Iterator[Running]:
    """The firefighting scenario, live; starting it takes seconds."""
    with console_at_work("firefighting") as running:
        yield running


@pytest.fixture(scope="module")
def whole_page(chromium: Browser, whole_console: Running) -> Iterator[Page]:
    with console_page(chromium, whole_console.url) as page:
        yield page


@pytest.fixture
def running(whole_console: Running) -> Running:
    """The console, frozen at the start of its scenario as shipped."""
    scenario = load_scenario("firefighting")
    whole_console.session.commands.clear()
    whole_console.push(
        Freeze(True), AskReset(), ResetEmergencyStop(), LoadScenario(scenario.text, scenario.name), Pick(0)
    )
    wait_until(lambda: whole_console.given(LoadScenario) and whole_console.given(Pick))
    whole_console.session.commands.clear()
    return whole_console


@pytest.fixture
def page(whole_page: Page, running: Running) -> Page:  # noqa: ARG001 - it shows that
    """The page, at its first tab, with the tool that draws paths."""
    take(whole_page, "path")
    tab(whole_page, "Steer")
    return whole_page


def take(page: Page, tool: str) -> None:
    page.locator(f"button[data-tool='{tool}']").click()


def drag(page: Page, ground: Floats) -> None:
    draw(page, to_page(page, ground))


def click(page: Page, x: float, y: float) -> None:
    draw(page, to_page(page, [[x, y]]), rate=0)


def test_a_fire_is_chosen_dragged_resized_and_brought_back(page: Page, running: Running) -> None:
    take(page, "edit")
    tab(page, "Edit")
    click(page, 500, 250)
    wait_until(shown(page, "Fire 1"))
    drag(page, np.linspace([500, 250], [560, 420], 20))
    wait_until(lambda: running.given(MoveEntity))
    assert running.session.setup.world.fire_position[0] == pytest.approx([560, 420], abs=2.0)
    wait_until(lambda: visible(page, "/edit/square"))
    screenshot(page, "edit-fire")
    radius = running.state.motion.fire_radius[0]
    drag(page, np.linspace([560 + radius, 420], [610, 420], 20))
    wait_until(lambda: running.given(ChangeEntity))
    assert running.state.motion.fire_radius[0] == pytest.approx(50.0, abs=2.0)
    page.keyboard.press("Control+z")
    wait_until(lambda: running.state.motion.fire_radius[0] == radius)
    page.keyboard.press("Control+z")
    wait_until(lambda: running.session.setup.world.fire_position[0].tolist() == [500.0, 250.0])
    page.keyboard.press("Control+y")
    wait_until(lambda: running.session.setup.world.fire_position[0].tolist() != [500.0, 250.0])
    wait_until(shown(page, "Fire 1 has radius"))
    screenshot(page, "edit-history")


def test_a_fire_dropped_on_a_robot_is_held_at_the_nearest_safe_place(page: Page, running: Running) -> None:
    take(page, "edit")
    x, y = running.state.motion.position[0]
    drag(page, np.linspace([500, 250], [x, y], 30))
    wait_until(lambda: any("nearest safe place" in event.text for event in running.session.snapshot.events))
    gap = np.hypot(*(running.state.motion.position - running.session.setup.world.fire_position[0]).T)
    gap -= running.state.motion.fire_radius[0]
    least = running.session.setup.params.safety.obstacle_clearance
    assert least <= gap.min() < least + 0.01


def test_things_are_added_numbered_and_deleted(page: Page, running: Running) -> None:
    take(page, "robot")
    click(page, 200, 600)
    wait_until(lambda: len(running.state.motion.position) == 4)
    take(page, "bar")
    click(page, 300, 560)
    wait_until(lambda: len(running.given(AddEntity)) == 2)
    tab(page, "Edit")
    take(page, "edit")  # the tool that adds stays until it is put away
    click(page, 300, 560)
    wait_until(shown(page, "Bar 2"))
    field = page.get_by_label("Angle (deg)")
    field.fill("30")
    field.press("Enter")

    def angle() -> float:
        bar = running.session.setup.world.bars[1]
        return float(np.degrees(np.arctan2(bar[3] - bar[1], bar[2] - bar[0])))

    wait_until(lambda: angle() == pytest.approx(30.0))
    wait_until(lambda: len(running.given(ChangeEntity)) == 1)
    screenshot(page, "edit-bar")
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("Delete")
    wait_until(lambda: len(running.session.setup.world.bars) == 1)


def test_a_typed_number_counts_once_and_one_that_cannot_be_springs_back(page: Page, running: Running) -> None:
    take(page, "edit")
    tab(page, "Edit")
    click(page, 500, 250)
    wait_until(shown(page, "Fire 1"))
    radius = page.get_by_label("Radius (m)", exact=True).input_value()
    type_over(page, "x (m)", "520")
    type_over(page, "Radius (m)", "-15")
    wait_until(lambda: len(running.given(ChangeEntity)) == 2)
    given = [(change.name, change.value) for change in running.given(ChangeEntity) if isinstance(change, ChangeEntity)]
    assert given == [("x", 520.0), ("radius", -15.0)]
    wait_until(lambda: page.get_by_label("Radius (m)", exact=True).input_value() == radius)
    if not page.get_by_label("Right (m)").is_visible():
        page.get_by_text("Arena and links", exact=True).click()
    type_over(page, "Top (m)", "800")
    type_over(page, "Right (m)", "1300")
    wait_until(lambda: running.session.setup.arena == Arena(0.0, 0.0, 1300.0, 800.0))
    assert len(running.given(SetArena)) <= 2


def test_a_field_left_empty_shows_what_holds_and_edits_nothing(page: Page, running: Running) -> None:
    running.push(ChangeEntity(EntityKind.FIRE, 0, "x", 500.126))
    take(page, "edit")
    tab(page, "Edit")
    click(page, 500, 250)
    field = page.get_by_label("x (m)", exact=True)
    wait_until(lambda: field.is_visible() and field.input_value() == "500.126")
    type_over(page, "x (m)", "")
    field.press("Backspace")
    assert field.input_value() == ""
    field.press("Tab")
    wait_until(lambda: field.input_value() == "500.126")
    type_over(page, "y (m)", "260")
    wait_until(lambda: running.session.setup.world.fire_position[0, 1] == 260.0)
    assert running.session.setup.world.fire_position[0, 0] == 500.126


def type_over(page: Page, label: str, words: str) -> None:
    """Replaces what is in a field, key by key."""
    field = page.get_by_label(label, exact=True)
    field.click()  # waits for a folder that opens
    field.press("Control+a")
    field.press_sequentially(words)
    if words:
        field.press("Enter")


def test_an_obstacle_is_drawn_freehand_and_a_link_from_robot_to_robot(page: Page, running: Running) -> None:
    take(page, "outline")
    turn = np.linspace(0, 6.6, 80)  # beyond a full turn: the ends cross
    drag(page, np.stack([1000 + 80 * np.cos(turn), 150 + 50 * np.sin(turn)], axis=1))
    wait_until(lambda: len(running.session.setup.layout.obstacles.polygons) == 1)
    take(page, "link")
    first, second = running.state.motion.position[:2]
    drag(page, np.linspace(first, second, 12))
    wait_until(lambda: running.given(ToggleLink))
    assert len(running.session.setup.world.link_to) == 4  # all but this one
    screenshot(page, "edit-outline")


def test_a_path_is_redrawn_bent_closed_and_slowed(page: Page, running: Running) -> None:
    drag(page, HAND)
    wait_until(lambda: running.state.intent.path.kind != PathKind.NONE)
    first = running.state.intent.path
    take(page, "redraw")
    drag(page, np.linspace(HAND[20], [900, 600], 10).tolist() + np.linspace([900, 600], HAND[40], 10).tolist())
    wait_until(lambda: running.state.intent.path is not first)
    second = running.state.intent.path
    assert second.length > first.length + 100.0
    take(page, "move_point")
    drag(page, np.linspace([900, 590], [900, 640], 10))
    wait_until(lambda: running.state.intent.path is not second)
    press(page, "Close")
    wait_until(lambda: running.state.intent.path.closed)
    screenshot(page, "steer-repaired")
    page.keyboard.press("Control+z")
    wait_until(lambda: not running.state.intent.path.closed)


def test_a_circled_fire_has_priority_for_the_chosen_robot(page: Page, running: Running) -> None:
    running.push(Pick(1))
    take(page, "priority")
    x, y = running.session.setup.world.fire_position[2]
    turn = np.linspace(0, 6.2, 50)
    drag(page, np.stack([x + 70 * np.cos(turn), y + 70 * np.sin(turn)], axis=1))
    wait_until(lambda: len(running.state.intent.priority))
    assert running.state.intent.priority[0, :2].tolist() == [1.0, 2.0]
    wait_until(shown(page, "robot 2: fire 3"))
    screenshot(page, "steer-priority")


def test_a_scenario_is_saved_and_loaded_again(page: Page, running: Running, tmp_path: Path) -> None:
    take(page, "circle")
    click(page, 200, 600)
    wait_until(lambda: running.given(AddEntity))
    unfold_files(page)
    with page.expect_download() as download:
        press(page, "Save scenario")
    file = tmp_path / "saved.yaml"
    download.value.save_as(file)
    saved = parse_scenario(file.read_text(), "saved.yaml").setup()
    assert saved.world.circles.tolist() == running.session.setup.world.circles.tolist()
    file.write_text("version: 1\narena: {size_m: [300, 200]}\nrobots: {start_m: [[50, 50]]}\ntitle: A small one\n")
    press(page, "Open scenario")
    choose(page, "Open a file …", file)
    wait_until(lambda: running.given(LoadScenario))
    wait_until(shown(page, "A small one"))
    assert len(running.state.motion.position) == 1
    wait_until(lambda: running.session.snapshot.history.done)
    screenshot(page, "edit-loaded")
    file.write_text("version: 1\narena: {}\n")
    press(page, "Open scenario")
    choose(page, "Open a file …", file)
    wait_until(lambda: running.session.snapshot.events[-1].kind == "refused")
    assert "robots" in running.session.snapshot.events[-1].text


def test_a_file_that_cannot_be_used_is_refused_on_the_page_and_changes_nothing(
    page: Page, running: Running, tmp_path: Path
) -> None:
    unfold_files(page)
    binary, text, large = (tmp_path / name for name in ("binary.yaml", "text.png", "large.yaml"))
    binary.write_bytes(b"\x89PNG\0\xff")
    text.write_text("no picture")
    large.write_bytes(b" " * 16_000_001)
    for button, file, words in (
        ("Open a file …", binary, "binary.yaml: not UTF-8 text"),
        ("Overhead image", text, "text.png: not an image"),
        ("Open a file …", large, "large.yaml: 16.0 MB are too many"),
    ):
        if button == "Open a file …":
            press(page, "Open scenario")
        choose(page, button, file)
        wait_until(shown(page, words))
    assert running.given(LoadScenario) == []
    assert running.console.ui.state.background is None


def test_the_strokes_of_a_loaded_scenario_are_offered_in_the_tab_for_steering_alone(
    page: Page, running: Running
) -> None:
    scenario = load_scenario("building")
    running.push(LoadScenario(scenario.text, scenario.name))
    offers = page.get_by_role("button", name="Show me: ")
    wait_until(lambda: offers.all_inner_texts() == [f"Show me: {stroke.name}" for stroke in scenario.strokes])
    tab(page, "Log")
    wait_until(shown(page, f"'{scenario.title}'"))
    assert not any(offer.is_visible() for offer in offers.all())


def unfold_files(page: Page) -> None:
    tab(page, "Edit")
    if not page.get_by_role("button", name="Save scenario", exact=True).is_visible():
        page.get_by_text("Files", exact=True).click()


def choose(page: Page, button: str, file: Path) -> None:
    with page.expect_file_chooser() as chooser:
        press(page, button)
    chooser.value.set_files(file)


def test_obstacles_are_made_of_an_overhead_image(page: Page, running: Running, tmp_path: Path) -> None:
    plan = np.full((70, 120, 3), 255, np.uint8)
    plan[8:20, 90:110] = 40  # 200 m x 120 m, dark, at the upper right
    file = tmp_path / "plan.png"
    cv2.imwrite(str(file), plan)
    unfold_files(page)
    choose(page, "Overhead image", file)
    wait_until(lambda: running.console.ui.state.background)
    press(page, "Dark")
    wait_until(lambda: len(running.session.setup.layout.obstacles.polygons) == 1)
    low, high = (bound(running.session.setup.layout.obstacles.polygons[0], axis=0) for bound in (np.min, np.max))
    assert low == pytest.approx([900, 500], abs=8.0)
    assert high == pytest.approx([1100, 620], abs=8.0)
    wait_until(lambda: visible(page, "/ground/image"))
    screenshot(page, "edit-image")
    other = load_scenario("building")  # which has another ground
    running.push(LoadScenario(other.text, other.name))
    wait_until(lambda: not visible(page, "/ground/image"))


def test_undo_does_not_set_a_stopped_team_in_motion(page: Page, running: Running) -> None:
    drag(page, HAND)
    wait_until(lambda: running.state.intent.path.kind != PathKind.NONE)
    running.push(EmergencyStop())
    page.keyboard.press("Control+z")
    wait_until(lambda: running.state.intent.path.kind == PathKind.NONE)
    assert running.state.intent.stopped
    assert running.state.intent.paused

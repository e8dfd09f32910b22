"""The look ahead in a real browser: ghosts while a stroke is drawn, then commit, redraw or discard."""

from collections.abc import Iterator

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from higvf_console.analysis.preview import Preview
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import Confirm, Discard, Freeze, MovePathPoint, ProposePick
from higvf_console.core.state import NO_PATH, NOBODY, Path, PathKind
from tests.browser import console_page, draw, screenshot, to_page, visible, wait_until
from tests.consoles import Running, console_at_work

pytestmark = pytest.mark.browser

HAND = np.stack([np.linspace(720, 1050, 120), 340 + 120 * np.sin(np.linspace(0, 3, 120))], axis=1)
THROUGH = np.stack([np.linspace(690, 420, 120), 340 + 60 * np.sin(np.linspace(0, 3, 120))], axis=1)  # an obstacle


@pytest.fixture(scope="module")
def running() -> Iterator[Running]:
    """The firefighting scenario, live."""
    with console_at_work("firefighting") as running:
        yield running


@pytest.fixture(scope="module")
def page(chromium: Browser, running: Running) -> Iterator[Page]:
    """A page that shows it."""
    with console_page(chromium, running.url) as page:
        yield page


@pytest.fixture(autouse=True)
def _waiting_is_on(running: Running, page: Page) -> None:
    """Each test begins with a frozen run at its start, and strokes that wait."""
    running.start_again()
    wait_until(lambda: running.state.motion.tick == 0 and running.state.intent.influenced == 0)
    running.session.commands.clear()
    at_once = page.get_by_role("checkbox", name="Commit at once")
    if at_once.is_checked():
        at_once.click()
    wait_until(lambda: not running.console.ui.state.commit_at_once)


def latest(running: Running) -> Preview | None:
    return running.console._previewer.latest  # pyright: ignore[reportPrivateUsage]


def draw_and_wait(page: Page, running: Running, hand: Floats = HAND, beside: Path = NO_PATH) -> Preview:
    """Draws a stroke; what is foreseen of the path that waits, which is another than one before."""
    draw(page, to_page(page, hand))
    wait_until(lambda: running.state.pointer_state.pending is not beside)
    path = running.state.pointer_state.pending

    def of_this_path() -> list[Preview]:
        found = latest(running)
        return [found] if found is not None and found.start.intent.path is path else []

    return wait_until(of_this_path)[0]


def test_a_ghost_is_seen_while_the_stroke_grows(page: Page, running: Running) -> None:
    draw(page, to_page(page, HAND), finish="")
    wait_until(lambda: visible(page, "/ghost/team") and visible(page, "/ghost/chosen") and visible(page, "/ghost/ends"))
    screenshot(page, "preview-drawing")
    assert running.state.pointer_state.stroke_source
    assert running.state.intent.path is NO_PATH
    page.keyboard.press("Escape")
    wait_until(lambda: not running.state.pointer_state.stroke_source)
    wait_until(lambda: not visible(page, "/ghost/team"))
    assert running.given(Discard) == [], "Escape cancels the stroke and discards nothing else"


def test_a_committed_path_is_followed_as_its_ghost_said(page: Page, running: Running) -> None:
    preview = draw_and_wait(page, running)
    wait_until(lambda: visible(page, "/ghost/path"))
    assert running.state.intent.path is NO_PATH, "nothing moves along a path that waits"
    page.get_by_role("button", name="Commit", exact=True).click()
    wait_until(lambda: running.state.intent.path.kind == PathKind.SPLINE)
    wait_until(lambda: not visible(page, "/ghost/path") and not visible(page, "/ghost/team"))
    page.get_by_role("button", name="Run clock", exact=True).click()
    wait_until(lambda: running.state.motion.tick > 300)
    running.push(Freeze(True))
    wait_until(lambda: running.session.snapshot.frozen)
    motion = running.state.motion
    gap = np.hypot(*(preview.tracks - motion.position[:, None]).transpose(2, 0, 1)).min(axis=1)
    assert (gap < 5.0).all(), "every robot is on its ghost's track"


def test_a_discarded_path_is_dropped_and_so_is_its_ghost(page: Page, running: Running) -> None:
    draw_and_wait(page, running)
    page.get_by_role("button", name="Discard", exact=True).click()
    wait_until(lambda: running.state.pointer_state.pending is NO_PATH)
    wait_until(lambda: not visible(page, "/ghost/path") and not visible(page, "/ghost/team"))
    wait_until(lambda: not page.get_by_role("button", name="Discard", exact=True).count())
    assert running.state.intent.path is NO_PATH


def test_enter_commits_and_escape_discards(page: Page, running: Running) -> None:
    draw_and_wait(page, running)
    page.keyboard.press("Escape")
    wait_until(lambda: running.state.pointer_state.pending is NO_PATH)
    draw_and_wait(page, running)
    page.keyboard.press("Enter")
    wait_until(lambda: running.state.intent.path.kind == PathKind.SPLINE)
    assert len(running.given(Confirm)) == 1


def test_enter_on_a_focused_button_presses_it_and_commits_nothing(page: Page, running: Running) -> None:
    draw_and_wait(page, running)
    page.get_by_role("button", name="Pause", exact=True).focus()
    page.keyboard.press("Enter")
    wait_until(lambda: running.state.intent.paused)
    assert running.given(Confirm) == []


def test_a_path_that_waits_is_drawn_anew_and_the_proposed_robot_stays(page: Page, running: Running) -> None:
    running.push(ProposePick(2, within=600.0, confidence=0.5))
    wait_until(lambda: visible(page, "/ghost/proposed"))
    draw_and_wait(page, running)
    page.mouse.move(20, 300)
    page.wait_for_timeout(500)
    screenshot(page, "preview-proposed")
    page.get_by_role("button", name="Redraw", exact=True).click()
    wait_until(lambda: running.state.pointer_state.pending is NO_PATH)
    assert running.state.pointer_state.proposed == 2
    page.get_by_role("button", name="Commit", exact=True).click()
    wait_until(lambda: running.state.intent.influenced == 2 and running.state.pointer_state.proposed == NOBODY)
    wait_until(lambda: not visible(page, "/ghost/proposed"))


def test_a_path_that_waits_is_repaired_before_it_is_committed(page: Page, running: Running) -> None:
    first = draw_and_wait(page, running).start.intent.path
    page.keyboard.press("g")
    detour = np.linspace(HAND[30], [830, 600], 10).tolist() + np.linspace([830, 600], HAND[70], 10).tolist()
    second = draw_and_wait(page, running, floats(detour), beside=first).start.intent.path
    assert second.length > first.length + 100.0
    page.keyboard.press("b")
    draw_and_wait(page, running, np.linspace([830, 590], [860, 640], 10), beside=second)
    page.keyboard.press("t")
    screenshot(page, "preview-repaired")
    assert running.state.intent.path is NO_PATH, "nothing moves along a path that waits"
    page.keyboard.press("Enter")
    wait_until(lambda: running.state.intent.path.kind == PathKind.SPLINE)
    assert len(running.given(MovePathPoint)) == 1


@pytest.mark.parametrize(("width", "height"), [(1280, 720), (1920, 1080)])
def test_the_read_out_tells_the_outcome_and_warns(page: Page, running: Running, width: int, height: int) -> None:
    page.set_viewport_size({"width": width, "height": height})
    page.wait_for_timeout(800)
    preview = draw_and_wait(page, running, floats(THROUGH))
    assert len(preview.repulsive)
    wait_until(lambda: visible(page, "/ghost/repulsive"))
    words = page.locator(".hg", has_text="Burnt").last
    wait_until(lambda: "in repulsive areas" in words.inner_text() and "m²" in words.inner_text())
    page.mouse.move(20, 300)  # away from every hint
    page.wait_for_timeout(500)
    screenshot(page, f"preview-{width}x{height}")
    page.set_viewport_size({"width": 1280, "height": 720})


def test_with_commit_at_once_a_stroke_is_followed_when_it_ends(page: Page, running: Running) -> None:
    page.get_by_role("checkbox", name="Commit at once").click()
    wait_until(lambda: running.console.ui.state.commit_at_once)
    draw(page, to_page(page, HAND))
    wait_until(lambda: running.state.intent.path.kind == PathKind.SPLINE)
    assert running.state.pointer_state.pending is NO_PATH

"""Fingers in the arena, as the browser itself turns them into events: one draws, two move and zoom."""

from collections.abc import Iterator, Sequence

import numpy as np
import pytest
from playwright.sync_api import Browser, CDPSession, Page

from tests.browser import Stage, open_console, to_page, wait_until

pytestmark = pytest.mark.browser
Fingers = Sequence[Sequence[float]]


@pytest.fixture(scope="module")
def tablet(chromium: Browser, whole_stage: Stage) -> Iterator[Page]:
    """A page on a screen that is touched."""
    page = open_console(chromium, whole_stage.url, touch=True)
    yield page
    page.context.close()


@pytest.fixture
def screen(tablet: Page) -> CDPSession:
    """The screen of the tablet, its view fitted."""
    tablet.keyboard.press("f")
    return tablet.context.new_cdp_session(tablet)


def touch(screen: CDPSession, *run_states: Fingers) -> None:
    """Fingers (n, 2) [CSS px] go down, move and are lifted together."""
    for kind, fingers in zip(["touchStart", *["touchMove"] * (len(run_states) - 1)], run_states, strict=True):
        points = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(fingers)]
        screen.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    screen.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})


def test_one_finger_draws_and_the_browser_does_not_take_it_for_a_scroll(
    tablet: Page, screen: CDPSession, stage: Stage
) -> None:
    ground = np.stack([np.linspace(300, 900, 25), np.linspace(600, 100, 25)], axis=1)
    touch(screen, *[[place] for place in to_page(tablet, ground)])
    wait_until(lambda: {"end", "cancel"} & set(stage.phases()))
    assert stage.phases() == ["start", "update", "end"]
    assert np.abs(stage.drawn()[[0, -1]] - ground[[0, -1]]).max() < 3.0


def test_a_tap_is_a_click(tablet: Page, screen: CDPSession, stage: Stage) -> None:
    touch(screen, to_page(tablet, [[400.0, 500.0]]))
    wait_until(lambda: stage.clicks)
    assert np.hypot(*(stage.clicks[0] - [400.0, 500.0])) < 3.0
    assert stage.strokes == []


def test_two_fingers_zoom_and_move_the_view_and_draw_nothing(tablet: Page, screen: CDPSession, stage: Stage) -> None:
    before = np.array(to_page(tablet, [[600.0, 350.0], [700.0, 350.0]]))
    middle = before[0]
    apart = np.concatenate([np.arange(50, 101, 5), np.full(10, 100)])
    lower = np.concatenate([np.zeros(11), np.arange(4, 41, 4)])
    left, right = (middle + np.stack([side * apart, lower], axis=1) for side in (-1, 1))
    touch(screen, *np.stack([left, right], axis=1).tolist())
    after = np.array(to_page(tablet, [[600.0, 350.0], [700.0, 350.0]]))
    assert np.hypot(*(after[1] - after[0])) / np.hypot(*(before[1] - before[0])) == pytest.approx(2.0, rel=0.1)
    assert after[0] - before[0] == pytest.approx([0.0, 40.0], abs=4.0)
    assert "end" not in stage.phases()
    assert stage.clicks == []
    assert tablet.evaluate("visualViewport.scale") == 1.0

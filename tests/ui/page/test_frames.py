"""Where the processor draws, the page rests between slow frames; tried on frames and a clock of the test's own."""

from collections.abc import Iterator
from importlib.resources import files
from typing import Any

import pytest
from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.browser

# A browser whose frames come on demand, whose clock stands between them, and whose graphics card has a name.
_WORLD = """
(card) => {
  const world = { now: 0, next: 0, frames: new Map(), rests: [], drawn: [] };
  window.requestAnimationFrame = (draw) => (world.frames.set(++world.next, draw), world.next);
  window.cancelAnimationFrame = (number) => world.frames.delete(number);
  performance.now = () => world.now;
  window.setTimeout = (act, rest) => world.rests.push([rest, act]);
  const gl = {
    RENDERER: 1, getParameter: (what) => (what === 2 ? card : "masked"),
    getExtension: () => ({ UNMASKED_RENDERER_WEBGL: 2 }),
  };
  world.frame = (took) => {
    world.now += took;
    const due = [...world.frames.values()];
    world.frames.clear();
    due.forEach((draw) => draw(world.now));
  };
  world.awake = () => world.rests.splice(0).map(([rest, act]) => (act(), rest));
  world.ask = (name) => requestAnimationFrame((now) => world.drawn.push([name, now]));
  window.world = world;
  world.part = (SCRIPT)({ canvas: () => ({ getContext: () => gl }) });
}
"""
CARDS = ["NVIDIA GeForce RTX 3060", "ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device), SwiftShader driver)", "llvmpipe"]


@pytest.fixture
def blank(chromium: Browser) -> Iterator[Page]:
    context = chromium.new_context()
    yield context.new_page()
    context.close()


def world(page: Page, card: str) -> None:
    script = (files("higvf_console.ui.page") / "browser_js" / "frames.js").read_text(encoding="utf-8")
    page.evaluate(_WORLD.replace("SCRIPT", script), card)


def stepped(page: Page, *steps: str) -> list[Any]:
    """What the world answers to these calls."""
    return page.evaluate(f"() => [{', '.join(f'world.{step}' for step in steps)}]")


@pytest.mark.parametrize("card", CARDS[1:])
def test_the_page_rests_as_long_as_a_slow_frame_took_where_the_processor_draws(blank: Page, card: str) -> None:
    world(blank, card)
    *_, rests, drawn = stepped(blank, "ask('slow')", "frame(120)", "frame(1)", "awake()", "drawn.length")
    assert (rests, drawn) == ([120], 0)
    assert stepped(blank, "frame(16)", "drawn")[1] == [["slow", 137]]


@pytest.mark.parametrize(("card", "took"), [(CARDS[0], 120), (CARDS[1], 30)])
def test_quick_frames_and_those_of_a_graphics_card_are_drawn_at_once(blank: Page, card: str, took: int) -> None:
    world(blank, card)
    assert stepped(blank, "ask('at once')", f"frame({took})", "drawn", "rests")[2:] == [[["at once", took]], []]


def test_a_page_that_was_hidden_for_long_is_drawn_soon(blank: Page) -> None:
    world(blank, CARDS[1])
    assert stepped(blank, "ask('hidden')", "frame(60000)", "awake()")[2] == [200]


def test_a_frame_is_called_off_before_and_in_a_rest(blank: Page) -> None:
    world(blank, CARDS[1])
    asked = stepped(blank, "ask('early')", "ask('late')", "ask('kept')")
    blank.evaluate("(number) => cancelAnimationFrame(number)", asked[0])
    stepped(blank, "frame(120)")
    blank.evaluate("(number) => cancelAnimationFrame(number)", asked[1])
    assert stepped(blank, "awake()", "frame(16)", "drawn")[2] == [["kept", 136]]


def test_without_the_script_the_browser_draws_as_before(blank: Page) -> None:
    world(blank, CARDS[1])
    assert stepped(blank, "part.remove()", "ask('after')", "frame(120)", "drawn")[3] == [["after", 120]]

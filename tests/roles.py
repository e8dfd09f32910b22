"""What tests of who steers share: a patient console, and what the strip of a page says and does."""

from pathlib import Path
from typing import Any

from playwright.sync_api import Page

from higvf_console.core.commands import HandOver
from higvf_console.scenario.scenario import load_scenario
from tests.consoles import Running


def patient_scenario(folder: Path) -> str:
    """The firefighting scenario, with patience for a machine whose pages are slow."""
    file = folder / "patient.yaml"
    text = load_scenario("firefighting").text.replace("inputs:", "inputs:\n  console: {stale: 30, lost: 60}", 1)
    file.write_text(text, encoding="utf-8")
    return str(file)


def strip(page: Page) -> Any:
    """The strip that says who steers, once it is open."""
    return page.locator(".roles.open")


def button(page: Page, name: str) -> Any:
    """A button of the strip."""
    return strip(page).locator("button").filter(has_text=name)


def click(page: Page, name: str) -> None:
    """Clicks a button of the strip."""
    button(page, name).click()


def says(page: Page, text: str) -> bool:
    """Whether the strip says so."""
    return strip(page).count() > 0 and text in strip(page).inner_text()


def changes(running: Running) -> list[tuple[str, str, str]]:
    """What became of control: how, the page that has or asks for it, the page that did it."""
    return [(c.how, c.page, c.operator) for c in running.given(HandOver) if isinstance(c, HandOver)]


def send(page: Page, **message: Any) -> None:
    """Sends a message as the page's own script would, or a forged one."""
    page.evaluate("(message) => window.__viserMutable.sendMessage(message)", message)

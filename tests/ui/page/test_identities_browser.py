"""The identity by which a page is known: a tab that was copied, two connections under one, and what is none."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page

from tests.browser import PATIENCE, open_console, wait_for_console, wait_until
from tests.consoles import Running, console_at_work
from tests.roles import changes, patient_scenario, says, send

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    """The firefighting scenario, live."""
    with console_at_work(patient_scenario(tmp_path_factory.mktemp("identities"))) as running:
        yield running


@pytest.fixture(scope="module")
def page(chromium: Browser, running: Running) -> Iterator[Page]:
    """The page that steers."""
    page = open_console(chromium, running.url)
    yield page
    page.context.close()


def test_a_second_tab_is_a_page_of_its_own(page: Page, running: Running) -> None:
    wait_until(lambda: len(changes(running)) == 1)  # the page has come, and steers
    with page.context.expect_page() as opened:
        page.evaluate("() => void window.open(location.href)")  # which copies the tab's storage
    copy = opened.value
    copy.set_default_timeout(PATIENCE * 1000)
    wait_for_console(copy)
    wait_until(lambda: says(copy, "Browser 1 steers, you watch"))
    wait_until(lambda: says(page, "You steer, 1 watches"))
    copy.close()
    assert len(changes(running)) == 1


def test_a_page_that_goes_over_to_the_identity_of_another_is_refused(
    page: Page, running: Running, caplog: pytest.LogCaptureFixture
) -> None:
    assert page.context.browser is not None
    forger = open_console(page.context.browser, running.url)
    roles = running.console._roles  # pyright: ignore[reportPrivateUsage]
    holder = roles._steering or 0  # pyright: ignore[reportPrivateUsage]
    identity = roles._identities[holder]  # pyright: ignore[reportPrivateUsage]
    send(forger, type="PageMessage", topic="hello", body={"identity": identity})
    wait_until(lambda: "hello: a page keeps its identity" in caplog.text)
    assert roles.steers(holder)
    forger.context.close()


def test_an_identity_that_is_none_is_refused(page: Page, running: Running, caplog: pytest.LogCaptureFixture) -> None:
    before = changes(running)
    send(page, type="PageMessage", topic="hello", body={"identity": "short"})
    send(page, type="PageMessage", topic="control", body={"act": "seize", "page": ""})
    wait_until(lambda: "control act: Invalid enum value 'seize'" in caplog.text)
    assert "hello identity: Expected `str` of length >= 16" in caplog.text
    assert changes(running) == before


# What a browser does to a tab that has been hidden for a minute, as far as its page can see.
_HIDE = """
() => {
  Object.defineProperty(document, "hidden", { configurable: true, get: () => true });
  window.setInterval = window.setTimeout = window.requestAnimationFrame = () => 0;
  for (let timer = 0; timer < 10000; timer++) { clearInterval(timer); clearTimeout(timer); }
}
"""


def test_a_page_whose_timers_are_held_back_while_it_is_hidden_is_not_forgotten(
    running: Running, chromium: Browser
) -> None:
    hidden = open_console(chromium, running.url)
    roles = running.console._roles  # pyright: ignore[reportPrivateUsage]
    hidden.wait_for_timeout(1500)
    client = max(running.server.get_clients())
    identity = roles._identities[client]  # pyright: ignore[reportPrivateUsage]
    hidden.evaluate(_HIDE)

    def last_seen() -> float:
        page = roles._control.page(identity)  # pyright: ignore[reportPrivateUsage]
        assert page is not None
        return page.last_seen

    seen: set[float] = set()
    wait_until(lambda: seen.add(last_seen()) or len(seen) > 4)
    hidden.context.close()

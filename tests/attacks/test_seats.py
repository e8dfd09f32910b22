"""Seats, identities and roles: nobody locks the others out, and nobody acts without the role."""

import http.client
from collections.abc import Callable
from urllib.parse import urlencode, urlsplit

import pytest

from higvf_console.core.commands import HandOver, Pick
from higvf_console.core.edits import AddEntity
from higvf_console.ui.page.access import Role
from higvf_console.ui.page.control_lease import MOST_PAGES
from higvf_console.ui.page.message_filter import settings_of
from tests.attacks.raw_page import Login, RawPage, log_in, said
from tests.attacks.watch import Watch
from tests.browser import wait_until
from tests.consoles import Running


def link_of(running: Running, role: Role) -> str:
    """A link that gives a role once."""
    access = settings_of(running.server).access
    assert access is not None
    return f"{running.url.partition('?')[0]}?{urlencode({'token': access.ticket(role)})}"


def test_sixteen_seats_asked_for_by_one_login(
    running: Running, honest: RawPage, login: Login, figure: Callable[[str], None]
) -> None:
    pages = [RawPage(running.url, login) for _ in range(16)]
    held = sum(page.status == 101 for page in pages)
    with RawPage(running.url) as other:
        assert other.status == 101
    for page in pages:
        page.close()
    figure(f"{held} of 16 seats")
    assert held == 8
    assert not honest.closed.is_set()


@pytest.mark.usefixtures("honest")
def test_sixty_four_identities_on_one_socket(running: Running, login: Login, figure: Callable[[str], None]) -> None:
    roles = running.console._roles  # pyright: ignore[reportPrivateUsage]
    before = len(roles._control.pages)  # pyright: ignore[reportPrivateUsage]
    with RawPage(running.url, login) as attacker:
        for number in range(64):
            attacker.hello(f"attacker number {number:02}")
        attacker.stop(1)
        wait_until(lambda: running.state.intent.stopped)
        known = len(roles._control.pages) - before  # pyright: ignore[reportPrivateUsage]
    figure(f"{known} identity")
    assert known == 1


def test_observers_that_fill_the_list_of_pages(
    running: Running, honest: RawPage, figure: Callable[[str], None]
) -> None:
    roles = running.console._roles  # pyright: ignore[reportPrivateUsage]
    observer = log_in(link_of(running, Role.OBSERVER))
    for number in range(MOST_PAGES + 6):
        with RawPage(running.url, observer) as page:
            identity = f"observer number {number}"
            page.hello(identity)
            wait_until(lambda identity=identity: roles._control.page(identity) is not None)  # pyright: ignore[reportPrivateUsage]
    with RawPage(running.url) as operator:
        operator.hello("a page that may steer")
        wait_until(lambda: roles._control.page("a page that may steer") is not None)  # pyright: ignore[reportPrivateUsage]
    figure(f"{len(roles._control.pages)} pages remembered")  # pyright: ignore[reportPrivateUsage]
    assert not honest.closed.is_set()


def test_an_observer_that_acts(running: Running, honest: RawPage, watch: Watch, figure: Callable[[str], None]) -> None:
    before = len(running.session.commands)
    with RawPage(link_of(running, Role.OBSERVER)) as observer:
        observer.hello("an observer, really")
        observer.send(said("control", act="take", page=""), said("control", act="ask", page=""))
        observer.send(said("key", name="pick_3", number=0), said("key", name="pause", number=0))
        observer.send(said("tool", name="robot"), said("click", point=(600.0, 300.0), group=False))
        observer.stop(1)
        wait_until(lambda: watch.stop_done is not None)
    given = [type(applied.command).__name__ for applied in list(running.session.commands)[before:]]
    figure(f"nothing but STOP, {watch.ticks_to_stop} ticks after it came")
    assert not {"Pause", "AddEntity", HandOver.__name__} & set(given)
    assert [c.robot for c in running.given(Pick) if isinstance(c, Pick)][-1:] != [2]
    assert not honest.closed.is_set()


@pytest.mark.parametrize("role", [Role.OPERATOR, Role.EXPERIMENTER])
def test_an_edit_needs_an_experimenter(
    role: Role, running: Running, honest: RawPage, figure: Callable[[str], None]
) -> None:
    before = len(running.given(AddEntity))
    with RawPage(link_of(running, role)) as page:
        page.hello(f"a page of an {role}")
        page.send(said("control", act="take", page=""), said("key", name="pick_1", number=0))
        wait_until(lambda: running.state.intent.influenced == 0)
        page.send(said("tool", name="circle"), said("click", point=(900.0, 600.0), group=False))
        page.send(said("key", name="pick_2", number=0))
        wait_until(lambda: running.state.intent.influenced == 1)
    made = len(running.given(AddEntity)) - before
    figure(f"{role}: {made} edits")
    assert made == (role is Role.EXPERIMENTER)
    honest.send(said("control", act="take", page=""))


def test_tokens_that_are_guessed(running: Running, honest: RawPage, figure: Callable[[str], None]) -> None:
    link = urlsplit(running.url)
    answers: list[int] = []
    for number in range(200):
        connection = http.client.HTTPConnection(link.netloc, timeout=60)
        connection.request("GET", f"/?token={number}")
        answers.append(connection.getresponse().status)
        connection.close()
    figure(f"{answers.count(401)} of 200 looked at")
    assert set(answers) == {401, 429}
    assert not honest.closed.is_set()

"""Roles, the tokens that give them, and logins that end when their token is revoked."""

from pathlib import Path

import pytest

from higvf_console.core.errors import ConsoleError
from higvf_console.ui.page import access as module
from higvf_console.ui.page.access import (
    MOST_LOGINS,
    MOST_TICKETS,
    SHORTEST_TOKEN,
    Access,
    Role,
    access_by,
    read_tokens,
)

TOKENS = {role: f"the-token-of-{role}" for role in Role}


class Socket:
    """A page that notes why it was closed."""

    def __init__(self) -> None:
        self.reason = ""

    def end(self, reason: str) -> None:
        self.reason = reason


def written(folder: Path, text: str, mode: int = 0o600) -> Path:
    file = folder / "tokens"
    file.write_text(text, encoding="utf-8")
    file.chmod(mode)
    return file


def test_each_role_may_do_what_those_before_it_may() -> None:
    assert Role.EXPERIMENTER.may(Role.OBSERVER) and Role.EXPERIMENTER.may(Role.EXPERIMENTER)
    assert Role.OPERATOR.may(Role.OBSERVER) and not Role.OPERATOR.may(Role.EXPERIMENTER)
    assert not Role.OBSERVER.may(Role.OPERATOR)


def test_a_token_gives_its_role_and_every_login_secrets_of_its_own() -> None:
    access = Access(TOKENS)
    logins = [access.log_in(token) for token in (*TOKENS.values(), TOKENS[Role.OBSERVER])]
    assert [login and login.role for login in logins] == [*Role, Role.OBSERVER]
    secrets = {secret for login in logins if login for secret in (login.cookie, login.key)}
    assert len(secrets) == 8
    assert all(login and access.login(login.cookie) is login for login in logins)
    assert access.log_in("wrong") is None
    assert access.log_in("") is None
    assert access.login("wrong") is None


def test_a_browser_that_opens_the_link_again_keeps_its_login_and_one_of_another_role_gets_a_new_one() -> None:
    access = Access(TOKENS)
    first = access.log_in(TOKENS[Role.OPERATOR])
    assert access.log_in(TOKENS[Role.OPERATOR], first) is first
    assert access.log_in(TOKENS[Role.OBSERVER], first) is not first
    assert access.log_in("wrong", first) is None


def test_a_ticket_logs_in_once() -> None:
    access = Access(TOKENS)
    ticket = access.ticket(Role.OPERATOR)
    first = access.log_in(ticket)
    assert first is not None and first.role is Role.OPERATOR
    assert access.log_in(ticket) is None


def test_so_many_tickets_are_open_at_once_and_the_oldest_goes() -> None:
    access = Access(TOKENS)
    tickets = [access.ticket(Role.OBSERVER) for _ in range(MOST_TICKETS + 1)]
    assert [access.log_in(ticket) is not None for ticket in tickets] == [False, *[True] * MOST_TICKETS]


def test_logins_are_bounded_and_one_with_pages_goes_last() -> None:
    access = Access(TOKENS)
    first = access.log_in(TOKENS[Role.OBSERVER])
    assert first is not None
    first.pages.add(Socket())
    second = access.log_in(TOKENS[Role.OBSERVER])
    assert second is not None
    for _ in range(MOST_LOGINS - 1):
        access.log_in(TOKENS[Role.OBSERVER])
    assert access.login(first.cookie) is first
    assert access.login(second.cookie) is None


def test_new_tokens_are_written_for_their_owner_alone_and_read_again(tmp_path: Path) -> None:
    file = tmp_path / "tokens"
    access = access_by(file)
    assert file.stat().st_mode & 0o777 == 0o600
    assert read_tokens(file) == {role: access.token(role) for role in Role}
    assert access_by(file).token(Role.OBSERVER) == access.token(Role.OBSERVER)
    assert access_by(None).token(Role.OBSERVER) != access_by(None).token(Role.OBSERVER)


def test_a_token_that_is_taken_out_of_the_file_ends_its_logins_and_theirs_alone(tmp_path: Path) -> None:
    file = tmp_path / "tokens"
    access = access_by(file)
    operator, observer = access.log_in(access.token(Role.OPERATOR)), access.log_in(access.token(Role.OBSERVER))
    assert operator is not None and observer is not None
    page = Socket()
    operator.pages.add(page)
    written(tmp_path, f"observer {access.token(Role.OBSERVER)}\noperator another-token-of-it\n")
    access.refresh()
    assert "revoked" in page.reason
    assert access.login(operator.cookie) is None
    assert access.login(observer.cookie) is observer
    assert access.log_in("another-token-of-it") is not None


def test_a_file_of_tokens_is_read_again_when_it_has_changed_and_then_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    access = access_by(tmp_path / "tokens")
    old, read = access.token(Role.OPERATOR), list[Path]()

    def noted(file: Path) -> dict[Role, str]:
        read.append(file)
        return read_tokens(file)

    monkeypatch.setattr(module, "read_tokens", noted)
    access.refresh()
    assert not read
    written(tmp_path, f"operator {'t' * SHORTEST_TOKEN}\n")
    for _ in range(3):
        access.refresh()
    assert len(read) == 1
    assert access.log_in(old) is None
    assert access.log_in("t" * SHORTEST_TOKEN) is not None


def test_a_file_that_cannot_be_read_while_it_is_written_changes_nothing(tmp_path: Path) -> None:
    file = tmp_path / "tokens"
    access = access_by(file)
    login = access.log_in(access.token(Role.OPERATOR))
    written(tmp_path, "oper")
    access.refresh()
    assert login is not None and access.login(login.cookie) is login


@pytest.mark.parametrize(
    ("text", "mode", "message"),
    [
        ("operator 0123456789abcdef\n", 0o644, "others may read it .mode 644.; run: chmod 600"),
        ("admin 0123456789abcdef\n", 0o600, "line 1: no role 'admin'; roles: observer, operator, experimenter"),
        ("# of us\noperator short\n", 0o600, "line 2: a token has at least 12 characters"),
        ("operator two words are none\n", 0o600, "line 1: a token has"),
        ("operator 0123456789abcdef\nobserver 0123456789abcdef\n", 0o600, "line 2: observer repeats"),
        ("\n", 0o600, "holds no token"),
        ("operator \xff", 0o600, "line 1: a token has"),
    ],
)
def test_a_file_that_holds_something_else_is_refused_with_its_line(
    tmp_path: Path, text: str, mode: int, message: str
) -> None:
    with pytest.raises(ConsoleError, match=message):
        access_by(written(tmp_path, text, mode))


def test_a_file_that_cannot_be_written_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ConsoleError, match=r"--token-file .*cannot be written"):
        access_by(tmp_path / "none" / "tokens")

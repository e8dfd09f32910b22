"""Who may do what: roles, the tokens that give them, and the logins that hold them.

A token gives a role. Whoever opens the link with it gets a login: a cookie, and a key that the page keeps for itself.
Every request needs the cookie; a page's socket needs the key too, since a browser sends the cookie to every server of
this host, whatever its port. A login ends when its token is revoked.
"""

import hmac
import os
import re
import secrets
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Protocol

from higvf_console.core.errors import ConsoleError

MOST_LOGINS = 256
MOST_TICKETS = 16
SHORTEST_TOKEN = 12  # characters
_TOKEN = re.compile(r"[^\s]+")


class Role(StrEnum):
    """What a login may do; each role may do what those before it may."""

    OBSERVER = "observer"  # sees everything, and presses STOP
    OPERATOR = "operator"  # steers
    EXPERIMENTER = "experimenter"  # edits, tunes, loads, and injects faults

    def may(self, other: "Role") -> bool:
        """Whether this role may do what `other` may."""
        order = list(Role)
        return order.index(self) >= order.index(other)


class Closable(Protocol):
    """A page's socket, from any thread."""

    def end(self, reason: str) -> None:
        """Closes it."""
        ...


@dataclass(eq=False)
class Login:
    """Of one browser.

    Attributes:
        role: what its pages may do.
        token: that gave it.
        cookie: secret that the browser sends with every request.
        key: secret that its pages send when they open a socket.
        pages: its open sockets.
    """

    role: Role
    token: str
    cookie: str = field(default_factory=lambda: secrets.token_urlsafe(24))
    key: str = field(default_factory=lambda: secrets.token_urlsafe(24))
    pages: set[Closable] = field(default_factory=set[Closable])


class Access:
    """Tokens and logins of a console."""

    def __init__(self, tokens: Mapping[Role, str], file: Path | None = None) -> None:
        """Starts with nobody logged in.

        Args:
            tokens: of each role that can be had.
            file: that holds them; it is read again when it has changed.

        Raises:
            ConsoleError: there is no token, or one is empty.
        """
        if not tokens or not all(tokens.values()):
            raise ConsoleError("token: '' would let anyone in; give a secret, e.g. from `guard.new_token()`")
        self._tokens, self._file = dict(tokens), file
        self._changed = _stamp(file)
        self._logins: dict[str, Login] = {}
        self._tickets: dict[str, Role] = {}

    def token(self, role: Role) -> str:
        """The token of a role; ConsoleError where there is none."""
        if role not in self._tokens:
            raise ConsoleError(f"role {role} has no token; roles with one: {', '.join(self._tokens)}")
        return self._tokens[role]

    @property
    def roles(self) -> tuple[Role, ...]:
        """Those that have a token, the least first."""
        return tuple(role for role in Role if role in self._tokens)

    @property
    def highest(self) -> Role:
        """The role that may most."""
        return self.roles[-1]

    def ticket(self, role: Role) -> str:
        """A token that logs in once."""
        if len(self._tickets) >= MOST_TICKETS:
            del self._tickets[next(iter(self._tickets))]
        ticket = secrets.token_urlsafe(18)
        self._tickets[ticket] = role
        return ticket

    def log_in(self, token: str, before: Login | None = None) -> Login | None:
        """A login by a token or a ticket; None where it is neither.

        Args:
            token: or ticket.
            before: that the browser has already; it goes on where its role is the same, since pages may be open by it.
        """
        ticket = next((ticket for ticket in self._tickets if same(token, ticket)), "")
        role = self._tickets.pop(ticket, None)
        if role is None:
            role = next((role for role, known in self._tokens.items() if same(token, known)), None)
        if role is None or role not in self._tokens:
            return None
        if before is not None and before.role is role:
            return before
        if len(self._logins) >= MOST_LOGINS:
            idle = next((cookie for cookie, login in self._logins.items() if not login.pages), "")
            self._logins.pop(idle or next(iter(self._logins)))
        login = Login(role, self._tokens[role])
        self._logins[login.cookie] = login
        return login

    def login(self, cookie: str) -> Login | None:
        """The login of a cookie, if it holds."""
        return next((login for known, login in self._logins.items() if same(cookie, known)), None)

    def log_out(self, login: Login, reason: str) -> None:
        """Ends a login, and closes its pages."""
        self._logins.pop(login.cookie, None)
        for page in list(login.pages):
            page.end(reason)

    def refresh(self) -> None:
        """Reads the file of tokens again if it has changed, and ends the logins whose token is no more."""
        stamp = _stamp(self._file)
        if self._file is None or stamp is None or stamp == self._changed:
            return
        self._changed = stamp
        with suppress(ConsoleError):  # a file that is being written: the tokens stay until it can be read
            self._tokens = read_tokens(self._file)
        for login in list(self._logins.values()):
            if self._tokens.get(login.role) != login.token:
                self.log_out(login, "this login was revoked; open the console by its new link")


def access_by(file: Path | None) -> Access:
    """Tokens out of a file; new ones for every role where there is none, written into it.

    Args:
        file: one line per role, "ROLE TOKEN", which nobody else may read; None = the tokens are kept nowhere.

    Raises:
        ConsoleError: the file cannot be read or written, is open to others, or holds something else.
    """
    if file is not None and file.exists():
        return Access(read_tokens(file), file)
    tokens = {role: secrets.token_urlsafe(18) for role in Role}
    if file is not None:
        try:
            number = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            with os.fdopen(number, "w", encoding="utf-8") as out:
                out.writelines(f"{role} {token}\n" for role, token in tokens.items())
        except OSError as error:
            raise ConsoleError(f"--token-file {file}: cannot be written ({error.strerror})") from error
    return Access(tokens, file)


def read_tokens(file: Path) -> dict[Role, str]:
    """The tokens in a file; errors as for `access_by`."""
    where = f"--token-file {file}"
    try:
        mode, text = file.stat().st_mode & 0o777, file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ConsoleError(f"{where}: cannot be read ({getattr(error, 'strerror', None) or error})") from error
    if mode & 0o077:
        raise ConsoleError(f"{where}: others may read it (mode {mode:o}); run: chmod 600 {file}")
    tokens: dict[Role, str] = {}
    for number, line in enumerate(text.splitlines(), 1):
        role, _, token = line.strip().partition(" ")
        if not role or role.startswith("#"):
            continue
        if role not in list(Role):
            raise ConsoleError(f"{where}, line {number}: no role {role[:20]!r}; roles: {', '.join(Role)}")
        if len(token) < SHORTEST_TOKEN or not _TOKEN.fullmatch(token):
            raise ConsoleError(
                f"{where}, line {number}: a token has at least {SHORTEST_TOKEN} characters and no space; "
                'make one by: python -c "import secrets; print(secrets.token_urlsafe())"'
            )
        if role in tokens or token in tokens.values():
            raise ConsoleError(f"{where}, line {number}: {role} repeats a role or a token of a line above")
        tokens[Role(role)] = token
    if not tokens:
        raise ConsoleError(f"{where}: holds no token; one line per role, 'ROLE TOKEN', roles: {', '.join(Role)}")
    return tokens


def same(given: str, expected: str) -> bool:
    """Whether two secrets are the same, in a time that tells nothing about them."""
    return hmac.compare_digest(given.encode(errors="replace"), expected.encode())


def _stamp(file: Path | None) -> tuple[int, int] | None:
    if file is None:
        return None
    with suppress(OSError):
        stat = file.stat()
        return stat.st_mtime_ns, stat.st_size
    return None

"""What the team `mqtt` is opened with: address of the broker, names of the robots, units, account.

--team mqtt=mqtt://127.0.0.1:1883:prefix=lab,names=anna+bob,stamp=sent,auth=broker.txt
"""

import re
from pathlib import Path
from typing import Annotated as A  # noqa: N817 (a table needs narrow columns)
from typing import NamedTuple
from urllib.parse import urlsplit

from higvf_console.core.arguments import one_of
from higvf_console.core.errors import InputError
from higvf_console.core.quantity import Quantity as Q  # noqa: N817
from higvf_console.core.team import TeamSpec, options_of

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}  # [m]
ANGLES = ("rad", "deg")
STAMPS = ("received", "sent")
PORTS = {"mqtt": 1883, "mqtts": 8883}
CONSOLE = "console"  # no robot's name: topics of consoles
_FORM = "give mqtt://HOST, mqtt://HOST:PORT, or mqtts:// for TLS, e.g. mqtt://127.0.0.1:1883"
_TOPIC = re.compile(r"[\w.-]+(/[\w.-]+)*")
_NAME = re.compile(r"[\w.-]+")


class MqttOptions(NamedTuple):
    """What its options mean."""

    prefix: A[str, "Where the topics are: PREFIX/ROBOT/cmd, /pose and /ack, and PREFIX/stop."] = "robots"
    names: A[str, "Names of the robots in the topics, joined by +; none = 1, 2, 3 and so on."] = ""
    unit: A[str, "Of the poses: m, cm or mm."] = "m"
    angle: A[str, "Of the headings: rad or deg."] = "rad"
    stamp: A[str, "When a pose was measured: 'received' = on arrival; 'sent' = by its t, from a clock of its own."] = (
        "received"
    )
    delay_s: A[float, Q("s", 0.0, 1.0, "", "Least age of a pose when it arrives.")] = 0.0
    rate_hz: A[float, Q("Hz", 10.0, 100.0, "", "Commands a second to each robot, at most.")] = 30.0
    auth: A[str, "File with the lines 'username NAME' and 'password SECRET', which nobody else may read."] = ""
    ca: A[str, "File with the certificates (PEM) to trust with mqtts://; none = those of the system."] = ""


class Broker(NamedTuple):
    """Where a broker is and how to log in; `username` "" = without an account."""

    host: str
    port: int
    tls: bool = False
    ca: str = ""
    username: str = ""
    password: str = ""

    @property
    def place(self) -> str:
        """How an error calls it, without the account."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{'mqtts' if self.tls else 'mqtt'}://{host}:{self.port}"


class MqttSettings(NamedTuple):
    """All that a team is opened with, checked; one of `names` for each robot."""

    broker: Broker
    options: MqttOptions
    names: tuple[str, ...]


def settings_of(spec: TeamSpec) -> MqttSettings:
    """Address and options of a team, checked.

    Raises:
        InputError: one of them cannot be used.
    """
    broker = broker_of(spec.address, f"--team {spec.name}")  # first: an address that holds a password is not shown
    options = options_of(spec, MqttOptions)
    for name, choices in (("unit", tuple(UNITS)), ("angle", ANGLES), ("stamp", STAMPS)):
        one_of(f"{spec.place}: {name}", getattr(options, name), choices, InputError)
    if not _TOPIC.fullmatch(options.prefix):
        raise InputError(f"{spec.place}: prefix: {options.prefix!r} is no topic; use letters, digits, . _ - and /")
    if options.ca and not broker.tls:
        raise InputError(f"{spec.place}: ca={options.ca} is for TLS: give mqtts:// instead of mqtt://")
    if options.auth:
        username, password = read_account(Path(options.auth), f"{spec.place}: auth={options.auth}")
        broker = broker._replace(username=username, password=password)
    return MqttSettings(broker._replace(ca=options.ca), options, _names(options.names, spec))


def broker_of(address: str, place: str) -> Broker:
    """The broker at `mqtt://HOST:PORT` or `mqtts://HOST:PORT`; without a port, the usual one.

    Raises:
        InputError: it is not of that form, or holds an account; `place` begins the message.
    """
    try:
        parts = urlsplit(address)
        host, port = parts.hostname or "", parts.port
    except ValueError as problem:
        raise InputError(f"{place}: the address has no usable host and port ({problem}); {_FORM}") from problem
    if "@" in parts.netloc:
        raise InputError(f"{place}: no account in the address, which others can see; put it into a file: auth=FILE")
    if parts.scheme not in PORTS or not host or port == 0 or parts.path.strip("/") or parts.query or parts.fragment:
        raise InputError(f"{place}: {address!r} is not the address of a broker; {_FORM}")
    return Broker(host, port or PORTS[parts.scheme], parts.scheme == "mqtts")


def read_account(file: Path, place: str) -> tuple[str, str]:
    """Name and password of an account, from a file that nobody else may read.

    Raises:
        InputError: the file cannot be read, is open to others, or has other lines; its content is not shown.
    """
    try:
        mode, text = file.stat().st_mode & 0o777, file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as problem:
        raise InputError(f"{place}: cannot be read ({getattr(problem, 'strerror', None) or problem})") from problem
    if mode & 0o077:
        raise InputError(f"{place}: others may read it (mode {mode:o}); run: chmod 600 {file}")
    found: dict[str, str] = {}
    for number, line in enumerate(text.splitlines(), 1):
        key, _, value = line.strip().partition(" ")
        if not key or key.startswith("#"):
            continue
        if key not in ("username", "password") or not value or key in found:
            raise InputError(f"{place}, line {number}: give one line 'username NAME' and one 'password SECRET'")
        found[key] = value
    if "username" not in found:
        raise InputError(f"{place}: the line 'username NAME' is missing")
    return found["username"], found.get("password", "")


def _names(text: str, spec: TeamSpec) -> tuple[str, ...]:
    if not text:
        return tuple(str(robot + 1) for robot in range(spec.robots))
    names = tuple(text.split("+"))
    for name in names:
        if not _NAME.fullmatch(name) or name == CONSOLE or names.count(name) > 1:
            why = "is given twice" if names.count(name) > 1 else "is no robot's name"
            raise InputError(f"{spec.place}: names: {name!r} {why}; use letters, digits, . _ -, joined by +")
    if len(names) != spec.robots:
        raise InputError(f"{spec.place}: names: {len(names)} names for the {spec.robots} robots of the scenario")
    return names

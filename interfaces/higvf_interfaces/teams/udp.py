"""`--team udp=udp://HOST:PORT`: robots behind one UDP port, with a JSON datagram for each robot and each direction.

    to a robot    {"robot": 1, "n": 7, "v": 0.1, "w": 0.2, "valid_s": 0.3, "at": 12.30}
    from a robot  {"robot": 1, "id": "serial 17", "t": 12.31, "x": 0.6, "y": 1.0, "theta": 0.0, "n": 7, "battery": 0.8}

Metres, radians, seconds; robots count from 1; robots that move any way hear "vx" and "vy" instead. `n` numbers the
commands, and comes back as that of the latest command that the robot obeys. A robot reports at 20 Hz or more to whoever
has sent the last datagram. It stands when a command has expired (`valid_s`) without another one: that is its own duty,
for nobody can tell it when the console is dead. `id`, where given, tells two robots apart that have one number.

UDP has no sender that could be trusted: use it on the loopback or on a network of the robots alone.
"""

import json
import math
import select
import socket
import time
from collections.abc import Mapping
from contextlib import suppress
from threading import Lock, Thread
from typing import Annotated as A  # noqa: N817 (a table needs narrow columns)
from typing import Any, NamedTuple
from urllib.parse import urlsplit

from higvf_console.core.errors import InputError
from higvf_console.core.quantity import Quantity as Q  # noqa: N817
from higvf_console.core.team import Drive, Poses, RobotLink, TeamSpec, never_seen, options_of, standing

_WAIT = 0.1  # of the thread for a datagram, after which it sees whether it shall end [s]
_LARGEST = 2048  # datagram [bytes]
_TWINS = 1.0  # within which reports of two senders are those of two robots with one number [s]


class UdpOptions(NamedTuple):
    """What its options mean."""

    stamp: str = "received"  # or "sent": "t" is a time of this machine's monotonic clock
    silent_s: A[float, Q("s", 0.1, 10.0, "", "Silence of a robot after which its link counts as broken.")] = 0.3


class _Heard(NamedTuple):
    """What one robot has told last."""

    at: float = -math.inf
    sender: str = ""
    twin_at: float = -math.inf
    twin: str = ""
    acknowledged: int = 0
    battery: float = math.nan


class UdpTeam:
    """N robots behind one UDP port."""

    name = "udp"

    def __init__(self, spec: TeamSpec) -> None:
        """Listens from now on.

        Raises:
            InputError: address or an option cannot be used.
        """
        self._options = options_of(spec, UdpOptions)
        if self._options.stamp not in ("received", "sent"):
            raise InputError(f"{spec.place}: stamp={self._options.stamp}: choose 'received' or 'sent'")
        self._robots, self._any_way = spec.robots, spec.look_ahead == 0.0
        self._socket = _connected(spec)
        self._lock, self._ends = Lock(), False
        self._poses, self._heard = never_seen(spec.robots), [_Heard()] * spec.robots
        self._number, self._malformed = 0, 0
        self._asked_at = math.inf  # when the robots were first sent something, and could answer [s]
        self._thread = Thread(target=self._listen, name="udp team", daemon=True)
        self._thread.start()

    def poses(self, now: float) -> Poses:  # noqa: ARG002
        """The newest pose of each robot."""
        with self._lock:
            return Poses(*(part.copy() for part in self._poses))

    def drive(self, command: Drive, now: float) -> None:
        """Sends each robot its command."""
        self._number, self._asked_at = command.number, min(self._asked_at, now)
        for k in range(self._robots):
            if self._any_way:
                does = {"vx": float(command.velocity[k, 0]), "vy": float(command.velocity[k, 1])}
            else:
                does = {"v": float(command.forward[k]), "w": float(command.turn[k])}
            told = {"robot": k + 1, "n": command.number, **does, "valid_s": command.valid_for, "at": now}
            with suppress(OSError):  # nobody is there, or the network is full: `links` tells the silence
                self._socket.send(json.dumps(told).encode())

    def stop(self, now: float) -> None:
        """Sends zeros, with the number of the last command."""
        self.drive(standing(self._robots, self._number), now)

    def links(self, now: float) -> tuple[RobotLink, ...]:
        """A robot that is silent, or whose number another one has too, has a broken link."""
        with self._lock:
            heard, malformed = tuple(self._heard), self._malformed
        return tuple(self._link(one, now, malformed) for one in heard)

    def close(self) -> None:
        """Listens no more."""
        self._ends = True
        self._thread.join(1.0)
        self._socket.close()

    def _link(self, heard: _Heard, now: float, malformed: int) -> RobotLink:
        acknowledged = heard.acknowledged if heard.acknowledged <= self._number else 0  # of an earlier console
        if now - heard.twin_at < _TWINS:
            detail = f"two robots have its number: '{heard.sender}' and '{heard.twin}'"
            return RobotLink(acknowledged, heard.battery, False, detail)
        silent = now - max(heard.at, self._asked_at)
        if silent > self._options.silent_s:
            return RobotLink(acknowledged, heard.battery, False, f"silent for {silent:.1f} s")
        return RobotLink(acknowledged, heard.battery, True, f"{malformed} malformed datagrams" if malformed else "")

    def _listen(self) -> None:
        while not self._ends:
            try:
                if not select.select([self._socket], [], [], _WAIT)[0]:
                    continue
                text = self._socket.recv(_LARGEST)
            except OSError:  # nobody hears there: the next command is sent all the same
                time.sleep(_WAIT)
                continue
            try:
                self._take(json.loads(text), time.monotonic())
            except (
                ValueError,
                TypeError,
                KeyError,
                AttributeError,
                OverflowError,
                RecursionError,
            ):  # whatever was sent
                with self._lock:
                    self._malformed += 1

    def _take(self, report: Mapping[str, Any], now: float) -> None:
        """Takes in a report; whatever it raises makes it malformed."""
        k = int(report["robot"]) - 1
        if not 0 <= k < self._robots:
            raise ValueError(f"no robot {k + 1}")
        sender, acknowledged = str(report.get("id", ""))[:40], int(report.get("n", -1))
        battery = float(report.get("battery", math.nan))
        pose = None
        if "x" in report:
            at = now if self._options.stamp == "received" else float(report["t"])
            pose = float(report["x"]), float(report["y"]), float(report.get("theta", math.nan)), at
        with self._lock:
            known = self._heard[k]
            if sender != known.sender and now - known.at < _TWINS:
                self._heard[k] = known._replace(twin_at=now, twin=sender)
                return
            self._heard[k] = known._replace(at=now, sender=sender, acknowledged=acknowledged, battery=battery)
            if pose is not None and not pose[3] < self._poses.measured_at[k] <= now:  # overtaken on its way
                self._poses.position[k], self._poses.heading[k] = pose[:2], pose[2]
                self._poses.measured_at[k] = pose[3]


def _connected(spec: TeamSpec) -> socket.socket:
    form = f"{spec.place}: give udp://HOST:PORT, e.g. udp://127.0.0.1:9000"
    try:
        parts = urlsplit(spec.address)
        host, port = parts.hostname, parts.port
    except ValueError as problem:
        raise InputError(form) from problem
    if parts.scheme != "udp" or host is None or port is None or parts.path:
        raise InputError(form)
    try:
        family, kind, protocol, _, where = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
        found = socket.socket(family, kind, protocol)
        found.setblocking(False)
        found.connect(where)
    except OSError as problem:
        raise InputError(f"{spec.place}: cannot be reached: {problem.strerror}") from problem
    return found


def open_udp(spec: TeamSpec) -> UdpTeam:
    """Entry point `udp`.

    Raises:
        InputError: address or an option cannot be used.
    """
    return UdpTeam(spec)

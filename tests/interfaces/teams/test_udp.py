"""Robots behind a UDP port: what they hear, what is believed of what they say, and silence."""

import json
import math
import socket
import time
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_console.core.team import Drive, TeamSpec
from higvf_interfaces.teams.udp import UdpTeam, open_udp

PATIENCE = 10.0  # [s]


class Robots:
    """Two robots that say what a test wants."""

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.settimeout(PATIENCE)
        self.port: int = self._socket.getsockname()[1]

    def hear(self) -> dict[str, object]:
        text, self._console = self._socket.recvfrom(4096)
        return json.loads(text)

    def say(self, text: bytes | None = None, **report: object) -> None:
        self._socket.sendto(json.dumps(report).encode() if text is None else text, self._console)

    def close(self) -> None:
        self._socket.close()


def spec_of(robots: Robots, **options: str) -> TeamSpec:
    return TeamSpec("udp", f"udp://127.0.0.1:{robots.port}", options, robots=2, look_ahead=0.02)


def command(number: int) -> Drive:
    return Drive(number, np.zeros((2, 2)), np.array([0.1, 0.0]), np.array([0.0, -1.0]))


@pytest.fixture
def robots() -> Iterator[Robots]:
    made = Robots()
    yield made
    made.close()


@pytest.fixture
def team(robots: Robots) -> Iterator[UdpTeam]:
    made = open_udp(spec_of(robots, stamp="sent"))
    made.drive(command(5), time.monotonic())
    yield made
    made.close()


def wait(until: Callable[[], bool]) -> None:
    end = time.monotonic() + PATIENCE
    while not until():
        assert time.monotonic() < end
        time.sleep(0.005)


def test_each_robot_hears_its_own_command_and_what_it_says_comes_back(robots: Robots, team: UdpTeam) -> None:
    first, second = robots.hear(), robots.hear()
    assert (first["robot"], first["n"], first["v"], first["w"], first["valid_s"]) == (1, 5, 0.1, 0.0, 0.3)
    assert (second["robot"], second["v"], second["w"]) == (2, 0.0, -1.0)
    robots.say(robot=2, t=3.5, x=1.0, y=2.0, theta=0.5, n=5, battery=0.25)
    wait(lambda: bool(np.isfinite(team.poses(0.0).measured_at[1])))
    poses, now = team.poses(0.0), time.monotonic()
    assert (poses.position[1].tolist(), poses.heading[1], poses.measured_at[1]) == ([1.0, 2.0], 0.5, 3.5)
    assert np.isnan(poses.position[0]).all()
    assert (team.links(now)[1].acknowledged, team.links(now)[1].battery) == (5, 0.25)


def test_a_confirmation_for_an_earlier_console_counts_for_nothing(robots: Robots, team: UdpTeam) -> None:
    robots.hear()
    robots.say(robot=1, n=5000, battery=0.5)
    wait(lambda: team.links(time.monotonic())[0].battery == 0.5)
    assert team.links(time.monotonic())[0].acknowledged == 0


def test_a_silent_robot_has_a_broken_link(robots: Robots, team: UdpTeam) -> None:
    robots.hear()
    robots.say(robot=1, n=5, battery=0.5)
    wait(lambda: team.links(time.monotonic())[0].battery == 0.5)
    link = team.links(time.monotonic() + 1.0)[0]
    assert not link.connected
    assert link.detail.startswith("silent for")


def test_two_robots_with_one_number_are_told_and_the_second_is_not_believed(robots: Robots, team: UdpTeam) -> None:
    robots.hear()
    robots.say(robot=1, id="a", t=1.0, x=1.0, y=1.0, theta=0.0)
    robots.say(robot=1, id="b", t=1.1, x=2.0, y=2.0, theta=0.0)
    wait(lambda: "two robots" in team.links(time.monotonic())[0].detail)
    link = team.links(time.monotonic())[0]
    assert (link.connected, link.detail) == (False, "two robots have its number: 'a' and 'b'")
    assert team.poses(0.0).position[0].tolist() == [1.0, 1.0]


def test_a_pose_that_was_overtaken_changes_nothing_but_one_after_a_stamp_from_the_future_does(
    robots: Robots, team: UdpTeam
) -> None:
    robots.hear()
    now = time.monotonic()
    for t, x in ((now - 1.0, 1.0), (now - 2.0, 2.0), (now + 1e4, 3.0), (now - 0.5, 4.0)):
        robots.say(robot=1, t=t, x=x, y=0.0, theta=0.0)
        robots.say(robot=2, n=1, battery=x / 10.0)
        wait(lambda x=x: team.links(time.monotonic())[1].battery == x / 10.0)
        assert team.poses(0.0).position[0, 0] == {1.0: 1.0, 2.0: 1.0, 3.0: 3.0, 4.0: 4.0}[x]


@pytest.mark.parametrize(
    "text", [b"", b"{", b"[]", b"3", b'{"robot": 9}', b'{"robot": 1e999}', b'{"robot": 1, "x": "east"}', b"[" * 2000]
)
def test_what_cannot_be_read_is_counted_and_told(robots: Robots, team: UdpTeam, text: bytes) -> None:
    robots.hear()
    robots.say(text)
    robots.say(robot=2, n=5, battery=0.5)
    wait(lambda: team.links(time.monotonic())[1].battery == 0.5)
    assert team.links(time.monotonic())[1].detail == "1 malformed datagrams"


def test_a_pose_that_is_no_number_is_left_to_the_console_to_refuse(robots: Robots, team: UdpTeam) -> None:
    robots.hear()
    robots.say(robot=1, t=2.0, x=math.nan, y=0.0, theta=0.0)
    wait(lambda: bool(team.poses(0.0).measured_at[0] == 2.0))
    assert math.isnan(team.poses(0.0).position[0, 0])


@pytest.mark.parametrize(
    "address", ["", "127.0.0.1:9", "udp://127.0.0.1", "tcp://127.0.0.1:9", "udp://[::1", "udp://h:9/x"]
)
def test_another_address_is_refused_with_an_example(address: str) -> None:
    with pytest.raises(InputError, match=r"give udp://HOST:PORT, e\.g\. udp://127"):
        open_udp(TeamSpec("udp", address))


def test_a_stamp_of_another_kind_is_refused_with_the_choices(robots: Robots) -> None:
    with pytest.raises(InputError, match="stamp=mine: choose 'received' or 'sent'"):
        open_udp(spec_of(robots, stamp="mine"))

"""What the team `mqtt` is opened with and what its messages mean, without a broker."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_console.core.team import Drive, TeamSpec
from higvf_console.core.viewport import Arena
from higvf_interfaces.teams.mqtt_messages import LONGEST, MessageError, ack_of, command_payload, pose_of
from higvf_interfaces.teams.mqtt_options import broker_of, settings_of
from higvf_interfaces.teams.sender_clock import AHEAD, DOUBTED_FOR, WINDOW, SenderClock

ARENA = Arena(0.0, 0.0, 3.2, 2.0)


def payload(**values: object) -> bytes:
    return json.dumps(values).encode()


@pytest.mark.parametrize(
    ("address", "host", "port", "tls"),
    [
        ("mqtt://127.0.0.1", "127.0.0.1", 1883, False),
        ("mqtt://127.0.0.1:1900", "127.0.0.1", 1900, False),
        ("mqtts://lab.example", "lab.example", 8883, True),
        ("mqtt://[::1]:1883", "::1", 1883, False),
    ],
)
def test_an_address_names_host_port_and_tls(address: str, host: str, port: int, tls: bool) -> None:
    assert broker_of(address, "--team mqtt")[:3] == (host, port, tls)


@pytest.mark.parametrize(
    "address", ["", "127.0.0.1:1883", "http://lab", "mqtt://", "mqtt://lab:0", "mqtt://lab:70000", "mqtt://lab/robots"]
)
def test_another_address_is_refused_in_one_line_that_shows_the_form(address: str) -> None:
    with pytest.raises(InputError, match=r"give mqtt://HOST, .*e\.g\. mqtt://127\.0\.0\.1:1883$"):
        broker_of(address, "--team mqtt")


def test_an_account_in_the_address_is_refused_and_not_repeated() -> None:
    with pytest.raises(InputError, match="auth=FILE") as refused:
        settings_of(TeamSpec("mqtt", "mqtt://me:secret@lab"))
    assert "secret" not in str(refused.value)


def test_an_account_comes_from_a_file_that_nobody_else_may_read(tmp_path: Path) -> None:
    file = tmp_path / "broker.txt"
    file.write_text("# of the lab\nusername anna\npassword two words\n")
    file.chmod(0o644)
    spec = TeamSpec("mqtt", "mqtt://lab", {"auth": str(file)})
    with pytest.raises(InputError, match="others may read it"):
        settings_of(spec)
    file.chmod(0o600)
    broker = settings_of(spec).broker
    assert (broker.username, broker.password) == ("anna", "two words")
    file.write_text("username anna\nsecret\n")
    with pytest.raises(InputError, match="line 2: give one line 'username NAME'") as refused:
        settings_of(spec)
    assert "secret" not in str(refused.value)


@pytest.mark.parametrize(
    ("options", "why"),
    [
        ({"unit": "inch"}, "unit"),
        ({"stamp": "now"}, "stamp"),
        ({"prefix": "a/+"}, "prefix: 'a/\\+' is no topic"),
        ({"names": "a+a"}, "'a' is given twice"),
        ({"names": "a+console"}, "'console' is no robot's name"),
        ({"names": "a+b+c"}, "3 names for the 2 robots"),
        ({"rate_hz": "5"}, "10 to 100 Hz"),
        ({"ca": "lab.pem"}, "give mqtts:// instead"),
        ({"prefx": "a"}, "did you mean 'prefix'"),
    ],
)
def test_an_option_that_cannot_be_used_is_named(options: dict[str, str], why: str) -> None:
    with pytest.raises(InputError, match=why):
        settings_of(TeamSpec("mqtt", "mqtt://lab", options, robots=2))


def test_a_command_has_the_motion_of_its_kind_of_robot() -> None:
    drive = Drive(7, np.array([[0.1, -0.2], [0.3, 0.0]]), np.array([0.4, 0.5]), np.array([1.0, -1.0]), 0.3)
    assert json.loads(command_payload(drive, 1, has_heading=True)) == {"v": 0.5, "w": -1.0, "n": 7, "valid_s": 0.3}
    assert json.loads(command_payload(drive, 0, has_heading=False)) == {"vx": 0.1, "vy": -0.2, "n": 7, "valid_s": 0.3}


def test_units_are_converted() -> None:
    pose = pose_of(payload(x=1200, y=400, theta=90), ARENA, "mm", "deg", has_heading=True)
    assert pose[:3] == pytest.approx((1.2, 0.4, math.pi / 2))


@pytest.mark.parametrize(
    ("raw", "why"),
    [
        (b"{", "not JSON"),
        (b"[" * LONGEST, "not JSON"),
        (b"\xff\xfe", "not JSON"),
        (b"[1, 2]", "not an object"),
        (b" " * (LONGEST + 1), "at most"),
        (payload(x=1, y=1), "theta: None is not a number"),
        (payload(x="1", y=1, theta=0), "x: '1' is not a number"),
        (payload(x=True, y=1, theta=0), "x: True is not a number"),
        (payload(x=1200, y=400, theta=0), "another unit or frame"),
        (payload(x=1, y=1, theta=90), "more than a turn in rad"),
        (payload(x=1, y=1, theta=0, t=10**15), "t: 1000000000000000 is too large"),
        (payload(x=1, y=1, theta=0, id="a" * 100), "id: .* is not a short text"),
    ],
)
def test_a_message_that_is_no_pose_is_refused_with_the_reason(raw: bytes, why: str) -> None:
    with pytest.raises(MessageError, match=why):
        pose_of(raw, ARENA, has_heading=True)


def test_numbers_that_are_none_pass_so_that_the_console_reports_them() -> None:
    pose = pose_of(b'{"x": NaN, "y": Infinity, "theta": 1e999}', ARENA, has_heading=True)
    assert all(math.isnan(value) for value in pose[:3])


@pytest.mark.parametrize(
    ("raw", "why"),
    [
        (payload(n=9), "n: 9 is not the number of a command, 0 to 8"),
        (payload(n=-1), "n: -1"),
        (payload(n=1.5), "n: 1.5"),
        (payload(battery=0.5), "n: None"),
        (payload(n=1, battery=80), "battery: 80 is not a share"),
    ],
)
def test_a_confirmation_of_what_was_not_sent_is_refused(raw: bytes, why: str) -> None:
    with pytest.raises(MessageError, match=why):
        ack_of(raw, 8)


def test_stamps_are_shifted_by_the_fastest_message() -> None:
    clock = SenderClock(delay=0.01)
    delays = (0.08, 0.02, 0.05, 0.02, 0.3)
    times = [clock.time(1000.0 + 0.02 * k, 5.0 + 0.02 * k + delay) for k, delay in enumerate(delays)]
    ages = [5.0 + 0.02 * k + delay - time for (k, delay), time in zip(enumerate(delays), times, strict=True)]
    assert ages == pytest.approx([0.01, 0.01, 0.04, 0.01, 0.29])


def test_one_stamp_from_the_future_stays_there_and_changes_nothing() -> None:
    clock = SenderClock()
    assert clock.time(100.0, 5.0) == 5.0
    assert clock.time(160.0, 5.02) == pytest.approx(65.0)
    assert clock.time(100.04, 5.04) == pytest.approx(5.04)


def test_a_clock_that_was_set_forward_is_believed_after_a_while() -> None:
    clock = SenderClock()
    clock.time(100.0, 5.0)
    late = [clock.time(160.0 + k / 50, 5.0 + k / 50) - (5.0 + k / 50) for k in range(1, round(DOUBTED_FOR * 50) + 3)]
    assert min(late[:40]) > AHEAD
    assert late[-1] == pytest.approx(0.0)


def test_messages_that_come_late_all_at_once_do_not_look_fresh() -> None:
    clock = SenderClock()
    clock.time(100.0, 5.0)
    burst = [clock.time(100.0 + k / 50, 8.0) for k in range(1, 100)]
    assert max(burst) < 7.1


def test_a_clock_that_was_set_back_is_followed_when_the_window_is_over() -> None:
    clock = SenderClock()
    clock.time(100.0, 5.0)
    ages = [5.0 + k / 10 - clock.time(40.0 + k / 10, 5.0 + k / 10) for k in range(1, round(2 * WINDOW * 10))]
    assert ages[0] == pytest.approx(60.0)
    assert ages[-1] == pytest.approx(0.0)

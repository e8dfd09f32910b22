"""The team `mqtt` with a real broker and emulated robots."""

import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_console.core.team import Drive, TeamSpec
from higvf_interfaces.teams import mqtt_connection
from higvf_interfaces.teams.mqtt import MqttTeam
from tests.mqtt import Broker, Client, Robots, mosquitto, soon

START = ((0.6, 0.6), (0.6, 1.0))


def spec(broker: Broker, **options: str) -> TeamSpec:
    return TeamSpec("mqtt", broker.address, options, robots=2, look_ahead=0.024)


def command(number: int, forward: float = 0.0, turn: float = 0.0) -> Drive:
    return Drive(number, np.zeros((2, 2)), np.full(2, forward), np.full(2, turn))


def reports(team: MqttTeam) -> str:
    return " ".join(link.detail for link in team.links(time.monotonic()))


def connected(team: MqttTeam) -> bool:
    return all(link.connected for link in team.links(time.monotonic()))


@pytest.fixture
def prefix(request: pytest.FixtureRequest) -> str:
    """Topics of the test alone."""
    return request.node.name[:60].replace("[", "-").strip("]")


@pytest.fixture
def team(broker: Broker, prefix: str) -> Iterator[MqttTeam]:
    opened = MqttTeam(spec(broker, prefix=prefix))
    yield opened
    opened.close()


@pytest.fixture
def client(broker: Broker, prefix: str) -> Iterator[Client]:
    opened = Client(broker, f"{prefix}/#")
    yield opened
    opened.close()


def test_robots_drive_as_they_are_told_and_tell_where_they_are(broker: Broker, team: MqttTeam, prefix: str) -> None:
    robots = Robots(broker, START, prefix)

    def driven() -> bool:
        numbers.append(len(numbers) + 1)
        team.drive(command(numbers[-1], forward=0.2), time.monotonic())
        return bool((team.poses(time.monotonic()).position[:, 0] > 0.7).all())

    numbers: list[int] = []
    try:
        soon(driven)
        soon(lambda: all(link.acknowledged > 1 for link in team.links(time.monotonic())))
        assert [link.battery for link in team.links(time.monotonic())] == [0.8, 0.8]
        team.stop(time.monotonic())
        soon(lambda: robots.stops > 0)
        assert [told[:2] for told in robots.told] == [(0.0, 0.0)] * 2
    finally:
        robots.close()


def test_nobody_is_seen_before_poses_come(team: MqttTeam) -> None:
    poses = team.poses(0.0)
    assert np.isnan(poses.position).all() and np.isnan(poses.heading).all() and np.isnan(poses.measured_at).all()
    assert [link.acknowledged for link in team.links(time.monotonic())] == [-1, -1]


def test_commands_go_as_often_as_the_rate_says_but_one_that_stops_at_once(
    team: MqttTeam, client: Client, prefix: str
) -> None:
    for number in range(1, 101):
        team.drive(command(number, forward=0.1), 10.0 + 0.01 * number)
    team.drive(command(101), 11.001)
    heard = soon(lambda: [c for c in client.of(f"{prefix}/1/cmd") if c["n"] == 101] and client.of(f"{prefix}/1/cmd"))
    assert heard[-1] == {"v": 0.0, "w": 0.0, "n": 101, "valid_s": 0.3}
    assert 26 <= len(heard) <= 36


def test_a_broker_that_dies_breaks_all_links_and_one_that_comes_back_joins_them(tmp_path: Path) -> None:
    with mosquitto(tmp_path) as broker:
        team = MqttTeam(spec(broker))
        assert connected(team)
        broker.kill()
        soon(lambda: not connected(team))
        assert f"broker {broker.address} is lost" in reports(team)
        team.drive(command(1, forward=0.1), time.monotonic())
        team.stop(time.monotonic())
        broker.start()
        soon(lambda: connected(team))
        team.close()


def test_a_broker_that_falls_silent_breaks_all_links(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mqtt_connection, "_KEEPALIVE", 60)
    with mosquitto(tmp_path) as broker:
        team = MqttTeam(spec(broker))
        assert connected(team)
        broker.process.send_signal(signal.SIGSTOP)
        try:
            soon(lambda: not connected(team))
            assert "has been silent for" in reports(team)
        finally:
            broker.process.send_signal(signal.SIGCONT)
        soon(lambda: connected(team))
        team.close()


def test_what_cannot_leave_is_forgotten_rather_than_sent_late(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mqtt_connection, "_KEEPALIVE", 60)
    with mosquitto(tmp_path) as broker:
        connection = mqtt_connection.Connection(
            settings_broker(broker), "lab", ["lab/1/pose"], lambda _topic, _payload, _now: None
        )
        broker.process.send_signal(signal.SIGSTOP)
        sent = 0
        while connection.say("lab/1/cmd", b"x" * 4000) and sent < 100_000:
            sent += 1
        assert sent < 100_000  # the buffers of the system, then those of the connection
        broker.process.send_signal(signal.SIGCONT)
        soon(lambda: connection.say("lab/1/cmd", b"again"))
        connection.close()


def settings_broker(broker: Broker) -> mqtt_connection.Broker:
    return mqtt_connection.Broker("127.0.0.1", broker.port)


def test_messages_that_mean_nothing_are_counted_and_harm_nobody(team: MqttTeam, client: Client, prefix: str) -> None:
    for junk in (b"", b"\x00\xff", b"[" * 900, b"x" * 2000, b"{}", b'{"x": 1e400, "y": null}'):
        for kind in ("pose", "ack"):
            client.say(f"{prefix}/1/{kind}", junk)
    client.say(f"{prefix}/1/pose", b"x" * 1_000_000)  # the broker keeps it
    for _ in range(3000):
        client.say(f"{prefix}/2/pose", b'{"x": "here"}')

    def seen() -> bool:
        """The broker drops what comes during the flood, so a pose is told again, as robots do."""
        client.say(f"{prefix}/1/pose", {"x": 1.0, "y": 1.5, "theta": 0.5})
        return bool(team.poses(0.0).position[0, 0] == 1.0)

    soon(seen)
    assert "12 messages refused" in reports(team)
    assert "messages refused, the last one: x: 'here' is not a number" in reports(team)
    assert connected(team)


def test_retained_messages_are_ignored(broker: Broker, client: Client, prefix: str) -> None:
    client.say(f"{prefix}/1/pose", {"x": 3.0, "y": 1.5, "theta": 0.5}, retain=True)
    client.say(f"{prefix}/1/ack", {"n": 0, "battery": 0.1}, retain=True)
    soon(lambda: len(client.heard) == 2)
    team = MqttTeam(spec(broker, prefix=prefix))
    client.say(f"{prefix}/2/pose", {"x": 1.0, "y": 1.5, "theta": 0.5})
    soon(lambda: team.poses(0.0).position[1, 0] == 1.0)
    assert np.isnan(team.poses(0.0).position[0]).all()
    assert np.isnan(team.links(time.monotonic())[0].battery)
    team.close()
    for kind in ("pose", "ack"):
        client.say(f"{prefix}/1/{kind}", b"", retain=True)


def test_the_last_will_of_a_console_that_is_killed_stops_all(broker: Broker, client: Client, prefix: str) -> None:
    program = (
        "import time; from higvf_console.core.team import TeamSpec; from higvf_interfaces.teams.mqtt import MqttTeam;"
        f"team = MqttTeam(TeamSpec('mqtt', {broker.address!r}, {{'prefix': {prefix!r}}}));"
        "print('open', flush=True); time.sleep(60)"
    )
    process = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE)
    assert process.stdout is not None and process.stdout.readline() == b"open\n"
    process.kill()
    process.wait()
    soon(lambda: client.of(f"{prefix}/stop") == [{"stop": True}])


def test_closing_sends_what_was_said_before_and_no_last_will(broker: Broker, client: Client, prefix: str) -> None:
    team = MqttTeam(spec(broker, prefix=prefix))
    team.stop(time.monotonic())
    team.close()
    soon(lambda: len(client.of(f"{prefix}/2/cmd")) == 1)
    client.say(f"{prefix}/end", b"1")
    soon(lambda: client.of(f"{prefix}/end"))
    assert len(client.of(f"{prefix}/stop")) == 1


def test_two_robots_with_one_name_break_the_link(team: MqttTeam, client: Client, prefix: str) -> None:
    for sender in ("a", "b"):
        client.say(f"{prefix}/1/pose", {"x": 1.0, "y": 1.5, "theta": 0.5, "id": sender})
    soon(lambda: "two robots have this name: a, b" in reports(team))
    assert [link.connected for link in team.links(time.monotonic())] == [False, True]
    soon(lambda: connected(team))


def test_a_robot_that_confirms_no_more_is_lost(team: MqttTeam, client: Client, prefix: str) -> None:
    team.drive(command(1), time.monotonic())
    client.say(f"{prefix}/1/ack", {"n": 1})
    soon(lambda: team.links(time.monotonic())[0].acknowledged == 1)
    team.drive(command(2), time.monotonic() + 1.0)
    soon(lambda: "confirms no command for" in reports(team))
    assert [link.connected for link in team.links(time.monotonic())] == [False, True]


def test_stamps_of_another_clock_are_used_where_that_is_asked_for(broker: Broker, prefix: str) -> None:
    team = MqttTeam(spec(broker, prefix=prefix, stamp="sent"))
    robots = Robots(broker, START, prefix, clock=1e6)
    try:
        soon(lambda: bool(np.isfinite(team.poses(0.0).measured_at).all()))
        measured = team.poses(0.0).measured_at
        assert (np.abs(measured - time.monotonic()) < 60.0).all()
    finally:
        robots.close()
        team.close()


def test_the_network_shows_robots_whatever_they_are_called(broker: Broker, prefix: str) -> None:
    robots = Robots(broker, START, prefix)
    try:
        heard = MqttTeam.heard(spec(broker, prefix=prefix), 1.0)
    finally:
        robots.close()
    assert [robot.name for robot in heard] == ["1", "2"]
    assert "the last at (0.60, 1.00) m" in heard[1].detail


def test_no_broker_is_told_at_once(tmp_path: Path) -> None:
    with mosquitto(tmp_path) as broker:
        broker.kill()
        with pytest.raises(InputError, match=rf"{broker.address}: no connection to a broker: .*refused"):
            MqttTeam(spec(broker))


def test_an_account_and_tls_are_used(tmp_path: Path, write_certificate: Callable[[Path], tuple[Path, Path]]) -> None:
    certificate, key = write_certificate(tmp_path)
    passwords, account = tmp_path / "passwords", tmp_path / "account"
    passwords.write_text("anna:secret\n")
    try:
        subprocess.run(["mosquitto_passwd", "-U", passwords], check=True)
    except FileNotFoundError:
        pytest.skip("no mosquitto_passwd: install the package 'mosquitto'")
    settings = (f"certfile {certificate}", f"keyfile {key}", f"password_file {passwords}", "allow_anonymous false")
    with mosquitto(tmp_path, *settings) as broker:
        account.write_text("username anna\npassword wrong\n")
        account.chmod(0o600)
        address = f"mqtts://127.0.0.1:{broker.port}"
        options = {"auth": str(account), "ca": str(certificate)}
        with pytest.raises(InputError, match=r"not authorized|bad user name"):
            MqttTeam(TeamSpec("mqtt", address, options))
        account.write_text("username anna\npassword secret\n")
        team = MqttTeam(TeamSpec("mqtt", address, options))
        assert connected(team)
        team.close()
        with pytest.raises(InputError, match="certificate"):
            MqttTeam(TeamSpec("mqtt", address, {"auth": str(account)}))


@pytest.fixture
def write_certificate() -> Callable[[Path], tuple[Path, Path]]:
    def write(folder: Path) -> tuple[Path, Path]:
        certificate, key = folder / "lab.pem", folder / "lab.key"
        subprocess.run(
            ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1", "-subj", "/CN=127.0.0.1",
             "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", key, "-out", certificate],
            check=True, capture_output=True,
        )  # fmt: skip
        return certificate, key

    return write

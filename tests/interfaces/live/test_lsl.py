"""Live streams are found, read, reported as lost and reconnected; the devices are outlets on the loopback interface."""

import time
from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from higvf_console.core.commands import Cursor, OperatorCommand, Pause, Pick, StrokeBegin, StrokeEnd, StrokePoints
from higvf_console.core.errors import InputError
from higvf_console.core.interface import ChannelState, InputSpec, OperatorContext
from higvf_interfaces.decisions.bci import open_bci
from higvf_interfaces.decisions.emg import open_emg
from higvf_interfaces.gaze.interface import GazeReplay, open_gaze
from higvf_interfaces.live import lsl as live
from higvf_interfaces.live.lsl import LslReader, StreamQuery
from tests.interfaces.live.lsl_devices import Device, until

ContextAt = Callable[..., OperatorContext]
GAZE = ("x", "y", "confidence")


@pytest.fixture
def opened() -> Iterator[Callable[..., Any]]:
    """Opens an interface on a live stream, and closes it after the test."""
    ours: list[Any] = []

    def open_one(opener: Callable[[InputSpec], Any], channel: str, **options: str) -> Any:
        ours.append(opener(InputSpec(channel, "lsl", options)))
        return ours[-1]

    yield open_one
    for interface in ours:
        interface.close()
        interface.close()


def polled(interface: Any, at: ContextAt, kind: type[OperatorCommand], now: float = 1.0) -> list[Any]:
    """Polls until there is a command of a kind."""
    given: list[OperatorCommand] = []

    def come() -> bool:
        given.extend(interface.poll(at(now)))
        return any(isinstance(command, kind) for command in given)

    until(come)
    return [command for command in given if isinstance(command, kind)]


def test_markers_become_commands_at_the_session_times_of_their_stamps(
    lsl: ModuleType, opened: Callable[..., Any], at: ContextAt
) -> None:
    device = Device(lsl, "Markers", name="fists")
    emg = opened(open_emg, "emg", name="fists")
    until(device.consumed)
    device.push('{"label": "fist", "confidence": 0.93}', at=lsl.local_clock() - 0.3)
    (pause,) = polled(emg, at, Pause, now=5.0)
    assert 4.0 < pause.time <= 4.7
    assert (pause.source, pause.confidence) == ("emg", 0.93)
    health = emg.health(5.0)
    assert health.state is ChannelState.LIVE
    assert "name fists, type Markers" in health.detail


def test_a_device_that_stamps_by_unix_time_is_joined_on_at_its_arrival_and_it_is_said(
    lsl: ModuleType, opened: Callable[..., Any], at: ContextAt
) -> None:
    device = Device(lsl, "Markers", name="unix")
    emg = opened(open_emg, "emg", name="unix")
    until(device.consumed)
    off = time.time() - lsl.local_clock()
    device.push("fist", at=lsl.local_clock() + off)
    assert 4.0 < polled(emg, at, Pause, now=5.0)[0].time <= 5.0
    assert f"its clock was {off:.0f} s off this machine's: joined 1 time" in emg.health(5.0).detail


def test_markers_before_the_run_count_at_its_start(lsl: ModuleType, opened: Callable[..., Any], at: ContextAt) -> None:
    device = Device(lsl, "Markers", name="early")
    emg = opened(open_emg, "emg", name="early")
    until(device.consumed)
    device.push("fist", at=lsl.local_clock() - 5.0)
    assert polled(emg, at, Pause, now=0.0)[0].time == 0.0


def test_no_matching_stream_or_several_are_refused_with_the_streams_on_the_network(lsl: ModuleType) -> None:
    one, other = Device(lsl, "Markers", name="left"), Device(lsl, "Markers", name="right")
    with pytest.raises(InputError) as refusal:
        LslReader(StreamQuery(name="nobody"), "input emg=lsl", within=0.5)
    assert "0 live streams fit name=nobody; found on the network: " in str(refusal.value)
    assert "name left, type Markers, source_id left-1, host " in str(refusal.value)
    with pytest.raises(InputError, match="2 live streams fit type=markers; choose one by name, type, source_id"):
        LslReader(StreamQuery(type="markers"), "input emg=lsl", within=0.5)
    one.kill()
    other.kill()


def test_a_killed_device_falls_silent_and_is_found_again_by_its_source_id(
    lsl: ModuleType, opened: Callable[..., Any], at: ContextAt
) -> None:
    device = Device(lsl, "Markers", name="mind", source_id="amplifier 7")
    bci = opened(open_bci, "bci", name="mind")
    until(device.consumed)
    device.push("robot2")
    assert polled(bci, at, Pick)[0].robot == 1
    until(lambda: 10.0 - bci.health(10.0).last_seen < 0.2)
    device.kill()
    until(lambda: 10.0 - bci.health(10.0).last_seen > 1.0)
    again = Device(lsl, "Markers", name="mind", source_id="amplifier 7")
    until(again.consumed)
    again.push("robot3")
    assert polled(bci, at, Pick, now=20.0)[0].robot == 2
    assert "lost 1 times" in bci.health(20.0).detail


def test_a_silent_event_stream_is_alive_and_a_silent_signal_is_not(lsl: ModuleType) -> None:
    events, signal = Device(lsl, "Markers", name="calm"), Device(lsl, "EEG", name="stuck", rate=100.0, labels=("O1",))
    readers = [LslReader(StreamQuery(name=name), "input", within=5.0) for name in ("calm", "stuck")]
    until(signal.consumed)
    signal.push(1.0)
    until(lambda: readers[0].quiet is not None and (readers[1].quiet or 0.0) > 1.0)
    assert (readers[0].quiet or 0.0) < 1.0, "nobody said anything, and the device answers"
    for reader in readers:
        reader.close()
    events.kill()


def test_live_gaze_moves_the_cursor_and_draws_under_the_clutch(
    lsl: ModuleType, opened: Callable[..., Any], at: ContextAt
) -> None:
    device = Device(lsl, "Gaze", name="tracker", rate=120.0, labels=GAZE, unit="pixels")
    gaze = opened(open_gaze, "gaze", name="tracker", screen="1200x700", clutch="held")
    assert isinstance(gaze, GazeReplay)
    until(device.consumed)
    targets, start, number = [(300, 200), (500, 300), (700, 200), (900, 400)], lsl.local_clock(), 0
    for x, y in targets:
        for _ in range(48):  # 0.4 s each
            device.push(float(x), float(y), 1.0, at=start + number / 120.0)
            number += 1
    given: list[OperatorCommand] = []

    def come() -> bool:
        given.extend(gaze.poll(at(2.0, clutch=True)))
        return sum(len(command.points) for command in given if isinstance(command, StrokePoints)) >= 2

    until(come)
    given.extend(gaze.poll(at(2.1, clutch=False)))
    assert {Cursor, StrokeBegin} <= {type(command) for command in given}
    assert isinstance(given[-1], StrokeEnd)
    drawn = np.concatenate([command.points for command in given if isinstance(command, StrokePoints)])
    np.testing.assert_allclose(drawn, [(x, 700 - y) for x, y in targets], atol=1.0)


def test_live_gaze_of_low_confidence_is_lost_gaze(lsl: ModuleType, opened: Callable[..., Any], at: ContextAt) -> None:
    device = Device(lsl, "Gaze", name="shut", rate=120.0, labels=GAZE, unit="pixels")
    gaze = opened(open_gaze, "gaze", name="shut")
    until(device.consumed)
    device.push(300.0, 300.0, 0.1)
    until(lambda: gaze.poll(at(1.0)) is not None and gaze.health(1.0).state is ChannelState.LIVE)
    assert not any(isinstance(command, Cursor) for command in gaze.poll(at(1.0)))


def test_a_gaze_stream_without_labels_needs_to_be_told_its_channels(lsl: ModuleType) -> None:
    device = Device(lsl, "Gaze", name="bare", rate=120.0, labels=("", ""))
    with pytest.raises(InputError, match="no channels with known gaze labels"):
        open_gaze(InputSpec("gaze", "lsl", {"name": "bare"}))
    with pytest.raises(InputError, match="frame=screen"):
        open_gaze(InputSpec("gaze", "lsl", {"name": "bare", "x": "1", "y": "2"}))
    device.kill()


def test_live_gaze_of_a_scene_camera_is_refused_unless_the_frame_is_given(
    lsl: ModuleType, opened: Callable[..., Any]
) -> None:
    device = Device(lsl, "Gaze", name="glasses", rate=120.0, labels=GAZE, unit="pixels", system="world")
    with pytest.raises(InputError, match=r"camera on the head.*calibration=FILE.*frame=screen"):
        opened(open_gaze, "gaze", name="glasses")
    opened(open_gaze, "gaze", name="glasses", frame="screen")
    device.kill()


def test_a_live_coordinate_system_or_unit_that_is_not_understood_is_refused(
    lsl: ModuleType, opened: Callable[..., Any]
) -> None:
    for name, unit, system, said in (("angles", "degrees", "", "degrees"), ("eyes", "pixels", "eye", "'eye'")):
        device = Device(lsl, "Gaze", name=name, rate=120.0, labels=GAZE, unit=unit, system=system)
        with pytest.raises(InputError, match=f"{said}.* is not understood; give frame="):
            opened(open_gaze, "gaze", name=name)
        device.kill()


def test_live_confidence_in_per_cent_is_not_trusted_and_said(
    lsl: ModuleType, opened: Callable[..., Any], at: ContextAt
) -> None:
    device = Device(lsl, "Gaze", name="percent", rate=120.0, labels=GAZE, unit="pixels")
    gaze = opened(open_gaze, "gaze", name="percent")
    until(device.consumed)
    device.push(300.0, 300.0, 95.0)
    until(lambda: gaze.poll(at(1.0)) is not None and gaze.health(1.0).state is ChannelState.LIVE)
    assert not any(isinstance(command, Cursor) for command in gaze.poll(at(1.0)))
    assert "1 samples with a confidence above 1 are not used" in gaze.health(1.0).detail


def test_live_shares_of_the_screen_that_are_called_pixels_are_lost_gaze(
    lsl: ModuleType, opened: Callable[..., Any], at: ContextAt
) -> None:
    device = Device(lsl, "Gaze", name="shares", rate=120.0, labels=GAZE, unit="")
    gaze = opened(open_gaze, "gaze", name="shares", frame="screen")
    until(device.consumed)
    for number in range(30):
        device.push(0.5, number / 30, 1.0)
    until(lambda: gaze.poll(at(1.0)) is not None and "gaze is not used: x and y lie between" in gaze.health(1.0).detail)
    device.push(0.5, 0.5, 1.0)
    assert not any(isinstance(command, Cursor) and np.isfinite(command.point).all() for command in gaze.poll(at(1.1)))


def test_a_live_signal_is_decoded_here(lsl: ModuleType, opened: Callable[..., Any], at: ContextAt) -> None:
    rate = 128.0
    device = Device(lsl, "EEG", name="scalp", rate=rate, labels=("Fz", "Oz"))
    bci = opened(
        open_bci, "bci", name="scalp", decoder="ssvep", targets="robot1@8+robot2@13", channels="Oz", votes="1/1"
    )
    until(device.consumed)
    noise, start = np.random.default_rng(1), lsl.local_clock()
    for number in range(round(6 * rate)):
        flicker = np.sin(2 * np.pi * 13.0 * number / rate) + 0.5 * np.sin(2 * np.pi * 26.0 * number / rate)
        fz, oz = noise.normal(0.0, 1.0, 2) * 0.3
        device.push(fz, 5.0 * (flicker + oz), at=start + number / rate)
    assert {pick.robot for pick in polled(bci, at, Pick)} == {1}


def test_the_queue_of_samples_is_bounded(lsl: ModuleType) -> None:
    device = Device(lsl, "EEG", name="flood", rate=1000.0, labels=("O1",))
    reader = LslReader(StreamQuery(name="flood"), "input", within=5.0, capacity=100)
    until(device.consumed)
    for number in range(5000):
        device.push(float(number))
    until(lambda: (reader.quiet or 0.0) > 0.3)
    newest = reader.take()
    assert [sample.values[0] for sample in newest] == list(map(float, range(4900, 5000)))
    reader.close()


def test_without_pylsl_the_message_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> ModuleType:
        raise ImportError(f"No module named {name!r}")

    monkeypatch.setattr(live, "import_module", missing)
    with pytest.raises(InputError, match=r"live streams need pylsl: pip install 'higvf-console\[lsl\]'"):
        open_emg(InputSpec("emg", "lsl"))

"""Fixating five targets corrects a live tracker with a constant error."""

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.interface import InputSpec, OperatorContext
from higvf_console.core.viewport import fit
from higvf_interfaces.gaze.interface import GazeReplay, open_gaze
from higvf_interfaces.gaze.live_calibration import COUNT
from tests.interfaces.live.lsl_devices import Device, until

ContextAt = Callable[..., OperatorContext]
RATE = 60
OFF = np.array([40.0, 25.0])  # of the tracker [px]


class Eye:
    """A tracker on the loopback interface with a constant gaze error and a clock set by the test."""

    def __init__(self, lsl: ModuleType, name: str) -> None:
        self._device = Device(lsl, "Gaze", name=name, rate=RATE, labels=("x", "y"), unit="pixels")
        self._time = float(lsl.local_clock()) - 1000.0
        self.consumed = self._device.consumed

    def rest(self, gaze: GazeReplay, at: ContextAt, ground: Floats) -> None:
        """Fixates a ground point until the next target, or none, is shown."""
        x, y = fit(InputSpec("gaze").arena, 1920, 1080).to_screen(floats(ground, 1, 2))[0] + OFF
        number = gaze.capture_report().number

        def done() -> bool:
            for _ in range(5):
                self._time += 1 / RATE
                self._device.push(float(x), float(y), at=self._time)
            gaze.poll(at(5.0))
            return gaze.capture_report().number != number

        until(done)


def test_a_live_calibration_takes_effect_at_once(
    lsl: ModuleType, at: ContextAt, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    eye = Eye(lsl, "off")
    options = {"name": "off", "screen": "1920x1080"}
    gaze = open_gaze(InputSpec("gaze", "lsl", options))
    until(eye.consumed)
    assert gaze.capture_report().refusal == ""
    assert gaze.calibration_report() is None
    gaze.begin_capture()
    gaze.poll(at(5.0))
    for number in range(1, COUNT + 1):
        report = gaze.capture_report()
        assert report.number == number
        assert report.target is not None
        eye.rest(gaze, at, report.target)
    found = gaze.calibration_report()
    assert found is not None
    assert found.residual_px < 1.0
    assert gaze.capture_report().target is None
    until(lambda: Path(found.file).is_file() and "; written" in gaze.capture_report().outcome)
    gaze.close()

    again = open_gaze(InputSpec("gaze", "lsl", {**options, "calibration": found.file}))
    until(eye.consumed)
    stored = again.calibration_report()
    assert stored is not None
    assert (stored.made, stored.file) == (found.made, found.file)
    again.close()


def test_a_recording_refuses_a_live_calibration(write: Callable[..., str], at: ContextAt) -> None:
    rows = "".join(f"{k / 100},5,5\n" for k in range(100))
    gaze = open_gaze(InputSpec("gaze", write("time,x,y\n" + rows), {"frame": "arena"}))
    gaze.begin_capture()
    gaze.poll(at(0.5))
    assert "live eye tracker" in gaze.capture_report().refusal
    assert gaze.capture_report().target is None

"""The source of poses `mocap`, with a module that stands in for `motioncapture`."""

import math
import time
from collections.abc import Iterator
from threading import Event
from types import SimpleNamespace

import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_console.core.team import TeamSpec
from higvf_interfaces.poses import mocap
from higvf_interfaces.poses.mocap import MocapOptions, MocapPoses, placed
from tests.mqtt import soon


def body(place: tuple[float, float, float], axis: tuple[float, float, float], angle: float) -> SimpleNamespace:
    half = math.sin(angle / 2)
    x, y, z = (half * part for part in axis)
    return SimpleNamespace(position=np.array(place), rotation=SimpleNamespace(w=math.cos(angle / 2), x=x, y=y, z=z))


class System:
    """Gives frames until it fails."""

    def __init__(self) -> None:
        self.rigidBodies = {"anna": body((1.0, 0.5, 0.1), (0, 0, 1), 0.7), "chair": body((9.0, 9.0, 0.0), (0, 0, 1), 0)}
        self.fails = False

    def waitForNextFrame(self) -> None:  # noqa: N802 (the library's name)
        time.sleep(0.005)
        if self.fails:
            raise RuntimeError("cable unplugged")


@pytest.fixture
def system(monkeypatch: pytest.MonkeyPatch) -> Iterator[System]:
    found = System()

    def connect(kind: str, settings: dict[str, str]) -> System:
        assert kind == "vicon"
        if settings["hostname"] == "nobody":
            Event().wait()
        return found

    monkeypatch.setattr(mocap, "motioncapture", SimpleNamespace(connect=connect))
    yield found
    found.fails = True


def spec(host: str = "lab", **options: str) -> TeamSpec:
    return TeamSpec("mocap", host, {"system": "vicon", "names": "anna+bob", **options}, robots=2)


def test_bodies_are_robots_by_name(system: System) -> None:
    poses = MocapPoses(spec())
    soon(lambda: bool(np.isfinite(poses.poses(0.0).measured_at[0])))
    seen = poses.poses(0.0)
    assert seen.position[0].tolist() == [1.0, 0.5]
    assert seen.heading[0] == pytest.approx(0.7)
    assert np.isnan(seen.position[1]).all()
    system.rigidBodies["bob"] = body((2.0, 0.5, 0.1), (0, 0, 1), 0.0)
    soon(lambda: bool(np.isfinite(poses.poses(0.0).measured_at[1])))
    poses.close()


def test_poses_grow_old_when_the_system_fails(system: System) -> None:
    poses = MocapPoses(spec())
    soon(lambda: bool(np.isfinite(poses.poses(0.0).measured_at[0])))
    system.fails = True
    poses._thread.join(20.0)  # pyright: ignore[reportPrivateUsage]
    assert not poses._thread.is_alive()  # pyright: ignore[reportPrivateUsage]
    assert poses.poses(0.0).position[0].tolist() == [1.0, 0.5]
    poses.close()


def test_the_frame_of_the_system_is_put_into_the_arena() -> None:
    turned = MocapOptions(x_m=1.0, y_m=2.0, turn_deg=90.0)
    assert placed(body((0.5, 0.0, 0.1), (0, 0, 1), 0.2), turned) == pytest.approx((1.0, 2.5, math.pi / 2 + 0.2))
    upright = MocapOptions(up="y")
    assert placed(body((0.5, 0.1, -0.3), (0, 1, 0), 0.2), upright) == pytest.approx((0.5, 0.3, 0.2))


@pytest.mark.usefixtures("system")
@pytest.mark.parametrize(
    ("given", "why"),
    [
        (spec(""), "give the host"),
        (spec(system="kinect"), "kinect"),
        (spec(names="anna"), "give 2 different names"),
        (spec(up="x"), "up"),
    ],
)
def test_what_cannot_be_used_is_named(given: TeamSpec, why: str) -> None:
    with pytest.raises(InputError, match=why):
        MocapPoses(given)


@pytest.mark.usefixtures("system")
def test_a_system_that_does_not_answer_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mocap, "WITHIN", 0.1)
    with pytest.raises(InputError, match=r"no vicon system answers within 0\.1 s"):
        MocapPoses(spec("nobody"))

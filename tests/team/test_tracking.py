"""Where a robot is by the time that a command reaches it, and which poses are believed."""

import math

import numpy as np
import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.team import Drive, Poses
from higvf_console.team.tracking import MEMORY, PoseFault, Rules, Sent, follow, nowhere, predicted, remembered

UNICYCLE = Rules(speed_limit=0.12, look_ahead=0.024, body_radius=0.037)
POINT = Rules(speed_limit=1.0, look_ahead=0.0, body_radius=0.1)


def poses(x: float, y: float, heading: float, at: float) -> Poses:
    return Poses(floats([[x, y]]), floats([heading]), floats([at]))


def drive(number: int, forward: float, turn: float, valid_for: float = 0.3) -> Drive:
    return Drive(number, floats([[forward, 0.0]]), floats([forward]), floats([turn]), valid_for)


def test_a_circle_closes() -> None:
    sent = (Sent(0.0, drive(1, 0.1, 2 * math.pi, valid_for=1.0)),)
    track, _ = follow(nowhere(1), poses(1.0, 0.5, 0.3, 0.0), 0.0, (), 0.0, UNICYCLE, carried=False)
    quarter, turned = predicted(track, sent, 0.0, 0.25, UNICYCLE)
    radius = 0.1 / (2 * math.pi)
    centre = np.array([1.0, 0.5]) + radius * np.array([-math.sin(0.3), math.cos(0.3)])
    assert quarter[0] == pytest.approx(centre + radius * np.array([math.cos(0.3), math.sin(0.3)]))
    assert turned[0] == pytest.approx(0.3 + math.pi / 2)
    whole, _ = predicted(track, sent, 0.0, 1.0, UNICYCLE)
    assert whole[0] == pytest.approx([1.0, 0.5])


@pytest.mark.parametrize(
    ("until", "expected"),
    [(0.1, 0.0), (0.2, 0.0), (0.3, 0.1), (0.5, 0.3), (0.6, 0.35), (0.7, 0.4), (0.8, 0.45), (1.5, 0.45)],
)
def test_a_command_acts_when_it_arrives_until_the_next_one_or_until_it_expires(until: float, expected: float) -> None:
    sent = (Sent(0.0, drive(1, 1.0, 0.0)), Sent(0.3, drive(2, 0.5, 0.0)))
    track, _ = follow(nowhere(1), poses(0.0, 0.0, 0.0, 0.1), 0.1, (), 0.0, POINT, carried=False)
    position, _ = predicted(track, sent, 0.2, until, POINT)
    assert position[0, 0] == pytest.approx(expected)


def test_nothing_is_predicted_of_robots_never_seen() -> None:
    position, heading = predicted(nowhere(2), (Sent(0.0, drive(1, 1.0, 0.0)),), 0.1, 1.0, POINT)
    assert np.isnan(position).all()
    assert np.isnan(heading).all()


def test_old_commands_are_forgotten() -> None:
    sent: tuple[Sent, ...] = ()
    for k in range(500):
        sent = remembered(sent, drive(k, 0.0, 0.0), 0.02 * k)
    assert len(sent) == round(MEMORY / 0.02)
    assert [one.command.number for one in sent][-1] == 499


@pytest.mark.parametrize(
    ("pose", "fault"),
    [
        (poses(1.0 + 0.012 + 0.0185 + 1e-4, 1.0, 0.0, 0.1), PoseFault.JUMP),
        (poses(1.0 + 0.012 + 0.0185 - 1e-4, 1.0, 0.0, 0.1), None),
        (poses(math.inf, 1.0, 0.0, 0.1), PoseFault.NUMBER),
        (poses(1.0, 1.0, math.nan, 0.1), PoseFault.NUMBER),
        (poses(1.0, 1.0, 0.0, math.nan), PoseFault.NUMBER),
        (poses(1.0, 1.0, 0.0, 0.151), PoseFault.FUTURE),
        (poses(1.0, 1.0, 0.0, 0.149), None),
    ],
)
def test_bounds_of_what_is_believed(pose: Poses, fault: PoseFault | None) -> None:
    track, _ = follow(nowhere(1), poses(1.0, 1.0, 0.0, 0.0), 0.0, (), 0.0, UNICYCLE, carried=False)
    after, refused = follow(track, pose, 0.1, (), 0.0, UNICYCLE, carried=False)
    assert refused == (((0, fault),) if fault else ())
    believed = track.position if fault else pose.position
    np.testing.assert_array_equal(after.position, believed)


def test_a_robot_that_jumped_is_believed_again_when_it_could_have_driven_there() -> None:
    track, _ = follow(nowhere(1), poses(1.0, 1.0, 0.0, 0.0), 0.0, (), 0.0, UNICYCLE, carried=False)
    times = [0.1 * k for k in range(1, 60)]
    believed = []
    for at in times:
        track, refused = follow(track, poses(1.3, 1.0, 0.0, at), at, (), 0.0, UNICYCLE, carried=False)
        believed.append(not refused)
    first = times[believed.index(True)]
    assert first == pytest.approx((0.3 - 0.0185) / 0.12, abs=0.1)
    assert all(believed[believed.index(True) :])


def test_people_may_carry_robots() -> None:
    track, _ = follow(nowhere(1), poses(1.0, 1.0, 0.0, 0.0), 0.0, (), 0.0, UNICYCLE, carried=True)
    track, refused = follow(track, poses(3.0, 1.0, 0.0, 0.1), 0.1, (), 0.0, UNICYCLE, carried=True)
    assert not refused
    assert track.position[0, 0] == 3.0


def test_the_same_report_counts_once_and_a_pose_never_goes_back() -> None:
    track, _ = follow(nowhere(1), poses(1.0, 1.0, 0.0, 0.1), 0.1, (), 0.0, UNICYCLE, carried=False)
    again, refused = follow(track, poses(9.0, 9.0, 0.0, 0.1), 0.2, (), 0.0, UNICYCLE, carried=False)
    assert again is track
    assert not refused
    older, _ = follow(track, poses(1.01, 1.0, 0.0, 0.05), 0.2, (), 0.0, UNICYCLE, carried=False)
    assert older is track


def test_drift_is_how_fast_poses_leave_the_prediction() -> None:
    track, _ = follow(nowhere(1), poses(0.0, 0.0, 0.0, 0.0), 0.0, (), 0.0, POINT, carried=False)
    sent = tuple(Sent(0.02 * k, drive(k + 1, 0.5, 0.0)) for k in range(40))
    for k in range(1, 20):
        at = 0.04 * k
        track, refused = follow(track, poses(0.4 * at, 0.0, 0.0, at), at, sent, 0.0, POINT, carried=False)
        assert not refused
    assert track.drift[0] == pytest.approx(0.1 * 0.04 / 0.05, rel=0.05)  # over the least horizon

"""STOP first, everything else in order and in measure."""

import numpy as np
import pytest

from higvf_console.channels.supervision import Said
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import (
    AskReset,
    EmergencyStop,
    OperatorCommand,
    Pick,
    ResetEmergencyStop,
    Resume,
    StrokeBegin,
    StrokePoints,
)
from higvf_console.runtime.admission import FULL_DETAIL, MOST_WAITING, Admission, StrokeDetail


def said(channel: str, *commands: OperatorCommand) -> list[Said]:
    return [Said(channel, command) for command in commands]


def order(admission: Admission) -> list[Said]:
    taken: list[Said] = []
    while (one := admission.next()) is not None:
        taken.append(one)
    return taken


def test_commands_come_in_the_order_of_the_channels_and_of_each_channel() -> None:
    admission = Admission()
    given = said("console", Pick(0), Pick(1)) + said("bci", Pick(2))
    admission.take_in(given)
    assert order(admission) == given


def test_a_stop_overtakes_all_that_waits() -> None:
    admission = Admission()
    admission.take_in(said("console", *(Pick(0) for _ in range(100))))
    admission.take_in(said("bci", Pick(1), EmergencyStop()))
    assert admission.next() == Said("bci", EmergencyStop())


@pytest.mark.parametrize("channel", ["console", "bci"])
def test_what_waits_and_would_reset_the_stop_is_dropped(channel: str) -> None:
    admission = Admission()
    admission.take_in(said(channel, Pick(0), AskReset(), ResetEmergencyStop(), Resume()))
    admission.take_in(said("console", EmergencyStop(), Resume()))
    assert [one.command for one in order(admission)] == [EmergencyStop(), Pick(0), Resume()]


def test_a_channel_that_floods_is_cut_short_and_counted_and_the_others_are_not() -> None:
    admission = Admission()
    admission.take_in(said("console", *(Pick(0) for _ in range(MOST_WAITING + 7))) + said("bci", Pick(1)))
    assert admission.take_dropped() == {"console": 7}
    assert admission.take_dropped() == {}
    assert len(admission) == MOST_WAITING + 1
    assert order(admission)[-1] == Said("bci", Pick(1))


def test_who_has_used_up_a_period_goes_last_in_the_next() -> None:
    admission = Admission()
    admission.take_in(said("console", Pick(0), Pick(1)) + said("bci", Pick(2)))
    assert admission.next() == Said("console", Pick(0))
    admission.yield_turn()
    assert [one.command for one in order(admission)] == [Pick(2), Pick(1)]


def drawn(points: Floats, sizes: list[int]) -> Floats:
    """What is kept of a stroke that comes in pieces of these sizes."""
    detail, kept = StrokeDetail(), [points[:0]]
    for piece in np.split(points, np.cumsum(sizes)):
        kept.append(detail.thinned(piece))
    return floats(np.concatenate(kept))


def test_a_long_stroke_is_thinned_over_its_whole_length() -> None:
    points = floats([(k, 2 * k) for k in range(200_001)])
    kept = drawn(points, [])
    assert (kept[:FULL_DETAIL] == points[:FULL_DETAIL]).all()
    assert FULL_DETAIL < len(kept) < 10 * FULL_DETAIL
    steps = np.diff(kept[:, 0])
    assert (np.diff(steps) >= 0).all()
    assert set(steps) == {float(2**k) for k in range(8)}
    assert points[-1, 0] - kept[-1, 0] < steps[-1]


@pytest.mark.parametrize("size", [1, 7, 1000, 4096])
def test_how_a_stroke_is_cut_into_messages_does_not_matter(size: int) -> None:
    points = floats([(k, -k) for k in range(20_000)])
    assert (drawn(points, [size] * (len(points) // size)) == drawn(points, [])).all()


def test_points_of_the_next_stroke_are_whole_again() -> None:
    admission, points = Admission(), floats(np.zeros((3000, 2)))
    for _ in range(2):
        admission.take_in(said("console", StrokeBegin(), StrokePoints(points=points)))
    lengths = [len(one.command.points) for one in order(admission) if isinstance(one.command, StrokePoints)]
    assert lengths[0] == lengths[1] < 3000

"""The safety filter alone keeps clearances, enlarges them by itself, and works on any number of robots and hazards."""

from collections.abc import Callable

import numpy as np
import pytest

import higvf_console as hc
from higvf_console.core.arrays import Floats


def closest_to(hazards: hc.Hazards, start: list[float], nominal: list[float], ticks: int = 300) -> Floats:
    """Positions (T, 2) of one robot that is driven by the filter."""
    where, way = np.array([start]), list[Floats]()
    for _ in range(ticks):
        where = where + 0.02 * hc.filter_velocities(where, [nominal], hazards).velocity
        way.append(where[0])
    return np.array(way)


def test_no_robots_and_no_hazards_are_no_error() -> None:
    for none in ([], np.zeros((0, 2)), ()):
        filtered = hc.filter_velocities(none, none)
        assert filtered.velocity.shape == (0, 2)
        assert filtered.active_constraints.shape == filtered.infeasible.shape == (0,)
    assert hc.filter_velocities([[0, 0]], [[5, 0]], hc.Hazards()).velocity.tolist() == [[5.0, 0.0]]


def test_a_nominal_velocity_passes_bit_for_bit_where_nothing_is_near() -> None:
    nominal = np.array([[1.0 / 3.0, 2.0 / 7.0]])
    assert (
        hc.filter_velocities([[0, 0]], nominal, hc.Hazards().circle((900, 0), 20)).velocity.tobytes()
        == nominal.tobytes()
    )


def _gap_to_circle(way: Floats) -> Floats:
    return np.hypot(*(way - (100.0, 0.0)).T) - 20.0


def _gap_to_edge(way: Floats) -> Floats:
    return 100.0 - way[:, 0]


@pytest.mark.parametrize(
    ("hazards", "gap"),
    [
        (hc.Hazards().circle((100, 0), 20), _gap_to_circle),
        (hc.Hazards().capsule((106, -300), (106, 300), 6), _gap_to_edge),
        (hc.Hazards().polygon([[100, -300], [200, -300], [200, 300], [100, 300]]), _gap_to_edge),
        (hc.Hazards().wall((-2, 0), -100), _gap_to_edge),
        (hc.Hazards().inside((-500, -500, 100, 500)), _gap_to_edge),
        (hc.Hazards().fire((100, 0), 20, growth=0.0), _gap_to_circle),
    ],
)
def test_a_robot_that_drives_at_a_hazard_keeps_its_clearance(
    hazards: hc.Hazards, gap: Callable[[Floats], Floats]
) -> None:
    least = gap(closest_to(hazards, [0.0, 0.0], [90.0, 0.0])).min()
    assert 12.0 - 1e-6 <= least < 13.5


def test_a_circle_that_grows_pushes_a_robot_away() -> None:
    still, growing = hc.Hazards().circle((0, 0), 20), hc.Hazards().circle((0, 0), 20, growth=5.0)
    assert hc.filter_velocities([[32.0, 0.0]], [[0.0, 0.0]], still).velocity[0, 0] == pytest.approx(0.0)
    assert hc.filter_velocities([[32.0, 0.0]], [[0.0, 0.0]], growing).velocity[0, 0] == pytest.approx(5.0, rel=0.01)


@pytest.mark.parametrize("speed", [20.0, 60.0])
@pytest.mark.parametrize("end", [(200.0, 0.0), (260.0, 150.0)])
def test_a_robot_gives_way_to_an_obstacle_that_drives_at_it(speed: float, end: tuple[float, float]) -> None:
    where, least = np.array([[0.0, 3.0]]), np.inf
    for tick in range(int(10_000 / speed)):
        moved = -0.02 * speed * tick
        start, stop = np.array([200.0 + moved, 0.0]), np.array([end[0] + moved, end[1]])
        hazard = hc.Hazards().capsule(start, stop, 15.0, velocity=(-speed, 0.0))
        filtered = hc.filter_velocities(where, [[0.0, 0.0]], hazard)
        assert not filtered.infeasible.any()
        where = where + 0.02 * filtered.velocity
        along = stop - start
        share = np.clip((where[0] - start) @ along / max(along @ along, 1e-12), 0.0, 1.0)
        least = min(least, float(np.hypot(*(where[0] - start - share * along))) - 15.0)
    assert 12.0 - 0.1 < least < 30.0


def test_a_hazard_that_grows_or_is_too_fast_is_refused_by_a_run() -> None:
    for hazards, line in (
        (hc.Hazards().circle((300, 0), 20, velocity=(-150, 0)), "hazard 1, a circle, moves at 150 m/s; expected 100"),
        (
            hc.Hazards().fire((300, 0), 9).circle((500, 0), 20, growth=1),
            "hazard 2, a circle, grows; expected no growth: in a run, only fires",
        ),
    ):
        with pytest.raises(hc.ArgumentError, match=line):
            hc.make_setup([[0, 0]], hazards)


def test_gains_that_do_not_hold_between_two_steps_are_refused_with_numbers() -> None:
    fast = hc.make_parameters(safety={"speed_limit": 600.0, "control_period": 0.1})
    with pytest.raises(hc.FilterError, match=r"pair barriers do not hold between two control steps: .* exceeds 1"):
        hc.filter_velocities([[0, 0]], [[0, 0]], None, fast)


def test_hazards_are_values() -> None:
    none = hc.Hazards()
    one = none.circle((0, 0), 5)
    assert (len(none.items), len(one.items)) == (0, 1)
    corners = np.array([[0.0, 0.0], [50.0, 0.0], [0.0, 50.0]])
    triangle = none.polygon(corners)
    corners[:] = np.nan
    assert np.isfinite(triangle.table).all()

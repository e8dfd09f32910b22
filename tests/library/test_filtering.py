"""The safety filter alone keeps clearances, enlarges them by itself, and works on any number of robots and hazards."""

import numpy as np
import pytest

import higvf_console as hc


def closest_to(hazards: hc.Hazards, start: list[float], nominal: list[float], ticks: int = 300) -> np.ndarray:
    """Positions (T, 2) of one robot that is driven by the filter."""
    where, way = np.array([start]), []
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


@pytest.mark.parametrize(
    ("hazards", "distance"),
    [
        (hc.Hazards().circle((100, 0), 20), lambda p: np.hypot(*(p - (100, 0)).T) - 20),
        (hc.Hazards().capsule((100, -300), (100, 300), 6), lambda p: 100 - 6 - p[:, 0]),
        (hc.Hazards().polygon([[100, -300], [200, -300], [200, 300], [100, 300]]), lambda p: 100 - p[:, 0]),
        (hc.Hazards().wall((-2, 0), -100), lambda p: 100 - p[:, 0]),
        (hc.Hazards().inside((-500, -500, 100, 500)), lambda p: 100 - p[:, 0]),
        (hc.Hazards().fire((100, 0), 20, growth=0.0), lambda p: np.hypot(*(p - (100, 0)).T) - 20),
    ],
)
def test_a_robot_that_drives_at_a_hazard_keeps_its_clearance(hazards: hc.Hazards, distance: object) -> None:
    gap = distance(closest_to(hazards, [0.0, 0.0], [90.0, 0.0]))  # pyright: ignore
    assert 12.0 - 1e-6 <= gap.min() < 13.0


def test_a_circle_that_grows_pushes_a_robot_away() -> None:
    still, growing = hc.Hazards().circle((0, 0), 20), hc.Hazards().circle((0, 0), 20, growth=5.0)
    assert hc.filter_velocities([[32.0, 0.0]], [[0.0, 0.0]], still).velocity[0, 0] == pytest.approx(0.0)
    assert hc.filter_velocities([[32.0, 0.0]], [[0.0, 0.0]], growing).velocity[0, 0] == pytest.approx(5.0, rel=0.01)


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
    assert np.isfinite(triangle.capsules).all()

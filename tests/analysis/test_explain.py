"""Why a robot moved: parts that sum to its velocity, rows by name, what hides a fire."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from higvf_console.analysis.active_constraints import active_constraints
from higvf_console.analysis.explain import Authority, Explanation, Moved, Part, explain
from higvf_console.analysis.sight import hider_names, sights
from higvf_console.control.forms import FORMS
from higvf_console.control.parameters import Parameters, controlled
from higvf_console.core.arrays import floats
from higvf_console.core.commands import EmergencyStop, OperatorCommand, Pause, Prioritise, ResetRun, ShapePath
from higvf_console.core.state import PathStatus
from higvf_console.runtime.run import Run
from higvf_console.world.polygons import segment_distance
from higvf_console.world.setup import Setup, with_params
from tests.teams import stroke, team

PATH = ((150.0, 350.0), (400.0, 300.0), (700.0, 420.0), (1000.0, 350.0))
CROWD = Parameters()._replace(formation=Parameters().formation._replace(communication_range=150.0))


def crowded(seed: int, params: Parameters = CROWD) -> Setup:
    """Nine robots that set out close together, among random circles and a bar, for two fires."""
    random = np.random.default_rng(seed)
    robots = [(60.0 + 30.0 * (k % 3), 300.0 + 30.0 * (k // 3)) for k in range(9)]
    circles = [(x, y, random.uniform(20.0, 40.0)) for x, y in random.uniform([220, 200], [600, 450], (7, 2))]
    return team(
        robots, [(700.0, 250.0, 20.0), (600.0, 500.0, 25.0)], circles, [(500.0, 60.0, 520.0, 180.0, 6.0)], params
    )


def periods(setup: Setup, commands: Sequence[OperatorCommand] = (), ticks: int = 600) -> list[Moved]:
    """Control periods all along a run, every seventh."""
    run, found = Run(setup), list[Moved]()
    for command in commands:
        run.apply(command)
    for tick in range(ticks):
        run.step()
        if tick % 7 == 0:
            found.append(run.last)
    return found


def everybody(moved: Moved, params: Parameters) -> Explanation:
    return explain(moved, params, np.arange(len(moved.after.position)))


def left_over(moved: Moved, params: Parameters) -> float:
    """Largest error of the sum of all parts [m/s]."""
    return float(np.abs(everybody(moved, params).parts.sum(axis=1) - moved.after.velocity).max())


def lossy(params: Parameters) -> Parameters:
    return params._replace(robots=params.robots._replace(packet_loss=0.4, seed=3.0))


def noisy(params: Parameters) -> Parameters:
    return params._replace(robots=params.robots._replace(position_noise=0.3))


def dead_zone(params: Parameters) -> Parameters:
    return params._replace(intention=params.intention._replace(dead_zone=0.02))


def boosted(params: Parameters) -> Parameters:
    return params._replace(intention=params.intention._replace(decay=0.0, human_weight=90.0))


CHANGES: list[Callable[[Parameters], Parameters]] = [lambda params: params, lossy, dead_zone, noisy, boosted]


@pytest.mark.parametrize("change", CHANGES, ids=["plain", "lossy", "dead zone", "noisy", "other weights"])
@pytest.mark.parametrize("commands", [[], stroke(PATH, 4)], ids=["alone", "with a human"])
def test_the_parts_sum_to_the_commanded_velocity(
    change: Callable[[Parameters], Parameters], commands: list[OperatorCommand]
) -> None:
    params = change(CROWD)
    moved = [period for seed in range(2) for period in periods(crowded(seed, params), commands)]
    assert max(left_over(period, params) for period in moved) < 1e-9


@pytest.mark.parametrize("forms", ["zero-in", "printed"])
def test_they_sum_under_the_paper_s_own_equations_too(forms: str) -> None:
    params = CROWD._replace(forms=FORMS[forms])
    for moved in periods(crowded(0, params), stroke(PATH, 4), 60):
        velocity = moved.after.velocity
        scale = max(1.0, float(np.nan_to_num(np.abs(moved.trace.blended)).max()))
        assert np.abs(everybody(moved, params).parts.sum(axis=1) - velocity).max() < 1e-9 * scale


@pytest.mark.parametrize("command", [Pause(), EmergencyStop()])
def test_a_pause_or_stop_is_a_part_of_its_own(command: OperatorCommand) -> None:
    run = Run(crowded(0))
    for _ in range(100):
        run.step()
    run.apply(command)
    run.step()
    parts = everybody(run.last, CROWD).parts
    assert parts.sum(axis=1) == pytest.approx(run.last.after.velocity, abs=1e-9)
    assert parts[:, Part.LIMIT] == pytest.approx(-run.last.trace.blended)
    assert not parts[:, Part.DETOUR].any()


def test_the_weight_of_a_human_that_was_raised_in_a_deadlock_is_found() -> None:
    run = Run(crowded(0))
    for command in stroke(PATH, 4):
        run.apply(command)
    for _ in range(30):
        run.step()
    weights, dt = CROWD.intention, CROWD.safety.control_period
    pull = CROWD.stall.human_boost * weights.human_weight
    old, trace = run.last.before.motion.intention, run.last.trace
    of = np.setdiff1d(trace.links[(trace.links == 4).any(axis=1)].ravel(), [4])
    weight = weights.decay + weights.robot_weight + pull + weights.neighbour_weight * len(of)
    drawn = weights.robot_weight * trace.robot_intention[4] + pull * trace.human_intention[4]
    drawn = drawn + weights.neighbour_weight * old[of].sum(axis=0)
    intention = run.last.after.intention.copy()
    intention[4] = (old[4] + dt * drawn) / (1.0 + dt * weight)
    raised = run.last._replace(after=run.last.after._replace(intention=intention))
    parts = everybody(raised, CROWD).parts[4]
    drive = trace.blending[4] * CROWD.blending.cruise_speed / np.hypot(*intention[4])
    assert parts[Part.HUMAN] == pytest.approx(drive * dt * pull / (1.0 + dt * weight) * trace.human_intention[4])


def test_each_part_belongs_to_whom_it_is_named_after() -> None:
    lone = team([(100.0, 300.0)], [(900.0, 300.0, 30.0)], needs=1)
    moved = periods(lone, ticks=1)[0]
    parts = everybody(moved, lone.params).parts[0]
    assert parts[Part.TARGET, 0] > 0.5
    assert not parts[[Part.HUMAN, Part.NEIGHBOURS, Part.FORMATION, Part.DETOUR, Part.LIMIT, Part.SAFETY]].any()
    led = team([(100.0, 300.0)])
    parts = everybody(periods(led, stroke(PATH), 1)[0], led.params).parts[0]
    assert np.hypot(*parts[Part.HUMAN]) > 1.0
    assert not parts[Part.TARGET].any()


def test_authority_shares_sum_to_one_and_name_who_leads() -> None:
    alone = [everybody(moved, CROWD).authority for moved in periods(crowded(0), ticks=60)]
    led = [everybody(moved, CROWD).authority for moved in periods(crowded(0), stroke(PATH, 4), 60)]
    for shares in (*alone, *led):
        total = shares.sum(axis=1)
        assert ((total == 0.0) | (np.abs(total - 1.0) < 1e-9)).all()  # 0: sees no fire and knows nobody who does
    assert led[-1].any(axis=1).all()
    assert not any(shares[:, Authority.HUMAN].any() for shares in alone)
    assert all(shares[4, Authority.HUMAN] > 0.5 for shares in led)
    assert not any(np.delete(shares, 4, axis=0)[:, Authority.HUMAN].any() for shares in led)


def test_some_robots_are_explained_as_in_the_whole_team() -> None:
    moved = periods(crowded(1), stroke(PATH, 4), 200)[-1]
    some = np.array([7, 4, 0])
    whole, few = everybody(moved, CROWD), explain(moved, CROWD, some)
    assert few.parts == pytest.approx(whole.parts[some], abs=1e-12)
    assert few.authority == pytest.approx(whole.authority[some])


def test_tight_rows_are_those_that_the_velocity_meets_with_equality() -> None:
    setup = with_params(crowded(0), CROWD)
    least = controlled(CROWD).safety
    named: set[str] = set()
    for moved in periods(setup, stroke(PATH, 4), 900):
        for robot in np.flatnonzero(moved.trace.active_constraints):
            rows = active_constraints(int(robot), moved, setup)
            assert len(rows) == moved.trace.active_constraints[robot]
            for row in rows:
                expected = distance_to(row.name, int(robot), moved, setup)
                assert row.distance == pytest.approx(expected)
                assert row.least == (least.robot_clearance if "robot" in row.name else least.obstacle_clearance)
                if row.name.startswith("circle") and not moved.trace.infeasible[robot]:
                    assert circle_slack(row.name, int(robot), moved, setup) == pytest.approx(0.0, abs=1e-6)
                named.add(row.name.split()[0])
    assert {"robot", "circle"} <= named


def circle_slack(name: str, robot: int, moved: Moved, setup: Setup) -> float:
    """How much faster the robot might have neared a named circle, by [27] [m/s]."""
    x, y, radius = setup.world.circles[int(name.split()[1]) - 1]
    safety, to = controlled(CROWD).safety, floats([x, y]) - moved.before.motion.position[robot]
    distance, clearance = float(np.hypot(*to)), radius + safety.obstacle_clearance
    h = (distance / clearance) ** 2 - 1.0
    bound = 0.5 * safety.obstacle_gain * clearance**2 * (h**3 if h >= 0.0 else h) / distance
    return bound - float(to @ moved.after.velocity[robot]) / distance


def distance_to(name: str, robot: int, moved: Moved, setup: Setup) -> float:
    """Distance of a named danger from a robot [m]."""
    kind, number = name.split()
    k, at = int(number) - 1, moved.before.motion.position
    if kind == "robot":
        return float(np.hypot(*(at[k] - at[robot])))
    if kind == "fire":
        return float(np.hypot(*(setup.world.fire_position[k] - at[robot])) - moved.before.motion.fire_radius[k])
    if kind == "circle":
        return float(np.hypot(*(setup.world.circles[k, :2] - at[robot])) - setup.world.circles[k, 2])
    ax, ay, bx, by, radius = setup.world.bars[k]
    return float(segment_distance(at[robot : robot + 1], floats([ax, ay]), floats([bx, by]))[0] - radius)


def test_a_wall_and_a_fire_that_hold_a_robot_back_are_named() -> None:
    setup = team([(100.0, 100.0)], [(900.0, 100.0, 30.0)])
    walled = setup._replace(world=setup.world._replace(walls=floats([[0.0, 1.0, 90.0]])))
    held = walled.start.motion._replace(position=floats([[100.0, 102.05]]))
    for position, name in (([100.0, 102.05], "wall"), ([900.0, 143.0], "fire 1")):
        start = walled.start._replace(motion=held._replace(position=floats([position])))
        run = Run(walled._replace(start=start))
        down = run.last._replace(after=run.last.after._replace(velocity=floats([[0.0, -1.0]])))
        counted = down._replace(trace=down.trace._replace(active_constraints=np.array([1])))
        assert [row.name for row in active_constraints(0, counted, walled)] == [name]
    assert (
        active_constraints(0, down._replace(trace=down.trace._replace(active_constraints=np.array([0]))), walled) == []
    )


def test_what_hides_a_fire_is_named_and_nothing_else_is() -> None:
    setup = team(
        [(100.0, 300.0)], [(900.0, 300.0, 30.0), (100.0, 600.0, 20.0)],
        [(500.0, 310.0, 40.0), (1000.0, 300.0, 40.0)], [(300.0, 340.0, 300.0, 500.0, 6.0)],
    )  # fmt: skip
    hidden, clear = sights(0, Run(setup).last, setup)
    assert hidden.value == pytest.approx(0.0, abs=1e-9)
    assert hider_names(hidden, setup) == ("circle 1",)
    assert clear.hidden_by == ()
    assert clear.value == pytest.approx(clear.whole)


def test_a_fire_beyond_the_perception_range_is_out_of_range_not_hidden() -> None:
    params = Parameters()._replace(perception=Parameters().perception._replace(perception_range=300.0))
    setup = team([(100.0, 300.0)], [(900.0, 300.0, 30.0)], [(500.0, 310.0, 40.0)], params=params)
    (far,) = sights(0, Run(setup).last, setup)
    assert not far.in_range
    assert far.value == 0.0
    assert far.hidden_by == ()


def test_the_edges_of_a_polygon_are_called_by_its_number() -> None:
    squares = [floats([[x, 250], [x + 50, 250], [x + 50, 350], [x, 350]]) for x in (400.0, 600.0)]
    setup = team([(100.0, 300.0)], [(900.0, 300.0, 30.0)], bars=[(500.0, 20.0, 550.0, 20.0, 5.0)], polygons=squares)
    (fire,) = sights(0, Run(setup).last, setup)
    assert sorted(hider_names(fire, setup)) == ["polygon 1", "polygon 2"]


def test_a_reset_run_is_explained_by_its_first_period_again() -> None:
    run = Run(crowded(0))
    first = run.last
    for _ in range(20):
        run.step()
    assert run.last.before.motion.tick == 19
    run.apply(ResetRun())
    assert run.last.before.motion.tick == 0
    assert run.last.after.velocity == pytest.approx(first.after.velocity)


@pytest.mark.parametrize("pace", [0.2, 1.5])
def test_the_parts_sum_at_another_pace_too(pace: float) -> None:
    commands = [*stroke(PATH, 4), ShapePath(pace=pace)]
    moved = [period for seed in range(2) for period in periods(crowded(seed), commands)]
    assert max(left_over(period, CROWD) for period in moved) < 1e-9


@pytest.mark.parametrize("ending", ["hold", "loop", "release"])
def test_the_parts_sum_when_a_path_is_over_and_the_wait_at_its_end_is_a_hold(ending: str) -> None:
    setup = crowded(0)
    commands = [*stroke(PATH, 4), ShapePath(ending=ending, duration=2.0)]
    moved = periods(setup, commands, 300)
    assert max(left_over(period, CROWD) for period in moved) < 1e-9
    last = moved[-1]
    held = last.after.path_status == PathStatus.HOLDING
    assert held is (ending == "hold")
    if held:
        parts = everybody(last, CROWD).parts
        led = last.trace.component == last.trace.component[4]
        assert parts[led, Part.LIMIT] == pytest.approx(-last.trace.blended[led])


def test_the_parts_sum_under_a_priority() -> None:
    moved = periods(crowded(0), [Prioritise(fires=(1,), robot=2)])
    assert max(left_over(period, CROWD) for period in moved) < 1e-9

"""Every public function refuses what it cannot use, in one line and before compiled code, and converts the rest."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import higvf_console as hc
from higvf_console import commands
from higvf_console.core.arrays import Floats
from tests.library.hostile import FORMS, USELESS, spoilt

TEAM = np.array([[100.0, 350.0], [60.0, 320.0], [60.0, 380.0]])
STROKE = np.array([[100.0, 350.0], [400.0, 300.0], [800.0, 350.0]])
SETUP = hc.make_setup(TEAM, hc.Hazards().circle((300, 330), 20).fire((500, 250), 20).inside((0, 0, 1200, 700)))
START, WORLD, PARAMS = SETUP.start, SETUP.world, SETUP.params
PATH = hc.circle_path((400, 300), 100)
_NONE: Any = "none"  # where None stands for a default


def _with_motion(**fields: object) -> hc.SimState:
    return START._replace(motion=START.motion._replace(**fields))  # pyright: ignore[reportArgumentType]


def _with_world(**fields: object) -> hc.World:
    return WORLD._replace(**fields)  # pyright: ignore[reportArgumentType]


# A function of an array (3, 2); all rows of it matter, so that another number of rows is wrong as well.
OF_A_TEAM: dict[str, Callable[[Any], object]] = {
    "Controller.step": lambda x: hc.Controller(SETUP).step(x),
    "filter_velocities of nominal": lambda x: hc.filter_velocities(TEAM, x),
    "filter_velocities of positions": lambda x: hc.filter_velocities(x, TEAM),
    "initial_state": lambda x: hc.initial_state(x, [20.0], WORLD),
    "advance": lambda x: hc.advance(_with_motion(position=x), WORLD, PARAMS),
    "advance of velocities": lambda x: hc.advance(_with_motion(velocity=x), WORLD, PARAMS),
    "advance of intentions": lambda x: hc.advance(_with_motion(intention=x), WORLD, PARAMS),
    "advance of a formation": lambda x: hc.advance(START, _with_world(formation=x), PARAMS),
    "roll": lambda x: hc.roll(_with_motion(position=x), WORLD, PARAMS, 2),
    "apply_command": lambda x: hc.apply_command(_with_motion(position=x), commands.Pause(), SETUP),
    "vector_field of a state": lambda x: hc.vector_field([[0.0, 0.0]], SETUP, _with_motion(position=x)),
    "make_setup of a formation": lambda x: hc.make_setup(TEAM, formation="none" if x is None else x),
}
# A function of any number of points.
OF_POINTS: dict[str, Callable[[Any], object]] = {
    "make_setup": hc.make_setup,
    "guiding_vectors": lambda x: hc.guiding_vectors(PATH, x),
    "vector_field": lambda x: hc.vector_field(x, SETUP),
    "sketch_path": hc.sketch_path,
    "Hazards.polygon": lambda x: hc.Hazards().polygon(x),
    "unicycle_commands": lambda x: hc.unicycle_commands(x, 0.0, hc.make_parameters(robots={"look_ahead": 5.0})),
    "apply_command of a stroke": lambda x: hc.apply_command(START, commands.StrokePoints(points=x), SETUP),
}


def refused(call: Callable[[], object]) -> str:
    """The one line with which a call is refused."""
    with pytest.raises(hc.HigvfError) as caught:
        call()
    line = str(caught.value)
    assert isinstance(caught.value, ValueError)
    assert "\n" not in line
    assert 10 < len(line) < 300
    return line


@pytest.mark.parametrize("what", USELESS)
@pytest.mark.parametrize("function", [*OF_A_TEAM, *OF_POINTS])
def test_what_is_no_array_of_points_is_refused(function: str, what: str) -> None:
    line = refused(lambda: (OF_A_TEAM | OF_POINTS)[function](USELESS[what]))
    assert "expected" in line
    assert "shape" in line


@pytest.mark.parametrize("what", ["NaN", "infinite", "huge"])
@pytest.mark.parametrize("function", [*OF_A_TEAM, *OF_POINTS])
def test_an_element_that_is_no_number_in_range_is_refused_by_its_place(function: str, what: str) -> None:
    line = refused(lambda: (OF_A_TEAM | OF_POINTS)[function](spoilt(TEAM)[what]))
    assert {"NaN": "[2, 1] is nan", "infinite": "[0, 0] is -inf", "huge": "[0, 1] is 1e+300"}[what] in line


@pytest.mark.parametrize("what", ["a row too few", "a row too many"])
@pytest.mark.parametrize("function", OF_A_TEAM)
def test_another_number_of_robots_is_refused(function: str, what: str) -> None:
    line = refused(lambda: OF_A_TEAM[function](spoilt(TEAM)[what]))
    assert "shape (2, 2)" in line or "shape (4, 2)" in line or "shape (3, 2)" in line


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("function", [*OF_A_TEAM, *OF_POINTS])
def test_what_can_be_converted_gives_the_same_bytes(function: str, form: str) -> None:
    call = (OF_A_TEAM | OF_POINTS)[function]
    assert _bytes(call(FORMS[form](TEAM))) == _bytes(call(TEAM))


def _bytes(result: object) -> list[bytes]:
    """All arrays of a result, field by field."""
    if isinstance(result, np.ndarray):
        return [result.tobytes()]
    if isinstance(result, tuple):
        return [content for part in result for content in _bytes(part)]
    return _bytes(tuple(result.__dict__.values())) if isinstance(result, hc.Hazards) else []


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("tick", 1.5), ("tick", -1), ("tick", None), ("heading", np.zeros(2)), ("heading", [0.0, np.nan, 0.0]),
        ("target", [0, 0, 1]), ("target", [-2, 0, 0]), ("target", [0.5, 0.0, 0.0]), ("target", [0, 0]),
        ("target_value", None), ("circulation", np.zeros((3, 3), int)), ("circulation", np.full((3, 2), 9)),
        ("stalled", "zero"), ("recovery_stage", [0, 0, -1]), ("fire_radius", [20.0, 30.0]), ("fire_radius", []),
        ("fire_progress", [np.inf]), ("fire_burning", [1]), ("fire_burning", [True, True]), ("path_parameter", np.nan),
        ("path_parameter", np.inf), ("path_status", 17), ("path_status", "following"), ("path_idle", [0.0]),
    ],
)  # fmt: skip
def test_a_state_that_does_not_fit_its_world_is_refused_by_field(field: str, value: object) -> None:
    for call in (
        lambda: hc.advance(_with_motion(**{field: value}), WORLD, PARAMS),
        lambda: hc.roll(_with_motion(**{field: value}), WORLD, PARAMS, 1),
        lambda: hc.Controller(SETUP._replace(start=_with_motion(**{field: value}))),
        lambda: hc.apply_command(_with_motion(**{field: value}), commands.Pause(), SETUP),
    ):
        assert f"motion.{field}" in refused(call)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("influenced", 3), ("influenced", -1), ("influenced", 0.5), ("paused", 1), ("stopped", None), ("path", None),
        ("priority", [[3, 0, 1.0]]), ("priority", [[0, 1, 1.0]]), ("priority", [[0, 0]]),
        ("path", PATH._replace(kind=9)), ("path", PATH._replace(kind=3)), ("path", PATH._replace(shape=np.zeros(3))),
        ("path", PATH._replace(direction=0.0)), ("path", PATH._replace(spacing=0.0)),
        ("path", PATH._replace(spline=np.zeros((2, 7)))), ("path", PATH._replace(ending=7)),
    ],
)  # fmt: skip
def test_an_intent_that_names_what_does_not_exist_is_refused_by_field(field: str, value: object) -> None:
    state = START._replace(intent=START.intent._replace(**{field: value}))  # pyright: ignore[reportArgumentType]
    assert f"intent.{field}" in refused(lambda: hc.advance(state, WORLD, PARAMS))


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("capsules", np.zeros((1, 4))), ("capsules", [[0.0, 0.0, 0.0, np.nan, 5.0]]), ("circle_count", 5),
        ("walls", None), ("capsule_velocity", np.zeros((2, 2))), ("mover", np.zeros((1, 8))), ("course_start", [0, 1]),
        ("course_start", []), ("course", np.zeros((2, 3))),
        ("fire_position", np.zeros((2, 2))), ("fire_growth", [1.0, 1.0]), ("fire_needs", [1.5]), ("fire_needs", [0]),
        ("link_start", [0, 1]), ("link_start", [0, 0, 0, 2]), ("link_to", [0, 1]), ("boundary", np.zeros((0, 9))),
        ("boundary", np.zeros((1, 8))), ("boundary_start", np.zeros((3, 3), int)), ("hull", np.zeros((2, 2))),
        ("boundary_start", [[0, 0], [0, 9], [0, 0]]), ("part", [5]), ("part", []), ("pocket", np.zeros((4, 3))),
    ],
)  # fmt: skip
def test_a_world_that_contradicts_itself_is_refused(field: str, value: object) -> None:
    for call in (
        lambda: hc.advance(START, _with_world(**{field: value}), PARAMS),
        lambda: hc.roll(START, _with_world(**{field: value}), PARAMS, 1),
        lambda: hc.initial_state(TEAM, [20.0], _with_world(**{field: value})),
        lambda: hc.Controller(SETUP._replace(world=_with_world(**{field: value}))),
    ):
        assert "." in refused(call)


@pytest.mark.parametrize("what", [None, "all", 3, {}, PARAMS.safety])
def test_records_of_another_type_are_refused(what: Any) -> None:
    for call in (
        lambda: hc.advance(what, WORLD, PARAMS),
        lambda: hc.advance(START, what, PARAMS),
        lambda: hc.advance(START, WORLD, what),
        lambda: hc.roll(START, WORLD, PARAMS, what) if what != 3 else hc.roll(START, WORLD, PARAMS, -3),
        lambda: hc.apply_command(START, what, SETUP),
        lambda: hc.apply_command(START, commands.Pause(), what),
        lambda: hc.Controller(what),
        lambda: hc.vector_field(TEAM, what),
        lambda: hc.filter_velocities(TEAM, TEAM, what or _NONE),
        lambda: hc.filter_velocities(TEAM, TEAM, None, what or _NONE),
        lambda: hc.guiding_vectors(what, TEAM),
        lambda: hc.path_points(what),
        lambda: hc.make_scenario(what),
        lambda: hc.make_setup(TEAM, path=what or _NONE),
        lambda: hc.run(what) if not isinstance(what, str) else hc.run(3),  # pyright: ignore[reportArgumentType]
        lambda: hc.run_headless(what),
        lambda: hc.Session(what, []),
        lambda: hc.replay(what),
        lambda: hc.open_interface(what),
    ):
        assert "expected" in refused(call)


def _params(group: str, **fields: Any) -> hc.Parameters:
    return PARAMS._replace(**{group: getattr(PARAMS, group)._replace(**fields)})


@pytest.mark.parametrize(
    "params",
    [
        _params("safety", robot_clearance=np.nan), _params("safety", speed_limit=-1.0),
        _params("safety", control_period="fast"), _params("safety", control_period=0.0),
        _params("blending", cruise_speed=None), _params("robots", seed=np.inf), _params("forms", h_index=2.0),
        _params("boundaries", reactive_margin=10.0), _params("path", capture_distance=[40.0]),
        PARAMS._replace(safety=None),
    ],
)  # fmt: skip
def test_parameters_out_of_range_are_refused_by_name(params: hc.Parameters) -> None:
    for call in (
        lambda: hc.advance(START, WORLD, params),
        lambda: hc.filter_velocities(TEAM, TEAM, None, params),
        lambda: hc.make_setup(TEAM, None, params),
        lambda: hc.guiding_vectors(PATH, TEAM, params),
    ):
        assert "." in refused(call)


SCALARS: dict[str, Callable[[Any], object]] = {
    "circle's radius": lambda x: hc.Hazards().circle((0, 0), x),
    "circle's growth": lambda x: hc.Hazards().circle((0, 0), 5, growth=x),
    "capsule's half width": lambda x: hc.Hazards().capsule((0, 0), (5, 0), x),
    "fire's radius": lambda x: hc.Hazards().fire((0, 0), x),
    "wall's offset": lambda x: hc.Hazards().wall((1, 0), x),
    "circle path's radius": lambda x: hc.circle_path((0, 0), x),
    "line path's angle": lambda x: hc.line_path((0, 0), x),
    "path's pace": lambda x: hc.line_path((0, 0), pace=x),
    "path's duration": lambda x: hc.line_path((0, 0), duration=x),
    "path's direction": lambda x: hc.line_path((0, 0), direction=x),
    "sketch's smoothing": lambda x: hc.sketch_path(STROKE, -1.0 if x is None else x),
    "robots_needed": lambda x: hc.Hazards().fire((0, 0), 5, robots_needed=x),
    "influenced": lambda x: hc.make_setup(TEAM, influenced=x),
    "influenced of a step": lambda x: hc.Controller(SETUP).step(TEAM, influenced=x if x is not None else -1),
    "ticks": lambda x: hc.roll(START, WORLD, PARAMS, x),
    "heading": lambda x: hc.initial_state(TEAM, [20.0], WORLD, x),
    "duration of a run": lambda x: hc.run(SETUP, -1.0 if x is None else x),
    "seed of a run": lambda x: hc.run(SETUP, 0.1, seed=x),
    "duration of a scenario": lambda x: hc.make_scenario(SETUP, duration=x),
    "seed of a setup": lambda x: hc.load_scenario("empty").setup(x),
}


@pytest.mark.parametrize("value", [None, "5", np.nan, -np.inf, [5.0, 6.0], {}, -1e9, b"5"], ids=repr)
@pytest.mark.parametrize("function", SCALARS)
def test_a_number_that_is_none_or_out_of_range_is_refused(function: str, value: object) -> None:
    assert "expected" in refused(lambda: SCALARS[function](value))


OF_A_POINT: dict[str, Callable[[Any], object]] = {
    "circle": lambda x: hc.Hazards().circle(x, 5),
    "circle's velocity": lambda x: hc.Hazards().circle((0, 0), 5, velocity=x),
    "capsule": lambda x: hc.Hazards().capsule(x, (0, 0), 5),
    "fire": lambda x: hc.Hazards().fire(x, 5),
    "wall": lambda x: hc.Hazards().wall(x, 5),
    "inside": lambda x: hc.Hazards().inside(x),
    "line_path": hc.line_path,
    "circle_path": lambda x: hc.circle_path(x, 5),
    "ellipse_path": lambda x: hc.ellipse_path(x, (5, 6)),
    "ellipse_path's axes": lambda x: hc.ellipse_path((0, 0), x),
}


@pytest.mark.parametrize("value", [None, "ab", [1.0], [[1.0, 2.0]], [np.nan, 0.0], [0.0, 1e9], {}, []], ids=repr)
@pytest.mark.parametrize("function", OF_A_POINT)
def test_a_point_that_is_none_is_refused(function: str, value: object) -> None:
    assert "expected" in refused(lambda: OF_A_POINT[function](value))


def test_interfaces_that_are_none_are_refused() -> None:
    class Deaf:
        name = "deaf"

    for interfaces in (None, 5, "mouse", [Deaf()], [Deaf], [None]):
        line = refused(lambda given=interfaces: hc.run(SETUP, 0.1, interfaces=given))  # pyright: ignore
        assert "interfaces" in line


def test_files_that_are_no_names_are_refused(tmp_path: Path) -> None:
    scenario: Any = hc.make_scenario(SETUP)
    bad: Any
    for bad in (None, 5, []):
        refused(lambda given=bad: hc.read_recording(given))
        refused(lambda given=bad: hc.Recorder(given, scenario, 0))
        refused(lambda given=bad: hc.load_scenario(given))
    refused(lambda: hc.Recorder(tmp_path / "run.jsonl", None, 0))  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize(
    "command",
    [
        commands.Pick(robot="first"),  # pyright: ignore[reportArgumentType]
        commands.Pick(robot=-4),
        commands.Cursor(point=np.zeros(3)),
        commands.MovePathPoint(grip=np.zeros(1), point=np.zeros(2)),
        commands.Pause,
        "Pause",
    ],
    ids=repr,
)
def test_commands_that_cannot_be_used_are_refused(command: Any) -> None:
    refused(lambda: hc.apply_command(START, command, SETUP))


def test_a_cursor_that_is_out_of_sight_is_no_error() -> None:
    state, _ = hc.apply_command(START, commands.Cursor(point=np.full(2, np.nan)), SETUP)
    assert np.isnan(state.pointer_state.cursor).all()


@pytest.fixture(name="random")
def _random() -> np.random.Generator:
    return np.random.default_rng(7)


def test_the_results_of_a_step_pass_the_checks_themselves(random: np.random.Generator) -> None:
    state = START
    for _ in range(20):
        state, _ = hc.advance(state, WORLD, PARAMS)
    ahead, history = hc.roll(START, WORLD, PARAMS, 20)
    assert ahead.motion.position.tobytes() == state.motion.position.tobytes() == history.position[-1].tobytes()
    nominal: Floats = random.uniform(-90, 90, (3, 2))
    assert hc.filter_velocities(state.motion.position, nominal).velocity.shape == (3, 2)

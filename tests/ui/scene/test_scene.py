"""What the operator sees has the right shape, place and colour; pure, without a browser."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from higvf_console.control.guidance.field import FieldKind
from higvf_console.control.guidance.paths import circle_path, line_path, sketch_path
from higvf_console.control.parameters import Parameters, RobotParameters
from higvf_console.core.arrays import Floats, floats, ints
from higvf_console.core.state import NO_PATH, SimState
from higvf_console.core.viewport import Arena
from higvf_console.sim.simulation import advance
from higvf_console.ui import theme
from higvf_console.ui.panels.view import FIELDS
from higvf_console.ui.scene import shapes
from higvf_console.ui.scene.field import field_grid
from higvf_console.ui.scene.fires import FireLook, fire_lettering, fire_look, progress_arcs
from higvf_console.ui.scene.glyphs import STROKES, WEIGHT, Triangles, glyph, lettering, numbering, width
from higvf_console.ui.scene.ground import axis_lettering, grid, obstacle_outlines, scale_bar, with_margin
from higvf_console.ui.scene.parts import Canvas, Layer, turned
from higvf_console.ui.scene.path import path_outline, thinned
from higvf_console.ui.scene.team import (
    ALL_AT_ONCE,
    LAG,
    MOST_LINKS,
    TRAIL_POINTS,
    Team,
    clock,
    faded,
    link_segments,
    rings,
    spread,
)
from higvf_console.ui.ui_state import UiStore, show_next_field
from tests.teams import team

ARENA = Arena(0.0, 0.0, 1200.0, 700.0)
TRIANGLE = floats([[100, 350], [60, 320], [60, 380]])


def lengths(segments: np.ndarray) -> np.ndarray:
    return np.hypot(*(segments[:, 1] - segments[:, 0]).T)


def test_a_moving_robot_heads_along_its_velocity_and_a_resting_one_keeps_its_heading() -> None:
    velocity = floats([[0.0, 30.0], [0.1, -0.1], [-30.0, 0.0]])
    heading = shapes.headings(velocity, floats([0.3, 0.4, 0.5]), cruise_speed=60.0)
    assert heading == pytest.approx([np.pi / 2, 0.4, np.pi])


def test_a_mark_points_along_x_before_it_is_turned() -> None:
    mark = shapes.dart(20.0)
    assert mark.vertices[:, 0].argmax() == 0
    assert mark.vertices[0, 1] == 0.0
    assert np.ptp(mark.vertices[:, 0]) == pytest.approx(20.0)
    assert turned(floats([np.pi]))[0] == pytest.approx([0, 0, 0, 1], abs=1e-6)


def test_every_point_of_a_capsule_outline_is_one_radius_from_its_spine() -> None:
    a, b = floats([100, 50]), floats([180, 110])
    outline = shapes.capsule(a, b, 12.0)
    along = np.clip((outline - a) @ (b - a) / np.sum((b - a) ** 2), 0, 1)
    gap = np.hypot(*(outline - a - along[:, None] * (b - a)).T)
    assert gap == pytest.approx(np.full(len(outline), 12.0))
    assert outline[0] == pytest.approx(outline[-1])


def test_an_annulus_covers_the_area_between_its_circles() -> None:
    vertices, faces = shapes.annulus(8.0, 10.0, 400)
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    (ux, uy), (vx, vy) = (b - a).T, (c - a).T
    assert np.abs(ux * vy - uy * vx).sum() / 2 == pytest.approx(np.pi * 36.0, rel=1e-3)


def test_dashes_cover_their_share_of_the_line_and_end_before_its_end() -> None:
    dashes = shapes.dashed(floats([[0, 0], [100, 0]]), 5.0, 5.0)
    assert lengths(dashes).sum() == pytest.approx(50.0)
    assert dashes[..., 0].max() < 100.0


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_chevrons_ride_on_the_path_and_point_along_travel(direction: float) -> None:
    heads = shapes.chevrons(floats([[0, 0], [300, 0], [300, 300]]), 60.0, 12.0, direction)
    nose, _, notch, _ = heads.vertices.reshape(-1, 4, 2).transpose(1, 0, 2)
    travel = (nose - notch) / np.hypot(*(nose - notch).T)[:, None]
    assert len(nose) == 10
    assert travel[0] == pytest.approx([direction, 0.0])
    assert travel[-1] == pytest.approx([0.0, direction])


def test_a_path_without_length_has_no_chevrons() -> None:
    assert len(shapes.chevrons(floats([[5, 5], [5, 5]]), 60.0, 12.0, 1.0).faces) == 0


def test_field_arrows_show_direction_and_share_of_the_largest_and_leave_out_zero() -> None:
    vectors = floats([[60.0, 0.0], [0.0, -30.0], [0.0, 0.0]])
    drawn = shapes.arrows(floats([[0, 0], [50, 0], [100, 0]]), vectors, 30.0)
    shafts = drawn[::3]
    assert len(drawn) == 6
    assert shafts[0] == pytest.approx(floats([[-15, 0], [15, 0]]))
    assert shafts[1, 1] - shafts[1, 0] == pytest.approx([0.0, -20.0])
    assert len(shapes.arrows(floats([[0, 0]]), floats([[0, 0]]), 30.0)) == 0


def test_ticks_are_round_numbers_and_never_too_many() -> None:
    for extent in (0.7, 3.2, 700.0, 1200.0, 4321.0):
        spacing = shapes.tick_spacing(extent, 13)
        assert len(shapes.ticks(0.0, extent, spacing)) <= 14
        assert f"{spacing:e}"[0] in "125"
    assert shapes.ticks(-250.0, 250.0, 100.0) == pytest.approx([-200, -100, 0, 100, 200])


def test_every_glyph_fits_its_advance_and_its_line() -> None:
    for character in STROKES:
        vertices = glyph(character).vertices
        if len(vertices):
            assert vertices[:, 0].min() > -WEIGHT
            assert vertices[:, 0].max() < width(character) + WEIGHT
            assert vertices[:, 1].max() < 1 + WEIGHT


@pytest.mark.parametrize(("anchor", "left"), [(0.0, 100.0), (0.5, 90.0), (1.0, 80.0)])
def test_a_text_lies_at_its_anchor(anchor: float, left: float) -> None:
    height = 20.0 / width("1200")
    text = lettering("1200", 100.0, 50.0, height, anchor)
    assert text.vertices[:, 0].min() == pytest.approx(left, abs=height * WEIGHT)
    assert text.vertices[:, 0].max() == pytest.approx(left + 20.0, abs=height * WEIGHT)
    assert text.vertices[:, 1].mean() == pytest.approx(50.0, abs=0.3 * height)


def test_robots_are_numbered_from_one_by_one_batch_a_digit() -> None:
    places = {found.digit: found for found in numbering(12, 50)}
    assert sorted(places) == list("0123456789")
    assert places["1"].robot.tolist() == [0, 9, 10, 10, 11]
    assert places["2"].robot.tolist() == [1, 11]
    first, second = places["1"].offset[[2, 3]]
    assert first < 0 < second


def test_a_team_larger_than_the_limit_is_not_numbered() -> None:
    assert numbering(50, 50) != []
    assert numbering(51, 50) == []


def test_grid_axes_and_scale_bar_fit_the_arena_and_its_margin() -> None:
    spacing, px = 100.0, 1.3
    room = with_margin(ARENA, 2 * px)
    lines, letters, bar = grid(ARENA, spacing), axis_lettering(ARENA, spacing, px), scale_bar(ARENA, spacing, px)
    assert len(lines) == 13 + 8
    assert lines.min() == 0.0
    assert lines[..., 0].max() == 1200.0
    assert np.ptp(bar[..., 0]) == spacing
    for points in (letters.vertices, bar.reshape(-1, 2)):
        assert (points >= [room.x_min, room.y_min]).all()
        assert (points <= [room.x_max, room.y_max]).all()


def test_boundaries_keep_their_margin_from_circles_and_bars() -> None:
    setup = team(circles=[(300.0, 200.0, 20.0)], bars=[(900.0, 200.0, 900.0, 400.0, 6.0)])
    circle, bar = obstacle_outlines(setup, 25.0)
    assert np.hypot(*(circle - [300, 200]).T) == pytest.approx(np.full(len(circle), 45.0))
    assert bar[:, 0].max() == pytest.approx(931.0)
    assert bar[:, 1].min() == pytest.approx(169.0)


def test_an_open_path_is_drawn_from_its_start_to_its_end() -> None:
    stroke = floats([[100, 100], [200, 150], [300, 120], [400, 300]])
    arc, points = path_outline(sketch_path(stroke, 0.0), ARENA)
    assert points[[0, -1]] == pytest.approx(stroke[[0, -1]], abs=0.1)
    assert arc[-1] == pytest.approx(lengths(shapes.segments(points)).sum(), rel=1e-3)


def test_a_closed_path_is_drawn_closed() -> None:
    arc, points = path_outline(circle_path(600.0, 300.0, 100.0), ARENA)
    assert points[0] == pytest.approx(points[-1])
    assert arc[-1] == pytest.approx(2 * np.pi * 100.0)


@pytest.mark.parametrize("angle", [0.0, np.pi / 2, 0.4, -2.0])
def test_a_line_is_drawn_from_border_to_border(angle: float) -> None:
    _, points = path_outline(line_path(600.0, 300.0, angle), ARENA)
    on_border = (np.abs(points[[0, -1]] - [[0, 0]]) < 1e-6) | (np.abs(points[[0, -1]] - [[1200, 700]]) < 1e-6)
    assert on_border.any(axis=1).all()
    assert (points >= -1e-6).all()


def test_a_line_that_misses_the_arena_and_no_path_draw_nothing() -> None:
    assert len(path_outline(line_path(600.0, 900.0, 0.0), ARENA)[1]) == 0
    assert len(path_outline(NO_PATH, ARENA)[1]) == 0


def test_a_long_stroke_is_thinned_between_its_ends() -> None:
    stroke = np.stack([np.arange(1000.0), np.zeros(1000)], axis=1)
    short = thinned(stroke, 400)
    assert len(short) == 400
    assert short[[0, -1]] == pytest.approx(stroke[[0, -1]])
    assert len(thinned(stroke[:3], 400)) == 3
    assert len(shapes.segments(thinned(stroke[:0], 400))) == 0


def test_a_fire_is_fought_when_its_crew_is_large_enough() -> None:
    setup = team(fires=[(500.0, 250.0, 20.0), (300.0, 450.0, 30.0), (900.0, 100.0, 40.0)])
    state, trace = advance(setup.start, setup.world, setup.params)
    work = setup.params.fires.extinguish_time * state.motion.fire_radius
    motion = state.motion._replace(fire_progress=work * [0.5, 0.0, 1.0], fire_burning=np.array([True, True, False]))
    look = fire_look(state._replace(motion=motion), trace._replace(crew=ints([2, 1, 2])), setup)
    assert look.fought.tolist() == [True, False, False]
    assert look.progress == pytest.approx([0.5, 0.0, 1.0])


def test_the_arc_of_a_fire_grows_clockwise_from_the_top_with_its_progress() -> None:
    look = FireLook(np.array([True, True]), np.array([True, False]), floats([0.25, 0.0]))
    arc = progress_arcs(floats([[500, 250], [300, 450]]), floats([20, 30]), look, 3.0)
    assert arc[0, 0] == pytest.approx([500, 273])
    assert arc[-1, 1] == pytest.approx([523, 250])
    assert lengths(arc).sum() == pytest.approx(0.5 * np.pi * 23.0, rel=1e-3)


def test_a_large_fire_is_numbered_inside_a_small_one_below_and_one_that_is_out_shows_its_loss() -> None:
    at, radius = floats([[100, 100], [300, 100], [500, 100]]), floats([40.0, 5.0, 30.0])
    inside, outside, ashes = fire_lettering(at, radius, np.array([True, True, False]), floats([0, 0, 2827.4]), 1.0)
    assert inside.vertices[:, 1].mean() == pytest.approx(100.0, abs=3.0)
    assert outside.vertices[:, 1].max() < 95.0
    assert np.ptp(ashes.vertices[:, 0]) > 40.0
    assert ashes.vertices[:, 1].min() < 70.0


def test_links_of_a_dense_team_are_shown_up_to_a_limit() -> None:
    at = floats(np.random.default_rng(1).uniform(0, 1000, (200, 2)))
    links = ints(np.stack(np.triu_indices(200, 1), axis=1))
    assert len(link_segments(at, links)) == MOST_LINKS
    assert link_segments(at, links[:5]) == pytest.approx(at[links[:5]])
    assert len(link_segments(at, links[:0])) == 0


def test_only_robots_in_trouble_wear_a_ring() -> None:
    marked = np.array([False, True, False])
    assert len(rings(TRIANGLE, marked, 10.0, 24)) == 24
    assert np.hypot(*(rings(TRIANGLE, marked, 10.0, 4)[:, 0] - TRIANGLE[1]).T) == pytest.approx(np.full(4, 10.0))
    assert len(rings(TRIANGLE, ~np.ones(3, np.bool_), 10.0, 24)) == 0


def test_trails_fade_with_age_into_the_floor() -> None:
    colours = faded(TRAIL_POINTS - 1, 3)
    assert colours.shape == (3 * (TRAIL_POINTS - 1), 2, 3)
    assert colours[0, 0].tolist() == list(theme.vertex_rgb(theme.DARK.floor))
    assert colours[-1, 1].tolist() == list(theme.vertex_rgb(theme.DARK.trail))
    assert faded(1, 3)[0, 1].tolist() == list(theme.vertex_rgb(theme.DARK.trail))


def test_the_field_grid_is_even_and_inside_the_arena() -> None:
    points = field_grid(ARENA, 50.0)
    assert len(points) == 24 * 14
    assert points.mean(axis=0) == pytest.approx([600, 350])
    assert (points > 0).all()


def test_the_field_key_goes_through_all_fields_and_off_again() -> None:
    ui = UiStore()
    seen = [ui.state.field, *(ui.change(show_next_field).field for _ in FIELDS)]
    assert seen == [*FIELDS.values(), None] == [None, FieldKind.PATH, FieldKind.COMPOSITE, FieldKind.BLENDED, None]


class _Drawn:
    """A canvas without a browser: what was placed or drawn last under each name."""

    px, palette, sizes = 1.0, theme.DARK, theme.NOMINAL

    def __init__(self) -> None:
        self.nodes: dict[str, _Node] = {}

    def marks(self, _layer: Layer, name: str, shape: Triangles, *, count: int, **_: object) -> "_Node":
        self.nodes[name] = _Node(count, float(shape.vertices.max()))
        return self.nodes[name]

    def lines(self, _layer: Layer, name: str, _colour: str | None, _thickness: float) -> "_Node":
        self.nodes[name] = _Node(0, 0.0)
        return self.nodes[name]


class _Node:
    def __init__(self, count: int, extent: float) -> None:
        self.count, self.extent = count, extent
        self.at = self.segments = floats([], 0, 2)
        self.heading: Floats | None = None

    def place(self, positions: Floats, heading: Floats | None = None, **_: object) -> None:
        self.at, self.heading = positions, heading

    def draw(self, segments: Floats, *_: object) -> None:
        self.segments = segments

    def show(self, *_: object) -> None: ...
    def resize(self, *_: object) -> None: ...
    def highlight(self, *_: object) -> None: ...


def drawn(params: Parameters) -> tuple[SimState, dict[str, _Node]]:
    """A team after one tick, as it is drawn."""
    setup = team(robots=[(100.0, 350.0), (40.0, 300.0)], params=params)
    heading = floats([0.0, np.pi / 2])
    start = setup.start._replace(motion=setup.start.motion._replace(heading=heading))
    state, trace = advance(start, setup.world, setup.params)
    canvas = _Drawn()
    Team(cast(Canvas, canvas), setup).update(state, trace, 0.0)
    return state, canvas.nodes


def test_a_unicycle_is_drawn_at_its_centre_with_its_heading_its_point_and_both_clearances() -> None:
    state, nodes = drawn(Parameters(robots=RobotParameters(look_ahead=6.0, turn_rate_limit=3.0, position_noise=0.5)))
    points, centres = state.motion.position, nodes["/team/robots"].at
    assert centres == pytest.approx(points - [[6.0, 0.0], [0.0, 6.0]], abs=1e-3)
    assert (nodes["/team/robots"].heading == state.motion.heading).all()
    assert (nodes["/team/look_ahead"].at == points).all()
    assert nodes["/team/look_ahead_ties"].segments == pytest.approx(np.stack([centres, points], axis=1))
    assert (nodes["/team/clearance"].at == centres).all()
    assert nodes["/team/clearance"].extent == pytest.approx(25.0 / 2)
    assert (nodes["/team/enlarged"].at == points).all()
    assert nodes["/team/enlarged"].extent == pytest.approx((25.0 + 2 * 6.5) / 2)


def test_a_single_integrator_has_neither_look_ahead_point_nor_a_second_clearance() -> None:
    state, nodes = drawn(Parameters())
    assert (nodes["/team/robots"].at == state.motion.position).all()
    assert nodes["/team/look_ahead"].count == nodes["/team/enlarged"].count == 0
    assert len(nodes["/team/look_ahead_ties"].segments) == 0


def test_a_number_moves_with_a_halo_of_the_floor_that_is_wider_by_its_margin() -> None:
    _, nodes = drawn(Parameters())
    for digit in "12":
        number, halo = nodes[f"/team/digit_{digit}"], nodes[f"/team/halo_{digit}"]
        assert halo.at == pytest.approx(number.at)
        assert len(halo.at) == 1
    assert np.ptp(spread(glyph("8"), 0.16).vertices, axis=0) == pytest.approx(
        np.ptp(glyph("8").vertices, axis=0) + 2 * 0.16
    )


@pytest.mark.parametrize(("robots", "at_once"), [(ALL_AT_ONCE, True), (ALL_AT_ONCE + 1, False)])
def test_links_rings_and_headings_of_a_large_team_follow_a_little_later(
    monkeypatch: pytest.MonkeyPatch, robots: int, at_once: bool
) -> None:
    now = SimpleNamespace(seconds=100.0)
    monkeypatch.setattr(clock, "monotonic", lambda: now.seconds)
    setup = team(robots=[(100.0 + 30.0 * (i % 8), 100.0 + 30.0 * (i // 8)) for i in range(robots)])
    state, trace = advance(setup.start, setup.world, setup.params)
    trace = trace._replace(links=ints([[0, 1]]), deadlocked=np.arange(robots) == 0)
    canvas = _Drawn()
    drawing = Team(cast(Canvas, canvas), setup)
    drawing.update(state, trace, 0.0)
    moved = state._replace(motion=state.motion._replace(position=state.motion.position + 5.0))
    lines = [canvas.nodes[name] for name in ("/team/links", "/team/deadlocked")]
    before = [node.segments for node in lines]
    drawing.update(moved, trace, 0.1)
    assert [np.array_equal(node.segments, old) for node, old in zip(lines, before, strict=True)] == [not at_once] * 2
    robots_drawn = canvas.nodes["/team/robots"]
    assert robots_drawn.at == pytest.approx(moved.motion.position)
    assert (robots_drawn.heading is not None) == at_once
    now.seconds += 1.01 * LAG
    drawing.update(moved, trace, 0.2)
    assert robots_drawn.heading is not None
    for node, old in zip(lines, before, strict=True):
        assert node.segments == pytest.approx(old + 5.0)

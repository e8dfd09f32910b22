"""Obstacles of every shape are drawn where they are: filled, edged, with boundaries that stay inside the arena."""

from collections.abc import Callable

import cv2
import numpy as np
import pytest
from playwright.sync_api import Page

from higvf_console.control.guidance.boundaries import ALONE, boundary_at, find_boundaries
from higvf_console.core.arrays import Floats, floats
from higvf_console.ui.scene import shapes
from higvf_console.ui.scene.glyphs import Triangles
from higvf_console.ui.scene.ground import Ground, obstacle_bodies, obstacle_outlines, obstacle_surfaces
from higvf_console.ui.scene.parts import Canvas
from higvf_console.ui.theme import DARK, dress, hex_rgb
from higvf_console.world.polygons import signed_area, signed_distance
from higvf_console.world.setup import Setup
from tests.browser import ARENA, open_stage, screenshot, to_page
from tests.teams import team

U_SHAPE = floats([[400, 200], [700, 200], [700, 500], [600, 500], [600, 300], [500, 300], [500, 500], [400, 500]])
BLOCK = floats([[800, 100], [1100, 100], [1100, 400], [800, 400]])
YARD = floats([[900, 200], [900, 300], [1000, 300], [1000, 200]])


def area(mesh: Triangles) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    (ux, uy), (vx, vy) = (b - a).T, (c - a).T
    return float(np.abs(ux * vy - uy * vx).sum() / 2)


def site(*polygons: Floats) -> Setup:
    """A circle, a true bar and polygons."""
    return team(circles=[(200.0, 200.0, 20.0)], bars=[(900.0, 600.0, 1000.0, 600.0, 6.0)], polygons=polygons)


def test_a_shape_that_is_not_convex_is_filled_exactly() -> None:
    mesh = shapes.filled_between([U_SHAPE])
    assert area(mesh) == pytest.approx(signed_area(U_SHAPE))
    centroids = mesh.vertices[mesh.faces].mean(axis=1)
    assert (signed_distance([U_SHAPE], centroids) < 0).all()


def test_a_free_area_inside_is_left_out() -> None:
    assert area(shapes.filled_between([BLOCK, YARD])) == pytest.approx(300 * 300 - 100 * 100)


def test_an_inflated_hull_keeps_its_margin_from_every_corner() -> None:
    hull = floats([[400, 200], [700, 200], [700, 500], [400, 500]])
    outline = shapes.inflated(hull, 25.0)
    assert signed_distance([hull], outline) == pytest.approx(np.full(len(outline), 25.0))
    assert outline[0] == pytest.approx(outline[-1])
    assert signed_area(outline[:-1]) == pytest.approx(300 * 300 + 4 * 300 * 25 + np.pi * 25**2, rel=1e-3)


def test_boundaries_are_drawn_where_the_field_turns_robots_and_once_for_parts_without_a_way_between() -> None:
    setup = team(
        circles=[(200.0, 200.0, 20.0), (255.0, 210.0, 25.0), (600.0, 500.0, 40.0)],
        bars=[(900.0, 200.0, 900.0, 400.0, 6.0), (905.0, 420.0, 1000.0, 430.0, 4.0)],
    )
    boundaries = find_boundaries(setup.start.motion, setup.world, setup.params.safety.obstacle_clearance)
    outlines = obstacle_outlines(setup, 25.0)
    assert len(outlines) == 3
    for group, outline in enumerate(outlines):
        gaps = [boundary_at(boundaries, ALONE, group, x, y)[0] for x, y in outline]
        assert gaps == pytest.approx([25.0] * len(gaps))


def test_segments_are_clipped_at_the_sides_of_a_rectangle() -> None:
    lines = floats([
        [[1, 1], [2, 2]], [[-5, 5], [15, 5]], [[5, -5], [5, 5]], [[-1, 9], [1, 11]], [[-5, 11], [15, 11]],
        [[-3, 2], [-1, 2]], [[4, 4], [4, 4]],
    ])  # fmt: skip
    seen = shapes.clipped(lines, 0, 0, 10, 10)
    assert seen[:3] == pytest.approx(floats([[[1, 1], [2, 2]], [[0, 5], [10, 5]], [[5, 0], [5, 5]]]))
    assert ((seen >= 0) & (seen <= 10)).all()
    assert len(shapes.clipped(lines[4:6], 0, 0, 10, 10)) == 0
    assert shapes.clipped(lines[:0], 0, 0, 10, 10).shape == (0, 2, 2)


def test_a_polygon_is_one_obstacle_and_its_edges_are_not_bars_of_their_own() -> None:
    setup = site(U_SHAPE, BLOCK, YARD)
    assert len(obstacle_outlines(setup, 25.0)) == 4  # circle, bar, two polygons
    assert len(obstacle_surfaces(setup)) == 5  # and the yard
    bar = obstacle_surfaces(setup)[1]
    assert np.ptp(bar[:, 0]) == pytest.approx(112.0)


def test_bodies_cover_as_much_as_the_obstacles_do() -> None:
    expected = np.pi * 20**2 + (100 * 12 + np.pi * 6**2) + signed_area(U_SHAPE) + 80_000
    assert area(obstacle_bodies(site(U_SHAPE, BLOCK, YARD))) == pytest.approx(expected, rel=1e-3)


@pytest.mark.browser
def test_the_pocket_of_a_u_and_a_yard_show_the_floor(open_page: Callable[[str], Page]) -> None:
    stage = open_stage()
    try:
        dress(stage.server, "Obstacles")
        Ground(Canvas(stage.server, ARENA), site(U_SHAPE, BLOCK, YARD))
        page = open_page(stage.url)
        page.wait_for_timeout(1500)
        screenshot(page, "obstacles")
        picture = cv2.imdecode(np.frombuffer(page.screenshot(), np.uint8), cv2.IMREAD_COLOR)
        assert picture is not None
        body, floor = (floats(hex_rgb(colour)) for colour in (DARK.obstacle, DARK.floor))
        for points, seen, other in (
            ([[450, 350], [650, 350], [550, 250], [850, 250], [1050, 130]], body, floor),
            ([[550, 430], [950, 250], [300, 350]], floor, body),
        ):
            for x, y in np.rint(to_page(page, points)).astype(int):
                colour = floats(picture[y, x, ::-1])
                assert np.abs(colour - seen).max() < np.abs(colour - other).max()
    finally:
        stage.server.stop()

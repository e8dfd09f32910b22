"""Obstacles drawn freehand, and obstacles found in an overhead image."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from higvf_console.core.arrays import floats
from higvf_console.core.errors import ScenarioError
from higvf_console.world.editing.freehand import outline_of
from higvf_console.world.editing.overhead import outlines_in, read_picture
from higvf_console.world.masks import MaskPlace
from higvf_console.world.polygons import crossing, signed_area


@given(turns=st.floats(0.85, 3.0), wobble=st.floats(0.0, 0.15), phase=st.floats(0.0, 6.0))
def test_a_stroke_round_an_obstacle_becomes_a_simple_outline(turns: float, wobble: float, phase: float) -> None:
    angle = np.linspace(0, 2 * np.pi * turns, 120) + phase
    reach = 1.0 + wobble * np.sin(2.7 * angle)
    outline = outline_of(np.stack([500 + 80 * reach * np.cos(angle), 300 + 50 * reach * np.sin(angle)], axis=1))
    assert crossing([outline]) is None
    assert len(outline) < 80
    assert signed_area(outline) == pytest.approx(np.pi * 80 * 50, rel=0.35)


@pytest.mark.parametrize("stroke", [[], [[0, 0], [1, 1]], [[0, 0], [5, 0], [9, 0]], [[0, 0], [5e-324, 0], [0, 5e-324]],
                                    [[0, 0], [1e308, 0], [-1e308, -1e308]]])  # fmt: skip
def test_a_stroke_that_encloses_nothing_is_refused(stroke: list[list[float]]) -> None:
    with pytest.raises(ScenarioError, match="encloses nothing"):
        outline_of(floats(stroke, -1, 2))


def plan() -> bytes:
    """A bright plan of 60 x 40 pixels with a dark block, and in it a bright yard."""
    image = np.full((40, 60, 3), 230, np.uint8)
    image[10:30, 10:40] = 30
    image[15:20, 15:25] = 230
    return bytes(cv2.imencode(".png", image)[1])


def test_dark_shapes_of_an_image_become_outlines_on_the_ground() -> None:
    (outline,) = outlines_in(read_picture(plan()), MaskPlace((100.0, 50.0), 2.0), 128.0, bright=False)
    assert outline.min(axis=0) == pytest.approx([120.0, 70.0], abs=1.0)
    assert outline.max(axis=0) == pytest.approx([180.0, 110.0], abs=1.0)
    assert signed_area(outline) > 0.0


def test_bright_obstacles_are_found_as_well_as_dark_ones() -> None:
    outlines = outlines_in(read_picture(plan()), MaskPlace((0.0, 0.0), 1.0), 128.0, bright=True)
    assert sorted(round(signed_area(outline)) > 1000 for outline in outlines) == [False, True]  # the yard, the rest


@pytest.mark.parametrize("content", [b"", b"not an image", plan()[:60]])
def test_what_is_no_image_is_refused(content: bytes) -> None:
    with pytest.raises(ScenarioError, match="not an image"):
        read_picture(content)


def test_an_image_without_obstacles_is_refused_with_the_threshold() -> None:
    with pytest.raises(ScenarioError, match="no dark shape at threshold 5"):
        outlines_in(read_picture(plan()), MaskPlace((0.0, 0.0), 1.0), 5.0, bright=False)

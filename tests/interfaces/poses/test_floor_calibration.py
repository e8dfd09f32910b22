"""Files of lens and floor are read strictly, and tags on the floor stand in for points."""

from pathlib import Path

import numpy as np
import pytest

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError
from higvf_console.core.viewport import Arena
from higvf_interfaces.poses.calibration import fitted, lowered, mapped, read_floor, read_lens
from higvf_interfaces.poses.floor_view import FloorView
from higvf_interfaces.poses.tags import Tag

ARENA = Arena(0.0, 0.0, 3.2, 2.0)
SIZE = "image_px: [640, 400]\n"
PIXELS = "points_px: [[0, 0], [640, 0], [640, 400], [0, 400]]\n"
METRES = "points_m: [[0, 2], [3.2, 2], [3.2, 0], [0, 0]]\n"
TAGS = "tags: [{id: 40, at_m: [0, 2]}, {id: 41, at_m: [3.2, 2]}, {id: 42, at_m: [3.2, 0]}, {id: 43, at_m: [0, 0]}]\n"
LENS = SIZE + "camera_matrix: [[500, 0, 320], [0, 500, 200], [0, 0, 1]]\ndistortion: [-0.2, 0.05, 0.001, -0.001, 0]\n"

FLOORS = [
    ("", "the file is empty"),
    (SIZE + PIXELS, "the key 'points_m' is missing; known keys: image_px"),
    (SIZE + PIXELS + METRES + "colour: red\n", "colour: unknown key"),
    ("image_px: [640.5, 400]\n" + PIXELS + METRES, r"image_px: .* is not \[width, height\] in whole pixels"),
    (SIZE + "points_px: [[0, 0], [640, 0], [640, 400]]\n" + METRES, "3 points_px and 4 points_m"),
    (SIZE + "points_px: [[0, 0], [1, 0], [2, 0], [0, 4]]\n" + METRES, "points_px: three of the four points lie"),
    (SIZE + PIXELS + "points_m: [[0, 2], [1, two], [3, 0], [0, 0]]\n", r"points_m\[2\]\[2\]: 'two' is not a number"),
    (SIZE + PIXELS + METRES + "camera_m: [1, 1, 0]\n", r"camera_m: .* height above 0"),
    ("tags: [{id: 40, at_m: [0, 2]}]\n", "tags: 1 tags are too few; give at least 4"),
    (TAGS.replace("41", "40"), r"tags\[2\].id: tag 40 is given twice"),
    (TAGS + SIZE, "image_px: unknown key"),
]


@pytest.mark.parametrize(("text", "reason"), FLOORS)
def test_a_floor_that_is_none_is_refused(tmp_path: Path, text: str, reason: str) -> None:
    (tmp_path / "floor.yaml").write_text(text)
    with pytest.raises(InputError, match=f"floor.yaml: {reason}"):
        read_floor(tmp_path / "floor.yaml")


LENSES = [
    (LENS.replace("500, 0, 320", "0, 0, 320"), "camera_matrix: .* fx and fy above 0"),
    (LENS.replace(", 0]\n", "]\n").replace("-0.001]", "-0.001, 0, 0]"), "distortion: .* 4, 5 or 8 numbers"),
    (SIZE, "the key 'camera_matrix' is missing"),
]


@pytest.mark.parametrize(("text", "reason"), LENSES)
def test_a_lens_that_is_none_is_refused(tmp_path: Path, text: str, reason: str) -> None:
    (tmp_path / "lens.yaml").write_text(text)
    with pytest.raises(InputError, match=f"lens.yaml: {reason}"):
        read_lens(tmp_path / "lens.yaml")


def test_a_lens_bends_what_it_straightens(tmp_path: Path) -> None:
    (tmp_path / "lens.yaml").write_text(LENS)
    lens = read_lens(tmp_path / "lens.yaml")
    pixels = floats([[40, 30], [320, 200], [600, 370]])
    assert np.abs(lens.straightened(pixels) - pixels).max() > 5.0
    assert lens.bent(lens.straightened(pixels)) == pytest.approx(pixels, abs=0.02)


def test_points_in_another_order_are_refused() -> None:
    pixels, metres = floats([[0, 0], [640, 0], [640, 400], [0, 400]]), floats([[0, 2], [3.2, 0], [3.2, 2], [0, 0]])
    with pytest.raises(InputError, match="floor: the horizon lies between these points"):
        fitted(pixels, metres, "floor")


def test_what_is_above_the_floor_lies_nearer_to_the_camera_than_it_looks() -> None:
    camera, tag = floats([1.0, 0.5, 2.0]), floats([[2.0, 1.5]])
    looks = camera[:2] + (tag - camera[:2]) * 2.0 / 1.9  # a ray through 0.1 m above the floor
    assert lowered(looks, 0.1, camera) == pytest.approx(tag)


def tag(number: int, centre: Floats) -> Tag:
    return Tag(number, floats(centre + np.array([[-9, -9], [9, -9], [9, 9], [-9, 9]])))


def test_tags_of_the_floor_make_it_and_a_moved_camera_begins_anew(tmp_path: Path) -> None:
    (tmp_path / "floor.yaml").write_text(TAGS)
    view = FloorView(read_floor(tmp_path / "floor.yaml"), None, (640, 400), ARENA, "test")
    corners = floats([[0, 0], [640, 0], [640, 400], [0, 400]])
    assert not view.look([tag(40 + k, corners[k]) for k in range(3)])
    assert view.homography is None and view.from_above(np.zeros((400, 640, 3), np.uint8)) is None
    assert not view.look([tag(43, corners[3])])
    assert view.homography is not None
    assert mapped(view.homography, floats([[320, 200]])) == pytest.approx(floats([[1.6, 1.0]]))
    assert view.look([tag(41, corners[1] + 12.0)])
    assert view.homography is None
    view.look([tag(40 + k, corners[k] + 12.0) for k in range(4)])
    assert view.on_floor(floats([[332, 212]]), 0.0) == pytest.approx(floats([[1.6, 1.0]]))

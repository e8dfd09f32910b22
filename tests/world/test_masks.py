"""A picture becomes the obstacles that a person sees in it: upright, in place, with their yards, never crossing."""

import struct
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest
from cv2.typing import MatLike

from higvf_console.core.arrays import Bools, floats
from higvf_console.core.errors import ScenarioError
from higvf_console.world.masks import MaskPlace, decoded, read_grey, trace
from higvf_console.world.polygons import crossing, obstacles_of, signed_area, signed_distance


def blank(rows: int = 40, columns: int = 60) -> Bools:
    return np.zeros((rows, columns), np.bool_)


def blobs(seed: int, size: int = 60) -> Bools:
    return cv2.GaussianBlur(np.random.default_rng(seed).random((size, size)), (0, 0), 2.0) > 0.5


def test_a_shape_lies_where_the_picture_shows_it_upright() -> None:
    blocked = blank()
    blocked[2:12, 5:25] = True  # near the upper left corner
    (outline,) = trace(blocked, MaskPlace((100.0, 50.0), 2.0), tolerance=0.5, least_area=1.0)
    assert outline.min(axis=0) == pytest.approx([110, 50 + 2 * 28], abs=0.4)
    assert outline.max(axis=0) == pytest.approx([150, 50 + 2 * 38], abs=0.4)
    assert signed_area(outline) == pytest.approx(40 * 20, rel=0.1)


def test_outlines_never_lie_inside_the_pixels_before_they_are_simplified() -> None:
    blocked = blobs(3)
    y, x = np.nonzero(blocked)
    centres = floats(np.stack([x + 0.5, len(blocked) - y - 0.5], axis=1))
    inside = np.zeros(len(centres), np.bool_)
    for chains in obstacles_of(trace(blocked, MaskPlace((0.0, 0.0), 1.0), 0.0, 0.0)):
        inside |= signed_distance(chains, centres) < -0.4
    assert inside.all()


def test_a_free_area_that_is_enclosed_keeps_its_own_outline_clockwise() -> None:
    blocked = blank()
    blocked[5:35, 10:50] = True
    blocked[12:28, 20:40] = False
    outer, inner = trace(blocked, MaskPlace((0.0, 0.0), 1.0), 0.5, 4.0)
    assert signed_area(outer) == pytest.approx(40 * 30, rel=0.05)
    assert signed_area(inner) == pytest.approx(-20 * 16, rel=0.1)
    assert signed_distance([outer, inner], np.array([[30.0, 20.0]]))[0] == pytest.approx(8.0, abs=0.5)


def test_specks_are_left_out_and_small_free_areas_filled() -> None:
    blocked = blank()
    blocked[5:35, 10:50] = True
    blocked[20, 30] = False
    blocked[2, 2] = True
    assert len(trace(blocked, MaskPlace((0.0, 0.0), 1.0), 0.5, 4.0)) == 1
    assert len(trace(blocked, MaskPlace((0.0, 0.0), 1.0), 0.5, 0.1)) == 3


def test_an_obstacle_may_reach_the_picture_s_edge() -> None:
    (outline,) = trace(~blank(), MaskPlace((0.0, 0.0), 1.0), 0.5, 1.0)
    assert signed_area(outline) == pytest.approx(60 * 40, rel=0.02)


def test_a_slanted_wall_becomes_few_edges() -> None:
    picture = np.zeros((200, 200), np.uint8)
    cv2.line(picture, (20, 30), (180, 110), 255, 8)
    (outline,) = trace(picture > 0, MaskPlace((0.0, 0.0), 1.0), 1.0, 1.0)
    assert len(outline) <= 10


@pytest.mark.parametrize("tolerance", [0.0, 1.0, 5.0, 20.0])
def test_no_outline_crosses_itself_or_its_free_areas_however_coarse(tolerance: float) -> None:
    for seed in range(4, 9):
        for chains in obstacles_of(trace(blobs(seed, 45), MaskPlace((0.0, 0.0), 1.0), tolerance, 4.0)):
            assert sum(len(chain) for chain in chains) < 500
            assert crossing(chains) is None
            assert [signed_area(chain) > 0.0 for chain in chains] == [True] + [False] * (len(chains) - 1)


def test_walls_one_pixel_thin_that_meet_at_corners_do_not_touch_themselves() -> None:
    blocked = blank(12, 12)
    np.fill_diagonal(blocked, True)
    blocked[3, 3:9] = True
    chains = trace(blocked, MaskPlace((0.0, 0.0), 1.0), 0.0, 0.0)
    assert crossing(chains) is None
    assert len(obstacles_of(chains)) == 1


def encoded(folder: Path, image: MatLike) -> str:
    assert cv2.imwrite(str(folder / "plan.png"), image)
    return "plan.png"


@pytest.mark.parametrize(
    "image",
    [
        np.array([[0, 255]], np.uint8),
        np.array([[0, 65535]], np.uint16),
        np.array([[[0, 0, 0], [255, 255, 255]]], np.uint8),
        np.array([[[0, 0, 0, 255], [0, 0, 0, 0]]], np.uint8),  # transparent, as drawing programs leave it
    ],
)
def test_black_and_white_are_read_from_every_kind_of_image(tmp_path: Path, image: MatLike) -> None:
    assert read_grey(encoded(tmp_path, image), (tmp_path,)).tolist() == [[0, 255]]


def test_colours_count_by_their_brightness(tmp_path: Path) -> None:
    red_green = np.array([[[0, 0, 255], [0, 255, 0]]], np.uint8)
    assert read_grey(encoded(tmp_path, red_green), (tmp_path,)).tolist() == [[76, 150]]


def test_the_first_folder_that_has_the_image_gives_it(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    encoded(tmp_path / "b", np.array([[7]], np.uint8))
    folders = (tmp_path / "a", tmp_path / "b")
    assert read_grey("plan.png", folders).tolist() == [[7]]
    encoded(tmp_path / "a", np.array([[9]], np.uint8))
    assert read_grey("plan.png", folders).tolist() == [[9]]


def test_an_image_that_is_missing_or_unreadable_is_told_with_the_places(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=f"no image 'plan.png' in {tmp_path} or {tmp_path / 'b'}"):
        read_grey("plan.png", (tmp_path, tmp_path / "b"))
    for content in (b"", b"GIF89 no"):
        (tmp_path / "plan.png").write_bytes(content)
        with pytest.raises(ScenarioError, match=r"plan\.png: not an image that OpenCV can read"):
            read_grey("plan.png", (tmp_path,))


def png(width: int, height: int) -> bytes:
    """A small file whose header promises an image of any size."""

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"")) + chunk(b"IEND", b"")


@pytest.mark.parametrize(
    ("size", "line"),
    [((5000, 5000), r"5000 x 5000 pixels; give at most 16 million"), ((30_000, 30_000), "over 100 million pixels")],
)
def test_a_huge_image_is_refused_by_its_header(
    size: tuple[int, int], line: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def decode(*_: object) -> None:
        pytest.fail("decoded")

    monkeypatch.setattr("cv2.imdecode", decode)
    with pytest.raises(ScenarioError, match=line):
        decoded(png(*size), 1)

"""A floor file is made of four corners or of four tags, and tells how good it is."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from higvf_console.lab.overhead_video import write_video
from higvf_interfaces.poses.calibration import Lens, fitted, mapped, read_floor
from higvf_interfaces.poses.making import camera_place, main

PLACES = {40: (100, 80), 41: (540, 80), 42: (540, 320), 43: (100, 320)}


@pytest.fixture
def video(tmp_path: Path) -> Path:
    """Four tags of 40 px, a metre apart per 200 px, on a floor of 640 x 400 px."""
    image = np.full((400, 640, 3), 200, np.uint8)
    known = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    for number, (x, y) in PLACES.items():
        tag = cv2.copyMakeBorder(
            cv2.aruco.generateImageMarker(known, number, 40), 8, 8, 8, 8, cv2.BORDER_CONSTANT, value=(255,)
        )
        image[y - 28 : y + 28, x - 28 : x + 28] = tag[:, :, None]
    write_video(tmp_path / "floor.mp4", [image] * 5, 20.0)
    return tmp_path / "floor.mp4"


def test_tags_make_a_floor_whose_error_is_printed(video: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = video.with_name("floor.yaml")
    at = ["0.5,1.6", "2.7,1.6", "2.7,0.4", "0.5,0.4"]
    assert main([str(video), "--floor-tags", "40,41,42,43", "--at", *at, "--size", "0.2", "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    assert "Reprojection error of the tags over all frames: 0." in printed and "of 200 mm." in printed
    floor = read_floor(out)
    homography = fitted(floor.pixels, floor.ground, "test")
    assert mapped(homography, np.array([[319.5, 199.5]])) == pytest.approx(np.array([[1.6, 1.0]]), abs=0.003)


def test_corners_make_a_floor(video: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = video.with_name("floor.yaml")
    assert main([str(video), "--corners", "0,0", "640,0", "640,400", "0,400", "--out", str(out)]) == 0
    assert "a pixel of error is about 5.0 mm" in capsys.readouterr().out
    assert read_floor(out).image == (640, 400)


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--floor-tags", "40,41,42,44"], "tags 44 are not seen in 5 frames; seen: 40, 41, 42, 43"),
        (["--floor-tags", "40,41"], "'40,41' is not four ids"),
        (["--corners", "0,0", "a,0", "1,1", "0,1"], "--corners: 'a,0' is not two numbers with ','"),
        (["--corners", "0,0", "9,0", "9,9", "0,9", "--arena", "3"], "--arena: '3' is not two numbers with 'x'"),
    ],
)
def test_what_makes_no_floor_is_refused(
    video: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], reason: str
) -> None:
    assert main([str(video), *arguments, "--out", str(video.with_name("floor.yaml"))]) == 2
    assert reason in capsys.readouterr().err


def test_a_known_lens_tells_where_the_camera_hangs() -> None:
    lens = Lens((640, 400), np.array([[500.0, 0, 320], [0, 500.0, 200], [0, 0, 1]]), np.zeros(5))
    ground = np.array([[0.0, 2.0], [3.2, 2.0], [3.2, 0.0], [0.0, 0.0]])
    pixels = np.array([320.0, 200.0]) + (ground - np.array([1.6, 1.0])) * np.array([1.0, -1.0]) * 500.0 / 2.5
    assert camera_place(pixels, ground, lens) == pytest.approx([1.6, 1.0, 2.5], abs=1e-3)

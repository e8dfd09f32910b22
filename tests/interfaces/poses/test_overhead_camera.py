"""The overhead camera tells where robots are, and says what keeps it from doing so."""

import csv
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError
from higvf_console.core.team import Poses, TeamSpec
from higvf_console.core.viewport import Arena
from higvf_console.lab.overhead_video import HEIGHT_M, TAG_M, View, floor_text, view_of, write_video
from higvf_console.scenario.scenario import data_folder
from higvf_interfaces.poses.calibration import read_floor
from higvf_interfaces.poses.camera import CameraPoses, open_camera
from higvf_interfaces.poses.floor_view import FloorView
from higvf_interfaces.poses.tags import TagDetector, dictionary

VIDEO = data_folder() / "assets" / "recordings" / "epucks-overhead.mp4"
ARENA = Arena(0.0, 0.0, 3.2, 2.0)
RATE = 20.0
PATIENCE = 20.0  # after which a test gives up [s]
Opener = Callable[..., CameraPoses]


@pytest.fixture
def camera() -> Iterator[Opener]:
    """Opens cameras on a video; closes them after the test."""
    opened: list[CameraPoses] = []

    def open_one(file: Path | str, **options: str) -> CameraPoses:
        opened.append(open_camera(TeamSpec("camera", str(file), options, robots=5, arena=ARENA)))
        return opened[-1]

    yield open_one
    for one in opened:
        one.close()


def tagged(places: dict[int, list[tuple[float, float]]], side: int = 40) -> NDArray[np.uint8]:
    """A picture of 640 x 400 px (200 px a metre) with upright tags at places [m]."""
    image = np.full((400, 640, 3), 200, np.uint8)
    known = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    for number, points in places.items():
        tag = cv2.aruco.generateImageMarker(known, number, side)
        plate = cv2.copyMakeBorder(tag, 8, 8, 8, 8, cv2.BORDER_CONSTANT, value=(255,))
        for x, y in points:
            left, top = round(200 * x) - len(plate) // 2, round(400 - 200 * y) - len(plate) // 2
            image[top : top + len(plate), left : left + len(plate)] = plate[:, :, None]
    return image


def video(folder: Path, images: list[NDArray[np.uint8]]) -> Path:
    """A video of pictures, with its floor file beside it."""
    file = folder / "seen.mp4"
    write_video(file, images, RATE)
    text = "image_px: [640, 400]\npoints_px: [[0, 0], [640, 0], [640, 400], [0, 400]]\n"
    (folder / "seen.floor.yaml").write_text(text + "points_m: [[0, 2], [3.2, 2], [3.2, 0], [0, 0]]\n")
    return file


def until(source: CameraPoses, met: Callable[[Poses, list[str]], bool]) -> tuple[Poses, list[str]]:
    """Asks until something is met; the poses then, and all notices."""
    notices: list[str] = []
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        poses = source.poses(time.monotonic())
        notices += source.notices()
        if met(poses, notices):
            return poses, notices
        time.sleep(0.005)
    raise AssertionError(f"not met: {source.poses(0.0)}, {notices}")


def ended(_: Poses, notices: list[str]) -> bool:
    return any("has ended" in notice or "breaks off" in notice for notice in notices)


def true_poses() -> dict[int, Floats]:
    """Of each frame of the shipped video: (5, 3) x, y [m], heading [rad]."""
    frames: dict[int, list[tuple[float, float, float]]] = {}
    with VIDEO.with_suffix(".truth.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            pose = (float(row["x_m"]), float(row["y_m"]), float(row["heading_rad"]))
            frames.setdefault(int(row["frame"]), []).append(pose)
    return {frame: floats(poses) for frame, poses in frames.items()}


def test_poses_agree_with_the_truth_to_a_millimetre() -> None:
    """Measured: median 0.2 mm, 95 % within 0.5 mm, headings 0.3 and 0.7 degrees, 99.6 % of the tags seen."""
    truth, read = true_poses(), cv2.VideoCapture(str(VIDEO))
    detector = TagDetector(dictionary("4x4_50", "test"))
    view = FloorView(read_floor(VIDEO.with_suffix(".floor.yaml")), None, (960, 600), ARENA, "test")
    error: list[float] = []
    turned: list[float] = []
    frames = 0
    for frame in range(len(truth)):
        image = read.read()[1]
        if frame % 10:
            continue
        frames += 1
        for tag in detector.find(np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), np.uint8)):
            corners = view.on_floor(tag.corners, HEIGHT_M)
            x, y, heading = truth[frame][tag.id]
            error.append(float(np.hypot(*(corners.mean(axis=0) - (x, y)))))
            forward = corners[0] + corners[1] - corners[2] - corners[3]
            turned.append(abs(np.remainder(np.arctan2(forward[1], forward[0]) - heading + np.pi, 2 * np.pi) - np.pi))
    assert len(error) >= 0.98 * 5 * frames
    assert np.median(error) < 0.0005 and np.quantile(error, 0.95) < 0.001 and max(error) < 0.003
    assert np.quantile(turned, 0.95) < np.radians(1.5)


def test_a_large_tag_is_found_at_half_size_as_exactly() -> None:
    image = np.asarray(cv2.cvtColor(cv2.resize(tagged({3: [(1.0, 1.0)]}), (1280, 800)), cv2.COLOR_BGR2GRAY), np.uint8)
    detector = TagDetector(dictionary("4x4_50", "test"))
    (whole,), (half,) = detector.find(image, side=20.0), detector.find(image, side=80.0)
    assert whole.id == half.id == 3
    assert np.abs(whole.corners - half.corners).max() < 0.1
    assert half.side == pytest.approx(80.0, abs=1.0)


def test_robots_of_the_shipped_video_are_seen_with_stamps_of_the_frame(camera: Opener) -> None:
    source = camera(VIDEO, size_m=str(TAG_M), height_m=str(HEIGHT_M))
    begun = time.monotonic()
    poses, _ = until(source, lambda poses, _: bool(np.isfinite(poses.measured_at).all()))
    assert (poses.measured_at >= begun).all() and (poses.measured_at <= time.monotonic()).all()
    frame = round(float(poses.measured_at.max() - begun) * 15)
    near = [true_poses()[k] for k in range(max(frame - 3, 0), frame + 4)]
    assert min(float(np.hypot(*(poses.position - one[:, :2]).T).max()) for one in near) < 0.003


def test_a_tag_that_is_hidden_for_a_moment_keeps_its_pose_and_its_stamp(camera: Opener, tmp_path: Path) -> None:
    both, one = tagged({0: [(1.0, 1.0)], 1: [(2.0, 1.0)]}), tagged({1: [(2.0, 1.0)]})
    source = camera(video(tmp_path, [both] * 6 + [one] * 10 + [both] * 8))
    poses, _ = until(source, lambda poses, _: bool(poses.measured_at[1] > poses.measured_at[0]))
    assert poses.position[0] == pytest.approx([1.0, 1.0], abs=0.01)
    hidden = poses.measured_at[0]
    poses, _ = until(source, lambda poses, _: bool(poses.measured_at[0] > hidden))
    assert poses.position[0] == pytest.approx([1.0, 1.0], abs=0.01)
    assert np.isnan(poses.position[2:]).all()


def test_a_tag_that_is_seen_twice_tells_nothing(camera: Opener, tmp_path: Path) -> None:
    image = tagged({0: [(1.0, 1.0), (1.5, 1.0)], 1: [(2.0, 1.0)]})
    poses, notices = until(camera(video(tmp_path, [image] * 8)), ended)
    assert np.isnan(poses.position[0]).all() and np.isfinite(poses.position[1]).all()
    assert [notice for notice in notices if "Tag 0" in notice] == ["Tag 0 is seen 2 times at once: it is not used."]


def test_a_tag_of_another_size_is_not_used(camera: Opener, tmp_path: Path) -> None:
    source = camera(video(tmp_path, [tagged({0: [(1.0, 1.0)]})] * 8), size_m="0.1")
    poses, notices = until(source, ended)
    assert np.isnan(poses.position[0]).all()
    assert notices[0].startswith("Tag 0 is ") and notices[0].endswith(" mm wide, not 100: not used.")


def test_the_upper_edge_of_a_tag_points_forward(camera: Opener, tmp_path: Path) -> None:
    file = video(tmp_path, [tagged({7: [(1.0, 1.0)]})] * 8)
    poses, _ = until(camera(file, first_id="7"), lambda poses, _: bool(np.isfinite(poses.heading[0])))
    assert poses.heading[0] == pytest.approx(np.pi / 2, abs=0.03)
    poses, _ = until(camera(file, first_id="7", turned_deg="90"), lambda poses, _: bool(np.isfinite(poses.heading[0])))
    assert poses.heading[0] == pytest.approx(0.0, abs=0.03)


def test_tags_on_the_floor_place_robots_and_tell_a_moved_camera(camera: Opener, tmp_path: Path) -> None:
    places = {40: (0.4, 1.6), 41: (2.8, 1.6), 42: (2.8, 0.4), 43: (0.4, 0.4)}
    image = tagged({0: [(1.5, 1.0)]} | {number: [place] for number, place in places.items()})
    moved = np.roll(image, (10, 16), axis=(0, 1))
    file = video(tmp_path, [image] * 6 + [moved] * 6)
    floor = tmp_path / "tags.yaml"
    floor.write_text("tags:\n" + "".join(f"  - {{id: {k}, at_m: [{x}, {y}]}}\n" for k, (x, y) in places.items()))
    poses, notices = until(camera(file, floor=str(floor)), ended)
    assert poses.position[0] == pytest.approx([1.5, 1.0], abs=0.01)
    assert notices[0].startswith("The camera was moved: ")


def test_the_end_of_a_video_is_told_and_poses_grow_old(camera: Opener, tmp_path: Path) -> None:
    source = camera(video(tmp_path, [tagged({0: [(1.0, 1.0)]})] * 8))
    _, notices = until(source, ended)
    assert "has ended after 0.4 s: it shows no robots any more." in notices[-1]
    time.sleep(0.5)  # the last frame is looked at
    last = source.poses(0.0).measured_at[0]
    assert source.poses(last + 9.0).measured_at[0] == last


def test_a_video_begins_again_where_it_is_asked_to(camera: Opener, tmp_path: Path) -> None:
    source = camera(video(tmp_path, [tagged({0: [(1.0, 1.0)]})] * 8), loop="1")
    poses, _ = until(source, ended)
    until(source, lambda later, _: bool(later.measured_at[0] > poses.measured_at[0] + 0.3))


def test_a_video_that_breaks_off_is_told(camera: Opener, tmp_path: Path) -> None:
    whole = tmp_path / "whole.avi"
    write_video(whole, [tagged({0: [(1.0, 1.0)]})] * 30, RATE)
    video(tmp_path, [tagged({})])
    cut = tmp_path / "seen.avi"
    cut.write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])
    _, notices = until(camera(cut), ended)
    assert any("seen.avi breaks off after" in notice and "of 1.5 s." in notice for notice in notices), notices


def test_threads_end_with_the_camera(camera: Opener) -> None:
    before = threading.active_count()
    source = camera(VIDEO, height_m=str(HEIGHT_M))
    source.poses(0.0)
    assert threading.active_count() == before + 2
    source.close()
    source.close()
    assert threading.active_count() == before


def test_pictures_are_made_while_they_are_asked_for(camera: Opener) -> None:
    source = camera(VIDEO, height_m=str(HEIGHT_M))
    stamps: set[float] = set()
    until(source, lambda poses, _: stamps.add(float(poses.measured_at[0])) or len(stamps) > 4)
    assert source.picture() is None
    until(source, lambda _, __: source.picture() is not None)
    picture = source.picture()
    assert picture is not None and picture.rgb.shape == (400, 640, 3) and picture.extent == ARENA
    x, y = source.poses(0.0).position[0]
    around = picture.rgb[round((2.0 - y) * 200) - 10 :, round(x * 200) - 10 :][:20, :20]
    assert around.min() < 60 and around.max() > 200  # the black and white of a tag


BROKEN = {
    "empty": (b"", "is empty"),
    "text": (b"time,x,y\n" + b"1,2,3\n" * 500, "is text; a video is wanted"),
    "noise": (np.random.default_rng(0).bytes(50_000), "cannot be read as a video"),
    "cut": (VIDEO.read_bytes()[:20_000] if VIDEO.is_file() else b"", "cannot be read as a video"),
}


@pytest.mark.parametrize("name", BROKEN)
@pytest.mark.parametrize("ending", ["mp4", "txt"])
def test_broken_files_are_refused(camera: Opener, tmp_path: Path, name: str, ending: str) -> None:
    content, reason = BROKEN[name]
    file = tmp_path / f"broken.{ending}"
    file.write_bytes(content)
    with pytest.raises(InputError, match=f"broken.{ending} {reason}"):
        camera(file, floor=str(VIDEO.with_suffix(".floor.yaml")))


REFUSED = [
    ({"tags": "4x4_51"}, r"tags=4x4_51 is no dictionary \(did you mean '4x4_50'\?\); choose 4x4_50, 4x4_100"),
    ({"size_m": "wide"}, "size_m: 'wide' is not a number from 0 to 10 m"),
    ({"colour": "red"}, "unknown key.*known keys: tags, floor"),
    ({"loop": "0.5"}, "loop=0.5 is no whole number"),
    ({"width_px": "640"}, "width_px and height_px need each other"),
    ({"floor": "/nowhere.yaml"}, "/nowhere.yaml: No such file"),
]


@pytest.mark.parametrize(("options", "reason"), REFUSED)
def test_options_that_cannot_be_are_refused(camera: Opener, options: dict[str, str], reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        camera(VIDEO, **options)


def test_a_missing_source_is_refused_with_what_to_give(camera: Opener, tmp_path: Path) -> None:
    floor = str(VIDEO.with_suffix(".floor.yaml"))
    with pytest.raises(InputError, match=r"none.mp4: No such file or directory; give a video file, the index"):
        camera(tmp_path / "none.mp4", floor=floor)
    with pytest.raises(InputError, match=r"camera 97 cannot be read; cameras here: "):
        camera("97", floor=floor)
    with pytest.raises(InputError, match="give a video file, the index of a camera, or a URL"):
        camera("", floor=floor)
    with pytest.raises(InputError, match=r"floor=FILE is missing, and there is no .*none.floor.yaml; make one with"):
        camera(tmp_path / "none.mp4")


def test_a_floor_of_other_pictures_is_refused(camera: Opener, tmp_path: Path) -> None:
    other = tmp_path / "other.yaml"
    other.write_text(floor_text(view_of(ARENA, (640, 400)), ARENA))
    with pytest.raises(InputError, match=r"floor was measured in pictures of 640 x 400 px.*960 x 600 px"):
        camera(VIDEO, floor=str(other))


def test_a_height_needs_the_place_of_the_camera(camera: Opener, tmp_path: Path) -> None:
    view = view_of(ARENA, (960, 600))
    lines = floor_text(View(view.size, view.projection, view.camera), ARENA).split("camera_m")[0]
    (tmp_path / "low.yaml").write_text(lines)
    with pytest.raises(InputError, match=r"height_m=0.05 needs camera_m: \[x, y, height\] in .*low.yaml"):
        camera(VIDEO, floor=str(tmp_path / "low.yaml"), height_m="0.05")

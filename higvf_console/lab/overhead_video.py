"""An overhead video of a run, drawn with known poses: `python -m higvf_console.lab.overhead_video OUT_FOLDER`.

The robots of a scenario follow its first stroke in a headless run. A camera that hangs a little aslant looks at them:
each carries a tag on a plate above its body; the picture is blurred and has noise. Beside the video are the floor file
for `--poses camera=...`, and the true poses of each frame as a table. The same seed gives the same run and picture;
the bytes of the video are the encoder's.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import StrokeBegin, StrokeEnd, StrokePoints
from higvf_console.core.errors import HigvfError
from higvf_console.core.optional import optional
from higvf_console.core.reading.document import yaml_text
from higvf_console.core.viewport import Arena
from higvf_console.runtime.run import Run
from higvf_console.scenario.scenario import load_scenario
from higvf_console.sim.unicycle import body_centres
from higvf_console.world.setup import Setup

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "images")

NAME, SCENARIO = "epucks-overhead", "epucks"
TAG_M, PLATE_M, HEIGHT_M = 0.08, 0.1, 0.05  # side of a tag, of its plate, and their height above the floor
_FINE = 2  # pictures are drawn so many times as large, and made smaller
_FOCUS = 0.78  # focal length as a share of the width
_NOISE = 1.0  # standard deviation, in grey levels
_FLOOR, _OBSTACLE, _BODY = 205, 120, (70, 110, 40)


class View(NamedTuple):
    """A pinhole camera without distortion: size of its pictures [px], projection (3, 4), where it hangs (3,) [m]."""

    size: tuple[int, int]
    projection: Floats
    camera: Floats

    def plane(self, height: float) -> Floats:
        """The homography (3, 3) from the plane at a height [m] to the picture."""
        matrix = self.projection
        return floats(np.column_stack((matrix[:, 0], matrix[:, 1], height * matrix[:, 2] + matrix[:, 3])))


class Truth(NamedTuple):
    """True poses: times (F,) [s], centres (F, N, 2) [m], headings (F, N) [rad]."""

    times: Floats
    centres: Floats
    headings: Floats


def view_of(arena: Arena, size: tuple[int, int]) -> View:
    """A camera above the middle of the arena, that looks a little aslant, so that all of it is in the picture."""
    focus = _FOCUS * size[0]
    camera = np.array(
        [(arena.x_min + arena.x_max) / 2 + 0.06, (arena.y_min + arena.y_max) / 2 - 0.25, 0.86 * arena.width]
    )
    target = np.array([(arena.x_min + arena.x_max) / 2, (arena.y_min + arena.y_max) / 2, 0.0])
    down = (target - camera) / np.linalg.norm(target - camera)
    right = np.cross(down, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    turned = np.stack((right, np.cross(down, right), down))  # rows: right, down in the picture, into it
    inner = np.array([[focus, 0.0, size[0] / 2], [0.0, focus, size[1] / 2], [0.0, 0.0, 1.0]])
    return View(size, floats(inner @ np.column_stack((turned, -turned @ camera))), floats(camera))


def true_poses(setup: Setup, strokes: Sequence[tuple[Floats, int | None]], seconds: float, rate: float) -> Truth:
    """Where robots are while the team follows strokes (n, 2) [m], each drawn for a robot (index from 0)."""
    run, period, look_ahead = Run(setup), setup.params.safety.control_period, setup.params.robots.look_ahead
    for points, robot in strokes:
        for command in (StrokeBegin(), StrokePoints(points), StrokeEnd(robot=robot)):
            run.apply(command)
    times = np.arange(0.0, seconds, 1.0 / rate)
    centres: list[Floats] = []
    headings: list[Floats] = []
    for time in times:
        while run.time < time - 0.5 * period:
            run.step()
        motion = run.state.motion
        centres.append(body_centres(motion.position, motion.heading, look_ahead))
        headings.append(motion.heading.copy())
    return Truth(times, floats(centres), floats(headings))


class Painter:
    """Draws the frames of one view."""

    def __init__(self, view: View, setup: Setup, seed: int) -> None:
        """Draws what stands still."""
        self._view, self._rng = view, np.random.default_rng(seed)
        self._tags = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
        width, height = (_FINE * side for side in view.size)
        texture = self._rng.normal(_FLOOR, 5.0, (height // 8, width // 8)).astype(np.float32)
        grey = cv2.resize(texture, (width, height), interpolation=cv2.INTER_CUBIC)
        self._ground = np.repeat(np.clip(grey, 0, 255).astype(np.uint8)[:, :, None], 3, axis=2)
        arena = setup.arena
        corners = floats([(arena.x_min, arena.y_min), (arena.x_max, arena.y_min), (arena.x_max, arena.y_max),
                          (arena.x_min, arena.y_max)])  # fmt: skip
        cv2.polylines(self._ground, [self._pixels(corners, 0.0)], True, (60, 60, 60), 2 * _FINE, cv2.LINE_AA)
        for x, y, radius in setup.layout.obstacles.circles:
            cv2.fillPoly(self._ground, [self._pixels(_disc(x, y, radius), 0.0)], (_OBSTACLE,) * 3, cv2.LINE_AA)

    def frame(self, centres: Floats, headings: Floats) -> NDArray[np.uint8]:
        """The picture (rows, columns, 3) of robots at centres (N, 2) [m] with headings (N,) [rad]; tags from 0."""
        fine = self._ground.copy()
        for robot, ((x, y), heading) in enumerate(zip(centres, headings, strict=True)):
            cv2.fillPoly(fine, [self._pixels(_disc(x, y, 0.037), 0.5 * HEIGHT_M)], _BODY, cv2.LINE_AA)
            self._put_tag(fine, robot, float(x), float(y), float(heading))
        image = cv2.resize(fine, self._view.size, interpolation=cv2.INTER_AREA)
        image = cv2.GaussianBlur(image, (0, 0), 0.7)
        noise = self._rng.normal(0.0, _NOISE, image.shape[:2])[:, :, None]
        return np.clip(image + noise, 0, 255).astype(np.uint8)

    def _put_tag(self, fine: NDArray[np.uint8], number: int, x: float, y: float, heading: float) -> None:
        modules = 12
        tag = cv2.aruco.generateImageMarker(self._tags, number, 6 * modules)
        edge = round(6 * modules * (PLATE_M / TAG_M - 1.0) / 2)
        plate = cv2.copyMakeBorder(tag, edge, edge, edge, edge, cv2.BORDER_CONSTANT, value=255)
        side, cos, sin = len(plate), np.cos(heading), np.sin(heading)
        metres = TAG_M / (6 * modules)
        # The upper edge of the plate points forward: its rows run backward, its columns to the right.
        onto = np.array([[sin, -cos, x], [-cos, -sin, y], [0.0, 0.0, 1.0]]) @ np.array(
            [[metres, 0.0, -(side - 1) / 2 * metres], [0.0, metres, -(side - 1) / 2 * metres], [0.0, 0.0, 1.0]]
        )
        scale = np.array([[_FINE, 0.0, (_FINE - 1) / 2], [0.0, _FINE, (_FINE - 1) / 2], [0.0, 0.0, 1.0]])
        whole = scale @ self._view.plane(HEIGHT_M) @ onto
        size = (fine.shape[1], fine.shape[0])
        warped = cv2.warpPerspective(plate, whole, size, flags=cv2.INTER_LINEAR)
        cover = cv2.warpPerspective(np.full_like(plate, 255), whole, size, flags=cv2.INTER_LINEAR)
        fine[cover > 127] = warped[cover > 127][:, None]

    def _pixels(self, points: Floats, height: float) -> NDArray[np.int32]:
        places = pixels_of(self._view, points, height)
        return np.round(_FINE * places + (_FINE - 1) / 2).astype(np.int32)


def _disc(x: float, y: float, radius: float) -> Floats:
    """The outline (48, 2) of a disc [m]."""
    turn = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    return floats(np.column_stack((x + radius * np.cos(turn), y + radius * np.sin(turn))))


def pixels_of(view: View, points: Floats, height: float) -> Floats:
    """Where points (n, 2) [m] at a height [m] are in the picture (n, 2) [px]."""
    whole = np.column_stack((points, np.ones(len(points)))) @ view.plane(height).T
    return floats(whole[:, :2] / whole[:, 2:])


def floor_text(view: View, arena: Arena) -> str:
    """The floor file: the corners of the arena, and where the camera hangs."""
    corners = floats([(arena.x_min, arena.y_max), (arena.x_max, arena.y_max), (arena.x_max, arena.y_min),
                      (arena.x_min, arena.y_min)])  # fmt: skip
    return yaml_text(
        {
            "image_px": list(view.size),
            "points_px": np.round(pixels_of(view, corners, 0.0), 3).tolist(),
            "points_m": corners.tolist(),
            "camera_m": np.round(view.camera, 4).tolist(),
        }
    )


def truth_text(truth: Truth) -> str:
    """The true poses as a table with one line for each robot in each frame."""
    lines = ["frame,time_s,robot,x_m,y_m,heading_rad"]
    for frame, (time, centres, headings) in enumerate(zip(*truth, strict=True)):
        for robot, ((x, y), heading) in enumerate(zip(centres, headings, strict=True), 1):
            lines.append(f"{frame},{time:.4f},{robot},{x:.5f},{y:.5f},{heading:.5f}")
    return "\n".join(lines) + "\n"


def write_video(file: Path, images: Sequence[NDArray[np.uint8]], rate: float) -> None:
    """Writes pictures of one size as MPEG-4.

    Raises:
        HigvfError: the file cannot be written.
    """
    size = (images[0].shape[1], images[0].shape[0])
    video = cv2.VideoWriter(str(file), cv2.CAP_FFMPEG, cv2.VideoWriter.fourcc(*"mp4v"), rate, size)
    if not video.isOpened():
        raise HigvfError(f"{file}: the video cannot be written")
    for image in images:
        video.write(image)
    video.release()


def main(arguments: Sequence[str] | None = None) -> int:
    """Writes video, floor file and true poses; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m higvf_console.lab.overhead_video", description=__doc__)
    parser.add_argument("out_folder", type=Path)
    parser.add_argument("--scenario", default=SCENARIO, help=f"with robots and a stroke (default {SCENARIO})")
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--rate", type=float, default=15.0, help="frames a second (default 15)")
    parser.add_argument("--size", type=int, nargs=2, default=(960, 600), metavar=("WIDTH", "HEIGHT"), help="[px]")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args(arguments)
    try:
        scenario = load_scenario(given.scenario)
        setup = scenario.setup(given.seed)
        view = view_of(scenario.arena, (given.size[0], given.size[1]))
        strokes = [(stroke.points, stroke.robot) for stroke in scenario.strokes[:1]]
        truth = true_poses(setup, strokes, given.seconds, given.rate)
        painter = Painter(view, setup, given.seed)
        images = [painter.frame(*one) for one in zip(truth.centres, truth.headings, strict=True)]
        given.out_folder.mkdir(parents=True, exist_ok=True)
        write_video(given.out_folder / f"{NAME}.mp4", images, given.rate)
        (given.out_folder / f"{NAME}.floor.yaml").write_text(floor_text(view, scenario.arena), encoding="utf-8")
        (given.out_folder / f"{NAME}.truth.csv").write_text(truth_text(truth), encoding="utf-8")
    except (HigvfError, OSError) as problem:
        print(problem, file=sys.stderr)
        return 2
    print(given.out_folder / f"{NAME}.mp4")
    return 0


if __name__ == "__main__":
    sys.exit(main())

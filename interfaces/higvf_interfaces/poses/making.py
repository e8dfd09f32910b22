"""Make the floor file of an overhead camera: `python -m higvf_interfaces.poses SOURCE --corners ... --out FLOOR.yaml`.

Either by the pixels of four corners, or by four tags that lie on the floor and are seen in some frames:

    python -m higvf_interfaces.poses 0 --corners 260,110 1660,118 1672,985 251,990 --arena 3.2x2 --out floor.yaml
    python -m higvf_interfaces.poses lab.mp4 --floor-tags 40,41,42,43 --size 0.08 --arena 3.2x2 --out floor.yaml

The order is that of the corners of the arena: top left, top right, bottom right, bottom left; `--at x,y x,y x,y x,y`
gives other places [m]. What is printed measures the file: how far tags wander from frame to frame, and, with `--size`,
what their sides come to, which four points that always fit cannot tell.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import HigvfError, InputError
from higvf_console.core.optional import optional
from higvf_console.core.reading.document import yaml_text
from higvf_interfaces.poses.calibration import Lens, fitted, inverse, mapped, read_floor, read_lens
from higvf_interfaces.poses.capture import Capture, Frame
from higvf_interfaces.poses.tags import Tag, TagDetector, dictionary

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "images")

FRAMES = 20  # in which tags are looked for
_WITHIN = 5.0  # in which one more frame must come [s]


def floor_of_corners(pixels: Floats, ground: Floats, size: tuple[int, int], camera: Floats | None = None) -> str:
    """The text of a floor file of points (n, 2) [px] and (n, 2) [m], and of where the camera hangs (3,) [m]."""
    content = {
        "image_px": list(size), "points_px": np.round(pixels, 3).tolist(), "points_m": np.round(ground, 4).tolist(),
    }  # fmt: skip
    return yaml_text(content | ({} if camera is None else {"camera_m": np.round(camera, 4).tolist()}))


def camera_place(pixels: Floats, ground: Floats, lens: Lens) -> Floats:
    """Where (3,) a camera hangs [m] whose lens is known and that sees points (n, 2) [m] at pixels (n, 2)."""
    flat = np.column_stack((ground, np.zeros(len(ground))))
    _, turn, move = cv2.solvePnP(flat, pixels, lens.matrix, lens.distortion)
    rotation, _ = cv2.Rodrigues(turn)
    return floats(-np.asarray(rotation).T @ np.asarray(move).reshape(3))


def seen_tags(frames: Sequence[Frame], wanted: Sequence[int], name: str, place: str) -> dict[int, Floats]:
    """The corners (k, 4, 2) [px] of each wanted tag in the k frames that show it once.

    Raises:
        InputError: there is no such dictionary, or a tag is never seen; the message names those that are.
    """
    detector = TagDetector(dictionary(name, place))
    found: dict[int, list[Floats]] = {}
    for frame in frames:
        tags = detector.find(np.asarray(cv2.cvtColor(frame.image, cv2.COLOR_BGR2GRAY), np.uint8))
        for tag in tags:
            if sum(other.id == tag.id for other in tags) == 1:
                found.setdefault(tag.id, []).append(tag.corners)
    if missing := [str(number) for number in wanted if number not in found]:
        seen = ", ".join(map(str, sorted(found))) or "none"
        raise InputError(f"{place}: tags {', '.join(missing)} are not seen in {len(frames)} frames; seen: {seen}")
    return {number: floats(found[number], -1, 4, 2) for number in wanted}


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m higvf_interfaces.poses", description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("source", help="video file, index of a camera, or URL")
    by = parser.add_mutually_exclusive_group(required=True)
    by.add_argument("--corners", nargs=4, metavar="X,Y", help="pixels of the four corners")
    by.add_argument("--floor-tags", metavar="ID,ID,ID,ID", help="tags whose centres lie on the four corners")
    parser.add_argument("--arena", default="3.2x2", metavar="WxH", help="[m] (default 3.2x2), its origin bottom left")
    parser.add_argument("--at", nargs=4, metavar="X,Y", help="where the four are [m], in place of --arena")
    parser.add_argument("--tags", default="4x4_50", help="dictionary of the tags (default 4x4_50)")
    parser.add_argument("--size", type=float, metavar="M", help="side of a tag [m], to measure the result by")
    parser.add_argument("--lens", type=Path, metavar="FILE", help="lens file; tells where the camera hangs, too")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help="floor file to write")
    given = parser.parse_args(arguments)
    try:
        text, measured = _made(given)
        given.out.write_text(text, encoding="utf-8")
        read_floor(given.out)
    except (HigvfError, OSError) as problem:
        print(problem, file=sys.stderr)
        return 2
    print(measured)
    print(given.out)
    return 0


def _made(given: argparse.Namespace) -> tuple[str, str]:
    """Text of the floor file, and what it measures."""
    place = f"camera {given.source}"
    lens = None if given.lens is None else read_lens(given.lens)
    ground = _corners(given)
    capture = Capture(given.source, place)
    try:
        frames = _frames(capture, 1 if given.corners else FRAMES)
        size = capture.size
    finally:
        capture.close()
    if lens is not None and lens.image != size:
        raise InputError(f"{given.lens}: is for pictures of {lens.image}, and these are of {size} px")
    if given.corners:
        pixels, tags = floats([_pair(text, "--corners") for text in given.corners]), {}
    else:
        wanted = _ids(given.floor_tags)
        tags = seen_tags(frames, wanted, given.tags, place)
        pixels = floats([tags[number].mean(axis=(0, 1)) for number in wanted])
    straight = pixels if lens is None else lens.straightened(pixels)
    homography = fitted(straight, ground, place)
    camera = None if lens is None else camera_place(pixels, ground, lens)
    measured = _measured(homography, ground, tags, lens, given.size)
    return floor_of_corners(pixels, ground, size, camera), measured


def _measured(
    homography: Floats, ground: Floats, tags: dict[int, Floats], lens: Lens | None, size: float | None
) -> str:
    if not tags:
        middle = float(np.abs(np.diff(mapped(inverse(homography), ground), axis=0)).max())
        longest = float(np.abs(np.diff(ground, axis=0)).max())
        return f"Four points always fit; a pixel of error is about {1e3 * longest / middle:.1f} mm on the floor."
    wander: list[float] = []
    sides: list[float] = []
    for corners, place in zip(tags.values(), ground, strict=True):
        for four in corners:
            straight = four if lens is None else lens.straightened(four)
            on_floor = mapped(homography, straight)
            wander.append(float(np.hypot(*(on_floor.mean(axis=0) - place))))
            sides.append(Tag(0, on_floor).side)
    text = f"Reprojection error of the tags over all frames: {1e3 * float(np.sqrt(np.mean(np.square(wander)))):.2f} mm"
    low, high = 1e3 * min(sides), 1e3 * max(sides)
    return f"{text}; their sides come to {low:.1f} to {high:.1f} mm" + (f", of {1e3 * size:g} mm." if size else ".")


def _frames(capture: Capture, count: int) -> list[Frame]:
    capture.start()
    frames: list[Frame] = []
    while len(frames) < count:
        frame = capture.wait(frames[-1].number if frames else -1, _WITHIN)
        if frame is None:
            break
        frames.append(frame)
    if not frames:
        raise InputError("no frame has come")
    return frames


def _corners(given: argparse.Namespace) -> Floats:
    if given.at is not None:
        return floats([_pair(text, "--at") for text in given.at])
    width, height = _pair(given.arena, "--arena", "x")
    return floats([(0.0, height), (width, height), (width, 0.0), (0.0, 0.0)])


def _pair(text: str, option: str, between: str = ",") -> tuple[float, float]:
    try:
        first, second = (float(part) for part in text.split(between))
    except ValueError:
        raise InputError(f"{option}: {text!r} is not two numbers with '{between}' between them") from None
    return first, second


def _ids(text: str) -> list[int]:
    parts = text.split(",")
    if len(parts) != 4 or not all(part.isdigit() for part in parts) or len(set(parts)) != 4:
        raise InputError(f"--floor-tags: {text!r} is not four ids such as 40,41,42,43")
    return [int(part) for part in parts]

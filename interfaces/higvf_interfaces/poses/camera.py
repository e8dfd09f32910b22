"""`--poses camera=FILE_OR_INDEX_OR_URL:tags=4x4_50,size_m=0.08,floor=a.yaml`: tags on robots, seen from above.

Each robot carries a tag whose id is its number, less 1 (`first_id` adds to it), and whose upper edge points forward.
A thread of its own looks for them in the newest frame. A robot whose tag is not seen keeps its last pose with its
stamp, so that the console predicts it on, and then calls it stale. A tag that is seen twice in one frame tells nothing.
"""

import math
import os
import sys
import threading
from collections import Counter
from contextlib import suppress
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, NamedTuple
from typing import Annotated as A  # noqa: N817 (a table needs narrow columns)

import numpy as np

from higvf_console.core.errors import InputError
from higvf_console.core.optional import optional
from higvf_console.core.quantity import Quantity as Q  # noqa: N817
from higvf_console.core.team import Picture, Poses, TeamSpec, never_seen, options_of
from higvf_interfaces.poses.calibration import read_floor, read_lens
from higvf_interfaces.poses.capture import Capture, Frame, Live
from higvf_interfaces.poses.floor_view import FloorView
from higvf_interfaces.poses.tags import Tag, TagDetector, dictionary

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "images")

MAKE_FLOOR = "make one with: python -m higvf_interfaces.poses SOURCE --corners ... --out FLOOR.yaml"
_SIZE_TOLERANCE = 0.25  # by which the side of a tag may differ from size_m
_PICTURE_EVERY = 0.1  # at least, between two pictures of the floor [s]
_PICTURE_WANTED = 2.0  # for which pictures are made after the last one was asked for [s]
_NICENESS = 5  # of the thread: control goes first


class CameraOptions(NamedTuple):
    """What its options mean."""

    tags: str = "4x4_50"
    floor: str = ""
    lens: str = ""
    size_m: A[float, Q("m", 0.0, 10.0, "", "Side of a tag, black border included; 0 = not checked.")] = 0.0
    height_m: A[float, Q("m", 0.0, 100.0, "", "Of the tags above the floor; needs camera_m in the floor file.")] = 0.0
    first_id: A[float, Q("", 0.0, 1023.0, "", "Id of the tag of robot 1.")] = 0.0
    turned_deg: A[float, Q("deg", -180.0, 180.0, "", "By which tags are turned on robots, counter-clockwise.")] = 0.0
    delay_s: A[float, Q("s", 0.0, 2.0, "", "From taking a picture until a live camera has sent it.")] = 0.0
    width_px: A[float, Q("px", 0.0, 16384.0, "", "Of the pictures that a live camera is asked for; 0 = as it is.")] = (
        0.0
    )
    height_px: A[float, Q("px", 0.0, 16384.0, "", "Likewise.")] = 0.0
    loop: A[float, Q("", 0.0, 1.0, "", "1 = a video file begins again at its end.")] = 0.0


class CameraPoses:
    """A source of poses: the newest of each robot, and a picture of the floor."""

    name = "camera"

    def __init__(self, spec: TeamSpec) -> None:
        """Opens the camera and its files; a video begins to play when poses are first asked for.

        Raises:
            InputError: an option, a file or the camera cannot be used.
        """
        options = _checked(spec, options_of(spec, CameraOptions))
        place = spec.place.replace("--team", "--poses")
        self._spec, self._options, self._place = spec, options, place
        self._detector = TagDetector(dictionary(options.tags, place))
        floor = read_floor(_floor_file(spec, options, place))
        if options.height_m > 0.0 and floor.camera is None:
            raise InputError(f"{place}: height_m={options.height_m:g} needs camera_m: [x, y, height] in {floor.file}")
        lens = read_lens(Path(options.lens)) if options.lens else None
        live = Live(int(options.width_px), int(options.height_px), options.delay_s)
        self._capture = Capture(spec.address, place, live, loop=bool(options.loop))
        try:
            self._view = FloorView(floor, lens, self._capture.size, spec.arena, place)
        except InputError:
            self._capture.close()
            raise
        self._poses = never_seen(spec.robots)
        self._picture: Picture | None = None
        self._picture_wanted_at = -math.inf
        self._doubled: frozenset[int] = frozenset()
        self._missized: frozenset[int] = frozenset()
        self._notices: list[str] = []
        self._lock = threading.Lock()
        self._stopping = threading.Event()
        self._started = False
        self._failure: Exception | None = None
        self._thread = threading.Thread(target=self._run, name="camera poses", daemon=True)

    def poses(self, now: float) -> Poses:  # noqa: ARG002 (frames have stamps of their own)
        """The newest pose of each robot.

        Raises:
            RuntimeError: the thread that looks for tags has failed.
        """
        if not self._started:
            self._started = True
            self._capture.start()
            self._thread.start()
        if self._failure is not None:
            raise RuntimeError(f"looking for tags failed: {self._failure}") from self._failure
        return self._poses

    def picture(self) -> Picture | None:
        """The newest picture of the floor; made only as long as it is asked for."""
        self._picture_wanted_at = monotonic()
        return self._picture

    def notices(self) -> tuple[str, ...]:
        """What has happened since the last call, a sentence each."""
        with self._lock:
            taken, self._notices = tuple(self._notices), []
        return taken + self._capture.take_notices()

    def close(self) -> None:
        """Ends the threads; may be called twice."""
        self._stopping.set()
        self._capture.close()
        if self._thread.is_alive():
            self._thread.join(0.2)

    def _run(self) -> None:
        if sys.platform == "linux":
            with suppress(OSError):
                os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _NICENESS)
        number = -1
        try:
            while not self._stopping.is_set():
                frame = self._capture.wait(number, 0.1)
                if frame is not None:
                    number = frame.number
                    self._look(frame)
        except Exception as error:  # whatever OpenCV raises: told by `poses`, on the thread that drives
            self._failure = error

    def _look(self, frame: Frame) -> None:
        grey = np.asarray(cv2.cvtColor(frame.image, cv2.COLOR_BGR2GRAY), np.uint8)
        side = self._options.size_m * self._view.pixels_per_metre() if self._options.size_m else math.nan
        tags = self._once(self._detector.find(grey, side))
        if self._view.look(tags):
            self._tell("The camera was moved: robots are seen again once it has found the tags of the floor.")
        if self._view.homography is None:
            return
        self._place_robots(tags, frame.taken_at)
        now = monotonic()
        last = -math.inf if self._picture is None else self._picture.taken_at
        if now - self._picture_wanted_at < _PICTURE_WANTED and frame.taken_at - last >= _PICTURE_EVERY:
            above = self._view.from_above(frame.image)
            if above is not None:
                self._picture = Picture(above[:, :, ::-1], self._spec.arena, frame.taken_at)

    def _once(self, tags: list[Tag]) -> list[Tag]:
        """The tags that are seen once."""
        counts = Counter(tag.id for tag in tags)
        doubled = frozenset(number for number, count in counts.items() if count > 1)
        for number in sorted(doubled - self._doubled):
            self._tell(f"Tag {number} is seen {counts[number]} times at once: it is not used.")
        self._doubled = doubled
        return [tag for tag in tags if tag.id not in doubled]

    def _place_robots(self, tags: list[Tag], taken_at: float) -> None:
        before, options = self._poses, self._options
        poses = Poses(before.position.copy(), before.heading.copy(), before.measured_at.copy())
        missized: set[int] = set()
        for tag in tags:
            robot = tag.id - int(options.first_id)
            if not 0 <= robot < self._spec.robots:
                continue
            corners = self._view.on_floor(tag.corners, options.height_m)
            side = Tag(tag.id, corners).side
            if options.size_m and abs(side / options.size_m - 1.0) > _SIZE_TOLERANCE:
                missized.add(tag.id)
                if tag.id not in self._missized:
                    self._tell(f"Tag {tag.id} is {1e3 * side:.0f} mm wide, not {1e3 * options.size_m:.0f}: not used.")
                continue
            forward = corners[0] + corners[1] - corners[2] - corners[3]
            heading = math.atan2(forward[1], forward[0]) - math.radians(options.turned_deg)
            poses.position[robot] = corners.mean(axis=0)
            poses.heading[robot] = math.remainder(heading, 2.0 * math.pi)
            poses.measured_at[robot] = taken_at
        self._missized = frozenset(missized)
        self._poses = poses  # as a whole: who reads it on another thread keeps the former one

    def _tell(self, text: str) -> None:
        with self._lock:
            self._notices.append(text)


def open_camera(spec: TeamSpec) -> CameraPoses:
    """Opens `--poses camera=...`.

    Raises:
        InputError: an option, a file or the camera cannot be used.
    """
    return CameraPoses(spec)


def _checked(spec: TeamSpec, options: CameraOptions) -> CameraOptions:
    place = spec.place.replace("--team", "--poses")
    if not spec.address:
        raise InputError(f"{place}: give a video file, the index of a camera, or a URL: --poses camera=0:floor=a.yaml")
    for name in ("first_id", "width_px", "height_px", "loop"):
        if not float(getattr(options, name)).is_integer():
            raise InputError(f"{place}: {name}={getattr(options, name):g} is no whole number")
    if (options.width_px > 0) is not (options.height_px > 0):
        raise InputError(f"{place}: width_px and height_px need each other")
    return options


def _floor_file(spec: TeamSpec, options: CameraOptions, place: str) -> Path:
    """The file of the floor: that of the option, else the one beside a video, `VIDEO.floor.yaml`."""
    if options.floor:
        return Path(options.floor)
    beside = Path(spec.address).with_suffix(".floor.yaml")
    if not beside.is_file():
        raise InputError(f"{place}: floor=FILE is missing, and there is no {beside}; {MAKE_FLOOR}")
    return beside

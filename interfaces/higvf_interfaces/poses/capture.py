"""Frames of an overhead camera: a video file, a camera by its index, or a stream by its URL; the newest one only.

    device -> thread that reads as fast as frames come -> the newest frame -> who asks

A file plays in real time from the moment it is started, as a camera would have seen it: frames that nobody was in time
for are passed over. A camera that falls silent is opened again, once a second.
"""

import re
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from higvf_console.core.errors import InputError
from higvf_console.core.optional import optional

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "images")

_OPENS_WITHIN_MS, _READS_WITHIN_MS = 3000, 800  # of a stream
_AGAIN = 1.0  # from one attempt to open a lost camera to the next [s]
_SLOWEST, _FASTEST = 1.0, 240.0  # rates of a video file that are believed [frames/s]
_URL = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*://")


def _head(file: Path) -> bytes:
    """The first bytes of a file; those of a video hold zeros."""
    with file.open("rb") as opened:
        return opened.read(4096)


class Frame(NamedTuple):
    """A picture (rows, columns, 3) in blue, green, red; when it was taken [s]; and how many came before."""

    image: NDArray[np.uint8]
    taken_at: float
    number: int


class Live(NamedTuple):
    """What is asked of a live camera: size of its pictures [px], 0 = as it comes; how late they arrive [s]."""

    width: int = 0
    height: int = 0
    delay: float = 0.0


AS_IT_COMES = Live()


class Capture:
    """The frames of one source, read on a thread of its own from `start` until `close`.

    Attributes:
        size: of its pictures, width and height [px].
        is_file: whether it is a video file.
    """

    def __init__(
        self, source: str, place: str, live: Live = AS_IT_COMES, *, loop: bool = False,
        clock: Callable[[], float] = monotonic,
    ) -> None:  # fmt: skip
        """Opens the source and reads its first frame.

        Args:
            source: a file, an index such as `0`, or a URL.
            place: how errors call it.
            live: what is asked of a camera.
            loop: whether a file begins again at its end.
            clock: of the stamps [s].

        Raises:
            InputError: it cannot be opened, or its first frame cannot be read.
        """
        self._source, self._place, self._live, self._loop, self._clock = source, place, live, loop, clock
        self.is_file = not source.isdigit() and not _URL.match(source)
        self._video, first = self._opened()
        self.size = (int(first.shape[1]), int(first.shape[0]))
        self._rate = self._rate_of_file() if self.is_file else 0.0
        self._announced = int(self._video.get(cv2.CAP_PROP_FRAME_COUNT)) if self.is_file else 0
        self._first, self._newest = first, None
        self._notices: list[str] = []
        self._fresh = threading.Condition()
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._read, name=f"camera {source}", daemon=True)

    def start(self) -> None:
        """Begins to read; a file plays from now on."""
        if not self._thread.is_alive() and not self._stopping.is_set():
            self._thread.start()

    def wait(self, after: int, timeout: float) -> Frame | None:
        """The newest frame, once it is later than number `after`; None = there was none within `timeout` [s]."""
        with self._fresh:
            self._fresh.wait_for(lambda: self._newest is not None and self._newest.number > after, timeout)
            newest = self._newest
        return newest if newest is not None and newest.number > after else None

    def take_notices(self) -> tuple[str, ...]:
        """What has happened since the last call, a sentence each."""
        with self._fresh:
            taken, self._notices = tuple(self._notices), []
        return taken

    def close(self) -> None:
        """Ends the thread; may be called twice."""
        self._stopping.set()
        with self._fresh:
            self._fresh.notify_all()
        if self._thread.is_alive():
            self._thread.join(_READS_WITHIN_MS / 1000)  # a device that hangs is left alone: it must not hold up the end
        elif self._thread.ident is None:
            self._video.release()

    def _opened(self) -> "tuple[cv2.VideoCapture, NDArray[np.uint8]]":
        if self.is_file:
            self._check_file()
        if self._source.isdigit():
            video = cv2.VideoCapture(int(self._source))
            if self._live.width and self._live.height:
                video.set(cv2.CAP_PROP_FOURCC, cv2.VideoWriter.fourcc(*"MJPG"))  # raw pictures fill a USB line
                video.set(cv2.CAP_PROP_FRAME_WIDTH, self._live.width)
                video.set(cv2.CAP_PROP_FRAME_HEIGHT, self._live.height)
            video.set(cv2.CAP_PROP_BUFFERSIZE, 1)
        else:
            within = [
                cv2.CAP_PROP_OPEN_TIMEOUT_MSEC,
                _OPENS_WITHIN_MS,
                cv2.CAP_PROP_READ_TIMEOUT_MSEC,
                _READS_WITHIN_MS,
            ]
            video = cv2.VideoCapture(self._source, cv2.CAP_FFMPEG, within)
        image = self._next(video) if video.isOpened() else None
        if image is None:
            video.release()
            raise InputError(f"{self._place}: {self._refusal()}")
        return video, image

    def _check_file(self) -> None:
        file = Path(self._source)
        try:
            empty = file.stat().st_size == 0
            head = b"" if empty or not file.is_file() else _head(file)
        except OSError as error:
            wanted = "give a video file, the index of a camera such as 0, or a URL such as rtsp://..."
            raise InputError(f"{self._place}: {self._source}: {error.strerror}; {wanted}") from error
        if not file.is_file():
            raise InputError(f"{self._place}: {self._source} is no file")
        if empty:
            raise InputError(f"{self._place}: {self._source} is empty")
        if b"\0" not in head:  # FFmpeg draws text as a film of letters
            raise InputError(f"{self._place}: {self._source} is text; a video is wanted")

    def _refusal(self) -> str:
        if self._source.isdigit():
            found = sorted(device.name for device in Path("/dev").glob("video*")) if sys.platform == "linux" else []
            return f"camera {self._source} cannot be read; cameras here: {', '.join(found) or 'none found'}"
        return f"{self._source} cannot be read as a video" + ("" if self.is_file else " stream")

    def _rate_of_file(self) -> float:
        rate = float(self._video.get(cv2.CAP_PROP_FPS))
        if not _SLOWEST <= rate <= _FASTEST:
            self._video.release()
            raise InputError(
                f"{self._place}: {self._source} has {rate:g} frames a second; a video has {_SLOWEST:g} to {_FASTEST:g}"
            )
        return rate

    @staticmethod
    def _next(video: "cv2.VideoCapture") -> NDArray[np.uint8] | None:
        found: Any = video.read()
        read, image = found
        if not read or image is None or image.ndim != 3 or image.shape[2] != 3:
            return None
        return np.asarray(image, np.uint8)

    def _read(self) -> None:
        try:
            if self.is_file:
                self._play()
            else:
                self._watch()
        finally:
            self._video.release()

    def _publish(self, image: NDArray[np.uint8], taken_at: float) -> None:
        with self._fresh:
            number = 0 if self._newest is None else self._newest.number + 1
            self._newest = Frame(image, taken_at, number)
            self._fresh.notify_all()

    def _tell(self, text: str) -> None:
        with self._fresh:
            self._notices.append(text)

    def _play(self) -> None:
        """The file in real time."""
        start, index, image = self._clock(), 0, self._first
        while not self._stopping.is_set():
            due = start + index / self._rate
            if not self._stopping.wait(max(due - self._clock(), 0.0)):
                self._publish(image, due)
            late = int((self._clock() - due) * self._rate) - 1
            passed = 0
            while passed < late and self._video.grab():
                passed += 1
            following = self._next(self._video)
            index += 1 + passed
            if following is None:
                self._tell_end(index)
                if not self._loop:
                    return
                self._video.release()
                try:
                    self._video, following = self._opened()
                except InputError as error:
                    self._tell(f"The video cannot be read again: {error}.")
                    return
            image = following

    def _tell_end(self, frames: int) -> None:
        played = f"{frames / self._rate:.1f} s"
        if frames < self._announced - 1:
            self._tell(f"The video {self._source} breaks off after {played} of {self._announced / self._rate:.1f} s.")
        elif self._loop:
            self._tell(f"The video {self._source} has ended after {played}, and begins again.")
        else:
            self._tell(f"The video {self._source} has ended after {played}: it shows no robots any more.")

    def _watch(self) -> None:
        """A camera or a stream, opened again where it is lost."""
        self._publish(self._first, self._clock() - self._live.delay)
        while not self._stopping.is_set():
            image = self._next(self._video)
            if image is not None:
                self._publish(image, self._clock() - self._live.delay)
                continue
            self._tell(f"Camera {self._source} gives no pictures any more.")
            self._video.release()
            if not self._found_again():
                return
            self._tell(f"Camera {self._source} gives pictures again.")

    def _found_again(self) -> bool:
        while not self._stopping.wait(_AGAIN):
            try:
                self._video, image = self._opened()
            except InputError:
                continue
            if (image.shape[1], image.shape[0]) != self.size:
                self._tell(
                    f"Camera {self._source} now has pictures of {image.shape[1]} x {image.shape[0]} px: not used."
                )
                self._video.release()
                return False
            return True
        return False

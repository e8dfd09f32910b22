"""Live gaze stream with the interface of a playback: fixations are detected as samples arrive.

A fixation is returned about 0.3 s after its end, when later samples can no longer change it. A fixation that is
unfinished when the clutch opens is returned at once with its part so far.
"""

import math

import numpy as np

from higvf_console.core.arrays import Floats, bools, floats
from higvf_console.core.interface import InputSpec
from higvf_interfaces.decisions.options import word
from higvf_interfaces.fields import Fields
from higvf_interfaces.formats.clock import Repairs
from higvf_interfaces.formats.records import MIN_CONFIDENCE, GazeStream, beyond, trusted
from higvf_interfaces.formats.xdf.gaze import gaze_channels
from higvf_interfaces.gaze.chunked_fixations import NO_PIXELS, ChunkClassifier, Pixels
from higvf_interfaces.gaze.fixations import IVT, METHODS, PX_PER_DEG, THRESHOLDS, Classified, Fixation, fixations_of
from higvf_interfaces.gaze.screens import NO_PIXELS_HINT, TELLING, are_shares, choose_screen, on_screen, to_pixels
from higvf_interfaces.live.lsl import WITHIN, LslReader, StreamQuery, query_of
from higvf_interfaces.streams import RunClock

GAZE = StreamQuery(type="Gaze")


class LiveGaze:
    """A live gaze stream: source and playback in one object.

    Attributes:
        reader: reader of the stream.
        screen: the tracker's screen and its mapping to the arena.
        px_per_deg: pixels per degree of visual angle.
        started: whether a sample has arrived.
        seen: whether gaze is known at the newest sample.
        point: newest sample (2,) [px]; NaN if unknown.
        ended: always False.
        first_time: always 0 [s].
        newest: samples of the last call of `advance`, on the clock of the stream.
    """

    ended = False
    first_time = 0.0

    def __init__(self, spec: InputSpec, options: Fields) -> None:
        """Find and open the stream.

        Raises:
            InputError: If no stream or several match, its gaze channels are unknown, or an option is invalid.
        """
        self.px_per_deg = options.number("px_per_deg", PX_PER_DEG, 1.0, 1000.0, "px/deg")
        self._method = options.choice("method", IVT, METHODS)
        self._trusted_from = options.number("min_confidence", MIN_CONFIDENCE, 0.0, 1.0)
        within = options.number("within", WITHIN, 0.1, 3600.0, "s")
        self._beyond, self._probe = 0, floats([], 0, 2)
        self.reader = LslReader(query_of(options, GAZE), options.place, within)
        try:
            x, y = (word(options, key) if options.has(key) else None for key in ("x", "y"))
            channels = gaze_channels(options.place, self.reader.header, self.reader.channels, x, y)
            self._x, self._y, self._confidence = channels.x, channels.y, channels.confidence
            self._assumed = tuple(channels.notes)
            columns = (channels.labels[self._x], channels.labels[self._y])
            stream = GazeStream("lsl", columns, channels.frame, iter(()), [], channels.origin, doubts=channels.doubts)
            self.screen = choose_screen(stream, options, spec.arena)
        except Exception:
            self.reader.close()
            raise
        self._clock = RunClock()
        self._restart()

    @property
    def format(self) -> str:
        """Name of the format."""
        return "lsl"

    @property
    def notes(self) -> tuple[str, ...]:
        """The stream, and assumptions made."""
        beyond_one = (f"{self._beyond} samples with a confidence above 1 are not used",) if self._beyond else ()
        shares = (f"gaze is not used: {NO_PIXELS_HINT}",) if are_shares(self._probe, self.screen) else ()
        return (*self.reader.notes, *self._assumed, *self.screen.notes, *beyond_one, *shares)

    @property
    def time(self) -> float:
        """Session time of the newest sample [s]."""
        return min(self._clock.now, self._clock.now - (self.reader.now - self._latest))

    def advance(self, now: float) -> tuple[bool, list[Fixation]]:
        """Process the samples that arrived by session time `now` [s].

        Returns:
            Whether there are new samples, and the fixations that have ended, in session time.
        """
        if self._clock.was_reset(now):
            self._restart()
        samples = [sample for sample in self.reader.take() if sample.time > self._latest]
        if not samples:
            self.newest = NO_PIXELS
            return False, []
        times = floats([sample.time for sample in samples])
        kept = Repairs().advancing(times)
        values = floats([sample.values for sample in samples], -1, self.reader.channels)[kept]
        raw = floats(values[:, [self._x, self._y]])
        if len(self._probe) < TELLING:
            self._probe = floats(np.concatenate([self._probe, raw[np.isfinite(raw).all(axis=1)]])[:TELLING])
        points = to_pixels(raw, self.screen)
        valid = np.isfinite(points).all(axis=1) & on_screen(points, self.screen)
        valid &= not are_shares(self._probe, self.screen)
        if self._confidence is not None:
            confidence = floats(values[:, self._confidence])
            valid &= trusted(confidence, self._trusted_from)
            self._beyond += int(np.count_nonzero(beyond(confidence)))
        points[~valid] = np.nan
        self._latest, self.started = float(times[kept][-1]), True
        self.point, self.seen = points[-1], bool(valid[-1])
        self.newest = Pixels(floats(times[kept]), points, bools(valid))
        chunk = self._classifier.push(self.newest)
        return True, self._fixations(chunk) if chunk is not None else []

    def unfinished(self) -> list[Fixation]:
        """Return the fixations not returned yet, including the current one if it is long enough."""
        rest = self._classifier.flush()
        if rest is None:
            return []
        self._classifier = ChunkClassifier(self.px_per_deg, self._method)
        return [found for found in self._fixations(rest) if found.end - found.start >= THRESHOLDS.shortest]

    def _fixations(self, chunk: Classified) -> list[Fixation]:
        """Return the fixations of a chunk, in session time."""
        shift = self._clock.now - self.reader.now
        return [rest._replace(start=rest.start + shift, end=rest.end + shift) for rest in fixations_of(chunk)]

    def close(self) -> None:
        """Stop reading; may be called twice."""
        self.reader.close()

    def _restart(self) -> None:
        """Reset the state, because the run was reset; the device continues."""
        self._classifier = ChunkClassifier(self.px_per_deg, self._method)
        self._latest = -math.inf
        self.started = self.seen = False
        self.point: Floats = np.full(2, np.nan)
        self.newest = NO_PIXELS

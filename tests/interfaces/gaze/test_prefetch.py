"""A poll reads at most one block of a recording, in the first play and in replays."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from higvf_console.core.arrays import bools, floats
from higvf_console.core.commands import Cursor
from higvf_console.core.interface import InputSpec, OperatorContext
from higvf_interfaces.formats.xdf import gaze as gaze_xdf
from higvf_interfaces.formats.xdf.samples import load
from higvf_interfaces.gaze.chunked_fixations import Pixels, chunk_per_block
from higvf_interfaces.gaze.fixations import Classified
from higvf_interfaces.gaze.interface import open_gaze
from higvf_interfaces.gaze.playback import GazePlayback
from higvf_interfaces.gaze.prefetch import AHEAD
from tests.interfaces.formats.xdf_files import Stream, xdf

RATE, BLOCK = 1000.0, 256
PERIOD = 0.02


class Recording:
    """Gaze that alternates between two points, except for a fixation from 20 s to 40 s; counts the blocks read."""

    def __init__(self, first: float = 0.0, last: float = 60.0) -> None:
        self.time = floats(np.arange(first, last, 1 / RATE))
        self.opened = self.read = 0

    def chunks(self) -> Iterator[Classified | None]:
        self.opened += 1
        return chunk_per_block(self.blocks())

    def blocks(self) -> Iterator[Pixels]:
        for first in range(0, len(self.time), BLOCK):
            self.read += 1
            time = self.time[first : first + BLOCK]
            away = (time % 0.8 > 0.4) & ~((time > 20) & (time < 40))
            points = np.stack([np.where(away, 900.0, 300.0), np.full(len(time), 400.0)], axis=1)
            yield Pixels(time, floats(points), bools(np.ones(len(time))))

    def played(self, playback: GazePlayback, until: float) -> tuple[list[float], int]:
        """Return the ends of the fixations and the largest number of blocks read in one poll."""
        ended: list[float] = []
        most = 0
        for tick in range(round(until / PERIOD)):
            before = self.read
            ended += [fixation.end for fixation in playback.advance(tick * PERIOD)[1]]
            most = max(most, self.read - before)
        return ended, most


def test_a_poll_reads_at_most_one_block_and_replays_are_equal() -> None:
    recording = Recording()
    playback = GazePlayback(recording.chunks)
    first, again, broken_off, last = (recording.played(playback, until) for until in (62.0, 62.0, 3.0, 62.0))
    assert [most for _, most in (first, again, broken_off, last)] == [1, 1, 1, 1]
    assert first == again == last
    assert playback.ended
    assert np.diff(first[0]).max() == pytest.approx(20, abs=1), "the stare"


def test_samples_before_the_run_are_skipped_when_the_recording_is_opened() -> None:
    recording = Recording(first=-15.0)
    playback = GazePlayback(recording.chunks)
    assert playback.first_time == -15.0
    first, again = (recording.played(playback, 30.0) for _ in range(2))
    assert first == again
    assert (first[1], again[1]) == (1, 1)
    assert first[0][0] == pytest.approx(0.4, abs=0.05)


def test_a_recording_that_is_shorter_than_the_head_is_opened_once() -> None:
    recording = Recording(last=AHEAD - 1)
    playback = GazePlayback(recording.chunks)
    assert recording.played(playback, AHEAD) == recording.played(playback, AHEAD)
    assert (recording.opened, playback.ended) == (1, True)


def test_an_xdf_file_is_loaded_once(
    write: Callable[..., str], monkeypatch: pytest.MonkeyPatch, at: Callable[..., OperatorContext]
) -> None:
    loaded: list[object] = []

    def counting(*arguments: Any, **named: Any) -> Any:
        loaded.append(arguments)
        return load(*arguments, **named)

    def play() -> list[list[float]]:
        commands = [command for tick in range(400) for command in gaze.poll(at(tick * PERIOD, clutch=True))]
        return [command.point.tolist() for command in commands if isinstance(command, Cursor)]

    monkeypatch.setattr(gaze_xdf, "load", counting)
    times = np.arange(1000) / 100
    looks = [[300.0 + 200.0 * (tick // 40 % 5), 400.0] for tick in range(1000)]
    stream = Stream("Tobii", "Gaze", "t", 100.0, times.tolist(), looks, ("x", "y"))
    gaze = open_gaze(InputSpec("gaze", write(xdf(stream)), {"frame": "screen", "origin": "bottom-left"}))
    assert play() == play()
    assert len(loaded) == 1

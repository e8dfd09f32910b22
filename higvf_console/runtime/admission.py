"""What the channels have said, between their poll and the run: STOP first, the rest in order and in measure.

A channel may say more than can be applied in a control period. What is too much waits for the next one, and what waits
too long is dropped and counted: a flood costs the one who sends it, never the team's rhythm.
"""

from collections import deque
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from higvf_console.channels.supervision import Said
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import EmergencyStop, OperatorCommand, Release, StrokeBegin, StrokePoints

MOST_WAITING = 4096  # commands of one channel
FULL_DETAIL = 1024  # points of a stroke that are all kept; of the next ones every second, then every fourth, and so on


class Admission:
    """The commands that wait to be applied, of all channels.

    Attributes:
        dropped: commands of each channel that came while too many waited, since the last `take_dropped`.
    """

    def __init__(self) -> None:
        """Starts with none."""
        self._stops: deque[Said] = deque()
        self._waiting: dict[str, deque[Said]] = {}
        self._strokes: dict[str, StrokeDetail] = {}
        self.dropped: dict[str, int] = {}

    def __len__(self) -> int:
        """How many wait."""
        return len(self._stops) + sum(map(len, self._waiting.values()))

    def take_in(self, said: Iterable[Said]) -> None:
        """Adds commands behind those that wait; a STOP goes before all, and what would reset it is dropped."""
        for channel, command in said:
            if isinstance(command, EmergencyStop):
                for waiting in self._waiting.values():
                    kept = [one for one in waiting if not isinstance(one.command, Release)]
                    waiting.clear()
                    waiting.extend(kept)
                self._stops.append(Said(channel, command))
                continue
            waiting = self._waiting.setdefault(channel, deque())
            if len(waiting) >= MOST_WAITING:
                self.dropped[channel] = self.dropped.get(channel, 0) + 1
                continue
            waiting.append(Said(channel, self._in_measure(channel, command)))

    def next(self) -> Said | None:
        """The next command to apply: a STOP, or the oldest of the first channel that has one."""
        if self._stops:
            return self._stops.popleft()
        for waiting in self._waiting.values():
            if waiting:
                return waiting.popleft()
        return None

    def yield_turn(self) -> None:
        """The first channel that has more to say goes last from now on: it has used up a control period."""
        for channel, waiting in self._waiting.items():
            if waiting:
                self._waiting = {**{k: v for k, v in self._waiting.items() if k != channel}, channel: waiting}
                return

    def take_dropped(self) -> dict[str, int]:
        """How many commands of which channel were dropped since the last call."""
        dropped, self.dropped = self.dropped, {}
        return dropped

    def _in_measure(self, channel: str, command: OperatorCommand) -> OperatorCommand:
        match command:
            case StrokeBegin():
                self._strokes[channel] = StrokeDetail()
            case StrokePoints(points=np.ndarray(ndim=2) as points) if channel in self._strokes:
                return replace(command, points=self._strokes[channel].thinned(points))
            case _:
                pass
        return command


class StrokeDetail:
    """Keeps a stroke short enough to be smoothed within a control period, however long it is drawn.

    The first `FULL_DETAIL` points are kept, then as many of every second one, then of every fourth, and so on: a stroke
    of n points keeps about `FULL_DETAIL` log2(n / `FULL_DETAIL`), spread over the whole of it.
    """

    def __init__(self) -> None:
        """Starts a stroke."""
        self._kept = 0
        self._skip = 0  # points that come before the next one to be kept

    def thinned(self, points: Floats) -> Floats:
        """Those of the next points (n, 2) [m] of the stroke that are kept."""
        pieces: list[Floats] = [points[:0]]
        while len(points) > self._skip:
            step = 2 ** (self._kept // FULL_DETAIL)
            piece = points[self._skip :: step][: FULL_DETAIL - self._kept % FULL_DETAIL]
            points = points[self._skip + (len(piece) - 1) * step + 1 :]
            self._kept += len(piece)
            self._skip = step - 1
            pieces.append(piece)
        self._skip -= len(points)
        return floats(pieces[1] if len(pieces) == 2 else np.concatenate(pieces))

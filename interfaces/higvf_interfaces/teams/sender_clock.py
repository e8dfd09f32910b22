"""Stamps of a sender whose clock is its own, on the clock of this machine.

The offset between both clocks is the least difference between arrival and stamp in the last seconds: no message was
faster than the fastest one. The least delay itself cannot be known this way; it is added as a number.
"""

import math

WINDOW = 10.0  # in which the fastest message is looked for; clocks that drift apart are followed this slowly [s]
AHEAD = 0.1  # by which a stamp may be faster than the fastest before it is doubted [s]
DOUBTED_FOR = 1.0  # after which doubted stamps are believed: the clock was set [s]


class SenderClock:
    """The clock of one sender.

    A clock that was set forward, or one stamp from the future, gives times from the future until it has gone on for a
    second. A clock that was set back gives old times until the window is over: what cannot be told from late messages
    must look late.
    """

    def __init__(self, delay: float = 0.0) -> None:
        """Starts with nothing known; `delay` is that of the fastest message [s]."""
        self._delay = delay
        self._least = [math.inf, math.inf]  # differences of arrival and stamp: in this half of the window, in the last
        self._half_began = -math.inf
        self._doubted_since = math.nan

    def time(self, stamp: float, arrived: float) -> float:
        """When a message was stamped, on this machine's clock [s].

        Args:
            stamp: on the sender's clock [s].
            arrived: when it came, on this machine's clock [s].
        """
        difference, known = arrived - stamp, min(self._least)
        if difference < known - AHEAD and math.isfinite(known):
            if math.isnan(self._doubted_since):
                self._doubted_since = arrived
            if arrived - self._doubted_since < DOUBTED_FOR:
                return stamp + known - self._delay
            self._least = [math.inf, math.inf]
        self._doubted_since = math.nan
        if arrived - self._half_began > WINDOW / 2:
            late = arrived - self._half_began > WINDOW
            self._least = [math.inf, math.inf if late else self._least[0]]
            self._half_began = arrived
        self._least[0] = min(self._least[0], difference)
        return stamp + min(self._least) - self._delay

"""How much a page may say: messages and bytes a second.

Beyond the soft limit a page's messages are dropped, and the page is told; beyond the hard limit it is cut off. An
honest page sends some 60 messages a second while its operator draws, at most 200, and files of 16 MB in pieces.
"""

from typing import NamedTuple


class Bucket:
    """A token bucket: so much at once, so much a second on and on."""

    def __init__(self, rate: float, burst: float) -> None:
        """Starts full.

        Args:
            rate: what comes back each second.
            burst: what it holds.
        """
        self._rate, self._burst = rate, burst
        self._left, self._at = burst, float("-inf")

    def holds(self, amount: float, now: float) -> bool:
        """Whether `amount` is there at `now` [s, any clock that runs on]."""
        self._left = min(self._burst, self._left + self._rate * (now - self._at))
        self._at = now
        return amount <= self._left

    def take(self, amount: float, now: float) -> bool:
        """Takes `amount`, if so much is there at `now` [s]."""
        if not self.holds(amount, now):
            return False
        self._left -= amount
        return True


class Limits(NamedTuple):
    """Of one page.

    Attributes:
        messages: that pass each second.
        messages_at_once: that pass beyond, after a pause.
        bytes: that pass each second.
        bytes_at_once: that pass beyond, after a pause.
        excess: times as many messages or bytes, dropped, that cut the page off.
    """

    messages: float = 300.0
    messages_at_once: float = 600.0
    bytes: float = 4e6
    bytes_at_once: float = 48e6
    excess: float = 5.0


class Pace:
    """What one page says, measured.

    Attributes:
        dropped: messages that were too many, since this was last read and set to 0.
    """

    def __init__(self, limits: Limits) -> None:
        """Starts with nothing said."""
        self._messages = Bucket(limits.messages, limits.messages_at_once)
        self._bytes = Bucket(limits.bytes, limits.bytes_at_once)
        self._hard = (
            Bucket(limits.messages * limits.excess, limits.messages_at_once * limits.excess),
            Bucket(limits.bytes * limits.excess, limits.bytes_at_once * limits.excess),
        )
        self.dropped = 0

    def allows(self, size: int, now: float) -> bool:
        """Whether a message of `size` bytes is within the soft limit at `now` [s]."""
        return self._messages.take(1, now) and self._bytes.take(size, now)

    def bears(self, size: int, now: float) -> bool:
        """Whether a message beyond the soft limit is within the hard one; it is counted as dropped."""
        self.dropped += 1
        messages, volume = self._hard
        return messages.take(1, now) and volume.take(size, now)

    def bears_part(self, now: float) -> bool:
        """Whether a frame that is no whole message is within the hard limit at `now` [s]."""
        return self._hard[0].take(1, now)

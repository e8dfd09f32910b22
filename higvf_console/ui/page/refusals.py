"""What is refused, told in the log: each kind once a minute with a count, so that nobody fills a disk with it."""

import logging
import threading
from time import monotonic

from higvf_console.core.limiter import Limiter

MOST_CHARACTERS = 80  # of what came from outside, in one line

_log = logging.getLogger(__name__)


class RefusedError(ValueError):
    """Something from outside that may not pass.

    Attributes:
        kind: what lines in the log are counted by; holds nothing that came from outside.
    """

    def __init__(self, kind: str, text: str) -> None:
        """Says why.

        Args:
            kind: what lines in the log are counted by.
            text: for people; may hold what came from outside.
        """
        super().__init__(cut(text))
        self.kind = kind


class Refusals:
    """The one limiter of all refusals of a console; callable from any thread."""

    def __init__(self) -> None:
        """Starts with nothing refused."""
        self._limiter = Limiter()
        self._lock = threading.Lock()

    def tell(self, kind: str, who: object, text: str, *, failure: BaseException | None = None) -> None:
        """Logs a refusal, or counts it where one of its kind was logged within a minute.

        Args:
            kind: what lines are counted by.
            who: from where it came.
            text: what was refused and why; is cut.
            failure: an error of our own, whose traceback is logged as well.
        """
        with self._lock:
            count = self._limiter.due(kind, monotonic())
        if count:
            more = f" ({count} of this kind since the last report)" if count > 1 else ""
            level = logging.WARNING if failure is None else logging.ERROR
            _log.log(level, "refused from %s: %s%s", who, cut(text), more, exc_info=failure)


def cut(text: str) -> str:
    """A text that fits a line: control characters are spelled out, what is too long ends in dots."""
    line = text[: 2 * MOST_CHARACTERS].encode("unicode_escape").decode()
    return line if len(line) <= MOST_CHARACTERS else f"{line[: MOST_CHARACTERS - 4]} ..."


class SocketLog(logging.Filter):
    """What the WebSocket library reports of a connection that fails, as refusals: without the tracebacks."""

    def __init__(self, refusals: Refusals) -> None:
        """Hands everything to `refusals`."""
        super().__init__()
        self._refusals = refusals

    def filter(self, record: logging.LogRecord) -> bool:
        """Drops the record, which is told as a refusal where it matters."""
        if record.levelno >= logging.WARNING:
            error = record.exc_info[1] if record.exc_info else None
            ours = error if record.getMessage() == "connection handler failed" else None
            reason = f": {error}" if error else ""
            self._refusals.tell(str(record.msg), "a connection", f"{record.getMessage()}{reason}", failure=ours)
        return False


def socket_logger(refusals: Refusals) -> logging.Logger:
    """A logger for the WebSocket library."""
    logger = logging.Logger("higvf_console.ui.page.sockets", logging.WARNING)
    logger.addFilter(SocketLog(refusals))
    return logger

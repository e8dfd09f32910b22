"""What every operator command carries."""

from dataclasses import dataclass

SESSION = "session"  # source of the commands that the session itself gives
CONSOLE = "console"  # name of the built-in channel, which carries what the browser's pages give


@dataclass(frozen=True, kw_only=True)
class Command:
    """What every command carries.

    Attributes:
        time: session time when it was given [s].
        source: name of the interface that gave it.
        operator: who gave it.
        sequence: count of commands of this source.
        confidence: of the decoder in [0, 1]; None where nothing was decoded.
    """

    time: float = 0.0
    source: str = CONSOLE
    operator: str = "operator"
    sequence: int = 0
    confidence: float | None = None

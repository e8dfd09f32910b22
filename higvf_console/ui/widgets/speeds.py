"""The speeds of the session clock that a page offers."""

from typing import Any

from higvf_console.ui.widgets.html import TIMES

SPEEDS: dict[str, Any] = {f"{factor:g}{TIMES}": factor for factor in (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)}


def nearest_speed(factor: float) -> str:
    """The name of the offered speed that is nearest to a factor."""
    return min(SPEEDS, key=lambda name: abs(SPEEDS[name] - factor))

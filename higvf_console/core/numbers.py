"""Numbers as people read them: one separator between the thousands, everywhere."""

import math

SEPARATOR = "\u202f"  # a narrow space that does not break


def grouped(value: float, digits: int = 0) -> str:
    """A number with narrow spaces between the thousands and so many digits after the point."""
    return f"{value:,.{digits}f}".replace(",", SEPARATOR)


def percent(share: float, digits: int = 0) -> str:
    """A share, 0 to 1, in percent; the sign stays on the line of its number."""
    return f"{100.0 * share:.{digits}f}\u00a0%"


def measured(value: float) -> str:
    """A length, an area or a speed, of a small arena too: whole from 10 on, below with two digits that count."""
    return grouped(value) if not math.isfinite(value) or abs(value) >= 9.5 else f"{float(f'{value:.2g}') + 0.0:g}"


def legible(value: float) -> float:
    """A number to 6 digits: what follows from the scale of a team may have more than people read."""
    return float(f"{value:.6g}")


def metres(value: float) -> str:
    """A gap with its unit, with two digits that count: decimetres from a metre on, millimetres below a decimetre."""
    size = abs(value)
    return f"{value:.{3 if size < 0.095 else 2 if size < 0.95 else 1}f} m"

"""Numbers as people read them: one separator between the thousands, everywhere."""

SEPARATOR = "\u202f"  # a narrow space that does not break


def grouped(value: float, digits: int = 0) -> str:
    """A number with narrow spaces between the thousands and so many digits after the point."""
    return f"{value:,.{digits}f}".replace(",", SEPARATOR)

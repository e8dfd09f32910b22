"""Files as an operator names them."""

from pathlib import Path


def named(text: str) -> Path:
    """The file that `text` names, with `~` for a home; where nobody has that home, as it is written."""
    path = Path(text)
    try:
        return path.expanduser()
    except RuntimeError:
        return path

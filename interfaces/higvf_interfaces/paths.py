"""Expand file names that an operator typed."""

from pathlib import Path


def named(text: str) -> Path:
    """Return `text` as a path, with a leading `~` expanded; left as written if that home does not exist."""
    path = Path(text)
    try:
        return path.expanduser()
    except RuntimeError:
        return path

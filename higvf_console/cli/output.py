"""What commands print and write."""

import os
import sys
from pathlib import Path

from higvf_console.core.errors import HigvfError


def log(text: str) -> None:
    """Prints a line on standard error."""
    print(text, file=sys.stderr, flush=True)


def write(option: str, file: str, text: str) -> None:
    """Writes the output of an option to a file; - is standard output."""
    if file == "-":
        sys.stdout.write(text)
        return
    try:
        Path(file).write_text(text, encoding="utf-8")
    except OSError as error:
        raise HigvfError(f"{option} {file}: {error.strerror}") from error


def discard_output() -> None:
    """Sends what is still to be printed nowhere, so that the interpreter ends quietly after a pipe was closed."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())

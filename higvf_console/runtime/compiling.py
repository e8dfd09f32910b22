"""Reports on standard error, once a process, that the engine is being compiled because the cache does not hold it."""

import sys
from functools import cache

from higvf_console.control.compilation.progress import listen

COMPILING = "Compiling the engine, once; this takes up to a minute ..."


def announce() -> None:
    """Makes sure that the first kernel which the cache does not hold is reported."""
    listen(_report)


def _report(_: str) -> None:
    report_once()


@cache
def report_once() -> None:
    """Reports the compilation, the first time."""
    print(COMPILING, file=sys.stderr, flush=True)

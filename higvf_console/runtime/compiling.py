"""Compilation tells of itself: one line on standard error before the first kernel that is not in the cache."""

import os
import sys
from functools import cache
from pathlib import Path

from higvf_console.sim import simulation

COMPILING = "Compiling the engine, once; this takes up to a minute ..."
TICK, ROLL, FILTER = "simulation.tick", "simulation._roll", "safety_filter.filter_velocities"
FIELD, PATH = "field._field", "paths.nearest"


@cache
def announce(name: str) -> None:
    """Says on standard error, once a process, that a kernel is about to be compiled; not where it is in the cache.

    Args:
        name: module and function of the kernel.
    """
    folder = os.environ.get("NUMBA_CACHE_DIR")
    compiles = hasattr(simulation.tick, "signatures")  # not under NUMBA_DISABLE_JIT=1
    if compiles and (folder is None or not any(Path(folder).rglob(f"{name}-*.nbi"))):
        say_once()


@cache
def say_once() -> None:
    """Says that the engine is being compiled, once a process."""
    print(COMPILING, file=sys.stderr, flush=True)

"""The engine ahead of a run: loaded from the cache, or compiled into it first, with progress on standard error.

Where there are two cores a second process compiles the smaller stages; the two share nothing but the cache.
"""
# ruff: noqa: PLC0415 (loads the compiler)

import os
import subprocess
import sys
from time import perf_counter
from typing import TYPE_CHECKING

from higvf_console.control.compilation.progress import listening
from higvf_console.runtime.compiling import report_once

if TYPE_CHECKING:
    from higvf_console.world.setup import Setup

SMALLER = "--smaller-stages"  # an option of `higvf compile` for the second process


class _NotCompiledError(Exception):
    """The cache lacks a kernel."""


def load_engine(setup: "Setup", coupled: bool = False) -> float:
    """Loads the engine, and compiles it first where the cache does not hold it; returns how long that took [s].

    Args:
        setup: any; what is compiled is the same for all.
        coupled: whether the centralised safety filter is needed too.
    """
    from higvf_console.sim.warm_up import warm_up

    def refuse(_: str) -> None:
        raise _NotCompiledError

    started = perf_counter()
    try:
        with listening(refuse):
            warm_up(setup.start, setup.world, setup.params, coupled)
    except _NotCompiledError:
        _compile(setup, coupled)
    return perf_counter() - started


def compile_smaller_stages(setup: "Setup", coupled: bool = False) -> None:
    """Compiles all stages but the largest into the cache: the work of the second process."""
    from higvf_console.sim.warm_up import stages

    for stage in stages(setup.start, setup.world, setup.params, coupled)[1:]:
        stage.run()
        _report(stage.name)


def _compile(setup: "Setup", coupled: bool) -> None:
    from higvf_console.control.compilation.cache import STORE
    from higvf_console.sim.warm_up import stages

    report_once()
    largest, *smaller = stages(setup.start, setup.world, setup.params, coupled)
    helper = _start_helper(coupled) if STORE.writable() and (os.cpu_count() or 1) > 1 else None
    try:
        largest.run()
    finally:
        if helper is not None:
            helper.wait()
    _report(largest.name)
    for stage in smaller:  # loaded, where the helper has compiled them
        stage.run()
        if helper is None:
            _report(stage.name)


def _start_helper(coupled: bool) -> "subprocess.Popen[bytes]":
    command = [sys.executable, "-m", "higvf_console", "compile", SMALLER]
    return subprocess.Popen([*command, "--centralised"] if coupled else command, stdin=subprocess.DEVNULL)


def _report(stage: str) -> None:
    print(f"  compiled: {stage}", file=sys.stderr, flush=True)

"""The engine ahead of a run: loaded from the cache, or compiled into it first, with progress on standard error.

Where there are two cores a second process lowers the safety filter while this one lowers the controller; they share
nothing but the cache.
"""
# ruff: noqa: PLC0415 (loads the compiler)

import os
import subprocess
import sys
from time import perf_counter
from typing import TYPE_CHECKING

from higvf_console.control.compilation.progress import listening
from higvf_console.core.arrays import ints
from higvf_console.runtime.compiling import report_once

if TYPE_CHECKING:
    from higvf_console.sim.warm_up import Stage
    from higvf_console.world.setup import Setup


class _NotCompiledError(Exception):
    """The cache lacks a kernel."""


def load_engine(setup: "Setup", coupled: bool = False) -> float:
    """Loads the engine, and compiles it first where the cache does not hold it; returns how long that took [s].

    Args:
        setup: any; what is compiled is the same for all.
        coupled: whether the centralised safety filter is needed too.
    """

    def refuse(_: str) -> None:
        raise _NotCompiledError

    started = perf_counter()
    try:
        with listening(refuse):
            for stage in _stages(setup, coupled):
                stage.run()
    except _NotCompiledError:
        _compile(coupled)
    return perf_counter() - started


def help_to_compile() -> None:
    """The work of the second process."""
    from higvf_console.sim.warm_up import lower_safety_filter

    lower_safety_filter()


def _stages(setup: "Setup", coupled: bool) -> "tuple[Stage, ...]":
    from higvf_console.sim.warm_up import Stage, stages

    engine = stages(setup.start, setup.world, setup.params, coupled)
    return (*engine, Stage("explanations", lambda: _explain(setup)))


def _explain(setup: "Setup") -> None:
    """Calls what the panels call, which must not be compiled while robots move."""
    from higvf_console.analysis.active_constraints import active_constraints
    from higvf_console.analysis.explain import Moved, explain
    from higvf_console.analysis.sight import sights
    from higvf_console.sim.simulation import advance

    state, trace = advance(setup.start, setup.world, setup.params)
    moved = Moved(setup.start, state.motion, trace)
    explain(moved, setup.params, ints(range(len(state.motion.position))))
    active_constraints(0, moved, setup)
    sights(0, moved, setup)


def _compile(coupled: bool) -> None:
    """Compiles everything, on a scenario that has something of all kinds."""
    from higvf_console.control.compilation.cache import STORE
    from higvf_console.scenario.scenario import load_scenario
    from higvf_console.sim.warm_up import lower_controller

    report_once()
    setup = load_scenario("firefighting").setup()
    if STORE.writable() and (os.cpu_count() or 1) > 1:
        _report("the equations")
        with _second_process():  # waits for it as well
            lower_controller(setup.start, setup.world, setup.params)
    for stage in _stages(setup, coupled):
        _report(stage.name)
        stage.run()


def _second_process() -> "subprocess.Popen[bytes]":
    command = [sys.executable, "-m", "higvf_console", "compile", "--lower-filter"]
    quiet = subprocess.DEVNULL
    return subprocess.Popen(command, stdin=quiet, stdout=quiet, stderr=quiet)  # what it lacks is compiled here


def _report(stage: str) -> None:
    print(f"  {stage} ...", file=sys.stderr, flush=True)

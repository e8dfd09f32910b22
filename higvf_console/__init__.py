"""HI-GVF console: one person guides a team of robots from the browser.

Where to start reading:

    core.state, core.commands     what changes in a run, and what an operator can ask for
    control.controller            the paper's method, step by step
    sim.simulation                one control period, pure: `advance`
    runtime.session               the loop between operator and team
    ui.console                    what the browser shows

The public names below are imported when they are first used, so that `import higvf_console` is quick.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from higvf_console.channels.channels import open_interface
    from higvf_console.control.parameters import Parameters
    from higvf_console.core.commands import OperatorCommand
    from higvf_console.core.errors import HigvfError
    from higvf_console.core.interface import InputSpec, Interface, OperatorContext
    from higvf_console.core.state import SimState, Trace, World
    from higvf_console.operator.reducer import apply_command
    from higvf_console.runtime.headless import run_headless
    from higvf_console.runtime.recording import Recorder, read_recording, replay
    from higvf_console.runtime.session import Session
    from higvf_console.runtime.snapshot import Snapshot
    from higvf_console.scenario.scenario import Scenario, load_scenario, scenario_names
    from higvf_console.sim.setup import Event, Setup
    from higvf_console.sim.simulation import advance, roll

_HOMES = {
    "channels.channels": ("open_interface",),
    "control.parameters": ("Parameters",),
    "core.commands": ("OperatorCommand",),
    "core.errors": ("HigvfError",),
    "core.interface": ("InputSpec", "Interface", "OperatorContext"),
    "core.state": ("SimState", "Trace", "World"),
    "operator.reducer": ("apply_command",),
    "runtime.headless": ("run_headless",),
    "runtime.recording": ("Recorder", "read_recording", "replay"),
    "runtime.session": ("Session",),
    "runtime.snapshot": ("Snapshot",),
    "scenario.scenario": ("Scenario", "load_scenario", "scenario_names"),
    "sim.setup": ("Event", "Setup"),
    "sim.simulation": ("advance", "roll"),
}

__all__ = [
    "Event", "HigvfError", "InputSpec", "Interface", "OperatorCommand", "OperatorContext", "Parameters", "Recorder",
    "Scenario", "Session", "Setup", "SimState", "Snapshot", "Trace", "World", "advance", "apply_command",
    "load_scenario", "open_interface", "read_recording", "replay", "roll", "run_headless", "scenario_names",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    for module, names in _HOMES.items():
        if name in names:
            return getattr(import_module(f"{__name__}.{module}"), name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])

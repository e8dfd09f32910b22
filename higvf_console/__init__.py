"""HI-GVF console: one person guides a team of robots from the browser; and the method as a library.

    >>> import higvf_console as hc
    >>> hazards = hc.Hazards().circle((300, 200), radius=20).inside((0, 0, 1200, 700))
    >>> controller = hc.Controller(hc.make_setup([[100, 350], [60, 320], [60, 380]], hazards))
    >>> path = hc.sketch_path([[100, 350], [400, 300], [800, 350]])
    >>> velocities = controller.step([[100, 350], [60, 320], [60, 380]], path)  # (3, 2) [m/s], each control period
    >>> bool(velocities[0, 0] > 0.0)
    True

The method on positions of one's own:

    Controller              one control period of HI-GVF with its safety filter, [2]-[28]
    filter_velocities       the safety filter alone, [20]-[28]
    guiding_vectors         the guiding vector field of a path, [2]; `vector_field`: round obstacles and blended
    sketch_path, ...        desired paths: strokes, lines, circles, ellipses, [1]
    Hazards                 circles, capsules, polygons, fires, walls
    make_parameters         all tunables, by name, each within its range

Whole runs:

    make_setup              what a run starts from; `make_scenario`, `load_scenario`: with a name and a duration
    run, replay             a report, and `each` control period on the way
    advance, roll           one control period, and many, as a pure function of the state
    Interface, commands     an operator's device of one's own, and what it can ask for

Every public function checks shape, type and range of its arguments before compiled code is reached, converts what it
can (lists, integers, float32, slices), and refuses the rest in one line, an `ArgumentError`. Positions are (N, 2) in
metres, x right, y up; times in seconds; angles in radians; indices count from 0.

Where to start reading the code:

    control.controller            the paper's method, step by step
    core.state, core.commands     what changes in a run, and what an operator can ask for
    sim.simulation                one control period, pure
    runtime.session               the loop between operator and team
    ui.console                    what the browser shows

The public names below are imported when they are first used, so that `import higvf_console` is quick.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from higvf_console.channels.channels import open_interface
    from higvf_console.control.parameters import Parameters
    from higvf_console.core import commands
    from higvf_console.core.commands import OperatorCommand
    from higvf_console.core.errors import (
        ArgumentError,
        FilterError,
        HigvfError,
        InputError,
        MissingExtraError,
        PathError,
        ScenarioError,
    )
    from higvf_console.core.events import Event
    from higvf_console.core.interface import ChannelHealth, ChannelState, InputSpec, Interface, OperatorContext
    from higvf_console.core.state import Motion, Path, SimState, Trace, World
    from higvf_console.core.viewport import Arena
    from higvf_console.library.controller import Controller
    from higvf_console.library.fields import vector_field
    from higvf_console.library.filtering import Filtered, filter_velocities, unicycle_commands
    from higvf_console.library.hazards import Hazards
    from higvf_console.library.paths import (
        circle_path,
        ellipse_path,
        guiding_vectors,
        line_path,
        path_points,
        sketch_path,
    )
    from higvf_console.library.running import run, warm_up
    from higvf_console.library.scenarios import make_scenario
    from higvf_console.library.setups import make_parameters, make_setup
    from higvf_console.library.stepping import advance, apply_command, initial_state, roll
    from higvf_console.runtime.headless import run_headless
    from higvf_console.runtime.recording import Recorder, read_recording, replay
    from higvf_console.runtime.run import Tick
    from higvf_console.runtime.session import Session
    from higvf_console.runtime.snapshot import Snapshot
    from higvf_console.scenario.scenario import Scenario, load_scenario, scenario_names
    from higvf_console.sim.simulation import Rollout
    from higvf_console.world.setup import Setup

_HOMES = {
    "channels.channels": ("open_interface",),
    "control.parameters": ("Parameters",),
    "core.commands": ("OperatorCommand",),
    "core.errors": (
        "ArgumentError",
        "FilterError",
        "HigvfError",
        "InputError",
        "MissingExtraError",
        "PathError",
        "ScenarioError",
    ),
    "core.events": ("Event",),
    "core.interface": (
        "ChannelHealth",
        "ChannelState",
        "InputSpec",
        "Interface",
        "OperatorContext",
    ),
    "core.state": (
        "Motion",
        "Path",
        "SimState",
        "Trace",
        "World",
    ),
    "core.viewport": ("Arena",),
    "library.controller": ("Controller",),
    "library.fields": ("vector_field",),
    "library.filtering": (
        "Filtered",
        "filter_velocities",
        "unicycle_commands",
    ),
    "library.hazards": ("Hazards",),
    "library.paths": (
        "circle_path",
        "ellipse_path",
        "guiding_vectors",
        "line_path",
        "path_points",
        "sketch_path",
    ),
    "library.running": (
        "run",
        "warm_up",
    ),
    "library.scenarios": ("make_scenario",),
    "library.setups": (
        "make_parameters",
        "make_setup",
    ),
    "library.stepping": (
        "advance",
        "apply_command",
        "initial_state",
        "roll",
    ),
    "runtime.headless": ("run_headless",),
    "runtime.recording": (
        "Recorder",
        "read_recording",
        "replay",
    ),
    "runtime.run": ("Tick",),
    "runtime.session": ("Session",),
    "runtime.snapshot": ("Snapshot",),
    "scenario.scenario": (
        "Scenario",
        "load_scenario",
        "scenario_names",
    ),
    "sim.simulation": ("Rollout",),
    "world.setup": ("Setup",),
}

__all__ = [
    "Arena", "ArgumentError", "ChannelHealth", "ChannelState", "Controller", "Event", "FilterError", "Filtered",
    "Hazards", "HigvfError", "InputError", "InputSpec", "Interface", "MissingExtraError", "Motion", "OperatorCommand",
    "OperatorContext", "Parameters", "Path", "PathError", "Recorder", "Rollout", "Scenario", "ScenarioError",
    "Session", "Setup", "SimState", "Snapshot", "Tick", "Trace", "World", "advance", "apply_command", "circle_path",
    "commands", "ellipse_path", "filter_velocities", "guiding_vectors", "initial_state", "line_path", "load_scenario",
    "make_parameters", "make_scenario", "make_setup", "open_interface", "path_points", "read_recording", "replay",
    "roll", "run", "run_headless", "scenario_names", "sketch_path", "unicycle_commands", "vector_field", "warm_up",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    if name == "commands":
        return import_module(f"{__name__}.core.commands")
    for module, names in _HOMES.items():
        if name in names:
            return getattr(import_module(f"{__name__}.{module}"), name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

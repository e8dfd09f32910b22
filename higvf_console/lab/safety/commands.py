"""Random operator commands, of every kind that changes a run, for the team as it is.

Most are what an operator could give; a few are what a broken device could: indices of nobody, points without a place.
"""

import math
from collections.abc import Callable

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import (
    AskReset,
    ClearPath,
    Clutch,
    Confirm,
    ContinueRun,
    Cursor,
    Discard,
    EmergencyStop,
    ForgetPath,
    LoadScenario,
    MovePathPoint,
    NextTask,
    OperatorCommand,
    Pause,
    Pick,
    Prioritise,
    ProposePick,
    Redo,
    ResetEmergencyStop,
    ResetRun,
    Resume,
    ReversePath,
    ShapePath,
    StartRun,
    StrokeBegin,
    StrokeEnd,
    StrokePoints,
    StrokeUse,
    TakeUpPath,
    Undo,
)
from higvf_console.core.edits import (
    AddEntity,
    AddOutlines,
    ChangeEntity,
    DeleteEntity,
    EntityKind,
    LinkByRange,
    MoveEntity,
    SetArena,
    SetParameters,
    ToggleLink,
)
from higvf_console.core.path_terms import ENDINGS
from higvf_console.lab.safety.worlds import outline, random_world
from higvf_console.runtime.run import Run
from higvf_console.world.editing.entities import NUMBERS, how_many, numbers_of
from higvf_console.world.editing.entities import EntityRef as Ref
from higvf_console.world.editing.parameters import parameter, parameter_names, quantity_of

_ON = 0.4  # share of wishes by which a team that stands goes on
_ODD = 0.02  # share of points and numbers that make no sense
Some = list[OperatorCommand]
_KINDS = tuple(EntityKind)
_TUNED = ("safety.", "robots.", "blending.", "fires.", "boundaries.", "formation.")


def random_commands(rng: np.random.Generator, run: Run) -> Some:
    """One wish of the operator, as the commands that it takes.

    Args:
        rng: source of the random numbers.
        run: the present one; it is only looked at.
    """
    intent = run.state.intent
    if intent.paused and rng.random() < _ON:  # a team that stands shows little
        return _release(rng, run) if intent.stopped else [Resume()]
    makers, weights = zip(*_MAKERS, strict=True)
    chosen = makers[int(rng.choice(len(makers), p=np.array(weights) / sum(weights)))]
    return chosen(rng, run)


def _stroke(rng: np.random.Generator, run: Run) -> Some:
    points = _points(rng, run, int(rng.integers(1, 9)))
    robot = _robot(rng, run) if rng.random() < 0.4 else None
    use = _any(rng, ("path", "path", "path", *StrokeUse))
    terms: dict[str, object] = {}
    if rng.random() < 0.4:
        terms = {"ending": _any(rng, tuple(ENDINGS)), "pace": rng.uniform(0.1, 1.6), "duration": rng.uniform(0.0, 20.0)}
    end = StrokeEnd(
        smoothing=rng.uniform(0.0, 20.0) if rng.random() < 0.3 else None,
        robot=robot,
        preview=bool(rng.random() < 0.2),
        use=str(use),
        **terms,  # pyright: ignore[reportArgumentType]
    )
    return [StrokeBegin(), StrokePoints(points[::2]), StrokePoints(points[1::2]), end]


def _pick(rng: np.random.Generator, run: Run) -> Some:
    robot = _robot(rng, run)
    return [Pick(robot) if rng.random() < 0.7 else ProposePick(robot, rng.uniform(0.0, 5.0))]


def _simple(rng: np.random.Generator, _: Run) -> Some:
    kinds = (Confirm, Discard, ClearPath, ReversePath, NextTask, StartRun, ContinueRun, ResetRun, LinkByRange)
    return [kinds[int(rng.integers(len(kinds)))]()]


def _pause(rng: np.random.Generator, run: Run) -> Some:
    return [Resume() if run.state.intent.paused and rng.random() < 0.9 else Pause()]


def _stop(_: np.random.Generator, __: Run) -> Some:
    return [EmergencyStop()]


def _release(rng: np.random.Generator, _: Run) -> Some:
    return [AskReset(), ResetEmergencyStop(), Resume()] if rng.random() < 0.8 else [ResetEmergencyStop(), Resume()]


def _path(rng: np.random.Generator, run: Run) -> Some:
    listed = int(rng.integers(-1, len(run.state.pointer_state.paths) + 1))
    grip, point = _points(rng, run, 2)
    choices: tuple[OperatorCommand, ...] = (
        MovePathPoint(floats(grip), floats(point), preview=bool(rng.random() < 0.2)),
        ShapePath(pace=rng.uniform(0.1, 1.6), closed=bool(rng.random() < 0.5)),
        ShapePath(ending=str(_any(rng, tuple(ENDINGS))), duration=rng.uniform(0.0, 10.0)),
        TakeUpPath(listed),
        ForgetPath(listed),
    )
    return [choices[int(rng.integers(len(choices)))]]


def _priority(rng: np.random.Generator, run: Run) -> Some:
    fires = len(run.state.motion.fire_radius)
    chosen = tuple(fire for fire in range(fires) if rng.random() < 0.5)
    if rng.random() < _ODD:
        chosen = (fires,)
    return [Prioritise(chosen, _robot(rng, run) if rng.random() < 0.5 else None, rng.uniform(0.5, 30.0))]


def _pointer(rng: np.random.Generator, run: Run) -> Some:
    return [Cursor(_points(rng, run, 1)[0]), Clutch(closed=bool(rng.random() < 0.5))]


def _undo(rng: np.random.Generator, _: Run) -> Some:
    return [Undo() if rng.random() < 0.6 else Redo() for _ in range(int(rng.integers(1, 4)))]


def _add(rng: np.random.Generator, run: Run) -> Some:
    return [AddEntity(str(_any(rng, ("robot", "fire", "circle", "bar"))), _points(rng, run, 1)[0])]


def _outlines(rng: np.random.Generator, run: Run) -> Some:
    x, y = _points(rng, run, 1)[0].tolist()
    return [AddOutlines((floats(outline(rng, x, y, rng.uniform(2.0, 60.0))),))]


def _entity(rng: np.random.Generator, run: Run) -> tuple[EntityKind, int] | None:
    kind = _KINDS[int(rng.integers(len(_KINDS)))]
    count = how_many(kind, run.setup.layout)
    if rng.random() < _ODD:
        return kind, int(rng.choice([-1, count]))
    return (kind, int(rng.integers(count))) if count else None


def _move(rng: np.random.Generator, run: Run) -> Some:
    entity = _entity(rng, run)
    return [] if entity is None else [MoveEntity(*entity, _points(rng, run, 1)[0])]


def _delete(rng: np.random.Generator, run: Run) -> Some:
    entity = _entity(rng, run)
    return [] if entity is None else [DeleteEntity(*entity)]


def _change(rng: np.random.Generator, run: Run) -> Some:
    """A number of an entity becomes another: mostly by a factor, so that obstacles and fires grow and shrink."""
    entity = _entity(rng, run)
    if entity is None:
        return []
    kind, row = entity
    name = str(_any(rng, tuple(NUMBERS[kind])))
    present = 0.0
    if 0 <= row < how_many(kind, run.setup.layout):
        present = numbers_of(Ref(kind, row), run.setup.layout, run.state.motion).get(name, 0.0)
    changed = present * rng.uniform(0.6, 1.7) + rng.normal(0.0, 2.0)
    if name == "needs":
        changed = float(rng.integers(1, len(run.state.motion.position) + 1))
    return [ChangeEntity(kind, row, name, _odd(rng, changed))]


def _tune(rng: np.random.Generator, run: Run) -> Some:
    """A few tunables become others, mostly by a factor; half of the time those that safety depends on."""
    names = parameter_names()
    if rng.random() < 0.5:
        names = tuple(name for name in names if name.startswith(_TUNED))
    values: dict[str, float] = {}
    for _ in range(int(rng.integers(1, 4))):
        name = str(_any(rng, names))
        quantity, present = quantity_of(name), parameter(run.setup.params, name)
        if not math.isfinite(present) or present == 0.0 or rng.random() < 0.2:
            high = min(quantity.high, max(1.0, 10.0 * abs(present)) if math.isfinite(present) else 100.0)
            values[name] = rng.uniform(quantity.low, max(high, quantity.low))
        else:
            values[name] = min(max(present * 10.0 ** rng.uniform(-0.4, 0.4), quantity.low), quantity.high)
        values[name] = _odd(rng, values[name])
    return [SetParameters(values)]


def _link(rng: np.random.Generator, run: Run) -> Some:
    return [ToggleLink(_robot(rng, run), _robot(rng, run))]


def _arena(rng: np.random.Generator, run: Run) -> Some:
    sides = np.array(run.setup.arena) + rng.normal(0.0, 40.0, 4)
    return [SetArena(floats(sides), walls=bool(rng.random() < 0.8))]


def _load(rng: np.random.Generator, _: Run) -> Some:
    scenario = random_world(rng, f"loaded-{int(rng.integers(1_000_000))}")
    return [LoadScenario(scenario.text, scenario.source, waits=bool(rng.random() < 0.5))]


def _robot(rng: np.random.Generator, run: Run) -> int:
    robots = len(run.state.motion.position)
    return int(rng.choice([-1, robots, 10**6])) if rng.random() < _ODD else int(rng.integers(robots))


def _points(rng: np.random.Generator, run: Run, count: int) -> Floats:
    """Points (n, 2) [m], mostly in the arena; some right at a robot."""
    arena = run.setup.arena
    spread = np.array([arena.width, arena.height])
    points = np.array(arena[:2]) + rng.uniform(-0.1, 1.1, (count, 2)) * spread
    if rng.random() < 0.3:
        robots = run.state.motion.position
        points[0] = robots[int(rng.integers(len(robots)))] + rng.normal(0.0, 10.0, 2)
    if rng.random() < _ODD:
        points[int(rng.integers(count))] = rng.choice([math.nan, math.inf, 1e9])
    return floats(points)


def _odd(rng: np.random.Generator, value: float) -> float:
    return float(rng.choice([math.nan, math.inf, -math.inf, -1e9])) if rng.random() < _ODD else float(value)


def _any(rng: np.random.Generator, choices: tuple[str, ...]) -> str:
    return choices[int(rng.integers(len(choices)))]


_MAKERS: tuple[tuple[Callable[[np.random.Generator, Run], Some], float], ...] = (
    (_stroke, 14.0),
    (_pick, 5.0),
    (_simple, 6.0),
    (_pause, 5.0),
    (_stop, 2.0),
    (_release, 4.0),
    (_path, 6.0),
    (_priority, 3.0),
    (_pointer, 2.0),
    (_undo, 7.0),
    (_add, 6.0),
    (_outlines, 2.0),
    (_move, 8.0),
    (_delete, 3.0),
    (_change, 10.0),
    (_tune, 10.0),
    (_link, 2.0),
    (_arena, 1.5),
    (_load, 0.5),
)

"""The actions of a script that edit the world and the tunables, give priority, or change how a path is followed."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import NamedTuple

from higvf_console.core.arrays import floats
from higvf_console.core.commands import ForgetPath, MovePathPoint, OperatorCommand, Prioritise, ShapePath, TakeUpPath
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
from higvf_interfaces.fields import Fields, is_number

ENDINGS = ("release", "hold", "loop")
_ADDED = tuple(kind for kind in EntityKind if kind is not EntityKind.POLYGON)  # a polygon is added by its outline
_MOST = 1e6


class EditAction(NamedTuple):
    """An action: the keys that go with it, and the command that it gives."""

    keys: tuple[str, ...]
    command: Callable[[Fields], OperatorCommand]


def _add(fields: Fields) -> OperatorCommand:
    return AddEntity(fields.required("kind").choice(_ADDED), floats(fields.numbers("at_m", 2)))


def _add_outline(fields: Fields) -> OperatorCommand:
    return AddOutlines((fields.points("points_m"),))


def _move(fields: Fields) -> OperatorCommand:
    return MoveEntity(_kind(fields), fields.whole("number", 1) - 1, floats(fields.numbers("at_m", 2)))


def _change(fields: Fields) -> OperatorCommand:
    value = fields.number("value", None, -_MOST, _MOST)
    return ChangeEntity(_kind(fields), fields.whole("number", 1) - 1, fields.text("name"), value)


def _delete(fields: Fields) -> OperatorCommand:
    return DeleteEntity(_kind(fields), fields.whole("number", 1) - 1)


def _link(fields: Fields) -> OperatorCommand:
    robots = _numbers(fields, "robots")
    if len(robots) != 2:
        raise fields.required("robots").wrong("a pair of robots such as [1, 2]")
    return ToggleLink(*robots)


def _link_by_range(_: Fields) -> OperatorCommand:
    return LinkByRange()


def _set_arena(fields: Fields) -> OperatorCommand:
    return SetArena(floats(fields.numbers("sides_m", 4)), fields.flag("walls", True))


def _set_parameters(fields: Fields) -> OperatorCommand:
    """Groups with names, as a scenario has them, become "group.name"."""
    values: dict[str, float] = {}
    parameters = fields.required("parameters")
    for group, section in parameters.mapping().items():
        for name, node in section.mapping().items():
            if not is_number(node.value):
                raise node.wrong("a number")
            values[f"{group}.{name}"] = float(node.value)
    if not values:
        raise parameters.error("nothing is given; give {GROUP: {NAME: NUMBER}}")
    return SetParameters(values)


def _prioritise(fields: Fields) -> OperatorCommand:
    return Prioritise(
        fires=_numbers(fields, "fires"),
        robot=fields.whole("robot", 1) - 1 if fields.has("robot") else None,
        factor=fields.number("factor", None, 1.0, _MOST) if fields.has("factor") else None,
    )


def _shape_path(fields: Fields) -> OperatorCommand:
    if not any(fields.has(key) for key in ACTIONS["shape_path"].keys):
        fields.fail(f"give at least one of {', '.join(ACTIONS['shape_path'].keys)}")
    return ShapePath(
        ending=fields.entries["ending"].choice(ENDINGS) if fields.has("ending") else None,
        pace=pace(fields) if fields.has("pace") else None,
        duration=duration(fields) if fields.has("duration_s") else None,
        closed=fields.flag("closed") if fields.has("closed") else None,
    )


def _move_path_point(fields: Fields) -> OperatorCommand:
    grip, point = floats(fields.numbers("grip_m", 2)), floats(fields.numbers("to_m", 2))
    return MovePathPoint(grip, point, preview=fields.flag("preview", False))


def _take_up_path(fields: Fields) -> OperatorCommand:
    return TakeUpPath(fields.whole("number", 1) - 1)


def _forget_path(fields: Fields) -> OperatorCommand:
    return ForgetPath(fields.whole("number", 1) - 1)


def pace(fields: Fields) -> float:
    """Share of their velocity that those who are led take; 1 where it is not given."""
    return fields.number("pace", 1.0, 0.0, 10.0)


def duration(fields: Fields) -> float:
    """How long a path is followed [s]; 0, as long as it takes, where it is not given."""
    return fields.number("duration_s", 0.0, 0.0, _MOST, "s")


def _kind(fields: Fields) -> str:
    return fields.required("kind").choice(tuple(EntityKind))


def _numbers(fields: Fields, key: str) -> tuple[int, ...]:
    """Indices from 0 of a list of numbers from 1."""
    return tuple(item.integer(1) - 1 for item in fields.nodes(key))


ACTIONS: Mapping[str, EditAction] = MappingProxyType(
    {
        "add": EditAction(("kind", "at_m"), _add),
        "add_outline": EditAction(("points_m",), _add_outline),
        "move": EditAction(("kind", "number", "at_m"), _move),
        "change": EditAction(("kind", "number", "name", "value"), _change),
        "delete": EditAction(("kind", "number"), _delete),
        "link": EditAction(("robots",), _link),
        "link_by_range": EditAction((), _link_by_range),
        "set_arena": EditAction(("sides_m", "walls"), _set_arena),
        "set_parameters": EditAction(("parameters",), _set_parameters),
        "prioritise": EditAction(("fires", "robot", "factor"), _prioritise),
        "shape_path": EditAction(("ending", "pace", "duration_s", "closed"), _shape_path),
        "move_path_point": EditAction(("grip_m", "to_m", "preview"), _move_path_point),
        "take_up_path": EditAction(("number",), _take_up_path),
        "forget_path": EditAction(("number",), _forget_path),
    }
)

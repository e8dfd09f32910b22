"""Reports of a team as lines of a recording, and back: with them a run of real robots is repeated without any."""

import math
from typing import Any

import numpy as np

from higvf_console.core.errors import InputError
from higvf_console.core.quantity import Quantity
from higvf_console.core.reading.node import Node
from higvf_console.core.team import Poses, RobotLink
from higvf_console.team.state import TeamReport
from higvf_console.team.tracking import Rules

_ANY = Quantity("", -1e12, 1e12, "", "")
_COUNT = Quantity("", -1.0, 2.0**53, "", "")
_KEYS = ("now", "position", "heading", "measured_at", "links", "failure")


def written(report: TeamReport) -> dict[str, Any]:
    """A report as JSON has it; null is NaN."""
    poses = {name: _nulled(value.tolist()) for name, value in report.poses._asdict().items()}
    links = [_nulled([*link]) for link in report.links]
    return {"now": report.now, **poses, "links": links, "failure": report.failure}


def read(entry: object, place: str, robots: int) -> TeamReport:
    """The report that was written.

    Args:
        entry: its fields.
        place: how an error calls it.
        robots: how many the team has.

    Raises:
        InputError: a field is missing or of another type.
    """
    fields = Node(entry, place, "team", InputError).section(_KEYS, _KEYS)
    position = np.array([_numbers(pair, 2) for pair in _items(fields["position"], robots)])
    heading, measured_at = (np.array(_numbers(fields[name], robots)) for name in ("heading", "measured_at"))
    links = tuple(_link(item) for item in _items(fields["links"], robots))
    failure = fields["failure"].value
    if not isinstance(failure, str):
        raise fields["failure"].wrong("text")
    return TeamReport(fields["now"].number(_ANY), Poses(position, heading, measured_at), links, failure)


def rules_written(rules: Rules) -> dict[str, float]:
    """What a header has of a team."""
    return rules._asdict()


def rules_read(entry: object, place: str) -> Rules:
    """The rules of a header.

    Raises:
        InputError: a number is missing or none.
    """
    fields = Node(entry, place, "team", InputError).section(Rules._fields, Rules._fields)
    return Rules(**{name: fields[name].number(_ANY) for name in Rules._fields})


def _link(node: Node) -> RobotLink:
    acknowledged, battery, connected, detail = _items(node, 4)
    if not isinstance(connected.value, bool) or not isinstance(detail.value, str):
        raise node.wrong("a link: number, battery, true or false, text")
    charge = math.nan if battery.value is None else battery.number(_ANY)
    return RobotLink(int(acknowledged.number(_COUNT)), charge, connected.value, detail.value)


def _items(node: Node, count: int) -> list[Node]:
    items = node.items()
    if len(items) != count:
        raise node.wrong(f"a list of {count}")
    return items


def _numbers(node: Node, count: int) -> list[float]:
    return [math.nan if item.value is None else item.number(_ANY) for item in _items(node, count)]


def _nulled(value: Any) -> Any:
    if isinstance(value, list):
        return [_nulled(item) for item in value]  # pyright: ignore[reportUnknownVariableType]
    return None if isinstance(value, float) and math.isnan(value) else value

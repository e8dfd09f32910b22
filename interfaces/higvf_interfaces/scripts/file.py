"""The YAML script of operator actions, read strictly: each entry has one trigger, and one action or one fault.

- at_s: 12.0                        - when: {extinguished: 1}
  do: pick                            after_s: 0.5
  robot: 2                            do: stroke
- at_s: 20                              points_m: [[300, 200], [500, 260], [700, 240]]
  fault: {channel: gaze, kind: freeze, for_s: 3}
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from higvf_console.core.arrays import Floats
from higvf_console.core.commands import (
    Arm,
    AskArm,
    Clutch,
    FaultKind,
    InjectFault,
    OperatorCommand,
    Pick,
    ReleaseRobot,
    StopRobot,
    StrokeEnd,
    StrokeUse,
)
from higvf_console.core.errors import ScriptError
from higvf_console.core.path_terms import ENDINGS, USUAL_TERMS, PathTerms, stroke_end
from higvf_console.core.reading.document import read_text, read_yaml
from higvf_console.core.reading.node import Node
from higvf_interfaces.decisions.actions import PLAIN
from higvf_interfaces.fields import Fields
from higvf_interfaces.scripts import edits as script_edits

_OF_ROBOT: Mapping[str, Callable[[int], OperatorCommand]] = {
    "pick": Pick,
    "stop_robot": StopRobot,
    "release_robot": ReleaseRobot,
}
_PLAIN = {**PLAIN, "ask_arm": AskArm, "arm": Arm}  # no decoder arms a team
EVENTS = ("extinguished", "extinguished_count")
DETAILS: dict[str, tuple[str, ...]] = {
    "stroke": ("points_m", "robot", "smoothing_m", "over_s", "preview", "use", "ending", "pace", "duration_s"),
    **dict.fromkeys(_OF_ROBOT, ("robot",)),
    "clutch": ("closed",),
    **dict.fromkeys(_PLAIN, ()),
    **{name: action.keys for name, action in script_edits.ACTIONS.items()},
}
FAULT = ("channel", "kind", "for_s", "by_s")
RENAMED_ACTIONS = {"bend_path": "move_path_point"}  # names of version 0.1, which are still read
RENAMED_KEYS = {"thing": "kind"}
RENAMED_USES = {"amend": "redraw"}
_TRIGGER = ("at_s", "when", "after_s", "do", "fault")
_LONGEST = 1e6  # [s]


class Trigger(NamedTuple):
    """When an entry fires.

    Attributes:
        at: session time [s]; None where an event decides.
        extinguished: fire index that must be out; None where it does not matter.
        fires_out: fires that must be out; 0 where it does not matter.
        after: delay behind the event [s].
    """

    at: float | None
    extinguished: int | None
    fires_out: int
    after: float

    def met(self, now: float, extinguished: Sequence[int]) -> float | None:
        """Session time from which the trigger holds, or None while it does not; `now` for an event."""
        if self.at is not None:
            return self.at
        burning = self.extinguished is not None and self.extinguished not in extinguished
        return None if burning or len(extinguished) < self.fires_out else now


class Stroke(NamedTuple):
    """A stroke to draw.

    Attributes:
        points: (n, 2) [m].
        duration: over which the points arrive [s].
        end: what it then becomes.
    """

    points: Floats
    duration: float
    end: StrokeEnd


class Entry(NamedTuple):
    """One line of a script: where it stands, when it fires, what it does."""

    place: str
    trigger: Trigger
    action: Stroke | OperatorCommand


class Script(NamedTuple):
    """The entries of a script, and a warning for each former name in it."""

    entries: tuple[Entry, ...]
    warnings: tuple[str, ...]


def read_script(path: Path) -> Script:
    """Reads a script.

    Raises:
        ScriptError: with file, entry number, key, value and the known keys.
    """
    root = read_yaml(read_text(path, ScriptError), str(path), ScriptError)
    if not isinstance(root.value, list) or not root.value:
        raise root.error("a script is a list of entries, each with do: and at_s: or when:")
    entries = tuple(
        _entry(replace(item, source=f"{path}, entry {number}", place=""))
        for number, item in enumerate(root.items(), start=1)
    )
    return Script(entries, tuple(root.warnings))


def _entry(node: Node) -> Entry:
    if not isinstance(node.value, dict):
        raise node.wrong("an entry with do: and at_s: or when:")
    values = node.mapping()
    if "fault" in values and "do" not in values:
        fields = Fields.of(node, _TRIGGER)
        return Entry(node.where, _trigger(fields), _fault(fields))
    action = values.get("do", node.entry("do", None)).choice(tuple(DETAILS), RENAMED_ACTIONS)
    fields = Fields.of(node, (*_TRIGGER[:-1], *DETAILS[action]), RENAMED_KEYS)
    return Entry(node.where, _trigger(fields), _action(action, fields))


def _trigger(fields: Fields) -> Trigger:
    if fields.has("at_s") == fields.has("when"):
        fields.fail("give either at_s: SECONDS or when: {EVENT: NUMBER}")
    if fields.has("at_s"):
        if fields.has("after_s"):
            fields.fail("after_s goes with when:, not with at_s:")
        return Trigger(fields.number("at_s", None, 0.0, _LONGEST, "s"), None, 0, 0.0)
    event = Fields.of(fields.required("when"), EVENTS)
    if len(event.entries) != 1:
        event.fail(f"give one event, one of {', '.join(EVENTS)}")
    after = fields.number("after_s", 0.0, 0.0, _LONGEST, "s")
    if event.has("extinguished"):
        return Trigger(None, event.whole("extinguished", 1) - 1, 0, after)
    return Trigger(None, None, event.whole("extinguished_count", 1), after)


def _fault(fields: Fields) -> InjectFault:
    fault = Fields.of(fields.required("fault"), FAULT)
    return InjectFault(
        channel=fault.text("channel"),
        kind=fault.choice("kind", FaultKind.FREEZE, tuple(FaultKind)),
        seconds=fault.number("for_s", None, 0.001, 3600.0, "s"),
        delay=fault.number("by_s", 0.5, 0.0, 3600.0, "s"),
    )


def _action(action: str, fields: Fields) -> Stroke | OperatorCommand:
    match action:
        case "stroke":
            return Stroke(
                points=fields.points("points_m"),
                duration=fields.number("over_s", 0.0, 0.0, _LONGEST, "s"),
                end=_stroke_end(fields),
            )
        case "clutch":
            return Clutch(fields.flag("closed"))
        case _ if action in _OF_ROBOT:
            return _OF_ROBOT[action](fields.whole("robot", 1) - 1)
        case _ if action in script_edits.ACTIONS:
            return script_edits.ACTIONS[action].command(fields)
        case _:
            return _PLAIN[action]()


def _stroke_end(fields: Fields) -> StrokeEnd:
    terms = PathTerms(
        ending=fields.choice("ending", USUAL_TERMS.ending, tuple(ENDINGS)),
        pace=script_edits.pace(fields),
        duration=script_edits.duration(fields),
        smoothing=fields.number("smoothing_m", None, 0.0, 1e6, "m") if fields.has("smoothing_m") else None,
    )
    use = StrokeUse(fields.choice("use", StrokeUse.PATH, tuple(StrokeUse), RENAMED_USES))
    robot = fields.whole("robot", 1) - 1 if fields.has("robot") else None
    return stroke_end(terms, use, robot, preview=fields.flag("preview", False))

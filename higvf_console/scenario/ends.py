"""How a run ends, read from a scenario file and written to one.

ends: {when: all_fires_out, after_s: 2}    # or path_finished, never; the run goes on for after_s once it is so
"""

from enum import StrEnum
from typing import Any, NamedTuple

from higvf_console.core.quantity import Quantity
from higvf_console.core.reading.node import Node

_AFTER = Quantity("s", 0.0, 3600.0, "", "How long a run goes on once its end condition holds.")


class EndWhen(StrEnum):
    """The condition that ends a run."""

    ALL_FIRES_OUT = "all_fires_out"  # never so in a world without fires
    PATH_FINISHED = "path_finished"
    NEVER = "never"


class Ends(NamedTuple):
    """How a run ends.

    Attributes:
        when: condition that ends it; but for NEVER, the scenario's duration ends a run in the console too.
        after: how long the run goes on once the condition holds [s].
    """

    when: EndWhen = EndWhen.ALL_FIRES_OUT
    after: float = 0.0


def read_ends(node: Node) -> Ends:
    """The section `ends`.

    Raises:
        ScenarioError: an unknown condition, a time out of range, or a time after an end that never comes.
    """
    entries = node.section(("when", "after_s"), ("when",))
    when = EndWhen(entries["when"].choice(tuple(EndWhen)))
    after = entries["after_s"].number(_AFTER) if "after_s" in entries else 0.0
    if when is EndWhen.NEVER and "after_s" in entries:
        raise entries["after_s"].error(
            f"{after:g} s after an end that never comes; remove it, or give when: all_fires_out or path_finished"
        )
    return Ends(when, after)


def written_ends(ends: Ends) -> dict[str, Any]:
    """The section that `read_ends` reads as this; empty for what holds without it."""
    if ends == Ends():
        return {}
    return {"when": ends.when.value} | ({"after_s": ends.after} if ends.after > 0.0 else {})


def end_warnings(ends: Ends, *, fires: bool, endless_path: bool, duration: float) -> tuple[str, ...]:
    """What of an end is allowed but probably not meant.

    Args:
        ends: how the run ends.
        fires: whether the scenario has any.
        endless_path: whether its path has no end.
        duration: of the scenario [s].
    """
    if ends.when is EndWhen.ALL_FIRES_OUT and not fires and ends.after > 0.0:
        return (f"ends: there are no fires to be out; the run ends after duration_s, {duration:g} s",)
    if ends.when is EndWhen.PATH_FINISHED and endless_path:
        return (f"ends: the path has no end that could be reached; the run ends after duration_s, {duration:g} s",)
    return ()

"""How a widget's callback becomes commands: in order, for operators only, and never at another callback's cost.

viser keeps order for coroutines alone, calls them also when the console itself assigns a value, and lets one that
raises starve those after it.
"""

import time
from collections.abc import Callable, Coroutine, Mapping
from typing import Any, TypeAlias

import viser

from higvf_console.core.arguments import not_one_of
from higvf_console.ui.page.notice import failed, refuse

Reaction: TypeAlias = Callable[[Any], Coroutine[None, None, None]]
SETTLE_S = 0.6  # from a touch until the session must have answered it


def reaction(act: Callable[[Any], object]) -> Reaction:
    """A callback that hands a page's value to `act`.

    A ValueError or TypeError refuses the value: the page is told which field refused what, and why.

    Args:
        act: validates the value, which may be anything that a page can send, and returns at once.
    """

    async def react(event: viser.GuiEvent[Any]) -> None:
        if event.client_id is None:  # the console's own assignment
            return
        try:
            act(event.target.value)
        except (ValueError, TypeError) as error:
            refuse(event, f"{_name_of(event)}: {error}")
        except Exception as error:
            failed(event, _name_of(event), error)

    return react


def _name_of(event: viser.GuiEvent[Any]) -> str:
    """The label of the widget that a page used."""
    return str(getattr(event.target, "label", "")).strip() or "value"


def mirror(widget: viser.GuiInputHandle[Any], value: Any, settle: float = SETTLE_S) -> None:
    """Makes a widget show what holds, unless it was touched less than `settle` [s] ago: its command is on its way."""
    age = time.time() - widget.update_timestamp  # negative after the clock of the machine was put back
    if widget.value != value and not 0.0 <= age <= settle:
        widget.value = value


def chosen(value: object, choices: Mapping[str, Any]) -> Any:
    """The choice that a page named.

    Raises:
        ValueError: there is none of that name.
    """
    if not isinstance(value, str) or value not in choices:
        raise ValueError(not_one_of(value, choices))
    return choices[value]


def number_in(value: object, low: float, high: float) -> float:
    """A number that a page sent.

    Raises:
        ValueError: it is none, or not from `low` to `high`.
    """
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise ValueError(f"{value!r} is not a number from {low:g} to {high:g}")
    return float(value)


def truth(value: object) -> bool:
    """A check mark that a page sent.

    Raises:
        ValueError: it is neither True nor False.
    """
    if not isinstance(value, bool):
        raise ValueError(f"{value!r} is neither True nor False")
    return value

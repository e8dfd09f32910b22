"""A number field that people type into: what was typed arrives as a whole, and is a number in its range or is refused.

viser's own number field drops characters that it does not expect (`1e-1` became -11) and sends every key stroke. Here
the field holds text; `browser_js/fields.js` sends it on Enter, or when the field is left, and Esc takes it back.
"""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import viser

from higvf_console.core.numbers import SEPARATOR
from higvf_console.ui.page.notice import failed, refuse
from higvf_console.ui.widgets.callbacks import SETTLE_S, mirror

_MINUS = "\u2212"
_NO_WORDS: Mapping[str, float] = MappingProxyType({})


class NumberRange(NamedTuple):
    """What may be typed.

    Attributes:
        unit: of the number; empty = none. It may be typed behind it.
        low: least number.
        high: greatest number.
        whole: whether it must be a whole number.
        words: numbers that have a word, such as "unlimited".
    """

    unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    whole: bool = False
    words: Mapping[str, float] = _NO_WORDS


class NumberField:
    """A number with its unit in the label; its value in force is shown by `show`."""

    def __init__(
        self,
        gui: viser.GuiApi,
        label: str,
        value: float,
        limits: NumberRange,
        act: Callable[[float], object],
        **options: Any,
    ) -> None:
        """Builds the field.

        Args:
            gui: where.
            label: what the number is, without its unit.
            value: in force now.
            limits: what may be typed.
            act: hears a number that was typed; returns at once. A ValueError refuses it.
            options: of viser's text field: hint, visible, disabled.
        """
        self._label, self._limits, self._act = label, limits, act
        self._text = typed_form(value, limits.words)
        self._widget = gui.add_text(labelled(label, limits.unit), self._text, **options)
        self._widget.on_update(self._react)

    async def _react(self, event: viser.GuiEvent[Any]) -> None:
        if event.client_id is None:  # the console's own assignment
            return
        try:
            self._act(number_typed(str(event.target.value), self._limits))
        except ValueError as error:
            self._widget.value = self._text
            refuse(event, f"{self._label}: {error}; {self._text} stays.")
        except Exception as error:
            failed(event, self._label, error)

    def describe(self, label: str, limits: NumberRange, hint: str) -> None:
        """It is another number from now on."""
        self._label, self._limits = label, limits
        self._widget.label, self._widget.hint = labelled(label, limits.unit), hint

    def show(self, value: float, settle: float = SETTLE_S) -> None:
        """Shows the number in force, unless one was typed less than `settle` [s] ago: its command is on its way."""
        self._text = typed_form(value, self._limits.words)
        mirror(self._widget, self._text, settle)

    @property
    def visible(self) -> bool:
        """Whether it is seen."""
        return self._widget.visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._widget.visible = visible

    def remove(self) -> None:
        """Removes the field."""
        self._widget.remove()


def labelled(label: str, unit: str) -> str:
    """A label with its unit."""
    return f"{label} ({unit})" if unit else label


def typed_form(value: float, words: Mapping[str, float] = _NO_WORDS) -> str:
    """A number as people type it, to 9 significant digits."""
    word = next((word for word, number in words.items() if number == value), None)
    return word if word is not None else f"{value + 0.0:.9g}"


def number_typed(text: str, limits: NumberRange) -> float:
    """The number that was typed: with a unit or without, `1e-1`, a decimal comma, spaces between thousands.

    Raises:
        ValueError: it is none, it is outside its range, or a comma may mean either.
    """
    typed = text.strip().removesuffix(limits.unit).strip().lower()
    if typed in limits.words:
        return limits.words[typed]
    number = _number(typed, text)
    if limits.whole and not number.is_integer():
        raise ValueError(f"{number:g} is not a whole number")
    if not limits.low <= number <= limits.high:
        low, high = (typed_form(end, limits.words) for end in (limits.low, limits.high))
        raise ValueError(f"{number:.9g} is not from {low} to {labelled_value(high, limits.unit)}")
    return number


def labelled_value(value: str, unit: str) -> str:
    """A value with its unit behind it."""
    return f"{value} {unit}".rstrip()


def _number(typed: str, text: str) -> float:
    plain = typed.replace(_MINUS, "-").replace(SEPARATOR, "").replace("\u00a0", "").replace(" ", "").replace("_", "")
    whole, comma, fraction = plain.partition(",")
    if comma:
        if "," in fraction or "." in plain or (len(fraction) == 3 and fraction.isdigit() and whole.lstrip("+-") != "0"):
            raise ValueError(f"the comma in '{text}' may part thousands or decimals: write 1500 or 1.5")
        plain = f"{whole}.{fraction}"
    try:
        number = float(plain)
    except ValueError:
        raise ValueError(f"'{text}' is not a number") from None
    if not math.isfinite(number):
        raise ValueError(f"'{text}' is not a finite number")
    return number

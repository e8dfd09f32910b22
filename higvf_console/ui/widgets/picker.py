"""A widget that names one robot: a list for a team that fits into one, a number for a larger one."""

from collections.abc import Callable

import viser

from higvf_console.ui.widgets.callbacks import chosen, mirror, reaction
from higvf_console.ui.widgets.number import NumberField, NumberRange

MOST_LISTED = 50  # robots


class RobotPicker:
    """Calls back with a robot's index, or None for the choice that names none of them."""

    def __init__(
        self, gui: viser.GuiApi, label: str, robots: int, choose: Callable[[int | None], None], *, hint: str,
        nobody: str = "",
    ) -> None:  # fmt: skip
        """Builds the list or the number.

        Args:
            gui: where.
            label: of the widget.
            robots: how many there are now.
            choose: hears what a page chose.
            hint: of the widget.
            nobody: name of a choice besides the robots; empty = there is none.
        """
        self._nobody, self._robots, self._choose = nobody, robots, choose
        self._list: viser.GuiDropdownHandle[str] | None = None
        self._number: NumberField | None = None
        if robots <= MOST_LISTED:
            self._list = gui.add_dropdown(label, self._names(), hint=hint)
            self._list.on_update(reaction(self._named))
        else:
            also = f"; 0 = {nobody}" if nobody else ""
            self._label, self._hint = label, hint + also
            self._number = NumberField(gui, label, self._least, self._limits(), self._numbered, hint=self._hint)

    @property
    def _least(self) -> int:
        return 0 if self._nobody else 1

    def _names(self) -> tuple[str, ...]:
        robots = tuple(f"Robot {number}" for number in range(1, self._robots + 1))
        return (self._nobody, *robots) if self._nobody else robots

    def _named(self, value: object) -> None:
        number = chosen(value, {name: number for number, name in enumerate(self._names(), self._least)})
        self._choose(number - 1 if number else None)

    def _limits(self) -> NumberRange:
        return NumberRange(low=self._least, high=self._robots, whole=True)

    def _numbered(self, number: float) -> None:
        self._choose(int(number) - 1 if number else None)

    def show(self, robot: int | None, robots: int) -> None:
        """Shows who is chosen in a team of so many robots."""
        if robots != self._robots:
            self._robots = robots
            if self._list is not None:
                self._list.options = self._names()
            elif self._number is not None:
                self._number.describe(self._label, self._limits(), self._hint)
        number = 0 if robot is None else robot + 1
        if self._list is not None:
            mirror(self._list, f"Robot {number}" if number else self._nobody)
        elif self._number is not None:
            self._number.show(number)

    def remove(self) -> None:
        """Removes the widget."""
        widget = self._list if self._list is not None else self._number
        if widget is not None:
            widget.remove()

"""Every tunable of the controller: shown group by group, changed live, compared with the scenario, put back."""

import math
from typing import TYPE_CHECKING, Any

import viser

from higvf_console.control.parameters import Parameters
from higvf_console.core.edits import SetParameters
from higvf_console.core.events import Event
from higvf_console.core.interface import PointerSink
from higvf_console.core.numbers import legible
from higvf_console.core.scale import USUAL_SCALE, Scale
from higvf_console.ui.messages import newer
from higvf_console.ui.widgets.callbacks import chosen, mirror, reaction
from higvf_console.ui.widgets.html import block, text
from higvf_console.ui.widgets.number import NumberField, NumberRange, labelled, typed_form
from higvf_console.world.editing.parameters import FIXED, parameter, parameter_names, quantity_of
from higvf_console.world.editing.presets import AS_IN_THE_SCENARIO, PRESETS, preset_name, preset_values

if TYPE_CHECKING:
    from higvf_console.runtime.session import Session
    from higvf_console.runtime.snapshot import Snapshot

UNLIMITED, OWN = "unlimited", "Own values"
_WORDS = {UNLIMITED: math.inf}
_FIXED = "fixed during a run: set it in a scenario file and load that"


class TunePanel:
    """A preset, a group, its tunables, and what differs from the scenario."""

    def __init__(self, gui: viser.GuiApi, session: "Session", sink: PointerSink) -> None:
        """Builds a field for every tunable; those of the chosen group are seen."""
        self._session, self._sink = session, sink
        self._scenario, self._params = session.scenario.params, session.setup.params
        self._wrong = ""  # with what was asked last
        self._heard: Event | None = None  # the newest event that was looked at
        self._described: tuple[Parameters, Parameters, str] | None = None
        names: dict[str, Any] = dict.fromkeys((*PRESETS, OWN))
        self._preset = gui.add_dropdown(
            "Preset",
            tuple(names),
            hint="Multiplies values of the scenario; values that the preset does not name stay unchanged",
        )
        self._preset.on_update(reaction(lambda value: self._take(value) if chosen(value, names) is None else None))
        groups = {title_of(name.split(".")[0]): name.split(".")[0] for name in parameter_names()}
        self._group = next(iter(groups.values()))
        self._choice = gui.add_dropdown("Group", tuple(groups), hint="Part of the controller that uses them")
        self._choice.on_update(reaction(lambda value: self._choose(chosen(value, groups))))
        self._head = gui.add_html("")
        self._fields = {name: self._make_field(gui, name) for name in parameter_names()}
        self._note = gui.add_html("")
        self._reset = gui.add_button("Reset this group", color="gray", hint="Its values as in the scenario")
        self._reset.on_click(reaction(lambda _: self._put_back(self._group)))
        self._changed = gui.add_html("")
        self._reset_all = gui.add_button("Reset all", color="gray", hint="All values as in the scenario")
        self._reset_all.on_click(reaction(lambda _: self._take(AS_IN_THE_SCENARIO)))

    def _make_field(self, gui: viser.GuiApi, name: str) -> NumberField:
        return NumberField(
            gui, title_of(name.split(".")[1]), parameter(self._params, name), limits_of(name, self._params.scale),
            lambda value: self._ask({name: value}), visible=False, disabled=name in FIXED,
        )  # fmt: skip

    def _choose(self, group: str) -> None:
        self._group = group

    def _take(self, value: object) -> None:
        if isinstance(value, str) and value in PRESETS:
            self._ask(preset_values(value, self._scenario))

    def _ask(self, values: dict[str, float]) -> None:
        """Asks for values; the session may refuse them."""
        self._wrong = ""
        self._sink.push(SetParameters(values))

    def _put_back(self, group: str) -> None:
        values = preset_values(AS_IN_THE_SCENARIO, self._scenario)
        self._ask({name: values[name] for name in values if name.split(".")[0] == group})

    def _hear(self, events: tuple[Event, ...]) -> None:
        """Takes up why the session refused values."""
        for event in newer(events, self._heard):
            if event.command == SetParameters.__name__:
                self._wrong = event.text
        self._heard = events[-1] if events else None

    def update(self, snapshot: "Snapshot") -> None:
        """Shows the tunables in force and marks what differs from the scenario."""
        self._scenario, self._params = self._session.scenario.params, snapshot.setup.params
        self._hear(snapshot.events)
        mirror(self._preset, preset_name(self._params, self._scenario) or OWN)
        for name, field in self._fields.items():
            field.show(legible(parameter(self._params, name)))
        self._note.content = block(note_html(self._group, self._wrong))
        described = (self._params, self._scenario, self._group)
        if self._described != described:
            self._described = described
            self._describe()

    def _describe(self) -> None:
        """Shows the fields of the group, what each means, and what differs."""
        self._head.content = block(f'<span class="dim">{text(about(self._params, self._group))}</span>')
        for name, field in self._fields.items():
            usual = parameter(self._scenario, name)
            field.visible = name.split(".")[0] == self._group
            title = marked(name, differs=parameter(self._params, name) != usual)
            field.describe(title, limits_of(name, self._params.scale), hint_of(name, usual, self._params.scale))
        different = differences(self._params, self._scenario)
        self._changed.content = block(changed_html(different))
        self._reset.disabled = not any(name.split(".")[0] == self._group for name, *_ in different)
        self._reset_all.disabled = not different


def shown(value: float) -> str:
    """A value as it is typed."""
    return typed_form(legible(value), _WORDS)


def limits_of(name: str, scale: Scale = USUAL_SCALE) -> NumberRange:
    """What may be typed for a tunable; the session judges whether it is in range, and says why not."""
    quantity = quantity_of(name, scale)
    return NumberRange(quantity.unit, words=_WORDS if math.isinf(quantity.high) else {})


def title_of(name: str) -> str:
    """A group or tunable in words."""
    return name.replace("_", " ").capitalize()


def marked(name: str, *, differs: bool) -> str:
    """A tunable, with a mark when it differs from the scenario."""
    return f"{'● ' * differs}{title_of(name.split('.')[1])}"


def label_of(name: str) -> str:
    """A tunable with its unit."""
    return labelled(title_of(name.split(".")[1]), quantity_of(name).unit)


def hint_of(name: str, usual: float, scale: Scale = USUAL_SCALE) -> str:
    """What a tunable means: sentence, symbol, range, the scenario's value, and why it may be fixed."""
    quantity = quantity_of(name, scale)
    symbol = f"{quantity.symbol}: " if quantity.symbol else ""
    limits = f"{symbol}{quantity.low:g} to {shown(quantity.high)} {quantity.unit}".rstrip()
    fixed = f" It is {_FIXED}." if name in FIXED else ""
    return f"{quantity.text} {limits}; {shown(usual)} in the scenario.{fixed}"


def about(params: Parameters, group: str) -> str:
    """What a group of tunables is for."""
    return str(type(getattr(params, group)).__doc__ or "")


def differences(params: Parameters, scenario: Parameters) -> tuple[tuple[str, float, float], ...]:
    """Name, value in the scenario and value now of each tunable that differs."""
    values = ((name, parameter(scenario, name), parameter(params, name)) for name in parameter_names())
    return tuple((name, usual, value) for name, usual, value in values if usual != value)


def note_html(group: str, wrong: str) -> str:
    """What is wrong with what was typed, and which tunables of a group are fixed."""
    lines = [f'<div class="warn">{text(wrong)}</div>'] if wrong else []
    lines += [
        f'<div class="dim">{title_of(name.split(".")[1])} is {_FIXED}.</div>'
        for name in FIXED
        if name.split(".")[0] == group
    ]
    return "".join(lines)


def changed_html(different: tuple[tuple[str, float, float], ...]) -> str:
    """What differs from the scenario, as a table."""
    if not different:
        return '<div class="title">Changed</div><span class="dim">Nothing; all values are the scenario\'s.</span>'
    rows = "".join(
        f"<tr><td>{text(label_of(name))}</td><td>{shown(usual)}</td><td>{shown(value)}</td></tr>"
        for name, usual, value in different
    )
    return (
        '<div class="title">Changed</div><table class="numbers"><thead><tr><th>Tunable</th><th>Scenario</th>'
        f"<th>Now</th></tr></thead><tbody>{rows}</tbody></table>"
    )

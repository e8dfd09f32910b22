"""The scenarios to choose from: shipped ones with a picture each, own files opened lately, and any own file."""

from collections.abc import Iterable
from typing import NamedTuple

from higvf_console.core.errors import HigvfError, ScenarioError
from higvf_console.scenario.kept import Recent
from higvf_console.scenario.scenario import Scenario, load_scenario, parse_scenario, scenario_names
from higvf_console.ui.cards.picture import scenario_svg
from higvf_console.ui.widgets.html import TIMES, text

_NO_PICTURE = '<svg viewBox="0 0 190 110" aria-hidden="true"></svg>'


LOADING_HTML = '<header><h2>Scenarios</h2></header><div class="body"><p class="dim">Drawing their pictures …</p></div>'


class Choice(NamedTuple):
    """A scenario that can be chosen.

    Attributes:
        value: by which a page names it.
        name: of its file.
        text: of its file; empty where it cannot be used here.
        title: what a person reads.
        description: one or two sentences, or why it cannot be used here.
        picture: SVG.
    """

    value: str
    name: str
    text: str
    title: str
    description: str
    picture: str


def shipped_choices() -> tuple[Choice, ...]:
    """The shipped scenarios; one that needs a package that is missing says so."""
    return tuple(_shipped(name) for name in scenario_names())


def _shipped(name: str) -> Choice:
    value = f"shipped:{name}"
    try:
        scenario = load_scenario(name)
    except HigvfError as error:
        return Choice(value, name, "", name, str(error), _NO_PICTURE)
    return _choice(value, f"{name}.yaml", scenario)


def recent_choices(recent: Iterable[Recent]) -> tuple[Choice, ...]:
    """Own files opened lately; one that cannot be used any more says why."""
    choices = list[Choice]()
    for number, opened in enumerate(recent):
        value = f"recent:{number}"
        try:
            choices.append(_choice(value, opened.source, parse_scenario(opened.text, opened.source)))
        except ScenarioError as error:
            choices.append(Choice(value, opened.source, "", opened.title, str(error), _NO_PICTURE))
    return tuple(choices)


def _choice(value: str, name: str, scenario: Scenario) -> Choice:
    return Choice(value, name, scenario.text, scenario.title, scenario.description, scenario_svg(scenario))


def scenarios_html(shipped: Iterable[Choice], recent: Iterable[Choice], current: str) -> str:
    """The card; the scenario whose text is `current` is marked."""
    own = list(recent)
    lately = f'<h3>Opened lately</h3><div class="choices">{_choices(own, current)}</div>' if own else ""
    close = f'<button class="fold" data-close title="Close" aria-label="Close">{TIMES}</button>'
    return (
        f"<header><h2>Scenarios</h2>{close}</header>"
        f'<div class="body"><p class="dim">Choosing one begins another run; undo brings this one back.</p>{lately}'
        f'<h3>Shipped</h3><div class="choices">{_choices(shipped, current)}</div></div>'
        '<footer><button class="act first" data-act="own_file">Open a file …</button>'
        '<button class="act" data-close>Cancel</button></footer>'
    )


def _choices(choices: Iterable[Choice], current: str) -> str:
    return "".join(
        f'<button class="choice" data-act="load" data-value="{text(choice.value)}"'
        f"{' aria-current=true' if choice.text and choice.text == current else ''}{'' if choice.text else ' disabled'}>"
        f'{choice.picture}<b>{text(choice.title)}</b><span class="dim">{text(choice.description)}</span></button>'
        for choice in choices
    )

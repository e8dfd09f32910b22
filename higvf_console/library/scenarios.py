"""Scenarios built in Python, without a file: a `Setup`, and what a report and a console say about it."""

import json
from collections.abc import Mapping

from higvf_console.core.arguments import instance, number
from higvf_console.core.errors import ArgumentTypeError
from higvf_console.library.stepping import given_setup
from higvf_console.scenario.scenario import Scenario, parse_scenario
from higvf_console.scenario.writer import scenario_yaml
from higvf_console.world.setup import Setup

_NO_INPUTS: Mapping[str, Mapping[str, object]] = {}


def make_scenario(
    setup: Setup,
    name: str = "scenario",
    *,
    title: str = "",
    description: str = "",
    duration: float = 120.0,
    inputs: Mapping[str, Mapping[str, object]] = _NO_INPUTS,
) -> Scenario:
    """A scenario that starts from `setup`; its `text` is that of a scenario file, so that its runs can be recorded.

    World, parameters and start positions are bit for bit those of `setup`; headings of unicycles and a path of splines
    are so up to rounding.

    Args:
        setup: from `make_setup`, with at least one robot.
        name: word that reports use.
        title: what a person reads; empty = the name.
        description: one or two sentences.
        duration: how long a headless run lasts at most [s].
        inputs: settings of operator interfaces, by their names.

    Raises:
        ArgumentError: an argument is of another type or out of range.
        ScenarioError: no run can start from `setup`.
    """
    given = given_setup(setup)
    texts = {"name": name, "title": title or name, "description": description}
    content: dict[str, object] = {key: instance(key, value, str) for key, value in texts.items()}
    content["duration_s"] = number("duration", duration, 0.001, 1e6)
    settings = instance("inputs", inputs, Mapping)  # pyright: ignore[reportUnknownVariableType]
    if settings:
        content["inputs"] = {key: dict(instance(f"inputs.{key}", part, Mapping)) for key, part in settings.items()}  # pyright: ignore[reportUnknownArgumentType, reportUnknownVariableType]
    try:
        lines = [f"{key}: {json.dumps(value, ensure_ascii=False)}\n" for key, value in content.items() if value]
    except TypeError as problem:
        raise ArgumentTypeError(f"inputs: {problem}; expected numbers, texts, lists and dicts of them") from problem
    return parse_scenario(scenario_yaml(given, given.start, None) + "".join(lines), f"{name}.yaml")

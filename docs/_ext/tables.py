"""The reference as Markdown, made from the code; the directive `generated` inserts a table by its name in `TABLES`."""

import argparse
import dataclasses
import tomllib
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any, cast, get_args

import yaml

from docs._ext.markdown import attributes, code, heading, sentence, summary, table
from docs._ext.scenario_trace import scenario_keys
from higvf_console.cli.arguments import parser
from higvf_console.control.forms import FORMS, Forms
from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import Floats
from higvf_console.core.command import Command
from higvf_console.core.commands import OperatorCommand
from higvf_console.core.quantity import Quantity, quantities
from higvf_console.scenario.scenario import KEYS
from higvf_console.ui.interaction.keys import KEYMAP, NOTE, POINTER_HELP

ROOT = Path(__file__).parents[2]
DATA = ROOT / "docs" / "_data"


def described(name: str) -> dict[str, Any]:
    """The file of that name in `docs/_data`."""
    return yaml.safe_load((DATA / f"{name}.yaml").read_text(encoding="utf-8"))


def parameters() -> list[str]:
    """Each group of parameters: name, symbol, unit, default, range, sentence."""
    lines: list[str] = []
    for group, part in Parameters()._asdict().items():
        known = quantities(type(part))
        if not known:
            continue
        lines += [*heading(2, group), summary(type(part)), ""]
        lines += table(
            ("Name", "Symbol", "Unit", "Default", "Range", "Meaning"),
            [
                (code(name), about.symbol, about.unit, f"{getattr(part, name):g}", _span(about), about.text)
                for name, about in known.items()
            ],
        )
    return lines


def forms() -> list[str]:
    """The equations with two forms, and the sets of forms that have a name."""
    named = ", ".join(code(name) for name in FORMS)
    rows = [(code(name), text) for name, text in attributes(Forms).items()]
    return [
        *table(("Equation", "Paper's number, and what is wrong with the printed form"), rows),
        f"Sets: {named}.",
        "",
    ]


def scenario() -> list[str]:
    """Every key of a scenario file."""
    means, lines = described("scenario_keys"), list[str]()
    found = sorted(scenario_keys().items(), key=lambda item: KEYS.index(item[0].split(".")[0].removesuffix("[]")))
    for path, key in found:
        if path in KEYS:
            required = ", required" if key.required else ""
            lines += [*heading(3, code(path)), f"{_kind(key.kind, key.unit, key.span)}{required}. {means[path]}", ""]
            inner = [(p, k) for p, k in found if p.split(".")[0].removesuffix("[]") == path and p != path]
            if inner:
                lines += table(
                    ("Key", "Value", "Required", "Meaning"),
                    [(code(p), _kind(k.kind, k.unit, k.span), "yes" if k.required else "", means[p]) for p, k in inner],
                )
    return lines


def report() -> list[str]:
    """Every key of a headless run's report."""
    return table(("Key", "Meaning"), [(code(key), text) for key, text in described("report_keys").items()])


def commands() -> list[str]:
    """Every operator command with its fields, and first the fields that all of them have."""
    lines = [*heading(2, "Fields of every command"), *_fields(Command, ()), *heading(2, "Commands")]
    shared = tuple(field.name for field in dataclasses.fields(Command))
    for command in sorted(get_args(OperatorCommand), key=lambda kind: kind.__name__):
        lines += [*heading(3, code(command.__name__)), summary(command), "", *_fields(command, shared)]
    return lines


def command_line() -> list[str]:
    """Every subcommand of `higvf` with its arguments."""
    whole = parser()
    chosen = next(action for action in whole._actions if isinstance(action, argparse._SubParsersAction))  # pyright: ignore[reportPrivateUsage]
    subcommands = cast("argparse._SubParsersAction[argparse.ArgumentParser]", chosen)  # pyright: ignore[reportPrivateUsage]
    helps = {choice.dest: choice.help or "" for choice in subcommands._choices_actions}  # pyright: ignore[reportPrivateUsage]
    lines: list[str] = []
    for name, command in subcommands.choices.items():
        usage = " ".join(command.format_usage().removeprefix("usage: ").split())
        lines += [*heading(2, f"higvf {name}"), sentence(helps.get(name, "")), "", "```text", usage, "```", ""]
        rows = [
            (code(_invocation(action)), sentence(_help(action)))
            for action in command._actions  # pyright: ignore[reportPrivateUsage]
            if action.help != argparse.SUPPRESS and "--help" not in action.option_strings
        ]
        lines += table(("Argument", "Meaning"), rows) if rows else []
    return lines


def keys() -> list[str]:
    """The keys of the console, and what the pointer does in the arena."""
    rows = [(key.key, sentence(key.text)) for key in KEYMAP] + [(name, sentence(text)) for name, text in POINTER_HELP]
    return [*table(("Key or pointer", "Action"), rows), NOTE, ""]


def glossary() -> list[str]:
    """Terms with symbol, equation, name in code and module; a name that the code does not have is an error."""
    lines: list[str] = []
    for group, terms in described("glossary").items():
        rows: list[tuple[str, ...]] = []
        for entry in terms:
            resolve(entry["where"], entry["name"])
            rows.append(
                (
                    entry["term"], entry.get("symbol", ""), str(entry.get("equation", "")), code(entry["name"]),
                    code(entry["where"]), sentence(entry["means"]),
                )
            )  # fmt: skip
        lines += [*heading(2, group), *table(("Term", "Symbol", "Equation", "Name", "Module", "Meaning"), rows)]
    return lines


def layers() -> list[str]:
    """The layers of the packages, top to bottom, as import-linter checks them, each with its first sentence."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    stack = next(c["layers"] for c in contracts if c.get("containers") == ["higvf_console"])
    lines = ["::::{container} layers", ""]
    for layer in stack:
        lines += [":::{container} layer", ""]
        for package in layer.split(" | "):
            module = import_module(f"higvf_console.{package}")
            lines += [f"**{package}** {summary(module)}", ""]
        lines += [":::", ""]
    return [*lines, "::::", ""]


def resolve(where: str, name: str) -> None:
    """Refuses a name of the glossary that its module does not have.

    Raises:
        LookupError: there is no such name; the message gives it.
    """
    found: Any = import_module(f"higvf_console.{where}")
    for part in name.split("."):
        known = getattr(found, "_fields", ()) or getattr(found, "__dataclass_fields__", ())
        if part not in known and not hasattr(found, part):
            raise LookupError(f"docs/_data/glossary.yaml: higvf_console.{where} has no '{name}'")
        found = getattr(found, part, None)


def _fields(command: type[Any], without: tuple[str, ...]) -> list[str]:
    means = attributes(command)
    rows = [
        (code(field.name), code(_type(field.type)), _default(field), means.get(field.name, ""))
        for field in dataclasses.fields(command)
        if field.name not in without
    ]
    return table(("Field", "Type", "Default", "Meaning"), rows) if rows else []


def _type(kind: object) -> str:
    text = kind.__name__ if isinstance(kind, type) and not get_args(kind) else str(kind)
    return text.replace(str(Floats), "Floats").replace("typing.", "").replace("collections.abc.", "")


def _default(field: "dataclasses.Field[Any]") -> str:
    return (
        "required"
        if field.default is dataclasses.MISSING
        else code(repr(getattr(field.default, "value", field.default)))
    )


def _span(about: Quantity) -> str:
    return f"{about.low:g} to {about.high:g}"


def _kind(kind: str, unit: str, span: str) -> str:
    kind = "Section" if kind == "section" else kind[:1].upper() + kind[1:]
    return f"{kind}{f', {span}' if span else ''}{f' {unit}' if unit else ''}"


def _invocation(action: argparse.Action) -> str:
    shown = action.metavar or (
        "{" + ",".join(map(str, action.choices)) + "}" if action.choices else action.dest.upper()
    )
    if not action.option_strings:
        return str(shown)
    flag = ", ".join(action.option_strings)
    return flag if action.nargs == 0 else f"{flag} {shown}"


def _help(action: argparse.Action) -> str:
    return (action.help or "") % {**vars(action), "prog": "higvf"} if "%(" in (action.help or "") else action.help or ""


TABLES: Mapping[str, Callable[[], list[str]]] = {
    "parameters": parameters, "forms": forms, "scenario": scenario, "report": report, "commands": commands,
    "command-line": command_line, "glossary": glossary, "keys": keys, "layers": layers,
}  # fmt: skip

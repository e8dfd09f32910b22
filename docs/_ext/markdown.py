"""Small pieces of Markdown: a table, a heading, a value in code font."""

import inspect
import re
from collections.abc import Iterable, Sequence


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """The lines of a Markdown table, with an empty line after it."""
    lines = [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    lines += [f"| {' | '.join(_cell(text) for text in row)} |" for row in rows]
    return [*lines, ""]


def heading(level: int, text: str) -> list[str]:
    """The lines of a heading, with an empty line after it."""
    return [f"{'#' * level} {text}", ""]


def code(text: object) -> str:
    """`text` in code font; nothing where it is empty."""
    return f"`{text}`" if str(text) else ""


def sentence(text: str) -> str:
    """A docstring's or a field's text in one line, with a capital letter and a full stop."""
    text = " ".join(text.split())
    text = text[:1].upper() + text[1:]
    return text if not text or text.endswith((".", "!", "?", ":")) else f"{text}."


def attributes(described: type) -> dict[str, str]:
    """The texts of the section `Attributes:` of a class's docstring, by name."""
    _, _, section = inspect.cleandoc(described.__doc__ or "").partition("Attributes:\n")
    found: dict[str, str] = {}
    name = ""
    for line in section.splitlines():
        entry = re.match(r" {4}(\w+): (.*)", line)
        if entry:
            name = entry[1]
            found[name] = entry[2]
        elif name and line.startswith(" " * 8):
            found[name] += f" {line.strip()}"
        elif line.strip():
            break
    return {key: sentence(text) for key, text in found.items()}


def summary(described: object) -> str:
    """The part of a docstring before its first section, in one line."""
    text = inspect.cleandoc(getattr(described, "__doc__", "") or "")
    return sentence(re.split(r"\n(?:Attributes|Args|Returns|Raises):\n", text)[0])


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")

"""Docstrings as reStructuredText: they are plain text in which `|v|` is a norm, `*` a product and columns are kept.

Runs before the docstring's sections (Args, Returns, ...) are read by `sphinx.ext.napoleon`.
"""

import re
from typing import Any

_SECTION = re.compile(r"(Args|Attributes|Returns|Raises|Yields):$")


def plain_text(_app: Any, _what: str, _name: str, _obj: Any, _options: Any, lines: list[str]) -> None:
    """Escapes what reStructuredText would read as markup, and keeps indented blocks as they are."""
    in_section, in_block, result = False, False, list[str]()
    for line in lines:
        indented = line.startswith("    ")
        if line and not indented:
            in_section, in_block = bool(_SECTION.match(line)), False
        if indented and not in_section and not in_block:
            in_block = True
            result += ["::", ""]
        result.append(line if in_block else _escaped(line))
    lines[:] = result


def skip_fields(_app: Any, _what: str, _name: str, obj: Any, skip: bool, _options: Any) -> bool:
    """Leaves out the fields of named tuples as members: their class's docstring lists them."""
    return skip or type(obj).__name__ == "_tuplegetter"


def _escaped(line: str) -> str:
    """The line outside of code with its markup characters escaped."""
    parts = re.split(r"(`[^`]*`)", line)
    return "".join(part if part.startswith("`") else re.sub(r"([*|]|_(?=\W|$))", r"\\\1", part) for part in parts)

"""Docstrings as reStructuredText: they are plain text in which `|v|` is a norm, `*` a product and columns are kept.

Runs before the docstring's sections (Args, Returns, ...) are read by `sphinx.ext.napoleon`.
"""

import re
from typing import Any

_ARRAYS = {"float64": "Floats", "int64": "Ints", "bool": "Bools"}
_ARRAY = re.compile(r"(?:numpy\.)?ndarray\[tuple\[(?:typing\.)?Any, \.\.\.\], (?:numpy\.)?dtype\[(?:numpy\.)?(\w+)\]\]")
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


def short_types(
    _app: Any, _what: str, _name: str, _obj: Any, _options: Any, signature: str | None, result: str | None
) -> tuple[str | None, str | None]:
    """Gives the arrays of a signature the names that the code has for them."""
    return _short(signature), _short(result)


def _short(signature: str | None) -> str | None:
    return signature and _ARRAY.sub(lambda match: _ARRAYS[match[1]], signature)


def _escaped(line: str) -> str:
    """The line outside of code with its markup characters escaped."""
    parts = re.split(r"(`[^`]*`)", line)
    return "".join(part if part.startswith("`") else re.sub(r"([*|]|_(?=\W|$))", r"\\\1", part) for part in parts)

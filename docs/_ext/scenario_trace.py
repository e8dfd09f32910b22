"""Which keys a scenario file may have, observed while the real reader reads files that use all of them.

Every key is found where the reader asks for it (`Node.section`), and its kind, unit and range where the reader takes
its value (`Node.number`, `Node.integer`, ...). So the reference cannot differ from the reader.
"""

import re
from collections.abc import Callable, Generator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, NamedTuple
from unittest.mock import patch

from docs._ext.markdown import number
from higvf_console.core.quantity import Quantity
from higvf_console.core.reading.node import Node
from higvf_console.scenario.scenario import parse_scenario

EXAMPLES = Path(__file__).parents[1] / "_data" / "scenarios"
_ITEM = re.compile(r"\[\d+\]")
ELSEWHERE = ("inputs", "teams", "parameters", "forms")  # sections with reference tables of their own


class Key(NamedTuple):
    """A key of a scenario file.

    Attributes:
        kind: what its value is, in words.
        unit: of a number; else empty.
        span: the range of a number; else empty.
        required: "yes" where its section must have it, "depends" where another key can take its place; else empty.
    """

    kind: str
    unit: str
    span: str
    required: str = ""


def scenario_keys() -> dict[str, Key]:
    """Every key by its path, such as `fires[].radius_m`, in the order in which the reader lists them."""
    found: dict[str, Key] = {}
    with _observed(found):
        for file in sorted(EXAMPLES.glob("*.yaml")):
            parse_scenario(file.read_text(encoding="utf-8"), str(file))
    return {path: key for path, key in found.items() if path.split(".")[0] not in ELSEWHERE or "." not in path}


@contextmanager
def _observed(found: dict[str, Key]) -> Generator[None]:
    """While it lasts, the reader's requests are noted in `found`."""
    methods = {name: getattr(Node, name) for name in ("section", *_KINDS)}

    def section(node: Any, known: Any, required: Any = (), **options: Any) -> Any:
        for name in known:
            path = _path(f"{node.place}.{name}" if node.place else name)
            if path not in found:
                found[path] = Key("section", "", "", "yes" if name in required else "")
            elif name in required and not found[path].required:
                found[path] = found[path]._replace(required="depends")
        return methods["section"](node, known, required, **options)

    def observer(name: str) -> Callable[..., Any]:
        def take(node: Any, *arguments: Any, **options: Any) -> Any:
            path, about = _path(node.place), _KINDS[name](*arguments, **options)
            if path in found and found[path].kind in ("section", "list"):
                found[path] = found[path]._replace(kind=about.kind, unit=about.unit, span=about.span)
            elif path.endswith("[]") and path[:-2] in found and found[path[:-2]].kind == "list":
                found[path[:-2]] = about._replace(kind=f"list of: {about.kind}", required=found[path[:-2]].required)
            return methods[name](node, *arguments, **options)

        return take

    with ExitStack() as patches:
        for name in methods:
            patches.enter_context(patch.object(Node, name, section if name == "section" else observer(name)))
        yield


def _path(place: str) -> str:
    return _ITEM.sub("[]", place)


def _number(quantity: Quantity) -> Key:
    return Key("number", quantity.unit, f"{number(quantity.low)} to {number(quantity.high)}")


def _numbers(count: int, quantity: Quantity) -> Key:
    return _number(quantity)._replace(kind=f"list of {count} numbers")


def _integer(low: int, *_: Any, **__: Any) -> Key:
    return Key("whole number", "", f"from {low}")


def _words(words: Any, *_: Any, **__: Any) -> Key:
    return Key(" or ".join(f"`{word}`" for word in words), "", "")


def _points(least: int = 0) -> Key:
    return Key(f"list of {f'at least {least} ' if least else ''}points", "m", "")


def _always(kind: str, unit: str = "") -> Callable[..., Key]:
    return lambda *_, **__: Key(kind, unit, "")


_KINDS: dict[str, Callable[..., Key]] = {
    "number": _number, "numbers": _numbers, "integer": _integer, "choice": _words, "points": _points,
    "flag": _always("`true` or `false`"), "text": _always("text"), "point": _always("point [x, y]", "m"),
    "items": _always("list"),
}  # fmt: skip

"""Which keys a scenario file may have, observed while the real reader reads files that use all of them.

Every key is found where the reader asks for it (`Node.section`), and its kind, unit and range where the reader takes
its value (`Node.number`, `Node.integer`, ...). So the reference cannot differ from the reader.
"""

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple
from unittest.mock import patch

from higvf_console.core.quantity import Quantity
from higvf_console.scenario import scenario
from higvf_console.scenario.scenario import parse_scenario

EXAMPLES = Path(__file__).parents[1] / "_data" / "scenarios"
_ITEM = re.compile(r"\[\d+\]")
_FREE = ("inputs", "parameters", "forms")  # sections with reference tables of their own


class Key(NamedTuple):
    """A key of a scenario file.

    Attributes:
        kind: what its value is, in words.
        unit: of a number; else empty.
        span: the range of a number; else empty.
        required: whether its section must have it.
    """

    kind: str
    unit: str
    span: str
    required: bool


def scenario_keys() -> dict[str, Key]:
    """Every key by its path, such as `fires[].radius_m`, in the order in which the reader lists them."""
    found: dict[str, Key] = {}
    with _observed(found):
        for file in sorted(EXAMPLES.glob("*.yaml")):
            parse_scenario(file.read_text(encoding="utf-8"), str(file))
    return {path: key for path, key in found.items() if path.split(".")[0] not in _FREE or "." not in path}


@contextmanager
def _observed(found: dict[str, Key]) -> Iterator[None]:
    """While it lasts, the reader's requests are noted in `found`."""
    kind: Any = scenario.Node
    methods = {name: getattr(kind, name) for name in ("section", *_KINDS)}

    def section(node: Any, known: Any, required: Any = ()) -> Any:
        for name in known:
            path = _path(f"{node.place}.{name}" if node.place else name)
            before = found.get(path, Key("section", "", "", False))
            found[path] = before._replace(required=before.required or name in required)
        return methods["section"](node, known, required)

    def observer(name: str) -> Callable[..., Any]:
        def take(node: Any, *arguments: Any, **options: Any) -> Any:
            path, about = _path(node.place), _KINDS[name](*arguments, **options)
            if path in found and found[path].kind in ("section", "list"):
                found[path] = found[path]._replace(kind=about.kind, unit=about.unit, span=about.span)
            elif path.endswith("[]") and path[:-2] in found and found[path[:-2]].kind == "list":
                found[path[:-2]] = about._replace(kind=f"list of: {about.kind}", required=found[path[:-2]].required)
            return methods[name](node, *arguments, **options)

        return take

    replaced = {"section": section, **{name: observer(name) for name in _KINDS}}
    with patch.multiple(kind, **replaced):
        yield


def _path(place: str) -> str:
    return _ITEM.sub("[]", place)


def _number(quantity: Quantity) -> Key:
    return Key("number", quantity.unit, f"{quantity.low:g} to {quantity.high:g}", False)


def _integer(low: int, _high: int, _what: str) -> Key:
    return Key("whole number", "", f"from {low}", False)


def _words(words: Any) -> Key:
    return Key(" or ".join(f"`{word}`" for word in words), "", "", False)


_KINDS: dict[str, Callable[..., Key]] = {
    "number": _number,
    "integer": _integer,
    "flag": lambda: Key("`true` or `false`", "", "", False),
    "text": lambda: Key("text", "", "", False),
    "choice": _words,
    "point": lambda: Key("point [x, y]", "m", "", False),
    "points": lambda least=0: Key(f"list of {f'at least {least} ' if least else ''}points", "m", "", False),
    "items": lambda: Key("list", "", "", False),
}

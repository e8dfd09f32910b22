"""Strict YAML, read and written: every value knows its place in the file, so that an error can say where it stands.

The types are those of YAML 1.2: `on`, `no` and `12:30` are text, `1e3` is a number. A key given twice is an error.
"""

import re
from collections.abc import Hashable, Mapping, Sequence
from typing import Any, NamedTuple

import yaml

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import ScenarioError, closest
from higvf_console.core.quantity import COORDINATE, Quantity, checked, shown


class _StrictLoader(yaml.SafeLoader):
    """A safe loader with the scalar types of YAML 1.2 and without double keys."""

    yaml_implicit_resolvers: dict[str, list[tuple[str, re.Pattern[str]]]] = {}  # noqa: RUF012 (PyYAML reads it off the class)

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        try:
            return super().construct_object(node, deep)
        except (ValueError, LookupError, AttributeError) as error:  # a tag that its text does not fit, endless digits
            kind = str(node.tag).rpartition(":")[2]
            text = f"{shown(node.value)} cannot be read as '{kind}'"
            raise yaml.constructor.ConstructorError(None, None, text, node.start_mark) from error

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        seen: set[object] = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, str):
                raise yaml.constructor.ConstructorError(None, None, f"key {key!r} is not text", key_node.start_mark)
            if key in seen:
                raise yaml.constructor.ConstructorError(None, None, f"key '{key}' is given twice", key_node.start_mark)
            seen.add(key)
        return super().construct_mapping(node, deep)


for _tag, _pattern, _first in (
    ("null", r"null|~|", ["n", "~", ""]),
    ("bool", r"true|false", ["t", "f"]),
    ("int", r"[-+]?(?:0|[1-9][0-9]*)", list("-+0123456789")),
    ("float", r"[-+]?(?:[0-9]+\.[0-9]*|\.[0-9]+|[0-9]+(?=[eE]))(?:[eE][-+]?[0-9]+)?", list("-+.0123456789")),
    ("float", r"[-+]?\.inf|\.nan", list("-+.")),
):
    _StrictLoader.add_implicit_resolver(f"tag:yaml.org,2002:{_tag}", re.compile(f"(?:{_pattern})$"), _first)


class Node(NamedTuple):
    """A value in a YAML file.

    Attributes:
        value: as the loader made it.
        source: the file.
        place: path of keys; list items are counted from 1, as robots and fires are.
    """

    value: Any
    source: str
    place: str = ""

    def error(self, text: str) -> ScenarioError:
        """An error that starts with file and key path."""
        return ScenarioError(f"{self.source}: {self.place}: {text}" if self.place else f"{self.source}: {text}")

    def wrong(self, wanted: str) -> ScenarioError:
        """The error that this value is not what was wanted."""
        return self.error(f"{shown(self.value)} is not {wanted}")

    def section(self, known: Sequence[str], required: Sequence[str] = ()) -> dict[str, "Node"]:
        """The entries of a mapping by name.

        Raises:
            ScenarioError: not a mapping, a key that is not `known`, or a `required` key that is missing.
        """
        if not isinstance(self.value, dict):
            raise self.wrong(f"a section with the keys {', '.join(known)}")
        entries: dict[str, Node] = {
            name: Node(value, self.source, f"{self.place}.{name}" if self.place else name)
            for name, value in self.value.items()
        }
        for name, entry in entries.items():
            if name not in known:
                raise entry.error(
                    f"unknown key{closest(name, known)}; value {shown(entry.value)}; known keys: {', '.join(known)}"
                )
        for name in required:
            if name not in entries:
                raise self.error(f"the key '{name}' is missing; known keys: {', '.join(known)}")
        return entries

    def items(self) -> "list[Node]":
        """The items of a list."""
        if not isinstance(self.value, list):
            raise self.wrong("a list")
        return [Node(value, self.source, f"{self.place}[{number}]") for number, value in enumerate(self.value, 1)]

    def number(self, quantity: Quantity) -> float:
        """A number within the range of `quantity`."""
        return checked(f"{self.source}: {self.place}", self.value, quantity)

    def integer(self, low: int, high: int, what: str) -> int:
        """A whole number from `low` to `high`."""
        if isinstance(self.value, bool) or not isinstance(self.value, int) or not low <= self.value <= high:
            raise self.wrong(f"{what}, a whole number from {low} to {high}")
        return self.value

    def flag(self) -> bool:
        """True or false."""
        if not isinstance(self.value, bool):
            raise self.wrong("true or false")
        return self.value

    def text(self) -> str:
        """A text."""
        if not isinstance(self.value, str):
            raise self.wrong("a text")
        return self.value

    def choice(self, words: Sequence[str]) -> str:
        """One of `words`."""
        if self.value not in words:
            raise self.wrong(f"one of: {', '.join(words)}")
        return self.value

    def point(self) -> tuple[float, float]:
        """A ground point [x, y] in m."""
        if not isinstance(self.value, list) or len(self.value) != 2:
            raise self.wrong("a point [x, y] in m")
        x, y = (item.number(COORDINATE) for item in self.items())
        return x, y

    def points(self, least: int = 0) -> Floats:
        """A list of at least `least` ground points, shape (n, 2) [m]."""
        points = [item.point() for item in self.items()]
        if len(points) < least:
            raise self.error(f"{len(points)} points are too few; give at least {least}")
        return floats(points, -1, 2)


def read_yaml(text: str, source: str) -> Node:
    """The root of a YAML document.

    Raises:
        ScenarioError: nothing in it, not YAML, or a key given twice; the message gives the line.
    """
    try:
        content = yaml.load(text, _StrictLoader)
    except yaml.MarkedYAMLError as error:
        line = f"line {error.problem_mark.line + 1}: " if error.problem_mark else ""
        raise ScenarioError(f"{source}: {line}{error.problem}") from error
    except yaml.YAMLError as error:
        raise ScenarioError(f"{source}: {str(error).splitlines()[0]}") from error
    except RecursionError as error:
        raise ScenarioError(f"{source}: lists or sections are nested too deeply") from error
    if content is None:
        raise ScenarioError(f"{source}: the file is empty")
    return Node(content, source)


class _StrictDumper(yaml.SafeDumper):
    """A safe dumper that quotes whatever any YAML would not read as text."""

    yaml_implicit_resolvers: dict[str, list[tuple[str, re.Pattern[str]]]] = {  # noqa: RUF012 (PyYAML reads it off the class)
        letter: [
            *yaml.SafeDumper.yaml_implicit_resolvers.get(letter, ()),
            *_StrictLoader.yaml_implicit_resolvers.get(letter, ()),
        ]
        for letter in {*yaml.SafeDumper.yaml_implicit_resolvers, *_StrictLoader.yaml_implicit_resolvers}
    }

    def ignore_aliases(self, data: Any) -> bool:  # noqa: ARG002 (written out as often as it occurs)
        return True


def yaml_text(content: Mapping[str, Any]) -> str:
    """YAML that `read_yaml` reads as the same; numbers keep every bit."""
    return yaml.dump(
        content, Dumper=_StrictDumper, sort_keys=False, default_flow_style=None, width=120, allow_unicode=True
    )

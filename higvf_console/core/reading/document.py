"""Strict YAML, read and written: scenarios, scripts, plans and calibrations all pass here.

The types are those of YAML 1.2: `on`, `no` and `12:30` are text, `1e3` is a number. A key given twice is an error.
Nesting is bounded, and so is what aliases stand for: a short text must not take minutes or fill the memory.
"""
# PyYAML has no types.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false

import gc
import re
from collections.abc import Generator, Hashable, Mapping
from contextlib import contextmanager
from itertools import accumulate
from pathlib import Path
from typing import Any

import yaml

from higvf_console.core.errors import HigvfError, ScenarioError
from higvf_console.core.quantity import shown
from higvf_console.core.reading.node import Node

DEEPEST = 100  # brackets; PyYAML's scanner takes minutes for a few thousand
MOST_REPEATED = 100_000  # values that aliases repeat
_BRACKETS = re.compile(r"[\[\]{}]")


# libyaml reads ten times faster than PyYAML's own parser, which stands in where it is not installed.
_SafeLoader: type[yaml.SafeLoader] = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class _StrictLoader(_SafeLoader):
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


@contextmanager
def without_collections() -> Generator[None]:
    """Collects no garbage: what a large document is made of stays, and looking through it takes as long as reading."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()


def read_text(file: Path, raises: type[HigvfError] = ScenarioError) -> str:
    """The text of a file in UTF-8.

    Raises:
        HigvfError: of class `raises`: it cannot be read, or is not UTF-8.
    """
    try:
        return file.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise raises(f"{file}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise raises(f"{file}: not UTF-8 text") from error


@without_collections()
def read_yaml(text: str, source: str, raises: type[HigvfError] = ScenarioError) -> Node:
    """The root of a YAML document.

    Args:
        text: the document.
        source: the file, for errors.
        raises: class of the errors that reading it, and taking values out of it, raise.

    Raises:
        HigvfError: nothing in it, not YAML, a key given twice, or nested too deeply; the message gives the line.
    """
    depth = max(accumulate((bracket in "[{") - (bracket in "]}") for bracket in _BRACKETS.findall(text)), default=0)
    if depth > DEEPEST:
        raise raises(f"{source}: brackets are nested over {DEEPEST} deep")
    try:
        content = _loaded(text)
    except yaml.MarkedYAMLError as error:
        last = text.rstrip().count("\n")  # where the text ends, its end is reported on the line behind
        line = f"line {min(error.problem_mark.line, last) + 1}: " if error.problem_mark else ""
        raise raises(f"{source}: {line}{error.problem}") from error
    except yaml.YAMLError as error:
        raise raises(f"{source}: {str(error).splitlines()[0]}") from error
    except RecursionError as error:
        raise raises(f"{source}: lists or sections are nested too deeply") from error
    if content is None:
        raise raises(f"{source}: the file is empty")
    return Node(content, source, raises=raises)


def _loaded(text: str) -> Any:
    loader = _StrictLoader(text)
    try:
        root = loader.get_single_node()
        if root is None:
            return None
        _expanded(root, {}, set())
        return loader.construct_document(root)
    finally:
        loader.dispose()


def _expanded(node: yaml.Node, sizes: dict[int, int], above: set[int]) -> int:
    """How many values a node is with its aliases written out.

    Args:
        node: of the composed document.
        sizes: of the nodes seen so far, by identity.
        above: identities of the nodes that hold this one.
    """
    if id(node) in above:
        raise yaml.constructor.ConstructorError(None, None, "a value holds itself by an alias", node.start_mark)
    if id(node) in sizes:
        return sizes[id(node)]
    if isinstance(node, yaml.MappingNode):
        parts = [part for pair in node.value for part in pair]
    else:
        parts = node.value if isinstance(node, yaml.SequenceNode) else []
    above.add(id(node))
    known = len(sizes)
    size = 1 + sum(_expanded(part, sizes, above) for part in parts)
    above.discard(id(node))
    if size > MOST_REPEATED + 1 + len(sizes) - known:
        problem = f"aliases repeat over {MOST_REPEATED} values"
        raise yaml.constructor.ConstructorError(None, None, problem, node.start_mark)
    sizes[id(node)] = size
    return size


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

    def text(self, data: str) -> yaml.ScalarNode:
        """A text, between double quotes where it has a line break that other styles do not keep."""
        return self.represent_scalar("tag:yaml.org,2002:str", data, '"' if _BREAKS.search(data) else None)


_BREAKS = re.compile("[\r\x85\u2028\u2029]")
_StrictDumper.add_representer(str, _StrictDumper.text)


def yaml_text(content: Mapping[str, Any]) -> str:
    """YAML that `read_yaml` reads as the same; numbers keep every bit."""
    return yaml.dump(
        content, Dumper=_StrictDumper, sort_keys=False, default_flow_style=None, width=120, allow_unicode=True
    )

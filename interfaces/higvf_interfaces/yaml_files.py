"""Reads a YAML file strictly: a key given twice is an error, and every fault is one of the console's own errors."""

from itertools import accumulate
from pathlib import Path
from typing import Any

import yaml

from higvf_console.core.errors import HigvfError

_DEEPEST = 100  # brackets; the scanner takes minutes for a few thousand


class _StrictLoader(yaml.SafeLoader):
    """The safe loader, which also refuses a key that is given twice."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen: set[str] = set()
        for key in (key for key, _ in node.value if isinstance(key, yaml.ScalarNode)):
            if key.value in seen:
                raise yaml.constructor.ConstructorError(
                    None, None, f"the key {key.value!r} is given more than once", key.start_mark
                )
            seen.add(key.value)
        return super().construct_mapping(node, deep)


def read_yaml(path: Path, error: type[HigvfError]) -> object:
    """What a YAML file holds.

    Raises:
        HigvfError: of class `error`: the file cannot be read, or is not YAML (the message gives the line).
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
        if max(accumulate((letter in "[{") - (letter in "]}") for letter in text), default=0) > _DEEPEST:
            raise error(f"{path}: brackets are nested over {_DEEPEST} deep")
        return yaml.load(text, _StrictLoader)
    except OSError as problem:
        raise error(f"{path}: cannot be read: {problem.strerror}") from problem
    except (yaml.YAMLError, ValueError, RecursionError) as problem:
        raise error(f"{path}: is not YAML: {problem}") from problem

"""Sidecar files of BIDS recordings, found by the inheritance principle.

A sidecar applies to a recording if it lies in the recording's folder or a folder above it, up to the root of the
dataset (the folder with `dataset_description.json`), and all its entities, such as `task-rest`, are entities of the
recording. Deeper and more specific files override those above them. Without a root, only the recording's folder counts.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import cast

_ROOT = "dataset_description.json"
_LARGEST = 1_000_000  # maximum size of a sidecar [bytes]
_DEEPEST = 12  # folders


def stem_of(path: Path) -> str:
    """Return the file name without `.tsv`, `.gz` and other suffixes of recordings."""
    return path.name.removesuffix(".gz").split(".")[0]


def sidecars(recording: Path, suffix: str, extension: str) -> list[Path]:
    """Return the sidecars `*_SUFFIX.EXTENSION` that apply to a recording, the most general first."""
    entities = set(stem_of(recording).split("_")[:-1])
    found: list[Path] = []
    for folder in _folders(recording):
        try:
            fit = [path for path in folder.glob(f"*{suffix}.{extension}") if _applies(path, suffix, entities)]
        except OSError:
            continue
        found += sorted(fit, key=lambda path: (len(stem_of(path).split("_")), path.name))
    return [path for path in found if path != recording]


def merged_json(recording: Path, suffix: str) -> Mapping[str, object] | None:
    """Return the keys of all JSON sidecars `*_SUFFIX.json` of a recording; None without one."""
    contents = [_json(path) for path in sidecars(recording, suffix, "json")]
    known = [content for content in contents if content is not None]
    return {key: value for content in known for key, value in content.items()} if known else None


def _folders(recording: Path) -> list[Path]:
    """Return the folders from the root of the dataset to that of the recording."""
    own = recording.absolute().parent
    above = [own, *own.parents][:_DEEPEST]
    root = next((place for place, folder in enumerate(above) if (folder / _ROOT).is_file()), 0)
    return above[root::-1]


def _applies(path: Path, suffix: str, entities: set[str]) -> bool:
    *own, last = stem_of(path).split("_")
    return last == suffix and set(own) <= entities


def _json(path: Path) -> Mapping[str, object] | None:
    try:
        if path.stat().st_size > _LARGEST:
            return None
        content: object = json.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError):
        return None
    return cast(dict[str, object], content) if isinstance(content, dict) else None

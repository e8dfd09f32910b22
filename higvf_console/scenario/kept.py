"""Scenario texts kept in the user's state folder: drafts of edited worlds, and own files opened lately.

    drafts/PID.yaml    the edited world of a console that runs, or that ended without saving it
    recent.json        [{"title": ..., "source": ..., "text": ...}, ...], the latest first

Files are written as a whole or not at all: beside their place first, then moved there.
"""

import json
import logging
import os
import sys
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple, cast

from higvf_console.core.errors import ScenarioError
from higvf_console.core.reading.document import read_text

MOST_RECENT = 8
LONGEST_TEXT = 500_000  # characters of a file that is kept among the recent ones
_DRAFTS, _RECENT = "drafts", "recent.json"
_log = logging.getLogger(__name__)


class Draft(NamedTuple):
    """An edited world that was not saved.

    Attributes:
        file: where it is kept.
        text: of a scenario file.
        saved: when it was written [s since 1970].
    """

    file: Path
    text: str
    saved: float


class Recent(NamedTuple):
    """An own scenario file that was opened.

    Attributes:
        title: what a person reads.
        source: file or name that it was opened from; images are looked for beside it.
        text: of the file.
    """

    title: str
    source: str
    text: str


def state_folder() -> Path:
    """`higvf` in XDG_STATE_HOME, or in ~/.local/state."""
    root = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    return Path(root) / "higvf"


def write_whole(file: Path, content: str | bytes) -> None:
    """Writes a file that its owner alone may read, as a whole or not at all, and its folder where it is missing.

    Raises:
        OSError: it cannot be written; a former file is as it was.
    """
    file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    beside = file.with_name(f".{file.name}.{os.getpid()}")
    try:
        with os.fdopen(os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "wb") as stream:
            stream.write(content.encode() if isinstance(content, str) else content)
            stream.flush()
            os.fsync(stream.fileno())
        beside.replace(file)
    finally:
        beside.unlink(missing_ok=True)


def draft_file(folder: Path, process: int) -> Path:
    """Where a process keeps its draft."""
    return folder / _DRAFTS / f"{process}.yaml"


def left_drafts(folder: Path) -> list[Draft]:
    """Drafts of processes that run no more, the latest first."""
    found = list[Draft]()
    for file in (folder / _DRAFTS).glob("*.yaml"):
        with suppress(OSError, ScenarioError):  # gone meanwhile, or not readable
            if not file.stem.isdecimal() or not process_runs(int(file.stem)):
                found.append(Draft(file, read_text(file), file.stat().st_mtime))
    return sorted(found, key=lambda draft: (-draft.saved, draft.file.name))


def recent_files(folder: Path) -> list[Recent]:
    """Own files opened lately, the latest first; none where the list is damaged, which is logged."""
    file = folder / _RECENT
    if not file.is_file():
        return []
    try:
        entries = json.loads(file.read_text(encoding="utf-8"))
        return [
            Recent(*(str(entry[key]) for key in Recent._fields)) for entry in cast("list[dict[str, object]]", entries)
        ]
    except (OSError, ValueError, TypeError, KeyError) as error:
        _log.warning("%s cannot be read: %r", file, error)
        return []


def remember(folder: Path, opened: Recent) -> None:
    """Puts a file at the head of those opened lately, once, unless its text is too long.

    Raises:
        OSError: the list cannot be written.
    """
    if len(opened.text) > LONGEST_TEXT:
        return
    others = [known for known in recent_files(folder) if (known.source, known.title) != (opened.source, opened.title)]
    entries = [entry._asdict() for entry in [opened, *others][:MOST_RECENT]]
    write_whole(folder / _RECENT, json.dumps(entries, ensure_ascii=False, indent=1) + "\n")


def process_runs(process: int) -> bool:
    """Whether a process of that number runs; on Windows, where asking would end it, only this one is known to."""
    if process == os.getpid():
        return True
    if sys.platform == "win32":
        return False
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:  # of another user
        return True
    return True

"""The report of a search: text for people, JSON for machines."""

import json
from pathlib import Path

from higvf_console.lab.safety.play import Case
from higvf_console.lab.safety.search import Searched
from higvf_console.lab.safety.watch import Broken, Failure


def as_json(searched: Searched) -> str:
    """One JSON object: counts, and for each kind of failure the recordings that reproduce it."""
    found = {
        broken.value: [str(one.file) for one in searched.found if one.failure.broken is broken] for broken in Broken
    }
    counts = {"ticks": searched.ticks, "commands": searched.commands, "replays": searched.replays}
    return json.dumps({**counts, **found, "seed": searched.seed}, indent=2)


def as_text(searched: Searched) -> str:
    """A few lines, with a line for each failure."""
    lines = [
        f"{searched.ticks} control periods in {searched.replays + len(searched.found)} random worlds, seed"
        f" {searched.seed}: {searched.commands} commands, {searched.replays} replays",
        *(f"{_WORDS[one.failure.broken]}: {one.failure.text}\n    {one.file}" for one in searched.found),
    ]
    if not searched.found:
        lines.append("Every guarantee held.")
    return "\n".join(lines)


def as_verdict(file: Path, case: Case, failure: Failure | None) -> str:
    """What a recording that was repeated under watch came to."""
    size = f"{case.ticks} control periods, {len(case.commands)} commands"
    verdict = "every guarantee held" if failure is None else f"{_WORDS[failure.broken]}: {failure.text}"
    return f"{file}: {size}: {verdict}"


_WORDS = {
    Broken.UNFLAGGED: "A violation that is not flagged",
    Broken.MISMATCH: "A replay that differs",
    Broken.EXCEPTION: "An error",
    Broken.MOVED: "Motion under a STOP",
}

"""Generate sample recordings from a plan: `python -m higvf_interfaces.recordings OUT_DIR --plan PLAN.yaml`.

The plan lists what the operator looks at and which labels the decoders give. The files are in formats that the readers
accept; the same plan gives the same bytes. interfaces/README.md describes the keys.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from higvf_console.core.errors import HigvfError, InputError
from higvf_console.core.reading.document import read_text, read_yaml
from higvf_console.core.reading.node import Node
from higvf_console.core.viewport import Arena, fit
from higvf_interfaces.fields import Fields, is_number
from higvf_interfaces.formats import command_log
from higvf_interfaces.formats.gaze import plain as gaze_csv
from higvf_interfaces.formats.gaze import tobii_prolab
from higvf_interfaces.formats.records import Decision
from higvf_interfaces.gaze.fixations import PX_PER_DEG
from higvf_interfaces.recordings.files import write_command_csv, write_command_jsonl, write_gaze_csv, write_gaze_tsv
from higvf_interfaces.recordings.gaze import MARGIN, DrawnByEye, synthetic_gaze

_PLAN = ("seed", "duration_s", "arena_m", "screen_px", "rate_hz", "px_per_deg", "gaze", "commands")
_GAZE = ("file", "format", "decimal_comma", "strokes")
_STROKE = ("from_s", "to_s", "points_m")
_COMMANDS = ("file", "format", "labels")
_LONGEST = 36_000.0  # [s]


def make_recordings(plan: Path) -> dict[str, str]:
    """Return the contents of the recordings that a plan describes, by file name.

    Raises:
        InputError: If the plan is invalid; the message gives place, value and known keys.
    """
    fields = Fields.of(read_yaml(read_text(plan, InputError), str(plan), InputError), _PLAN)
    files: dict[str, str] = {}
    if fields.has("gaze"):
        gaze = Fields.of(fields.required("gaze"), _GAZE)
        files[_file_name(gaze)] = _gaze_text(fields, gaze)
    for item in fields.nodes("commands"):
        log = Fields.of(item, _COMMANDS)
        files[_file_name(log)] = _command_text(log)
    return files


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    parser = argparse.ArgumentParser(prog="python -m higvf_interfaces.recordings", description=__doc__)
    parser.add_argument("out_dir", type=Path, help="folder that receives the recordings")
    parser.add_argument("--plan", type=Path, required=True, help="YAML plan of strokes and labels")
    given = parser.parse_args(arguments)
    try:
        files = make_recordings(given.plan)
        given.out_dir.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            (given.out_dir / name).write_text(text, encoding="utf-8", newline="")
            print(given.out_dir / name)
    except (HigvfError, OSError) as problem:
        print(problem, file=sys.stderr)
        return 2
    return 0


def _gaze_text(plan: Fields, gaze: Fields) -> str:
    arena, screen = Arena(*plan.numbers("arena_m", 4)), plan.numbers("screen_px", 2)
    if arena.width <= 0 or arena.height <= 0:
        raise plan.required("arena_m").wrong("[x_min, y_min, x_max, y_max]")
    if min(screen) < 1:
        raise plan.required("screen_px").wrong("[width, height]")
    duration = plan.number("duration_s", None, 1.0, _LONGEST, "s")
    samples = synthetic_gaze(
        _strokes(gaze, duration),
        duration,
        fit(arena, screen[0], screen[1]),
        seed=plan.whole("seed", 0),
        rate=plan.number("rate_hz", 120.0, 30.0, 2000.0, "Hz"),
        px_per_deg=plan.number("px_per_deg", PX_PER_DEG, 1.0, 1000.0, "px/deg"),
    )
    if gaze.choice("format", tobii_prolab.NAME, (tobii_prolab.NAME, gaze_csv.NAME)) == gaze_csv.NAME:
        return write_gaze_csv(samples)
    return write_gaze_tsv(samples, (screen[0], screen[1]), decimal_comma=gaze.flag("decimal_comma", False))


def _strokes(gaze: Fields, duration: float) -> list[DrawnByEye]:
    strokes: list[DrawnByEye] = []
    free_from = 0.0
    for item in gaze.nodes("strokes"):
        fields = Fields.of(item, _STROKE)
        start = fields.number("from_s", None, free_from, duration, "s")
        end = fields.number("to_s", None, start + 1.0, duration, "s")
        strokes.append(DrawnByEye(start, end, fields.required("points_m").points(least=2)))
        free_from = end + 2 * MARGIN
    return strokes


def _command_text(log: Fields) -> str:
    decisions = [_decision(item) for item in log.nodes("labels")]
    usual = command_log.JSON_NAME if _file_name(log).endswith(".jsonl") else command_log.CSV_NAME
    chosen = log.choice("format", usual, (command_log.CSV_NAME, command_log.JSON_NAME))
    return write_command_jsonl(decisions) if chosen == command_log.JSON_NAME else write_command_csv(decisions)


def _decision(item: Node) -> Decision:
    match item.value:
        case [time, str() as label] if is_number(time):
            return Decision(float(time), label, None)
        case [time, str() as label, trust] if is_number(time) and is_number(trust) and 0 <= trust <= 1:
            return Decision(float(time), label, float(trust))
        case _:
            raise item.wrong("[seconds, label] or [seconds, label, confidence from 0 to 1]")


def _file_name(fields: Fields) -> str:
    name = fields.text("file")
    if Path(name).name != name:
        raise fields.required("file").wrong("a plain file name")
    return name

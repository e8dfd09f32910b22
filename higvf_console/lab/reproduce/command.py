"""The command `higvf reproduce`: runs cases and writes the report."""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from higvf_console.core.errors import HigvfError
from higvf_console.core.optional import require

OUT = Path("reproduction")


def reproduce(
    names: Sequence[str], out: Path | None, json_file: str | None, prepare: Callable[[], object] | None = None
) -> None:
    """Runs cases, with a progress bar on standard error, and writes report.html, report.md and report.json.

    Args:
        names: names of the cases; empty = all.
        out: folder of the report; None = `reproduction`, or no report if the JSON goes to standard output.
        json_file: additional file for the JSON; "-" = standard output.
        prepare: called after the names are checked and before the first case, e.g. to compile the engine.

    Raises:
        HigvfError: an unknown case, a package of the extra `report` is missing, or a file cannot be written.
    """
    for module in ("matplotlib", "tqdm"):
        require(module, "report", "higvf reproduce")
    from higvf_console.lab.reproduce.registry import choose  # noqa: PLC0415 (needs matplotlib)
    from higvf_console.lab.reproduce.report.write import write_report  # noqa: PLC0415
    from higvf_console.lab.reproduce.results import run_cases  # noqa: PLC0415

    cases = choose(names)
    if prepare is not None:
        prepare()
    results = run_cases(cases)
    if out is not None or json_file != "-":
        _log(f"Report: {write_report(results, out or OUT)}")
    if json_file == "-":
        sys.stdout.write(results.json())
    elif json_file is not None:
        _write(Path(json_file), results.json())


def _write(file: Path, text: str) -> None:
    try:
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        raise HigvfError(f"--json {file}: {error.strerror}") from error


def _log(text: str) -> None:
    print(text, file=sys.stderr)

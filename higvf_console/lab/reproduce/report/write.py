"""Writes a reproduction to a folder: report.html, report.md with figures/, report.json."""

from pathlib import Path

from higvf_console.core.errors import HigvfError
from higvf_console.lab.reproduce.figures.canvas import rendered
from higvf_console.lab.reproduce.report.markdown import markdown_report
from higvf_console.lab.reproduce.report.page import html_report
from higvf_console.lab.reproduce.results import Results


def write_report(results: Results, folder: Path) -> Path:
    """Draws all pictures and writes all files.

    Args:
        results: findings to report.
        folder: created if it does not exist.

    Returns:
        The path of report.html.

    Raises:
        HigvfError: a file cannot be written.
    """
    pictures = [picture for result in results.results for picture in result.findings.pictures]
    files = {picture.name: rendered(picture.draw, "svg", "png") for picture in pictures}
    page = folder / "report.html"
    try:
        (folder / "figures").mkdir(parents=True, exist_ok=True)
        for name, endings in files.items():
            (folder / "figures" / f"{name}.png").write_bytes(endings["png"])
        page.write_text(html_report(results, {name: f["svg"] for name, f in files.items()}), encoding="utf-8")
        (folder / "report.md").write_text(markdown_report(results), encoding="utf-8")
        (folder / "report.json").write_text(results.json(), encoding="utf-8")
    except OSError as error:
        raise HigvfError(f"--out {folder}: {error.strerror}") from error
    return page

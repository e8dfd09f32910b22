"""The documentation site is built without a warning."""

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("sphinx", reason="the extra `docs` is not installed")

from docs._ext.docstrings import plain_text

DOCS = Path(__file__).parents[2] / "docs"


def test_the_site_is_built_without_a_warning_and_shows_what_is_generated(tmp_path: Path) -> None:
    arguments = ["--nitpicky", "--fail-on-warning", "--quiet", "-d", str(tmp_path / "trees"), str(DOCS), str(tmp_path)]
    done = subprocess.run([sys.executable, "-m", "sphinx", *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "jitter_m" in (tmp_path / "reference" / "scenario.html").read_text(encoding="utf-8")
    assert "<math" in (tmp_path / "explanation" / "derivations.html").read_text(encoding="utf-8")
    assert "run_headless" in (tmp_path / "reference" / "api.html").read_text(encoding="utf-8")


def test_norms_and_products_of_a_docstring_are_no_markup() -> None:
    lines = ["The largest |v_s| * 2, `|v|` in code."]
    plain_text(None, "function", "name", None, None, lines)
    assert lines == [r"The largest \|v_s\| \* 2, `|v|` in code."]


def test_an_indented_block_of_a_docstring_keeps_its_columns_and_sections_stay() -> None:
    lines = ["Steps:", "", "    one   first", "    two   second", "", "Args:", "    x: a number"]
    plain_text(None, "function", "name", None, None, lines)
    assert lines == ["Steps:", "", "::", "", "    one   first", "    two   second", "", "Args:", "    x: a number"]

"""Links between the project's documents lead somewhere, and the checker sees when they do not."""

from pathlib import Path

import pytest

from docs.check_links import anchors, broken_links, documents, main

ROOT = Path(__file__).parents[2]


def test_no_link_of_the_project_is_broken() -> None:
    assert [line for file in documents(ROOT) for line in broken_links(file)] == []


def test_the_documents_of_the_root_the_interfaces_and_the_site_are_checked() -> None:
    names = {str(file.relative_to(ROOT)) for file in documents(ROOT)}
    assert {"README.md", "CONTRIBUTING.md", "interfaces/README.md", "docs/index.md"} <= names


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("see [there](nowhere.md)", "no such file"),
        ("see ![a picture](nowhere.png)", "no such file"),
        ("see [below](#nothing)", "no such heading"),
        ("# Title\n\nsee [above](#titles)", "no such heading"),
    ],
)
def test_a_link_to_nowhere_is_reported_with_its_line(tmp_path: Path, text: str, reason: str) -> None:
    file = tmp_path / "page.md"
    file.write_text(text)
    (found,) = broken_links(file)
    assert f"{file}:{text.count(chr(10)) + 1}:" in found
    assert reason in found


@pytest.mark.parametrize(
    "text",
    [
        "# The title, twice\n\n[above](#the-title-twice)",
        "```\n[code](nowhere.md)\n```",
        "the syntax `[text](nowhere.md)`",
        "[elsewhere](https://example.org/nowhere)",
        "[itself](page.md)",
    ],
)
def test_what_leads_somewhere_and_what_is_no_link_is_left_alone(tmp_path: Path, text: str) -> None:
    file = tmp_path / "page.md"
    file.write_text(text)
    assert broken_links(file) == []


def test_a_repeated_heading_gets_a_number() -> None:
    assert anchors("# Keys\n\n## Keys\n\n```\n# no heading\n```\n") == {"keys", "keys-1"}


def test_an_anchor_of_an_included_document_counts(tmp_path: Path) -> None:
    (tmp_path / "inner.md").write_text("# Inside\n")
    (tmp_path / "outer.md").write_text("```{include} inner.md\n```\n")
    (tmp_path / "page.md").write_text("[there](outer.md#inside)")
    assert broken_links(tmp_path / "page.md") == []


def test_the_exit_status_tells_whether_a_link_is_broken(tmp_path: Path) -> None:
    (tmp_path / "page.md").write_text("[there](nowhere.md)")
    assert main([str(tmp_path)]) == 1
    (tmp_path / "page.md").write_text("no link")
    assert main([str(tmp_path)]) == 0

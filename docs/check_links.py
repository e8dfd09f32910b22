"""Checks the links between the project's documents: every file that a link names exists, and so does every anchor.

Looks at relative links of the Markdown files in the repository and of the pages in `docs`; nothing is fetched from the
network. Usage: `python docs/check_links.py [FOLDER]`. Exit status 1 where a link is broken, with a line for each.
"""

import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
_SKIPPED = {".git", ".venv", "node_modules", "_build", "_ext"}
_FENCE = re.compile(r"^(`{3,}|~{3,}).*?^\1`*\s*$", re.MULTILINE | re.DOTALL)
_CODE = re.compile(r"(`+)(?!`).+?(?<!`)\1(?!`)", re.DOTALL)
_LINK = re.compile(r"!?\[(?:[^\]\[]|\[[^\]]*\])*\]\(([^)\s]+)(?:\s+\"[^\"]*\")?\)")
_HEADING = re.compile(r"^#{1,6}\s+(.+?)\s*#*$", re.MULTILINE)
_INCLUDE = re.compile(r"^```\{include\} (\S+)$", re.MULTILINE)
_REMOTE = re.compile(r"[a-z][a-z0-9+.-]*:", re.IGNORECASE)


def documents(folder: Path) -> Iterator[Path]:
    """The Markdown files under `folder`, in order."""
    for file in sorted(folder.rglob("*.md")):
        if not _SKIPPED & set(file.relative_to(folder).parts):
            yield file


def anchors(text: str) -> set[str]:
    """The anchors of a document's headings: lower case, no punctuation, hyphens for spaces, numbers on repeats."""
    found: set[str] = set()
    for title in _HEADING.findall(_FENCE.sub("", text)):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title).lower()
        slug = re.sub(r"[^\w\- ]", "", words).strip().replace(" ", "-")
        number, name = 0, slug
        while name in found:
            number += 1
            name = f"{slug}-{number}"
        found.add(name)
    return found


def broken_links(file: Path) -> list[str]:
    """What is wrong with the links of one document, a line each: place, link, reason."""
    text = file.read_text(encoding="utf-8")
    found: list[str] = []
    for match in _LINK.finditer(_blanked(text)):
        target = match[1]
        if _REMOTE.match(target):
            continue
        line = text.count("\n", 0, match.start()) + 1
        reason = _wrong(file, target)
        if reason:
            found.append(f"{file}:{line}: {target}: {reason}")
    return found


def _blanked(text: str) -> str:
    """The text with blocks and spans of code made blank; lengths and lines stay."""
    for pattern in (_FENCE, _CODE):
        text = pattern.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)
    return text


def _wrong(file: Path, target: str) -> str:
    name, _, anchor = target.partition("#")
    path = (file.parent / name).resolve() if name else file
    if not path.exists():
        return "there is no such file"
    if not anchor:
        return ""
    if path.suffix != ".md":
        return "only Markdown files have anchors"
    return "" if anchor in _with_included(path) else f"{path.name} has no such heading"


def _with_included(path: Path) -> set[str]:
    """The anchors of a document and of the documents that it includes."""
    text = path.read_text(encoding="utf-8")
    found = anchors(text)
    for name in _INCLUDE.findall(text):
        found |= _with_included((path.parent / name).resolve())
    return found


def main(arguments: list[str]) -> int:
    """Checks every document under a folder, by default the repository; the exit status."""
    folder = Path(arguments[0]) if arguments else ROOT
    files = list(documents(folder))
    broken = [line for file in files for line in broken_links(file)]
    print("\n".join([*broken, f"{len(files)} documents, {len(broken)} broken links"]))
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

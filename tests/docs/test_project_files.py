"""The files around the code agree with each other: versions, locked dependencies, hooks."""

import re
import tomllib
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
HASHED = (ROOT / "requirements-hashed.txt").read_text(encoding="utf-8")
CONSTRAINTS = (ROOT / "constraints.txt").read_text(encoding="utf-8")


def pins(text: str) -> set[str]:
    return {line.removesuffix("\\").strip() for line in text.splitlines() if re.match(r"[a-z0-9]", line)}


def test_the_hashed_list_pins_what_the_constraints_pin() -> None:
    assert pins(HASHED) == pins(CONSTRAINTS)


def test_every_package_of_the_hashed_list_has_a_hash() -> None:
    blocks = re.split(r"\n(?=[a-z0-9])", HASHED)
    assert all("--hash=sha256:" in block for block in blocks)


def test_every_dependency_is_pinned() -> None:
    extras = [name for extra in PROJECT["optional-dependencies"].values() for name in extra]
    named = {
        re.split(r"[\[<>=~! ;]", line)[0].lower().replace("_", "-") for line in [*PROJECT["dependencies"], *extras]
    }
    assert named - {"higvf-console"} <= {pin.partition("==")[0] for pin in pins(CONSTRAINTS)}


def test_no_list_of_packages_names_a_place_to_get_them() -> None:
    assert not re.search(r"://|--index|--find-links|--trusted", HASHED + CONSTRAINTS)


def test_the_version_is_the_same_everywhere() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["version"] == PROJECT["version"]
    assert f"## [{PROJECT['version']}] - {citation['date-released']}" in (ROOT / "CHANGELOG.md").read_text(
        encoding="utf-8"
    )


def test_the_hooks_run_what_make_check_runs() -> None:
    recipe = re.search(r"^check:.*\n((?:\t.*\n)+)", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    assert recipe is not None
    checks = {line.strip().replace("$(BIN)", ".venv/bin").removesuffix(" .") for line in recipe[1].splitlines()}
    (local,) = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8"))["repos"]
    assert {hook["entry"] for hook in local["hooks"]} == checks


def test_the_public_workflow_runs_actions_by_commit_not_by_a_tag_that_may_move() -> None:
    text = (ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8")
    actions = re.findall(r"uses: (\S+)", text)
    assert actions
    assert all(re.fullmatch(r"[\w/-]+@[0-9a-f]{40}", action) for action in actions)


def test_the_public_workflow_covers_the_versions_that_the_readme_names() -> None:
    flow = yaml.safe_load((ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8"))
    (job,) = flow["jobs"].values()
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert all(version in readme for version in job["strategy"]["matrix"]["python"])

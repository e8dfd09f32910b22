"""Whatever a text holds, it is read strictly or refused in one sentence with file, place, value and choices."""

import gc
import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from higvf_console.core.errors import HigvfError, InputError, ScenarioError, ScriptError
from higvf_console.core.quantity import Quantity
from higvf_console.core.reading.document import MOST_REPEATED, read_text, read_yaml, without_collections, yaml_text
from higvf_console.core.reading.node import Node

SPEED = Quantity("m/s", 0.0, 10.0, "v", "A speed.")


def value_of(text: str) -> Any:
    return read_yaml(f"v: {text}", "f.yaml").section(("v",))["v"].value


@pytest.mark.parametrize(
    "text", ["on", "off", "yes", "no", "y", "0x10", "010", "12:30", "2026-03-02", "1_000", "<<", "="]
)
def test_words_of_other_versions_of_yaml_are_text(text: str) -> None:
    assert value_of(text) == text


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("true", True), ("false", False), ("null", None), ("~", None), ("", None), ("12", 12), ("-3", -3),
        ("1e3", 1000.0),
        ("1.5e-3", 0.0015), (".5", 0.5), ("5.", 5.0), (".inf", math.inf), ("-.inf", -math.inf), ("'on'", "on"),
    ],
)  # fmt: skip
def test_types_are_those_of_yaml_1_2(text: str, value: object) -> None:
    found = value_of(text)
    assert (found, type(found)) == (value, type(value))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: 1\na: 2", "f.yaml: line 2: key 'a' is given twice"),
        ("{b: {a: 1, a: 2}}", "f.yaml: line 1: key 'a' is given twice"),
        ("1: a", "f.yaml: line 1: key 1 is not text"),
        ("[a]: b", "f.yaml: line 1: key ['a'] is not text"),
        ("a: [", "f.yaml: line 1: "),
        ("a: *b", "f.yaml: line 1: found undefined alias"),
        ("&a [*a]", "f.yaml: line 1: a value holds itself by an alias"),
        ("a: &a {b: *a}", "f.yaml: line 1: a value holds itself by an alias"),
        ("a: !!int x", "f.yaml: line 1: 'x' cannot be read as 'int'"),
        ("a: " + "9" * 5000, "cannot be read as 'int'"),
        ("a: !!python/name:os.system", "f.yaml: line 1: could not determine a constructor"),
        ("--- a\n--- b", "f.yaml: line 2: but found another document"),
        ("a: \x00", "f.yaml: unacceptable character"),
        ("", "f.yaml: the file is empty"),
        ("# a remark", "f.yaml: the file is empty"),
        ("[" * 200, "f.yaml: brackets are nested over 100 deep"),
        ("- " * 5000 + "a", "f.yaml: lists or sections are nested too deeply"),
    ],
)
def test_what_is_not_strict_yaml_is_refused_with_its_line(text: str, message: str) -> None:
    for raises in (ScenarioError, ScriptError):
        with pytest.raises(raises) as refusal:
            read_yaml(text, "f.yaml", raises)
        assert message in str(refusal.value)
        assert "\n" not in str(refusal.value)


def test_a_short_text_cannot_stand_for_a_huge_one() -> None:
    tenfold = ", ".join(f"&a{k} [{f'*a{k - 1}, ' * 10}]" for k in range(1, 30))
    with pytest.raises(ScenarioError, match=rf"line 1: aliases repeat over {MOST_REPEATED} values"):
        read_yaml(f"a: [&a0 [x], {tenfold}]", "f.yaml")


def test_an_alias_that_repeats_a_little_is_what_it_stands_for() -> None:
    assert read_yaml("a: &p [1, 2]\nb: [*p, *p]", "f.yaml").value == {"a": [1, 2], "b": [[1, 2], [1, 2]]}


def test_a_long_list_without_aliases_is_no_repetition() -> None:
    assert len(read_yaml("[" + "1, " * (MOST_REPEATED + 10) + "]", "f.yaml").value) == MOST_REPEATED + 10


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    (tmp_path / "bytes").write_bytes(b"\xff\xfe")
    for name, reason in (("none", "No such file"), ("bytes", "not UTF-8 text"), (".", "Is a directory")):
        with pytest.raises(InputError, match=reason):
            read_text(tmp_path / name, InputError)
    (tmp_path / "marked").write_bytes(b"\xef\xbb\xbfa: 1")
    assert read_text(tmp_path / "marked") == "a: 1", "a byte order mark is no part of the text"


def test_an_error_names_file_place_value_and_choices() -> None:
    root = read_yaml("{team: [{speed: 11, mode: fly, at: [1]}]}", "f.yaml", InputError)
    robot = root.section(("team",))["team"].items()[0].section(("speed", "mode", "at"))
    for refused, message in (
        (lambda: robot["speed"].number(SPEED), "f.yaml: team[1].speed: 11 is not a number from 0 to 10 m/s"),
        (lambda: robot["mode"].choice(("walk", "swim")), "f.yaml: team[1].mode: 'fly' is not one of walk, swim"),
        (robot["at"].point, "f.yaml: team[1].at: [1] is not a point [x, y]"),
        (lambda: robot["at"].numbers(2), "f.yaml: team[1].at: [1] is not a list of 2 numbers"),
        (robot["at"].points, "f.yaml: team[1].at[1]: 1 is not a point [x, y]"),
        (lambda: robot["speed"].integer(12), "f.yaml: team[1].speed: 11 is not a whole number from 12 up"),
        (lambda: robot["speed"].integer(1, 3, "a crew"), "speed: 11 is not a crew, a whole number from 1 to 3"),
        (robot["speed"].flag, "f.yaml: team[1].speed: 11 is not true or false"),
        (robot["speed"].text, "f.yaml: team[1].speed: 11 is not a text"),
        (robot["speed"].items, "f.yaml: team[1].speed: 11 is not a list"),
        (lambda: robot["speed"].section(("a", "b")), "f.yaml: team[1].speed: 11 is not a section with the keys a, b"),
        (lambda: root.section(("tea",)), "f.yaml: team: unknown key (did you mean 'tea'?); value [{"),
        (lambda: root.section(("team",), ("name",)), "f.yaml: the key 'name' is missing; known keys: team"),
    ):  # fmt: skip
        with pytest.raises(InputError) as refusal:
            refused()
        assert message in str(refusal.value)


@pytest.mark.parametrize("value", [True, "1", None, math.nan, math.inf, 10**400, -(10**400), -0.1, [1]])
def test_a_number_is_finite_and_in_range_and_no_boolean(value: object) -> None:
    with pytest.raises(ScriptError, match=r"f: v: .* is not a number from 0 to 10 m/s"):
        Node(value, "f", "v", ScriptError).number(SPEED)


@pytest.mark.parametrize("value", [True, 1.0, "1", None, 0, 4, 10**400])
def test_a_whole_number_is_no_boolean_and_no_fraction_and_in_range(value: object) -> None:
    with pytest.raises(ScriptError, match=r"f: v: .* is not a whole number from 1 to 3"):
        Node(value, "f", "v", ScriptError).integer(1, 3)


def test_a_renamed_key_is_read_with_a_warning_that_names_the_new_one() -> None:
    root = read_yaml("{edit: {thing: bar, use: amend}}", "f.yaml")
    edit = root.section(("edit",))["edit"].section(("kind", "use"), ("kind",), {"thing": "kind"})
    assert edit["kind"].value == "bar"
    assert edit["use"].choice(("path", "redraw"), {"amend": "redraw"}) == "redraw"
    assert root.warnings == [
        "f.yaml: edit.thing: renamed; write edit.kind",
        "f.yaml: edit.use: amend is renamed; write redraw",
    ]


@pytest.mark.parametrize("text", ["{thing: bar, kind: fire}", "{kind: fire, thing: bar}"])
def test_a_key_given_under_both_its_names_is_refused(text: str) -> None:
    with pytest.raises(ScenarioError, match="thing is the former name of kind, which is given too"):
        read_yaml(text, "f.yaml").section(("kind",), renamed={"thing": "kind"})


def test_a_former_name_is_not_among_the_known_ones_of_an_error() -> None:
    with pytest.raises(ScenarioError, match=r"thong: unknown key; value 1; known keys: kind$"):
        read_yaml("{thong: 1}", "f.yaml").section(("kind",), renamed={"thing": "kind"})


TEXTS = st.text(st.sampled_from("ab01:,-.[]{}&*!|>#'\"%@`?~ \n\t<=eon\\/\x00\u2028\ufeff"), max_size=60)


@given(text=TEXTS)
@example(text="!!set {a}")
@example(text="!!binary =")
@example(text="!!timestamp 2026-13-40")
@example(text="? a\n: b")
@example(text="%YAML 9.9\n---\na")
def test_any_text_is_read_or_refused_in_one_sentence_with_its_source(text: str) -> None:
    try:
        node = read_yaml(text, "f.yaml", InputError)
    except InputError as refusal:
        assert str(refusal).startswith("f.yaml: ")
        assert "\n" not in str(refusal)
    else:
        assert node.value is not None


@given(value=st.recursive(st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5), st.lists))
def test_every_check_accepts_a_value_or_raises_the_callers_error(value: object) -> None:
    node = Node(value, "f", "v", ScriptError)
    for check in (
        node.flag, node.text, node.items, node.point, node.points, node.mapping, lambda: node.number(SPEED),
        lambda: node.integer(0), lambda: node.choice(("a",)), lambda: node.numbers(2), lambda: node.section(("a",)),
    ):  # fmt: skip
        try:
            check()
        except ScriptError as refusal:
            assert str(refusal).startswith("f: v")


KEYS = st.text(min_size=1, max_size=8)
LEAVES = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=12)
VALUES = st.recursive(LEAVES, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(KEYS, inner, max_size=3))


@given(content=st.dictionaries(KEYS, VALUES, min_size=1, max_size=4))
@example(content={"on": "on", "v": "1e3", "w": "0x10", "t": "12:30", "n": "null", "m": "<<", "e": ""})
def test_what_is_written_is_read_back_as_the_same(content: dict[str, object]) -> None:
    text = yaml_text(content)
    try:
        again = read_yaml(text, "f.yaml").value
    except HigvfError as refusal:  # letters that YAML does not allow are written escaped; brackets in texts count
        assert "brackets" in str(refusal)
    else:
        assert again == content


def test_no_garbage_is_collected_while_a_document_is_read_and_as_before_afterwards() -> None:
    collects: list[bool] = []

    @without_collections()
    def read(*, fails: bool = False) -> None:
        collects.append(gc.isenabled())
        with without_collections():
            pass
        collects.append(gc.isenabled())
        if fails:
            raise ScenarioError("no")

    read()
    with pytest.raises(ScenarioError):
        read(fails=True)
    assert collects == [False] * 4
    assert gc.isenabled()
    gc.disable()
    try:
        read()
        assert not gc.isenabled()
    finally:
        gc.enable()

"""What a page may say: every field of every message has a type, a range and a size."""

import math
import re
from pathlib import Path
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

import higvf_console.ui
from higvf_console.ui.page.message_table import BODIES, MOST_POINTS, PIECE_BYTES, checked
from higvf_console.ui.page.refusals import MOST_CHARACTERS, RefusedError

UI = Path(higvf_console.ui.__file__).parent
CAMERA = {
    "wxyz": [1, 0, 0, 0.0], "position": [0, 0, 900.5], "fov": 0.17, "near": 1.0, "far": 2e4, "image_height": 700,
    "image_width": 900, "look_at": [0, 0, 0], "up_direction": [0, 1, 0],
}  # fmt: skip
HONEST: dict[str, dict[str, Any]] = {
    "alive": {},
    "calibration": {},
    "card": {"act": "load", "value": "shipped:firefighting"},
    "click": {"point": [600, 350.5], "group": False},
    "control": {"act": "grant", "page": "Browser 2"},
    "file": {"kind": "scenario", "name": "a.yaml", "size": 3, "part": 0, "parts": 1, "content": "YWJj"},
    "hello": {"identity": "0123456789abcdef"},
    "key": {"name": "pick_1", "number": 1764518400000},
    "landscape": {},
    "read": {"text": "Robot 1 is lost."},
    "run": {"act": "speed", "value": "2x"},
    "stroke": {"id": 1764518400000, "sequence": 0, "phase": "start", "points": [600, 350.5], "group": True},
    "tool": {"name": "move_point"},
    "viewport": {
        "page": [1280, 720], "canvas": [0, 0, 960.5, 720], "pixel_ratio": 2, "centre": [600, 350],
        "metres_per_px": 1.25,
    },
}  # fmt: skip


def frame(kind: str, **fields: Any) -> bytes:
    return msgspec.msgpack.encode({"type": kind, **fields})


def of_page(topic: str, body: object) -> bytes:
    return frame("PageMessage", topic=topic, body=body)


def test_the_table_has_an_honest_message_of_each_topic_and_lets_it_pass() -> None:
    assert HONEST.keys() == BODIES.keys()
    for topic, body in HONEST.items():
        checked(of_page(topic, body))


def test_the_table_has_a_row_for_each_topic_that_a_script_sends_and_for_each_that_the_console_hears() -> None:
    scripts = "".join(file.read_text(encoding="utf-8") for file in (UI / "page" / "browser_js").glob("*.js"))
    modules = "".join(file.read_text(encoding="utf-8") for file in UI.rglob("*.py"))
    sent = re.findall(r'page\.send\((?:"(\w+)"|.)', scripts)
    heard = re.findall(r'page\.listen\((?:self\._)?server, (?:"(\w+)"|.)', modules)
    assert set(sent) == BODIES.keys()
    assert sorted(heard) == sorted(BODIES)


@pytest.mark.parametrize("value", [True, 3, -2.5, "", "a choice", "x" * 4000])
def test_values_of_widgets_pass(value: object) -> None:
    checked(frame("GuiUpdateMessage", uuid="u", updates={"value": value}))


def test_viser_s_camera_and_palette_pass() -> None:
    checked(frame("ViewerCameraMessage", **CAMERA))
    checked(frame("CommandTriggerMessage", uuid="u"))


WRONG: dict[str, bytes | str] = {
    "text": "hello",
    "nothing": b"",
    "no MessagePack": b"\xc1\xc1",
    "deep nesting": frame("PageMessage", topic="alive", body={})[:-1] + b"\x91" * 100_000,
    "an unknown topic": of_page("x" * 10_000, {}),
    "another topic": of_page("nonsense", {}),
    "no body": frame("PageMessage", topic="alive"),
    "a further field": of_page("alive", {"more": 1}),
    "a further field of the message": frame("CommandTriggerMessage", uuid="u", more=1),
    "an attribute of a widget": frame("GuiUpdateMessage", uuid="u", updates={"update_cb": []}),
    "a list for a widget": frame("GuiUpdateMessage", uuid="u", updates={"value": [1]}),
    "a long text": frame("GuiUpdateMessage", uuid="u", updates={"value": "x" * 4001}),
    "a camera that is nowhere": frame("ViewerCameraMessage", **CAMERA | {"position": [0, 0, math.nan]}),
    "a camera in two dimensions": frame("ViewerCameraMessage", **CAMERA | {"position": [0, 0]}),
    "a click of one number": of_page("click", HONEST["click"] | {"point": [1]}),
    "a click far away": of_page("click", HONEST["click"] | {"point": [1e7, 0]}),
    "a click at infinity": of_page("click", HONEST["click"] | {"point": [math.inf, 0]}),
    "a short identity": of_page("hello", {"identity": "short"}),
    "a long identity": of_page("hello", {"identity": "x" * 65}),
    "a truth value for a number": of_page("key", {"name": "stop", "number": True}),
    "a negative number": of_page("key", {"name": "stop", "number": -1}),
    "a phase of its own": of_page("stroke", HONEST["stroke"] | {"phase": "pause"}),
    "too many points": of_page("stroke", HONEST["stroke"] | {"points": [0.0] * (2 * MOST_POINTS + 1)}),
    "a page without a scale": of_page("viewport", HONEST["viewport"] | {"metres_per_px": 0}),
    "too large a piece": of_page("file", HONEST["file"] | {"content": "A" * (2 * PIECE_BYTES)}),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_what_does_not_fit_is_refused_in_one_short_line(name: str) -> None:
    with pytest.raises(RefusedError) as refused:
        checked(WRONG[name])
    assert 0 < len(str(refused.value)) <= MOST_CHARACTERS
    assert str(refused.value).isprintable()


EDGES: list[tuple[str, str, object, object]] = [  # topic, field, the last value that passes, the first that does not
    ("key", "number", 2**53, 2**53 + 1),
    ("key", "number", 0, -1),
    ("key", "name", "x" * 32, "x" * 33),
    ("click", "point", [1e6, -1e6], [1e6, -1.000001e6]),
    ("click", "point", [-1e6, 1e6], [1.000001e6, 0.0]),
    ("control", "page", "x" * 80, "x" * 81),
    ("hello", "identity", "x" * 16, "x" * 15),
    ("hello", "identity", "x" * 64, "x" * 65),
    ("read", "text", "x" * 4000, "x" * 4001),
    ("file", "name", "x" * 1024, "x" * 1025),
    ("stroke", "points", [1.0] * (2 * MOST_POINTS), [1.0] * (2 * MOST_POINTS + 1)),
    ("viewport", "page", [1e5, -1e5], [1.00001e5, 0.0]),
    ("viewport", "page", [-1e5, 1e5], [0.0, -1.00001e5]),
    ("viewport", "pixel_ratio", 32.0, 32.01),
    ("viewport", "pixel_ratio", 1e-9, 0.0),
    ("viewport", "metres_per_px", 1e6, 1.000001e6),
]


@pytest.mark.parametrize(("topic", "field", "last", "beyond"), EDGES)
def test_each_range_and_size_ends_where_it_says(topic: str, field: str, last: object, beyond: object) -> None:
    checked(of_page(topic, HONEST[topic] | {field: last}))
    with pytest.raises(RefusedError, match=f"^{topic} {field}"):
        checked(of_page(topic, HONEST[topic] | {field: beyond}))


def test_the_ranges_of_viser_s_own_messages_end_where_they_say() -> None:
    for field, last, beyond in (("far", 1e12, 1.000001e12), ("image_width", 100_000, 100_001), ("fov", -1e12, -2e12)):
        checked(frame("ViewerCameraMessage", **CAMERA | {field: last}))
        with pytest.raises(RefusedError, match=f"^message {field}"):
            checked(frame("ViewerCameraMessage", **CAMERA | {field: beyond}))
    checked(frame("CommandTriggerMessage", uuid="u" * 64))
    with pytest.raises(RefusedError, match=r"^message uuid"):
        checked(frame("CommandTriggerMessage", uuid="u" * 65))
    checked(frame("GuiUpdateMessage", uuid="u", updates={"value": 1e300}))
    with pytest.raises(RefusedError, match=r"^message"):
        checked(frame("GuiUpdateMessage", uuid="u", updates={"value": 1.1e300}))


values = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**63), 2**64 - 1) | st.floats() | st.text() | st.binary(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=8,
)


@given(st.sampled_from(sorted(HONEST)), st.data())
def test_a_generated_value_in_a_field_passes_or_is_refused(topic: str, data: st.DataObject) -> None:
    body: dict[str, object] = dict(HONEST[topic])
    field = data.draw(st.sampled_from([*body, "other"]))
    body[field] = data.draw(values)
    try:
        _, fields = checked(of_page(topic, body))
    except RefusedError as refused:
        assert refused.kind in {"message ", "topic"} | {f"{topic} {name}" for name in ("", *body)}
    else:
        assert type(fields) is BODIES[topic]


@given(st.binary(max_size=200))
def test_random_bytes_pass_or_are_refused(content: bytes) -> None:
    with pytest.raises(RefusedError):
        checked(content)

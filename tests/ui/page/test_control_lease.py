"""Who of several pages steers: one at a time, handed over by clicks, and never kept by a page that has gone."""

from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from higvf_console.core.commands import ControlChange
from higvf_console.ui.page.control_lease import (
    MOST_PAGES,
    Change,
    Control,
    Outcome,
    answered,
    asked,
    forgotten,
    heartbeat,
    released,
    taken,
)

PATIENCE = 8.0  # [s]


def with_pages(*identities: str, at: float = 0.0) -> Control:
    control = Control()
    for identity in identities:
        control, _ = heartbeat(control, identity, at)
    return control


def done(control: Control, *steps: Callable[[Control], Outcome]) -> tuple[Control, list[Change]]:
    changes: list[Change] = []
    for step in steps:
        control, change = step(control)
        changes += [change] if change else []
    return control, changes


def test_the_first_page_steers_and_those_after_it_watch() -> None:
    control, change = heartbeat(Control(), "a", 0.0)
    assert change == Change(ControlChange.FIRST, "Browser 1", "Browser 1")
    control, change = heartbeat(control, "b", 1.0)
    assert change is None
    assert control.holder == "a"
    assert control.name("b") == "Browser 2"


def test_who_asks_is_told_and_the_holder_grants_it() -> None:
    control, changes = done(
        with_pages("a", "b"), lambda c: asked(c, "b"), lambda c: answered(c, "a", "Browser 2", granted=True)
    )
    assert control.holder == "b"
    assert control.waiting == ()
    assert changes == [
        Change(ControlChange.ASKED, "Browser 2", "Browser 2"),
        Change(ControlChange.GRANTED, "Browser 2", "Browser 1"),
    ]


def test_a_refused_page_waits_no_more_and_may_ask_again() -> None:
    control, changes = done(
        with_pages("a", "b"), lambda c: asked(c, "b"), lambda c: answered(c, "a", "Browser 2", granted=False)
    )
    assert (control.holder, control.waiting) == ("a", ())
    assert changes[-1] == Change(ControlChange.REFUSED, "Browser 2", "Browser 1")
    assert asked(control, "b")[0].waiting == ("b",)


def test_only_the_holder_answers_and_only_who_asked_is_answered() -> None:
    control, _ = asked(with_pages("a", "b", "c"), "b")
    for identity, name in (("b", "Browser 2"), ("c", "Browser 2"), ("a", "Browser 3"), ("a", "Browser 1"), ("a", "")):
        assert answered(control, identity, name, granted=True) == (control, None)


def test_asking_twice_is_asking_once() -> None:
    control, _ = asked(with_pages("a", "b"), "b")
    assert asked(control, "b") == (control, None)


def test_anybody_takes_over_and_the_others_that_wait_go_on_waiting() -> None:
    control, changes = done(with_pages("a", "b", "c"), lambda c: asked(c, "b"), lambda c: taken(c, "c"))
    assert (control.holder, control.waiting) == ("c", ("b",))
    assert changes[-1] == Change(ControlChange.TAKEN, "Browser 3", "Browser 3")


def test_released_control_goes_to_who_waited_longest_else_to_nobody() -> None:
    control, changes = done(
        with_pages("a", "b", "c"), lambda c: asked(c, "c"), lambda c: asked(c, "b"), lambda c: released(c, "a")
    )
    assert (control.holder, control.waiting) == ("c", ("b",))
    assert changes[-1] == Change(ControlChange.RELEASED, "Browser 3", "Browser 1")
    control, change = released(with_pages("a", "b"), "a")
    assert control.holder == ""
    assert change == Change(ControlChange.RELEASED, "", "Browser 1")


@pytest.mark.parametrize("act", [asked, taken])
def test_what_nobody_has_is_had_for_one_click(act: Callable[[Control, str], Outcome]) -> None:
    free, _ = released(with_pages("a", "b"), "a")
    control, change = act(free, "b")
    assert control.holder == "b"
    assert change == Change(ControlChange.FIRST, "Browser 2", "Browser 2")


def test_a_page_that_comes_while_nobody_steers_steers() -> None:
    free, _ = released(with_pages("a"), "a")
    assert heartbeat(free, "b", 1.0)[0].holder == "b"
    assert heartbeat(free, "a", 1.0)[0].holder == "", "who let go is no newcomer"


def test_a_reload_keeps_control_name_and_place_in_the_line() -> None:
    control, _ = asked(with_pages("a", "b"), "b")
    control, changes = done(
        control,
        lambda c: forgotten(c, 7.9, PATIENCE),
        lambda c: heartbeat(c, "b", 7.9),
        lambda c: heartbeat(c, "a", 7.9),
    )
    assert changes == []
    assert (control.holder, control.waiting, control.name("a")) == ("a", ("b",), "Browser 1")


def test_a_holder_that_falls_silent_is_lost_and_its_control_goes_to_one_that_waits_and_is_awake() -> None:
    control, _ = done(with_pages("a", "b", "c", "d"), lambda c: asked(c, "b"), lambda c: asked(c, "c"))
    control, changes = done(
        control,
        lambda c: heartbeat(c, "b", 4.0),
        lambda c: heartbeat(c, "c", 8.0),
        lambda c: forgotten(c, 8.5, PATIENCE),
    )
    assert control.holder == "c", "b has not been heard of for a while either"
    assert changes == [Change(ControlChange.LOST, "Browser 3", "Browser 1")]


def test_a_lost_holder_whom_nobody_asked_leaves_it_to_nobody() -> None:
    control, _ = heartbeat(with_pages("a", "b"), "b", 8.0)
    control, change = forgotten(control, 8.5, PATIENCE)
    assert control.holder == ""
    assert change == Change(ControlChange.LOST, "", "Browser 1")


def test_a_page_that_is_lost_while_it_watches_is_not_missed() -> None:
    control, _ = asked(with_pages("a", "b"), "b")
    control, _ = heartbeat(control, "a", 8.0)
    control, change = forgotten(control, 8.5, PATIENCE)
    assert change is None
    assert (control.holder, control.waiting) == ("a", ())


def test_no_two_pages_ever_have_the_same_name() -> None:
    control, _ = forgotten(with_pages("a"), 9.0, PATIENCE)
    assert heartbeat(control, "b", 9.0)[0].name("b") == "Browser 2"


def test_where_there_is_no_room_the_page_that_was_silent_longest_goes_and_never_the_one_that_steers() -> None:
    full = with_pages(*(str(number) for number in range(MOST_PAGES)))
    full, _ = done(full, lambda c: heartbeat(c, "1", 1.0), lambda c: asked(c, "2"))
    later, change = heartbeat(full, "one more", 2.0)
    assert change is None
    assert len(later.pages) == MOST_PAGES
    assert (later.holder, later.page("2"), later.waiting) == ("0", None, ())
    assert later.page("1") and later.page("one more")


def test_observers_get_no_control_and_leave_room_for_those_who_may_steer() -> None:
    control = Control()
    for number in range(MOST_PAGES):
        control, change = heartbeat(control, f"observer {number}", float(number), may_steer=False)
        assert change is None
    control, change = heartbeat(control, "operator", 0.0)
    assert change == Change(ControlChange.FIRST, f"Browser {MOST_PAGES + 1}", f"Browser {MOST_PAGES + 1}")
    assert control.page("observer 0") is None
    full = with_pages(*(str(number) for number in range(MOST_PAGES)))
    with pytest.raises(ValueError, match=f"{MOST_PAGES} pages that may steer"):
        heartbeat(full, "observer", 1.0, may_steer=False)


IDENTITIES = st.sampled_from(["a", "b", "c", ""])
ACTS = st.one_of(
    st.tuples(st.just("heard"), st.sampled_from(["a", "b", "c"])),
    st.tuples(st.sampled_from(["ask", "take", "release", "wait"]), IDENTITIES),
    st.tuples(st.sampled_from(["grant", "refuse"]), IDENTITIES, st.sampled_from(["Browser 1", "Browser 2", ""])),
)


@given(st.lists(ACTS, max_size=30))
def test_whatever_is_clicked_one_page_that_is_there_steers_or_nobody_and_every_change_is_told(
    acts: list[tuple[str, ...]],
) -> None:
    control, now = Control(), 0.0
    for act, identity, *name in acts:
        before = control
        match act:
            case "heard":
                control, change = heartbeat(control, identity, now)
            case "ask":
                control, change = asked(control, identity)
            case "take":
                control, change = taken(control, identity)
            case "release":
                control, change = released(control, identity)
            case "wait":
                now += 5.0
                control, change = forgotten(control, now, PATIENCE)
            case _:
                control, change = answered(control, identity, name[0], granted=act == "grant")
        present = {page.identity for page in control.pages}
        assert control.holder in present | {""}
        assert set(control.waiting) <= present - {control.holder}
        assert len(set(control.waiting)) == len(control.waiting)
        if control.holder != before.holder:
            assert change is not None
            assert change.page == control.name(control.holder)


def test_a_page_that_was_forgotten_comes_back_under_its_name_and_steers_where_nobody_does() -> None:
    control, change = forgotten(with_pages("a"), 100.0, PATIENCE)
    assert change == Change(ControlChange.LOST, "", "Browser 1")
    control, change = heartbeat(control, "a", 160.0)
    assert change == Change(ControlChange.FIRST, "Browser 1", "Browser 1")
    assert control.former == ()
    control, _ = heartbeat(control, "b", 160.0)
    assert control.name("b") == "Browser 2"


def test_only_so_many_forgotten_pages_are_remembered() -> None:
    control = Control()
    for number in range(MOST_PAGES + 5):
        control, _ = heartbeat(control, f"page {number}", 100.0 * number)
        control, _ = forgotten(control, 100.0 * number + 50.0, PATIENCE)
    assert len(control.former) == MOST_PAGES

"""The debouncer accepts one command per onset and names the stage that held each decision."""

from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from higvf_interfaces.decisions.debouncer import Debounced, Evidence, Stage, judge, observe, support
from higvf_interfaces.formats.records import Decision

STRICT = Evidence(threshold=0.3, votes=3, of=5, enter=0.8, leave=0.5, refractory=1.0)


def stages_of(labels: str, evidence: Evidence, confidence: float | None = 1.0, spacing: float = 0.1) -> list[Stage]:
    """Stages of decisions with one-letter labels; a dot means idle, a comma a gap of ten decisions."""
    state, stages, time = Debounced(), list[Stage](), 0.0
    for label in labels:
        time += spacing * (10 if label == "," else 1)
        if label == ".":
            state = observe(state, Decision(time, "idle", confidence), lambda _: evidence)
        elif label != ",":
            state, verdict = judge(state, Decision(time, label, confidence), lambda _: evidence)
            stages.append(verdict.stage)
    return stages


def passed(stages: Sequence[Stage]) -> list[int]:
    return [k for k, stage in enumerate(stages) if stage is Stage.PASSED]


def test_with_the_default_evidence_every_decision_passes() -> None:
    assert passed(stages_of("aabba", Evidence())) == [0, 1, 2, 3, 4]


def test_a_decision_below_the_threshold_is_held_there_and_one_without_confidence_is_not() -> None:
    assert stages_of("a", Evidence(threshold=0.6), 0.59) == [Stage.THRESHOLD]
    assert stages_of("a", Evidence(threshold=0.6), None) == [Stage.PASSED]


def test_a_label_needs_n_of_the_last_m_votes() -> None:
    assert stages_of("ababa", Evidence(votes=3, of=5)) == [Stage.VOTE] * 4 + [Stage.PASSED]
    assert stages_of("abbba", Evidence(votes=3, of=5))[-1] is Stage.VOTE


def test_decisions_that_are_too_old_do_not_vote() -> None:
    assert stages_of("a,a,a", Evidence(votes=2, of=3, memory=0.5)) == [Stage.VOTE] * 3
    assert stages_of("a,a,a", Evidence(votes=2, of=3, memory=5.0)) == [Stage.VOTE, Stage.PASSED, Stage.PASSED]


def test_a_label_passes_at_its_onset_and_again_only_after_its_support_has_fallen() -> None:
    stages = stages_of("aaaaaaaa......aaaaa", STRICT)
    assert passed(stages) == [3, 11]
    assert stages[:4] == [Stage.VOTE, Stage.VOTE, Stage.HYSTERESIS, Stage.PASSED]
    assert set(stages[4:8]) == {Stage.ONSET}
    assert passed(stages_of("aaaaaaaa.aaaaaaaa", STRICT)) == [3], "one idle window does not release it"


def test_support_between_leave_and_enter_changes_nothing() -> None:
    assert passed(stages_of("aaaaaaaaaa", STRICT, confidence=0.7)) == []
    assert stages_of("aaaaa", STRICT, confidence=0.7)[-1] is Stage.HYSTERESIS


def test_the_refractory_time_holds_a_new_onset() -> None:
    evidence = Evidence(enter=0.8, leave=0.5, refractory=1.0)
    assert stages_of("a.a", evidence, spacing=0.4) == [Stage.PASSED, Stage.REFRACTORY]
    assert stages_of("a.a", evidence, spacing=0.6) == [Stage.PASSED, Stage.PASSED]
    assert stages_of("a.b", evidence, spacing=0.1) == [Stage.PASSED, Stage.PASSED], "each label has its own"


def test_a_decision_without_confidence_counts_as_a_full_vote() -> None:
    votes = (Decision(0.0, "a", None), Decision(0.1, "b", 0.9), Decision(0.2, "a", 0.5))
    assert support(votes, "a", Evidence(of=3)) == pytest.approx(0.5)
    assert support(votes[:1], "a", Evidence(of=3)) == pytest.approx(1 / 3), (
        "votes that are missing are not votes for it"
    )


decisions = st.lists(
    st.tuples(st.floats(0.0, 2.0), st.sampled_from("abc"), st.one_of(st.none(), st.floats(0.0, 1.0))), max_size=40
)


@given(items=decisions)
def test_two_commands_of_a_label_are_at_least_its_refractory_time_apart(
    items: list[tuple[float, str, float | None]],
) -> None:
    state, last, time = Debounced(), dict[str, float](), 0.0
    for wait, label, confidence in items:
        time += wait
        state, verdict = judge(state, Decision(time, label, confidence), lambda _: STRICT._replace(votes=1, enter=0.3))
        if verdict.stage is Stage.PASSED:
            assert time - last.get(label, -9.0) >= STRICT.refractory
            last[label] = time


@given(items=decisions)
def test_each_onset_needs_a_release_before_the_next(items: list[tuple[float, str, float | None]]) -> None:
    state, time = Debounced(), 0.0
    for wait, label, confidence in items:
        time += wait
        before = state.active
        state, verdict = judge(state, Decision(time, label, confidence), lambda _: STRICT._replace(refractory=0.0))
        if verdict.stage is Stage.PASSED:
            assert before != label
            assert state.active == label

"""Whatever is edited and whenever: clearances hold, refusals change nothing, undo and redo are exact."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from higvf_console.core.commands import OperatorCommand, Redo, Undo
from higvf_console.runtime.run import Run
from tests.world.editing.actions import (
    EDITS,
    GIVEN,
    HAIR,
    SCENES,
    assert_same,
    edited_run,
    give,
    refused,
    shortfalls,
)

STEPS = st.one_of(
    GIVEN,
    EDITS.map(lambda edit: (edit,)),
    st.sampled_from([(Undo(),), (Redo(),)]),
    st.integers(1, 30),
)  # fmt: skip
PLANS = st.lists(STEPS, max_size=8)


def steps(run: Run, ticks: int) -> tuple[float, bool]:
    """Least clearance over some ticks [m], and whether a robot could not meet its rows in one of them."""
    least, flagged = np.inf, False
    for _ in range(ticks):
        run.step()
        least, flagged = min(least, float(run.trace.clearance.min())), flagged or bool(run.trace.infeasible.any())
    return least, flagged


@pytest.mark.parametrize("scene", SCENES)
@settings(max_examples=30)
@given(plan=PLANS)
def test_no_edit_and_no_undo_brings_anybody_nearer_to_anything_than_allowed(
    scene: str, plan: list[int | tuple[OperatorCommand, ...]]
) -> None:
    run = edited_run(scene)
    for step in plan:
        if isinstance(step, int):
            steps(run, step)
            continue
        worst = max(shortfalls(run).max(), 0.0)
        give(run, *step)
        assert shortfalls(run).max() <= worst + HAIR, step
    if shortfalls(run).max() <= HAIR:
        least, flagged = steps(run, 100)
        assert flagged or least > -1e-5


@pytest.mark.parametrize("scene", SCENES)
@settings(max_examples=60)
@given(plan=PLANS, last=GIVEN)
def test_undo_and_redo_at_once_are_exact_and_a_refusal_changes_nothing(
    scene: str, plan: list[int | tuple[OperatorCommand, ...]], last: tuple[OperatorCommand, ...]
) -> None:
    run = edited_run(scene)
    for step in plan:
        if isinstance(step, int):
            steps(run, step)
        else:
            give(run, *step)
    for command in last[:-1]:
        run.apply(command)
    before, history = run.run_state, run.history
    events = run.apply(last[-1])
    after = run.run_state
    if refused(events):
        assert run.setup is before.setup
        assert run.state.motion is before.state.motion
        assert run.state.intent is before.state.intent
        assert run.history is history
        assert events[-1].text.endswith(".")
        return
    if run.history is history:
        return
    assert not refused(run.apply(Undo()))
    assert run.setup is before.setup
    for part in ("motion", "intent"):
        assert_same(getattr(run.state, part), getattr(before.state, part), part)
    assert_same(run.tally, before.tally)
    assert not refused(run.apply(Redo()))
    assert run.setup is after.setup
    for part in ("motion", "intent"):
        assert_same(getattr(run.state, part), getattr(after.state, part), part)
    assert_same(run.tally, after.tally)

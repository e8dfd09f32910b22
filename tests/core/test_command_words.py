"""A command with a word that nobody knows fails where it is made, with the choices."""

from collections.abc import Callable

import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.commands import FaultKind, HandOver, InjectFault, ShapePath, StrokeEnd, StrokeUse
from higvf_console.core.edits import AddEntity, ChangeEntity, DeleteEntity, EntityKind, MoveEntity
from higvf_console.core.errors import ArgumentError

HERE = floats([1.0, 2.0])


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda: StrokeEnd(use="scribble"), "StrokeEnd.use: 'scribble' is not one of path, redraw, priority, obs"),
        (lambda: StrokeEnd(ending="stop"), "StrokeEnd.ending: 'stop' is not one of release, hold, loop"),
        (lambda: ShapePath(ending="Hold"), "ShapePath.ending: 'Hold' is not one of release, hold, loop"),
        (lambda: InjectFault("emg", "melt"), "InjectFault.kind: 'melt' is not one of freeze, drop, delay"),
        (lambda: HandOver("a", "stolen"), "HandOver.how: 'stolen' is not one of first, asked, refused"),
        (
            lambda: AddEntity("lake", HERE),
            "AddEntity.kind: 'lake' is not one of robot, fire, circle, bar, polygon",
        ),
        (lambda: MoveEntity("lake", 0, HERE), "MoveEntity.kind: 'lake'"),
        (lambda: ChangeEntity("lake", 0, "x", 1.0), "ChangeEntity.kind: 'lake'"),
        (lambda: DeleteEntity("", 0), "DeleteEntity.kind: ''"),
        (lambda: StrokeEnd(use=3), "StrokeEnd.use: 3"),  # pyright: ignore[reportArgumentType]
    ],
)
def test_an_unknown_word_is_refused_with_the_choices(made: Callable[[], object], message: str) -> None:
    with pytest.raises(ArgumentError) as refusal:
        made()
    assert message in str(refusal.value)


def test_known_words_and_their_members_are_taken() -> None:
    assert StrokeEnd(use=StrokeUse.REDRAW, ending="hold").use == "redraw"
    assert InjectFault("emg", FaultKind.DROP).kind == "drop"
    assert ShapePath(pace=0.5).ending is None
    assert AddEntity(EntityKind.BAR, HERE).kind == "bar"

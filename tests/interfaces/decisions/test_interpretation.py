"""Costly actions need more evidence, STOP the least, and a doubtful robot change waits for confirmation."""

from collections.abc import Callable

import pytest

from higvf_console.core.commands import Confirm, Discard, EmergencyStop, OperatorCommand, Pause, Pick, ProposePick
from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec, OperatorContext
from higvf_interfaces.decisions.bci import open_bci
from higvf_interfaces.decisions.debouncer import Stage
from higvf_interfaces.decisions.interface import DecisionReplay

ContextAt = Callable[..., OperatorContext]
Write = Callable[..., str]


def bci(write: Write, labels: str, confidence: str = "", **settings: object) -> DecisionReplay:
    """A channel with a decision every 0.1 s, starting at 0.1 s; `labels` are separated by blanks."""
    rows = (f"{0.1 * k:.1f},{label},{confidence}\n" for k, label in enumerate(labels.split(), start=1))
    return open_bci(InputSpec("bci", write("time,label,confidence\n" + "".join(rows)), settings=settings))


def given(replay: DecisionReplay, at: ContextAt) -> list[tuple[type[OperatorCommand], float]]:
    return [(type(command), round(command.time, 3)) for command in replay.poll(at(99.0))]


def test_stop_and_pause_need_one_vote_and_costly_actions_one_more(write: Write, at: ContextAt) -> None:
    def first(label: str) -> float:
        commands = given(bci(write, " ".join([label] * 8), votes="3/5", hysteresis="0.6/0.4"), at)
        return commands[0][1]

    assert first("stop") == first("pause") == 0.1
    assert first("clutch_close") == pytest.approx(0.3)
    assert first("resume") == first("next_task") == first("robot2") == pytest.approx(0.4)


def test_the_evidence_table_overrides_the_defaults(write: Write, at: ContextAt) -> None:
    table = {"stop": {"votes": "2/5"}, "robot": {"votes": "1/1", "hysteresis": "0/0"}}
    stop = bci(write, "stop stop stop", votes="3/5", evidence=table)
    assert given(stop, at)[0] == (EmergencyStop, 0.2)
    assert given(bci(write, "robot2", votes="3/5", evidence=table), at) == [(Pick, 0.1)]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"votes": "5/3"}, "votes: 5/3 is not n/m with 1 <= n <= m <= 50, such as 3/5"),
        ({"votes": 3}, "votes: 3 is not n/m"),
        ({"votes": "nan/5"}, "votes: 'nan/5' is not n/m"),
        ({"votes": "inf/5"}, "votes: 'inf/5' is not n/m"),
        ({"hysteresis": "0.5/0.8"}, "hysteresis: 0.5/0.8 is not ENTER/LEAVE with 0 <= LEAVE <= ENTER <= 1"),
        ({"evidence": {"jump": {}}}, "evidence: 'jump' is not an action; known actions: pause, resume"),
        ({"evidence": {"stop": 3}}, "evidence: stop: 3 is not a mapping with the keys threshold, votes"),
        (
            {"evidence": {"stop": {"vote": 1}}},
            "evidence: stop: vote: unknown key (did you mean 'votes'?); value 1; known keys: threshold, votes",
        ),
        ({"confirm": 2}, "confirm: 2 is not a number from 0 to 1"),
    ],
)
def test_invalid_evidence_is_refused_with_the_valid_form(
    write: Write, settings: dict[str, object], message: str
) -> None:
    with pytest.raises(InputError) as refusal:
        open_bci(InputSpec("bci", write("time,label\n1,stop\n"), settings=settings))
    assert message in str(refusal.value)


def test_a_doubtful_robot_change_is_only_proposed(write: Write, at: ContextAt) -> None:
    (proposed,) = bci(write, "robot2", "0.5", confirm=0.7, confirm_within=3).poll(at(99.0))
    assert isinstance(proposed, ProposePick)
    assert (proposed.robot, proposed.within, proposed.confidence) == (1, 3.0, 0.5)
    sure = bci(write, "robot2", "0.8", confirm=0.7)
    assert given(sure, at) == [(Pick, 0.1)]
    assert given(bci(write, "robot2", confirm=0.7), at) == [(Pick, 0.1)], "an unknown confidence is not a low one"
    assert given(bci(write, "pause", "0.1", confirm=0.7), at) == [(Pause, 0.1)], "only robot changes are proposed"


def test_confirm_and_discard_are_actions_of_every_channel(write: Write, at: ContextAt) -> None:
    assert given(bci(write, "confirm discard"), at) == [(Confirm, 0.1), (Discard, 0.2)]
    nodding = open_bci(InputSpec("bci", write("time,label\n1,nod\n"), settings={"labels": {"nod": "confirm"}}))
    assert given(nodding, at) == [(Confirm, 1.0)]


def test_a_reset_of_the_run_forgets_the_votes(write: Write, at: ContextAt) -> None:
    replay = bci(write, "stop stop stop", votes="3/5", evidence={"stop": {"votes": "2/5"}})
    assert replay.poll(at(0.1)) == []
    assert replay.poll(at(0.0)) == []
    assert given(replay, at)[0] == (EmergencyStop, 0.2)


def test_a_reset_of_the_run_resets_the_counters(write: Write, at: ContextAt) -> None:
    replay = bci(write, "stop robot2 wave", "0.5", threshold=0.4, confirm=0.9, evidence={"robot": {"threshold": 0.6}})
    replay.poll(at(1.0))
    told = replay.health(1.0), replay.decision_report(1.0)
    assert (told[1].passed, told[1].unknown) == (1, 1)
    replay.poll(at(0.0))
    assert replay.decision_report(0.0).passed == 0
    replay.poll(at(1.0))
    assert (replay.health(1.0), replay.decision_report(1.0)) == told


def test_every_decision_can_be_traced_to_the_stage_that_held_it(write: Write, at: ContextAt) -> None:
    replay = bci(write, "robot2 robot2 robot2 robot2 idle wave", votes="3/5")
    replay.poll(at(9.0))
    assert [(round(v.time, 1), v.label, v.stage) for v in replay.trace] == [
        (0.1, "robot2", Stage.VOTE), (0.2, "robot2", Stage.VOTE), (0.3, "robot2", Stage.VOTE),
        (0.4, "robot2", Stage.PASSED),
    ]  # fmt: skip
    assert "3 x fewer than 4 of 5 votes" in replay.health(9.0).detail

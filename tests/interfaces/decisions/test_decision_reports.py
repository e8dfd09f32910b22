"""The decision report has the evidence for the latest label and counts all decisions."""

from collections.abc import Callable

from higvf_console.core.interface import InputSpec, OperatorContext
from higvf_interfaces.decisions.bci import open_bci

LOG = (
    "time,label,confidence\n"
    "1.0,fly,0.9\n"  # unknown
    "2.0,pause,0.3\n"  # below the threshold
    "3.0,pause,0.9\n"
    "3.2,pause,0.9\n"  # too soon
    "4.0,robot2,0.55\n"  # a proposal
    "5.0,robot3,0.95\n"
)
SETTINGS = {"threshold": 0.5, "refractory": 1.5, "confirm": 0.7}


def test_the_report_has_the_latest_decision_with_its_evidence(
    write: Callable[..., str], at: Callable[..., OperatorContext]
) -> None:
    bci = open_bci(InputSpec("bci", write(LOG), settings=SETTINGS))
    assert (bci.decision_report(0.0).label, bci.decision_report(0.0).stage) == ("", "")
    bci.poll(at(1.5))
    assert (bci.decision_report(1.5).label, bci.decision_report(1.5).stage) == ("fly", "unknown")
    bci.poll(at(2.5))
    held = bci.decision_report(2.5)
    assert (held.stage, held.threshold, held.confidence, held.votes) == ("threshold", 0.5, 0.3, 0)
    bci.poll(at(3.1))
    passed = bci.decision_report(3.1)
    assert (passed.stage, passed.votes, passed.votes_needed) == ("passed", 1, 1)
    assert abs(passed.refractory - 1.4) < 1e-9
    bci.poll(at(3.5))
    assert bci.decision_report(3.5).stage == "refractory"
    assert bci.decision_report(9.0).refractory == 0.0


def test_every_decision_is_counted_once(write: Callable[..., str], at: Callable[..., OperatorContext]) -> None:
    bci = open_bci(InputSpec("bci", write(LOG), settings=SETTINGS))
    bci.poll(at(9.0))
    report = bci.decision_report(9.0)
    assert (report.passed, report.proposed, report.unknown) == (3, 1, 1)
    assert dict(report.held) == {"threshold": 1, "vote": 0, "hysteresis": 0, "onset": 0, "refractory": 1}

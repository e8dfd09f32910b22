"""What an interface may report beside its commands: attention, decoding, calibration; all of it optional.

The session asks each interface that has one of these methods, shows and writes down the answers, and acts on none.
"""

from typing import NamedTuple, Protocol, runtime_checkable

from higvf_console.core.arrays import Floats
from higvf_console.core.viewport import Arena


class AttentionReport(NamedTuple):
    """What the operator has looked at since the run started.

    Attributes:
        heat: (rows, columns) time that gaze spent in each cell of the ground [s]; row 0 is the top.
        extent: the ground that the cells cover.
        degree: one degree of visual angle on the ground [m], as far as gaze spreads.
        fires: (M,) time of fixations on each fire [s].
        robots: (N,) time of fixations on each robot [s].
        elsewhere: time of fixations on neither [s].
        fixation_rate: fixations in a second of seen gaze [1/s].
        fixation_duration: their mean duration [s]; NaN without any.
        transition_entropy: how unforeseeably gaze goes from area to area: 0 always the same way, 1 at random; NaN with
            fewer than two transitions.
    """

    heat: Floats
    extent: Arena
    degree: float
    fires: Floats
    robots: Floats
    elsewhere: float
    fixation_rate: float
    fixation_duration: float
    transition_entropy: float


class DwellReport(NamedTuple):
    """A button that gaze presses by resting on it.

    Attributes:
        progress: share of the dwell time that has passed, in [0, 1].
        outline: (5, 2) its border on the ground, closed [m].
    """

    progress: float
    outline: Floats


class DecisionReport(NamedTuple):
    """Where a decoded channel stands: its latest decision, the evidence for it, and what became of all before.

    Attributes:
        label: the latest; empty before the first.
        confidence: of the decoder in [0, 1]; None where it gave none.
        stage: that held the latest, or "passed", "unknown", "idle".
        votes: how many of the last `of` decisions say the label.
        votes_needed: how many must.
        of: how many vote.
        threshold: confidence below which a decision abstains.
        support: mean confidence with which the voters say the label.
        enter: support that makes a label active; 0 = every one that is voted for.
        leave: support at which an active label is released.
        active: the label that has given its command and is not released yet; empty = none.
        refractory: for how long the label will not be accepted again [s].
        passed: decisions that gave a command.
        proposed: those among them whose robot change waits for a confirmation.
        unknown: decisions with an unknown label, or of a robot that is not there.
        held: name of each stage and how many decisions it held, in the order of the stages.
    """

    label: str
    confidence: float | None
    stage: str
    votes: int
    votes_needed: int
    of: int
    threshold: float
    support: float
    enter: float
    leave: float
    active: str
    refractory: float
    passed: int
    proposed: int
    unknown: int
    held: tuple[tuple[str, int], ...]


class CalibrationReport(NamedTuple):
    """The map from screen to arena in use.

    Attributes:
        file: where it is stored; empty where it is not.
        made: date and time, as ISO 8601.
        screen_px: width and height of the screen [px].
        points_px: where gaze was [px].
        points_m: what it looked at [m].
        homography: (3, 3), row by row: w (x, y, 1) = homography (u, v, 1).
        residual_px: root mean square of the points' distances on the screen [px].
        residual_m: likewise on the ground [m].
    """

    file: str
    made: str
    screen_px: tuple[float, float]
    points_px: tuple[tuple[float, float], ...]
    points_m: tuple[tuple[float, float], ...]
    homography: tuple[tuple[float, float, float], ...]
    residual_px: float
    residual_m: float


class CaptureReport(NamedTuple):
    """A calibration being made: the operator looks at one target after the other.

    Attributes:
        refusal: why there can be none; empty = there can.
        target: (2,) what to look at now [m]; None = none is being made.
        number: of the target, from 1.
        targets: how many there are.
        progress: share of the samples that this target needs, in [0, 1].
        outcome: of the last one, in words; empty = there has been none.
    """

    refusal: str
    target: Floats | None = None
    number: int = 0
    targets: int = 0
    progress: float = 0.0
    outcome: str = ""


@runtime_checkable
class Attentive(Protocol):
    """An interface that sees where the operator looks."""

    def attention_report(self) -> AttentionReport | None:
        """What has been looked at so far; None before the first sample. Asked twice a second."""
        ...

    def dwell_report(self) -> DwellReport | None:
        """The button that gaze can press now; None where there is none. Asked each control period."""
        ...


@runtime_checkable
class Warned(Protocol):
    """An interface that has something to warn of in what it was opened with."""

    @property
    def warnings(self) -> tuple[str, ...]:
        """What was accepted and should be changed, such as a key under its former name; a sentence each."""
        ...


@runtime_checkable
class Deciding(Protocol):
    """An interface that weighs decoded labels."""

    def decision_report(self, now: float) -> DecisionReport:
        """Where it stands at session time `now` [s]. Asked a few times a second."""
        ...


@runtime_checkable
class Calibrated(Protocol):
    """An interface that maps a screen to the arena, and can be recalibrated."""

    def calibration_report(self) -> CalibrationReport | None:
        """The map in use; None where it is none that was measured."""
        ...

    def capture_report(self) -> CaptureReport:
        """How the making of a calibration stands. Asked each control period."""
        ...

    def begin_capture(self) -> None:
        """Begins to make one; callable from any thread."""
        ...

    def cancel_capture(self) -> None:
        """Gives it up; the map in use stays. Callable from any thread."""
        ...

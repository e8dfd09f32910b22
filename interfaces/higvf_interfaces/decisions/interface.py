"""Interface of decoded labels, replayed or live: feed -> interpreter -> commands.

The label map has the action names and the channel's defaults; the scenario's option `labels` overrides both:

    inputs: {emg: {labels: {fist: pause, spread: none, point: "robot:2"}, threshold: 0.6, refractory: 1.0}}
"""

from collections.abc import Mapping, Sequence

from higvf_console.core.commands import OperatorCommand, ResetRun
from higvf_console.core.interface import ChannelHealth, ChannelState, InputSpec, OperatorContext
from higvf_console.core.reports import DecisionReport
from higvf_interfaces.decisions import interpretation
from higvf_interfaces.decisions.debouncer import Evidence, Verdict
from higvf_interfaces.decisions.evidence import STREAMING
from higvf_interfaces.decisions.feeds import LogFeed
from higvf_interfaces.decisions.interpretation import Interpreter
from higvf_interfaces.decisions.options import DECODING, RECORDED, decoder_of, signal_request
from higvf_interfaces.emulation import ERRORS, ConfusedFeed, error_model, idle_seed
from higvf_interfaces.fields import option_fields
from higvf_interfaces.formats.clock import clock_warnings
from higvf_interfaces.formats.signals.reading import read_decisions
from higvf_interfaces.live import lsl
from higvf_interfaces.streams import RunClock, Stamp

OPTIONS = (
    "labels", "threshold", "refractory", "start", "format",
    *(key for key in interpretation.OPTIONS if key not in ("threshold", "refractory")),
    *(key for key in RECORDED if key != "format"), *DECODING, *ERRORS, *lsl.OPTIONS,
)  # fmt: skip
_RECORDED_ALONE = ("format", "start")  # not applicable to a live stream


class DecisionReplay:
    """Interface that turns a feed of decisions into commands.

    The feed is a log, a live stream or, with the option `decoder`, a decoder of raw signals. Decisions that give no
    command are counted and reported by `health`.
    """

    def __init__(self, spec: InputSpec, defaults: Mapping[str, str]) -> None:
        """Open `spec.source`.

        Args:
            spec: the input.
            defaults: actions of the channel's default labels.

        Raises:
            InputError: If the recording, an option or the label map is invalid.
        """
        options = option_fields(spec, OPTIONS)
        decodes = decoder_of(spec, options, "channels") is not None
        self._interpreter = Interpreter(defaults, options, STREAMING if decodes else Evidence())
        errors = error_model(options, spec.seed)
        self._warnings = idle_seed(options)
        start = options.number("start", 0.0, -1e6, 1e6, "s")
        self._live: lsl.LslReader | None = None
        if lsl.is_live(spec, _RECORDED_ALONE if decodes else (*_RECORDED_ALONE, "stream", "rate", "period")):
            from higvf_interfaces.live.feeds import live_feed  # noqa: PLC0415 - as below

            feed = live_feed(options)
            self._live = feed.reader
        elif decodes:
            from higvf_interfaces.decoding.replay import decoder_feed  # noqa: PLC0415 - filters load for a second

            feed = decoder_feed(spec.source, options, start)
        else:
            feed = LogFeed(read_decisions(spec.source, signal_request(options)), start)
        self._feed = feed if errors is None else ConfusedFeed(feed, errors)
        self._name = spec.channel
        self._stamp = Stamp(spec.channel)
        self._clock = RunClock()
        self._resets: set[int] = set()

    @property
    def name(self) -> str:
        """Channel name, shown in the status line."""
        return self._name

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is doubtful about the recording's clock and the options."""
        return (*self._warnings, *clock_warnings(self._feed.notes))

    @property
    def trace(self) -> Sequence[Verdict]:
        """Verdicts on the last decisions, oldest first."""
        return tuple(self._interpreter.trace)

    def poll(self, context: OperatorContext) -> list[OperatorCommand]:
        """Return the commands of the decisions that are due, stamped with the times of the decisions."""
        if self._clock.was_reset(context.time):
            self._interpreter.restart()
        given: list[OperatorCommand] = []
        for index, decision in self._feed.due(context.time):
            command = self._interpreter.command(decision, context.robots)
            if command is not None and not self._repeats(index, command):
                given.append(self._stamp(command, decision.time, context))
        return given

    def health(self, now: float) -> ChannelHealth:
        """Never seen before the first decision, ended after the last; the detail lists ignored decisions."""
        detail = "; ".join((*self._interpreter.describe(), *self._feed.notes))
        if self._live is not None:
            quiet = self._live.quiet
            state = ChannelState.NEVER_SEEN if quiet is None else ChannelState.LIVE
            return ChannelHealth(state, detail, None if quiet is None else now - quiet)
        if self._feed.ended and self._feed.started:
            return ChannelHealth(ChannelState.ENDED, f"replayed to its end; {detail}")
        return ChannelHealth(ChannelState.LIVE if self._feed.started else ChannelState.NEVER_SEEN, detail)

    def decision_report(self, now: float) -> DecisionReport:
        """Return the state of the debouncer."""
        return self._interpreter.report(now)

    def close(self) -> None:
        """Stop reading a live stream; files are closed as soon as they are read."""
        if self._live is not None:
            self._live.close()

    def _repeats(self, index: int, command: OperatorCommand) -> bool:
        """Return whether the log already gave this `reset_run`; repeating it would reset the run endlessly."""
        if not isinstance(command, ResetRun):
            return False
        known = index in self._resets
        self._resets.add(index)
        return known

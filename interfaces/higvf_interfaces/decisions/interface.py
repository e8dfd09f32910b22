"""A channel of decoded labels, replayed on the session clock or live: feed -> interpreter -> commands.

Every action's own name is a label too, and so is what a channel's defaults add; the scenario's map goes over both:

    inputs: {emg: {labels: {fist: pause, spread: none, point: "robot:2"}, threshold: 0.6, refractory: 1.0}}
"""

import math
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
from higvf_interfaces.emulation import ERRORS, EmulatedFeed, error_model
from higvf_interfaces.fields import option_fields
from higvf_interfaces.formats.signals.reading import read_decisions
from higvf_interfaces.live import lsl
from higvf_interfaces.streams import Stamp

OPTIONS = (
    "labels", "threshold", "refractory", "start", "format",
    *(key for key in interpretation.OPTIONS if key not in ("threshold", "refractory")),
    *(key for key in RECORDED if key != "format"), *DECODING, *ERRORS, *lsl.OPTIONS,
)  # fmt: skip
_RECORDED_ALONE = ("format", "start")  # options that mean nothing live; others may speak of a calibration


class DecisionReplay:
    """A channel's decisions, played on the session clock.

    They are those of a log or a live stream or, with the option `decoder`, those that the decoder makes of raw signals.
    What gives no command is counted and told by `health`.
    """

    def __init__(self, spec: InputSpec, defaults: Mapping[str, str]) -> None:
        """Reads `spec.source`; `defaults` are the channel's own labels and their actions.

        Raises:
            InputError: the recording, an option or the label map cannot be used.
        """
        options = option_fields(spec, OPTIONS)
        decodes = decoder_of(spec, options, "channels") is not None
        self._interpreter = Interpreter(defaults, options, STREAMING if decodes else Evidence())
        errors = error_model(options)
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
        self._feed = feed if errors is None else EmulatedFeed(feed, errors)
        self._name = spec.channel
        self._stamp = Stamp(spec.channel)
        self._now = -math.inf
        self._resets: set[int] = set()

    @property
    def name(self) -> str:
        """Channel name, shown in the status line."""
        return self._name

    @property
    def trace(self) -> Sequence[Verdict]:
        """The last decisions, each with the stage that held it or let it pass, oldest first."""
        return tuple(self._interpreter.trace)

    def poll(self, context: OperatorContext) -> list[OperatorCommand]:
        """Commands of the decisions that have fallen due, at their own times."""
        if context.time < self._now:
            self._interpreter.restart()
        self._now = context.time
        given: list[OperatorCommand] = []
        for index, decision in self._feed.due(context.time):
            command = self._interpreter.command(decision, context.robots)
            if command is not None and not self._repeats(index, command):
                given.append(self._stamp(command, decision.time, context))
        return given

    def health(self, now: float) -> ChannelHealth:
        """Never seen before the first decision, ended after the last; the detail tells what was ignored."""
        detail = "; ".join((*self._interpreter.describe(), *self._feed.notes))
        if self._live is not None:
            quiet = self._live.quiet
            state = ChannelState.NEVER_SEEN if quiet is None else ChannelState.LIVE
            return ChannelHealth(state, detail, None if quiet is None else now - quiet)
        if self._feed.ended and self._feed.started:
            return ChannelHealth(ChannelState.ENDED, f"replayed to its end; {detail}")
        return ChannelHealth(ChannelState.LIVE if self._feed.started else ChannelState.NEVER_SEEN, detail)

    def decision_report(self, now: float) -> DecisionReport:
        """Where the debouncer stands."""
        return self._interpreter.report(now)

    def close(self) -> None:
        """Ends the reading of a live stream; a file is closed after reading."""
        if self._live is not None:
            self._live.close()

    def _repeats(self, index: int, command: OperatorCommand) -> bool:
        """Whether this is a restart that the log gave before; given twice, the run would never end."""
        if not isinstance(command, ResetRun):
            return False
        known = index in self._resets
        self._resets.add(index)
        return known

"""The emulated link of a channel: its commands come late, or are lost, whichever interface gives them.

    --input script=FILE:latency=0.3,jitter=0.1,dropout=0.1,seed=3

Each command has its own random generator, seeded by (seed, number of the command): the same seed gives the same
commands at any session speed. Nothing overtakes. The bounds of a stroke and STOP come late, but are never lost; what
takes a channel back into service, and who steers, passes at once.
"""

import math
from collections import deque
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import NamedTuple, cast

import numpy as np

from higvf_console.core.commands import (
    Acknowledge,
    EmergencyStop,
    HandOver,
    InjectFault,
    OperatorCommand,
    StrokeBegin,
    StrokeCancel,
    StrokeEnd,
)
from higvf_console.core.errors import InputError
from higvf_console.core.interface import (
    LINK_OPTIONS,
    Capabilities,
    ChannelHealth,
    ChannelState,
    InputSpec,
    Interface,
    OperatorContext,
    PointerSink,
    capabilities_of,
)
from higvf_console.core.quantity import Quantity
from higvf_console.core.reading.node import Node

_SEED = "seed"
_GRAIN = 1e-9  # [s]
_DELAY = Quantity("s", 0.0, 60.0, "", "")
_SHARE = Quantity("", 0.0, 1.0, "", "")
_SEEDS = Quantity("", 0.0, 2.0**32, "", "")


class LinkErrors(NamedTuple):
    """What a link does to commands.

    Attributes:
        latency: constant delay [s].
        jitter: mean of an additional, exponentially distributed delay [s].
        dropout: probability in [0, 1] that a command is lost.
        seed: of all random draws.
    """

    latency: float = 0.0
    jitter: float = 0.0
    dropout: float = 0.0
    seed: int = 0

    def __str__(self) -> str:
        """As its options are written."""
        return ", ".join(f"{key}={value:g}" for key, value in self._asdict().items() if value)


def split_link(spec: InputSpec) -> tuple[InputSpec, LinkErrors | None]:
    """What an interface is opened with, without the options of its link; and these, None where there are none.

    With a link, its seed is that of all errors of the channel (`InputSpec.seed`).

    Raises:
        InputError: an option is no number, or out of range.
    """
    given: dict[str, object] = {**spec.settings, **spec.options}
    if not any(key in given for key in LINK_OPTIONS):
        return spec, None
    place = f"input {spec.channel}={spec.source}" if spec.source else f"input {spec.channel}"
    latency, jitter = (_number(given, key, place, _DELAY) for key in ("latency", "jitter"))
    seed = int(_number(given, _SEED, place, _SEEDS))
    errors = LinkErrors(latency, jitter, _number(given, "dropout", place, _SHARE), seed)
    own = (*LINK_OPTIONS, _SEED)
    options = {key: value for key, value in spec.options.items() if key not in own}
    settings = {key: value for key, value in spec.settings.items() if key not in own}
    return replace(spec, options=options, settings=settings, seed=seed), errors


def _number(given: Mapping[str, object], key: str, place: str, quantity: Quantity) -> float:
    value = given.get(key, 0.0)
    if isinstance(value, str):
        with suppress(ValueError):
            value = float(value)
    return Node({key: value}, place, raises=InputError).section((key,))[key].number(quantity)


class Link:
    """An interface behind a link that is slow or loses commands.

    Attributes:
        device: the interface.
    """

    def __init__(self, device: Interface, errors: LinkErrors) -> None:
        """Starts with nothing on its way."""
        self.device = device
        self._errors = errors
        self._now = -math.inf
        self._way: deque[tuple[float, OperatorCommand]] = deque()
        self._sent = self._come = 0

    @property
    def name(self) -> str:
        """Channel name."""
        return self.device.name

    @property
    def capabilities(self) -> Capabilities:
        """Those of the interface."""
        return capabilities_of(self.device)

    def push(self, command: OperatorCommand) -> None:
        """Passes a command of the pages to an interface that takes them."""
        cast(PointerSink, self.device).push(command)

    def heartbeat(self) -> None:
        """Passes a page's sign of life to an interface that takes it."""
        cast(PointerSink, self.device).heartbeat()

    def poll(self, context: OperatorContext) -> Sequence[OperatorCommand]:
        """The commands that have arrived, stamped with their times of arrival."""
        if context.time < self._now:  # the run was reset
            self._way.clear()
            self._sent = 0
        self._now = context.time
        given: list[tuple[float, OperatorCommand]] = []
        for command in self.device.poll(context):
            if isinstance(command, Acknowledge | HandOver | InjectFault):
                given.append((command.time, command))
            else:
                self._send(command)
        while self._way and self._way[0][0] <= context.time + _GRAIN:
            given.append(self._way.popleft())
        first, self._come = self._come, self._come + len(given)
        given.sort(key=lambda come: come[0])
        return [replace(command, time=time, sequence=k) for k, (time, command) in enumerate(given, start=first)]

    def health(self, now: float) -> ChannelHealth:
        """That of the interface; it has not ended while a command is on its way."""
        health = self.device.health(now)
        under_way = health.state is ChannelState.ENDED and bool(self._way)
        detail = f"{health.detail}; emulated link: {self._errors}"
        return health._replace(state=ChannelState.LIVE if under_way else health.state, detail=detail)

    def close(self) -> None:
        """Closes the interface."""
        self.device.close()

    def _send(self, command: OperatorCommand) -> None:
        draw = np.random.default_rng((self._errors.seed, self._sent))
        self._sent += 1
        lost, delay = draw.random(), draw.exponential()
        kept = isinstance(command, StrokeBegin | StrokeEnd | StrokeCancel | EmergencyStop)
        if lost < self._errors.dropout and not kept:
            return
        due = command.time + self._errors.latency + self._errors.jitter * delay
        self._way.append((max(due, self._way[-1][0] if self._way else -math.inf), command))


def device_of(interface: Interface) -> Interface:
    """The interface at the far end of a link, or the interface itself: what reports and takes the pointer."""
    return interface.device if isinstance(interface, Link) else interface

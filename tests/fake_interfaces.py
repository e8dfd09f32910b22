"""Interfaces without devices."""

from collections.abc import Sequence

from higvf_console.core.commands import OperatorCommand
from higvf_console.core.interface import Capabilities, ChannelHealth, ChannelState, OperatorContext


class FakeInterface:
    """Gives the commands that a test planned, when their time has come."""

    def __init__(self, name: str, *plan: tuple[float, OperatorCommand]) -> None:
        self.name = name
        self.plan = list(plan)
        self.contexts: list[OperatorContext] = []
        self.closed = 0

    def push(self, command: OperatorCommand) -> None:
        self.plan.append((0.0, command))

    def poll(self, context: OperatorContext) -> Sequence[OperatorCommand]:
        self.contexts.append(context)
        due = [command for time, command in self.plan if time <= context.time + 1e-9]
        self.plan = [(time, command) for time, command in self.plan if time > context.time + 1e-9]
        return due

    def health(self, now: float) -> ChannelHealth:
        return ChannelHealth(ChannelState.LIVE, f"at {now:.2f} s")

    def close(self) -> None:
        self.closed += 1


class FakeConsole(FakeInterface):
    """A channel with the capabilities of the console's own, by that name or another."""

    capabilities = Capabilities(takes_pointer=True, self_acknowledging=True, draws_previewed=True, stale_after=2.0)

    def __init__(self, *plan: tuple[float, OperatorCommand], name: str = "console") -> None:
        super().__init__(name, *plan)
        self.heartbeats = 0

    def heartbeat(self) -> None:
        self.heartbeats += 1


class BrokenInterface(FakeInterface):
    """Raises at every poll from its second one on."""

    def poll(self, context: OperatorContext) -> Sequence[OperatorCommand]:
        commands = super().poll(context)
        if len(self.contexts) > 1:
            raise RuntimeError("cable pulled")
        return commands

"""The operator's interfaces: found by entry point or built in, polled each tick, set aside when they fail."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from importlib.metadata import EntryPoint, entry_points
from typing import Any, cast

from higvf_console.channels.console import open_console
from higvf_console.channels.link import Link, device_of, split_link
from higvf_console.core.arguments import brief, instance, sequence
from higvf_console.core.command import CONSOLE
from higvf_console.core.commands import EmergencyStop, OperatorCommand
from higvf_console.core.errors import ArgumentTypeError, HigvfError, InputError, closest
from higvf_console.core.events import Event, Severity
from higvf_console.core.interface import (
    Capabilities,
    ChannelHealth,
    ChannelState,
    InputSpec,
    Interface,
    OperatorContext,
    PointerSink,
    StopSource,
    capabilities_of,
    current_channel,
)

GROUP = "higvf_console.interfaces"


class CrashedError(InputError):
    """An interface failed to open where it should have refused its input with `InputError`."""


def interface_names() -> tuple[str, ...]:
    """Names of the interfaces: the built-in one and those that are installed."""
    return tuple(sorted({CONSOLE, *(point.name for point in entry_points(group=GROUP))}))


def open_interface(spec: InputSpec) -> Interface:
    """Opens the console's own channel, or the interface that the entry point `spec.channel` names.

    Args:
        spec: channel, file or stream, options and settings; a channel's former name is read as its present one. The
            options `LINK_OPTIONS` put the interface behind an emulated link.

    Raises:
        InputError: no such interface is installed, it cannot be imported, or its input cannot be used.
        CrashedError: it raised something else while it opened, or offers what is no interface.
    """
    instance("spec", spec, InputSpec)
    spec, errors = split_link(replace(spec, channel=current_channel(spec.channel)))
    interface = open_console(spec) if spec.channel == CONSOLE else _installed(spec)
    return interface if errors is None else Link(interface, errors)


def _installed(spec: InputSpec) -> Interface:
    points: Mapping[str, EntryPoint] = {point.name: point for point in entry_points(group=GROUP)}
    if spec.channel not in points:
        names = interface_names()
        hint = closest(spec.channel, names)
        raise InputError(f"no interface '{spec.channel}'{hint}; installed interfaces: {', '.join(names) or 'none'}")
    try:
        opener = points[spec.channel].load()
    except Exception as error:  # whatever there is in a package's module
        raise InputError(f"interface '{spec.channel}' ({points[spec.channel].value}) does not load: {error}") from error
    try:
        interface = opener(spec)
    except HigvfError:
        raise
    except Exception as error:  # as above
        raise CrashedError(f"interface '{spec.channel}' does not open: {type(error).__name__}: {error}") from error
    if missing := _missing(interface):
        raise CrashedError(f"interface '{spec.channel}' opens as {interface!r:.60}, without {', '.join(missing)}")
    try:
        capabilities_of(interface)
    except InputError as error:
        raise CrashedError(str(error)) from error
    return interface


def _missing(interface: object) -> list[str]:
    """What an object lacks of an interface."""
    return [name for name in ("name", "poll", "health", "close") if not hasattr(interface, name)]


def _given(index: int, interface: Any) -> Interface:
    place = f"interfaces[{index}], {brief(interface)},"
    if isinstance(interface, type):
        raise ArgumentTypeError(f"{place} is a class; expected an object of it")
    if missing := _missing(interface):
        raise ArgumentTypeError(f"{place} lacks {', '.join(missing)}")
    return interface


class Channels:
    """Interfaces in use; one that raises is polled no more.

    Attributes:
        capabilities: of each, by name.
    """

    capabilities: Mapping[str, Capabilities]

    def __init__(self, interfaces: Iterable[Interface]) -> None:
        """Takes them in the order in which they are to be polled.

        Raises:
            InputError: two have the same name, or one offers capabilities that cannot be.
            ArgumentTypeError: one lacks a function of an interface.
        """
        self._interfaces = tuple(_given(k, one) for k, one in enumerate(sequence("interfaces", interfaces)))
        self._stop_sources = [(one.name, one) for one in self._interfaces if isinstance(one, StopSource)]
        self._failed: dict[str, str] = {}
        self.capabilities = {interface.name: capabilities_of(interface) for interface in self._interfaces}
        names = [interface.name for interface in self._interfaces]
        for name in names:
            if names.count(name) > 1:
                raise InputError(f"interface '{name}' is given {names.count(name)} times; give each once")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the interfaces, in the order given."""
        return tuple(interface.name for interface in self._interfaces)

    @property
    def pointer_name(self) -> str:
        """Name of the first interface that takes what the console's pages give.

        Raises:
            InputError: there is none.
        """
        name = next((name for name, capabilities in self.capabilities.items() if capabilities.takes_pointer), None)
        if name is None:
            given = ", ".join(self.names) or "none"
            raise InputError(
                f"no input accepts the pointer and keys of the console's pages; inputs: {given}; add '{CONSOLE}'"
            )
        return name

    @property
    def pointer(self) -> PointerSink:
        """The interface of that name.

        Raises:
            InputError: there is none.
        """
        return cast(PointerSink, self.named(self.pointer_name))

    def named(self, name: str) -> Interface | None:
        """The interface of that name."""
        return next((interface for interface in self._interfaces if interface.name == name), None)

    def device(self, name: str) -> Interface | None:
        """The interface of that name without its link: what reports of itself."""
        interface = self.named(name)
        return None if interface is None else device_of(interface)

    def poll(self, context: OperatorContext) -> tuple[dict[str, list[OperatorCommand]], list[Event]]:
        """The commands that are due, by interface, and an event for each interface that failed just now."""
        commands: dict[str, list[OperatorCommand]] = {}
        events: list[Event] = []
        for interface in self._interfaces:
            if interface.name in self._failed:
                continue
            try:
                commands[interface.name] = list(interface.poll(context))
            except Exception as error:  # whatever a device's code raises must not stop the team's loop
                events.append(self.fail(interface.name, error, context.time))
        return commands, events

    def take_stops(self, context: OperatorContext) -> list[tuple[str, EmergencyStop]]:
        """The STOPs that do not wait for a poll, each with the name of its interface."""
        stops: list[tuple[str, EmergencyStop]] = []
        for name, source in self._stop_sources:
            if (stop := source.take_stop(context)) is not None:
                stops.append((name, stop))
        return stops

    def fail(self, name: str, error: Exception, time: float) -> Event:
        """Sets an interface aside; the event says why."""
        self._failed[name] = f"{type(error).__name__}: {error}"
        text = f"Input '{name}' failed and is off: {self._failed[name]}"
        return Event(time, Severity.ALARM, "channel", text, channel=name)

    def failed(self, name: str) -> bool:
        """Whether the interface of that name has been set aside."""
        return name in self._failed

    def health(self, now: float) -> tuple[tuple[str, ChannelHealth], ...]:
        """How each channel is, in the order given."""
        return tuple((interface.name, self._health_of(interface, now)) for interface in self._interfaces)

    def _health_of(self, interface: Interface, now: float) -> ChannelHealth:
        if interface.name in self._failed:
            return ChannelHealth(ChannelState.LOST, self._failed[interface.name])
        try:
            return interface.health(now)
        except Exception as error:  # as in poll
            return ChannelHealth(ChannelState.LOST, f"{type(error).__name__}: {error}")

    def close(self) -> None:
        """Closes every interface, also after one of them fails to."""
        errors: list[Exception] = []
        for interface in self._interfaces:
            try:
                interface.close()
            except Exception as error:  # the others must still be closed
                errors.append(error)
        if errors:
            raise InputError(f"an input did not close: {errors[0]}") from errors[0]


def unknown_settings(inputs: Iterable[str]) -> tuple[str, ...]:
    """A warning for each section of settings that no installed interface reads."""
    known = interface_names()
    return tuple(
        f"inputs.{name}: no such interface is installed{closest(name, known)}; installed: {', '.join(known)}"
        for name in inputs
        if name not in known
    )

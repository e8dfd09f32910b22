"""`--input CHANNEL=FILE:option=value,option=value`, as words of the command line and of a scenario's `demo`."""

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from higvf_console.channels.channels import Channels, interface_names
from higvf_console.core.errors import InputError, closest
from higvf_console.core.events import Event, Severity
from higvf_console.core.interface import InputSpec, current_channel, renamed_channel
from higvf_console.core.reports import Warned
from higvf_console.scenario.scenario import Scenario, data_folder

NO_CHANNEL = "inspect"  # stands for the channel of a file that is inspected as that of none
_CHANNEL = re.compile(r"[A-Za-z][\w-]*")
_OPTIONS = re.compile(r"[A-Za-z]\w*=[^,]*(,[A-Za-z]\w*=[^,]*)*")
_MEANT = re.compile(r"\s*[A-Za-z]\w*\s*(=.*)?")  # as options


def input_spec(text: str, scenario: Scenario, folder: Path | None = None) -> InputSpec:
    """What an interface is opened with.

    The options start behind the colon that leaves the name of an existing file in front of it, else behind the first
    one that options follow: so `C:\\run 1\\gaze.tsv:frame=screen` and `run 12:30.csv` mean what they should.

    Args:
        text: `gaze=FILE:frame=screen`, `bci=:stream=Decoder` or just `console`; a channel's former
            name is read as its present one.
        scenario: with the arena and the interface's settings.
        folder: what a relative file is relative to; None = the working directory.

    Raises:
        InputError: not of that form, an option is given twice, or what follows an existing file are no options.
    """
    channel, _, rest = text.partition("=")
    if not _CHANNEL.fullmatch(channel):
        raise InputError(f"--input {text}: give CHANNEL=FILE or CHANNEL=FILE:option=value,option=value")
    channel = current_channel(channel)
    source, options = _split(rest, folder or Path())
    settings = scenario.inputs.get(channel, {})
    return InputSpec(
        channel,
        source,
        options_behind(options, f"--input {text}"),
        settings,
        scenario.arena,
        len(scenario.robots.points),
    )


def inspected_spec(text: str, scenario: Scenario) -> InputSpec:
    """What a file is inspected with: `CHANNEL=FILE:options` as an input, or `FILE:options` as that of no channel.

    Raises:
        InputError: as `input_spec`, or there is no such channel.
    """
    channel, equals, _ = text.partition("=")
    if not equals or not _CHANNEL.fullmatch(channel) or _is_file(Path(_split(text, Path())[0])):
        return input_spec(f"{NO_CHANNEL}={text}", scenario)
    names = interface_names()
    if current_channel(channel) not in (*names, NO_CHANNEL):
        raise InputError(f"no interface '{channel}'{closest(channel, names)}; installed interfaces: {', '.join(names)}")
    return input_spec(text, scenario)


def renamed_specs(texts: Iterable[str]) -> tuple[str, ...]:
    """A warning for each `--input` that names a channel by its former name."""
    warnings = [(text, renamed_channel(text.partition("=")[0])) for text in texts]
    return tuple(f"--input {text}: {warning}" for text, warning in warnings if warning)


def demo_specs(scenario: Scenario) -> list[InputSpec]:
    """The inputs of the scenario's demonstration.

    Raises:
        InputError: the scenario has none.
    """
    if not scenario.demo:
        raise InputError(f"scenario '{scenario.name}' has no section 'demo' ({scenario.source})")
    return [input_spec(text, scenario, data_folder()) for text in scenario.demo]


def opening_warnings(scenario: Scenario, channels: Channels) -> tuple[Event, ...]:
    """The warnings of a scenario and of the inputs that a session is opened with."""
    warned = (interface for interface in map(channels.device, channels.names) if isinstance(interface, Warned))
    return (
        *(Event(0.0, Severity.WARNING, "scenario", text) for text in scenario.warnings),
        *(Event(0.0, Severity.WARNING, "input", text) for interface in warned for text in interface.warnings),
    )


def _split(rest: str, folder: Path) -> tuple[str, str]:
    splits = [(rest, ""), *_splits(rest)]
    found = [(source, options) for source, options in splits if source and _is_file(folder / source)]
    if not found:
        _refuse_torn(rest, folder)
    source, options = found[0] if found else splits[1] if len(splits) > 1 else splits[0]
    return (str(folder / source) if source and folder != Path() else source), options


def _refuse_torn(rest: str, folder: Path) -> None:
    """Refuses a source whose first part is a file and whose options hold a blank or lack a value."""
    for colon in re.finditer(":", rest):
        source, options = rest[: colon.start()], rest[colon.end() :]
        if _MEANT.fullmatch(options) and not _OPTIONS.fullmatch(options) and source and _is_file(folder / source):
            raise InputError(f"{source}: {options!r} is not of the form option=value,option=value, without blanks")


def _is_file(path: Path) -> bool:
    """Whether it is a file; False for what cannot be a file name, e.g. one of 300 letters."""
    try:
        return path.is_file()
    except OSError:
        return False


def split_source(rest: str) -> tuple[str, str]:
    """Address and options of `ADDRESS:option=value,option=value`, split at the first colon that options follow."""
    return next(_splits(rest), (rest, ""))


def _splits(rest: str) -> Iterator[tuple[str, str]]:
    for colon in re.finditer(":", rest):
        if _OPTIONS.fullmatch(rest[colon.end() :]):
            yield rest[: colon.start()], rest[colon.end() :]


def options_behind(text: str, whole: str) -> dict[str, str]:
    """The options of `option=value,option=value`.

    Args:
        text: these.
        whole: of which they are the end, for the error.

    Raises:
        InputError: one is given twice.
    """
    options: dict[str, str] = {}
    for part in text.split(",") if text else ():
        name, _, value = part.partition("=")
        if name in options:
            raise InputError(f"{whole}: option '{name}' is given twice")
        options[name] = value
    return options

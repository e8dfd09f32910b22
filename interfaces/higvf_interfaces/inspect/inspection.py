"""Inspection of a file: format, streams, columns, rate, validity, repairs, and conversion to commands.

The console finds `inspect` by the entry-point group `higvf_console.inspectors`. The first entry of `KINDS` that
recognises the file describes it; for a channel of decisions without a decoder, commands go first, as in a run.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from higvf_console.core.arguments import one_of
from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec
from higvf_interfaces.decisions import interface as decisions
from higvf_interfaces.decisions.debouncer import Evidence
from higvf_interfaces.decisions.interpretation import Interpreter
from higvf_interfaces.decisions.options import named_decoder, signal_request
from higvf_interfaces.emulation import error_model
from higvf_interfaces.fields import Fields, option_fields
from higvf_interfaces.formats.reading import gaze_formats, unknown_format
from higvf_interfaces.formats.signals.reading import decision_formats, signal_formats
from higvf_interfaces.formats.text import look
from higvf_interfaces.gaze import interface as gaze
from higvf_interfaces.inspect import commands as inspect_commands
from higvf_interfaces.inspect import gaze as inspect_gaze
from higvf_interfaces.inspect import signals as inspect_signals
from higvf_interfaces.inspect import streams as inspect_streams
from higvf_interfaces.inspect.description import Request
from higvf_interfaces.live import lsl

OPTIONS = tuple(dict.fromkeys(key for key in (*gaze.OPTIONS, *decisions.OPTIONS) if key not in lsl.OPTIONS))


class Kind(NamedTuple):
    """A kind of file: its name, and functions to recognise it, to describe it and to check the options."""

    name: str
    knows: Callable[[Request], bool]
    describe: Callable[[Request], Mapping[str, object]]
    check: Callable[[Fields], object]


def _deciding(options: Fields) -> None:
    Interpreter({}, options, Evidence())
    error_model(options)


KINDS: tuple[Kind, ...] = (
    Kind("gaze", inspect_gaze.knows, inspect_gaze.describe, gaze.drawing_options),
    Kind("signals", inspect_signals.knows, inspect_signals.describe, _deciding),
    Kind("commands", inspect_commands.knows, inspect_commands.describe, _deciding),
    Kind("streams", inspect_streams.knows, inspect_streams.describe, signal_request),
)


def inspect(spec: InputSpec, plot: Path | None = None, steps: bool = False) -> Mapping[str, object]:
    """Describe the file `spec.source`; entry point of the group `higvf_console.inspectors`.

    Args:
        spec: the file, the options of its channel, and the arena.
        plot: path of a PNG picture to write; None for no picture.
        steps: whether to report the processing steps from samples to a path.

    Returns:
        Plain values: format, kind, streams, columns, samples, duration_s, rate_hz, frame, origin, valid_share, gaps,
        becomes, warnings, and further keys of the kind.

    Raises:
        InputError: If the file is unrecognised or unreadable, or an option is invalid. Unrecognised files are rejected
            with the list of formats tried.
    """
    lsl.is_live(spec, ())  # refuses options of a live stream
    request = Request(spec, look(spec.source), option_fields(spec, (*OPTIONS, *lsl.OPTIONS)), plot, steps)
    decodes = named_decoder(request.options) is not None
    text = bool(request.file.head) or request.format is not None
    for kind in _kinds(spec.channel, decodes) if text else KINDS[:1]:  # a folder can only be a gaze recording
        if kind.knows(request):
            kind.check(request.options)
            return kind.describe(request)
    sought = [(known.name, known.title) for known in (*gaze_formats(), *signal_formats(), *decision_formats())]
    if request.options.has("format"):
        one_of("format", request.options.text("format"), [name for name, _ in sought], InputError)
    raise unknown_format(request.file, sought)


def _kinds(channel: str, decodes: bool) -> Sequence[Kind]:
    """Return the kinds in the order in which a channel asks them."""
    of_decisions = channel in inspect_commands.CHANNELS
    first = () if not of_decisions else ("signals",) if decodes else ("commands",)
    return sorted(KINDS, key=lambda kind: (kind.name not in first, of_decisions and kind.name == "gaze"))

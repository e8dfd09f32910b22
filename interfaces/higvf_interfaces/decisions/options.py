"""Options of EMG and BCI inputs: how to read the recording and how to decode it."""

from higvf_console.core.interface import InputSpec
from higvf_interfaces.fields import Fields, shown
from higvf_interfaces.formats.signals.records import SignalRequest

RECORDED = ("format", "stream", "rate", "period", "channels")
DECODERS = {
    "lda": ("calibration", "markers", "marker_stream", "trial_s", "calibrate_to", "mains"),
    "ssvep": ("targets", "mains", "window", "hop"),
}
DECODING = ("decoder", *dict.fromkeys(key for keys in DECODERS.values() for key in keys))


def signal_request(options: Fields) -> SignalRequest:
    """Read the options `RECORDED`.

    Raises:
        InputError: If a value is invalid, or both `rate` and `period` are given.
    """
    if options.has("rate") and options.has("period"):
        options.fail("rate and period exclude each other; give one")
    rate = options.number("rate", 0.0, 0.1, 100_000.0, "Hz") or None
    if options.has("period"):
        rate = 1.0 / options.number("period", None, 1e-5, 10.0, "s")
    name = options.text("format") if options.has("format") else None
    return SignalRequest(name, word(options, "stream") if options.has("stream") else None, rate, words(options))


def named_decoder(options: Fields) -> str | None:
    """Return the name of the decoder, or None if the option is not set.

    Raises:
        InputError: If the decoder is unknown.
    """
    return options.choice("decoder", "", tuple(DECODERS)) if options.has("decoder") else None


def decoder_of(spec: InputSpec, options: Fields, *raw: str) -> str | None:
    """Return the name of the decoder after checking that the other options fit it, or None if none is set.

    Args:
        spec: the input.
        options: options of the command line and the scenario.
        raw: further options that need a decoder.

    Raises:
        InputError: If the decoder is unknown, or the command line has an option of another decoder.
    """
    name = named_decoder(options)
    for key in spec.options:
        users = [known for known, keys in DECODERS.items() if key in (*keys, *raw)]
        if users and name not in users:
            options.fail(f"{key} is for decoder={' or '.join(users)}; give that, or leave {key} out")
    return name


def word(options: Fields, key: str) -> str:
    """Return an option as text; a number is accepted, since YAML reads `stream: 2` as one.

    Raises:
        InputError: If the value is neither text nor a number.
    """
    value = options.values[key]
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        options.fail(f"{key}: {shown(value)} is not text")
    return f"{value:.15g}" if isinstance(value, float) else str(value)


def words(options: Fields) -> tuple[str, ...]:
    """Return the names in the option `channels`: `channels=TP9+AF7`, or a list in a scenario.

    Raises:
        InputError: If the value is neither text nor a list.
    """
    if not options.has("channels"):
        return ()
    value = options.values["channels"]
    if isinstance(value, list):
        return tuple(str(item) for item in options.items("channels"))
    return tuple(part.strip() for part in word(options, "channels").split("+") if part.strip())

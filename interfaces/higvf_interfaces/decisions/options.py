"""Options that say how a recording of an EMG or BCI is to be read, and how it is to be decoded."""

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
    """What the options `RECORDED` say.

    Raises:
        InputError: a value that cannot be used, or both rate and period.
    """
    if options.has("rate") and options.has("period"):
        options.fail("rate and period say the same; give one")
    rate = options.number("rate", 0.0, 0.1, 100_000.0, "Hz") or None
    if options.has("period"):
        rate = 1.0 / options.number("period", None, 1e-5, 10.0, "s")
    name = options.text("format") if options.has("format") else None
    return SignalRequest(name, word(options, "stream") if options.has("stream") else None, rate, words(options))


def named_decoder(options: Fields) -> str | None:
    """The decoder that the options name; None = none.

    Raises:
        InputError: there is no such decoder.
    """
    return options.choice("decoder", "", tuple(DECODERS)) if options.has("decoder") else None


def decoder_of(spec: InputSpec, options: Fields, *raw: str) -> str | None:
    """Name of the decoder that an input's options ask for; None = none.

    Args:
        spec: the input.
        options: its options, those of the scenario included.
        raw: further options that mean nothing without a decoder.

    Raises:
        InputError: there is no such decoder, or the command line has an option that is for another one.
    """
    name = named_decoder(options)
    for key in spec.options:
        users = [known for known, keys in DECODERS.items() if key in (*keys, *raw)]
        if users and name not in users:
            options.fail(f"{key} is for decoder={' or '.join(users)}; give that, or leave {key} out")
    return name


def word(options: Fields, key: str) -> str:
    """A word that may look like a number: in a scenario, `stream: 2` is stream 2.

    Raises:
        InputError: neither a text nor a number.
    """
    value = options.values[key]
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        options.fail(f"{key}: {shown(value)} is not a text")
    return f"{value:.15g}" if isinstance(value, float) else str(value)


def words(options: Fields) -> tuple[str, ...]:
    """The channels wanted: `channels=TP9+AF7`, or a list in a scenario.

    Raises:
        InputError: neither.
    """
    if not options.has("channels"):
        return ()
    value = options.values["channels"]
    if isinstance(value, list):
        return tuple(str(item) for item in options.items("channels"))
    return tuple(part.strip() for part in word(options, "channels").split("+") if part.strip())

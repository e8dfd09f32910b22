"""Evaluate a decoder on a recording: `python -m higvf_interfaces.decoding FILE decoder=lda`.

The options are those of `--input`, joined by commas. A recording with trials gives accuracy by trial, latency and wrong
commands per minute. With `--idle` the recording contains no intended command, and every command counts as false.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from typing import Any

from higvf_console.core.errors import HigvfError
from higvf_console.core.interface import InputSpec
from higvf_interfaces.decisions.evidence import STREAMING
from higvf_interfaces.decisions.options import DECODERS, DECODING, RECORDED, signal_request
from higvf_interfaces.decoding import replay
from higvf_interfaces.decoding.emg_lda import BAND
from higvf_interfaces.decoding.evaluation import (
    Score,
    false_commands_per_minute,
    score_decoder,
    score_emg,
    verdict,
)
from higvf_interfaces.decoding.ssvep import WINDOW
from higvf_interfaces.fields import Fields, option_fields
from higvf_interfaces.formats.signals.reading import read_signals

FULL_BAND = 2 * BAND[1]  # Nyquist rate of surface EMG [Hz]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    parser = argparse.ArgumentParser(prog="python -m higvf_interfaces.decoding", description=__doc__)
    parser.add_argument("file", help="recording of raw samples")
    parser.add_argument("options", help="such as decoder=ssvep,targets=1@30+2@20,mains=60,trial_s=3")
    parser.add_argument(
        "--idle", action="store_true", help="the recording contains no intended command: count false commands"
    )
    parser.add_argument("--json", action="store_true", help="write JSON")
    given = parser.parse_args(arguments)
    try:
        parts = dict(part.partition("=")[::2] for part in given.options.split(","))
        options = option_fields(InputSpec("decoding", given.file, options=parts), (*RECORDED, *DECODING))
        found = idle_report(given.file, options) if given.idle else report(given.file, options)
    except HigvfError as problem:
        print(problem, file=sys.stderr)
        return 2
    print(json.dumps(found, indent=2) if given.json else "\n".join(f"{key}: {value}" for key, value in found.items()))
    return 0


def report(source: str, options: Fields) -> dict[str, Any]:
    """Return the scores of a labelled recording, cross-validated by trial if the decoder is fitted.

    Raises:
        InputError: If the recording, its trials or an option is invalid.
    """
    kind, mains = options.choice("decoder", "", tuple(DECODERS)), options.number("mains", 50.0, 0.0, 1000.0, "Hz")
    record = read_signals(source, signal_request(options))
    trials, moved = replay.labelled(source, record, options)
    cautions: list[str] = []
    if kind == "lda":
        result = score_emg(record, trials, mains)
        if record.rate < FULL_BAND:
            cautions.append(f"{record.rate:.0f} Hz covers only part of the EMG band, which extends to {BAND[1]:.0f} Hz")
    else:
        window = options.number("window", WINDOW, 0.2, 10.0, "s")
        result = score_decoder(kind, record, trials, replay.ssvep_decoder(record, options, mains), window)
    return _figures(result) | {"notes": [*cautions, *moved, *record.notes]}


def idle_report(source: str, options: Fields) -> dict[str, Any]:
    """Return the false commands per minute in a recording without intended commands.

    Raises:
        InputError: If the recording or an option is invalid.
    """
    feed = replay.decoder_feed(source, options, 0.0)
    decisions = [due.decision for due in feed.due(float("inf"))]
    return {
        "decoder": options.text("decoder"),
        "decisions": len(decisions),
        "false_commands_per_minute": round(false_commands_per_minute(decisions, STREAMING), 2),
        "notes": list(feed.notes),
    }


def _figures(result: Score) -> dict[str, Any]:
    low, high = result.interval
    return {
        "decoder": result.decoder,
        "trials": result.trials,
        "accuracy_by_trial": round(result.accuracy, 3),
        "interval_95": [round(low, 3), round(high, 3)],
        "chance": round(result.chance, 3),
        "accuracy_by_window": round(result.windows_correct / result.windows, 3),
        "trials_with_their_command": result.reached,
        "latency_s": round(result.latency_s, 2),
        "wrong_commands_per_minute": round(result.wrong_per_minute, 1),
        "confusion": {f"{cued} -> {decided or 'none'}": count for (cued, decided), count in result.confusion.items()},
        "verdict": verdict(result),
    }


if __name__ == "__main__":
    sys.exit(main())

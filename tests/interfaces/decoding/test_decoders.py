"""Decoders find the signal in any division into chunks, and report idleness without one."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import Pause, Pick
from higvf_console.core.errors import InputError
from higvf_console.core.interface import ChannelState, InputSpec, OperatorContext
from higvf_interfaces.decisions.bci import open_bci
from higvf_interfaces.decisions.emg import open_emg
from higvf_interfaces.decoding.conditioning import Conditioner
from higvf_interfaces.decoding.contract import Decoder, SlidingWindow, Trial
from higvf_interfaces.decoding.emg_features import features
from higvf_interfaces.decoding.emg_lda import EmgDecoder, EmgFrontEnd, fit
from higvf_interfaces.decoding.fbcca import usable_harmonics
from higvf_interfaces.decoding.ssvep import IDLE, SsvepDecoder
from higvf_interfaces.decoding.trials import trials_of
from higvf_interfaces.formats.records import Decision
from higvf_interfaces.formats.signals.records import SignalChunk

ContextAt = Callable[..., OperatorContext]
Write = Callable[..., str]
RATE = 1000.0
CUES = [Trial(label, 3.0 * k + 0.5, 3.0 * k + 2.5) for k, label in enumerate(["fist", "open", "rest"] * 4)]


def emg(seed: int = 1, cues: Sequence[Trial] = CUES) -> SignalChunk:
    """Two electrodes on large drifting offsets: a fist moves the first muscle, an open hand the second."""
    draw = np.random.default_rng(seed)
    times = np.arange(0.0, cues[-1].end + 0.5, 1 / RATE)
    params = np.ones((len(times), 2)) * 5.0
    for cue in cues:
        inside = (times >= cue.start) & (times < cue.end)
        params[inside] = {"fist": (60.0, 10.0), "open": (10.0, 60.0), "rest": (5.0, 5.0)}[cue.label]
    offsets = np.array([20_000.0, -5_000.0]) + 10.0 * times[:, None]
    return SignalChunk(floats(times), floats(offsets + params * draw.normal(size=(len(times), 2))))


def eeg(frequency: float, seconds: float = 8.0, *, hum: float = 0.0, rate: float = 256.0) -> SignalChunk:
    """One electrode: noise of 10 uV, a response of 5 uV where `frequency` is not 0, mains hum at 60 Hz."""
    draw = np.random.default_rng(5)
    times = np.arange(0.0, seconds, 1 / rate)
    wave = 5.0 * np.sin(2 * np.pi * frequency * times + 0.7) * (frequency > 0)
    wave += hum * np.sin(2 * np.pi * 60.0 * times)
    return SignalChunk(floats(times), floats(wave + 10.0 * draw.normal(size=len(times)), -1, 1))


def pushed(decoder: Decoder, signal: SignalChunk, sizes: Sequence[int]) -> list[Decision]:
    """The decisions made of a signal that comes in chunks of these sizes, over and over."""
    decisions, start, k = list[Decision](), 0, 0
    while start < len(signal.times):
        stop = start + sizes[k % len(sizes)]
        decisions += decoder.push(SignalChunk(signal.times[start:stop], signal.values[start:stop]))
        start, k = stop, k + 1
    return decisions


def emg_decoder() -> EmgDecoder:
    windows = EmgFrontEnd(RATE, 50.0).windows(emg())
    return EmgDecoder(fit(windows, CUES), RATE, 50.0)


def test_gestures_are_classified_in_a_recording_unseen_by_the_model() -> None:
    decisions = pushed(emg_decoder(), emg(seed=2), [512])
    inside = [(d, cue) for cue in CUES for d in decisions if cue.start + 0.3 <= d.time <= cue.end]
    assert np.mean([d.label == cue.label for d, cue in inside]) > 0.97
    assert all(d.confidence is not None and 1 / 3 <= d.confidence <= 1 for d in decisions)


@pytest.mark.parametrize("make", [emg_decoder, lambda: SsvepDecoder({"a": 12.0, "b": 15.0}, 256.0, 60.0)])
def test_decisions_do_not_depend_on_the_chunks_and_a_restart_clears_the_state(make: Callable[[], Decoder]) -> None:
    decoder = make()
    signal = emg() if "fist" in decoder.labels else eeg(12.0)
    whole = pushed(decoder, signal, [10**6])
    decoder.restart()
    parts = pushed(decoder, signal, [1, 7, 64, 400])
    assert [(d.time, d.label) for d in parts] == [(d.time, d.label) for d in whole]
    assert [d.confidence for d in parts] == pytest.approx([d.confidence for d in whole])
    assert len(whole) > 20


def test_decisions_are_causal() -> None:
    decoder = emg_decoder()
    signal = emg()
    whole = pushed(decoder, signal, [512])
    decoder.restart()
    changed = signal.values.copy()
    changed[3000:] = 0.0
    cut = pushed(decoder, signal._replace(values=changed), [512])
    before = signal.times[3000]
    assert [d for d in cut if d.time < before] == [d for d in whole if d.time < before]


def test_missing_samples_do_not_affect_later_decisions() -> None:
    signal = emg()
    holed = signal.values.copy()
    holed[1000:1010] = np.nan
    holed[0] = np.nan
    decisions = pushed(emg_decoder(), signal._replace(values=holed), [512])
    assert all(np.isfinite(d.confidence or 0.0) for d in decisions)
    assert [d.label for d in decisions if 7.0 < d.time < 8.4] == ["rest"] * 14


def test_features_follow_their_definitions() -> None:
    window = floats([[1.0], [-1.0], [1.0], [1.0], [3.0]])
    log_mav, log_rms, log_wl, crossings, turns = features(window, floats([0.5])).tolist()
    assert np.exp([log_mav, log_rms, log_wl]) == pytest.approx([7 / 5, np.sqrt(13 / 5), 6 / 4])
    assert crossings == pytest.approx(2 / 4)
    assert turns == pytest.approx(1 / 3)
    assert features(window, floats([9.0])).tolist()[3:] == [0, 0], "steps within the deadband do not count"


def test_the_filter_passes_its_band_and_stops_offset_and_mains() -> None:
    times = np.arange(0, 8, 1 / 256)

    def gain(frequency: float, offset: float = 0.0) -> float:
        wave = floats(np.sin(2 * np.pi * frequency * times) + offset, -1, 1)
        return float(np.abs(Conditioner(256.0, 8.0, 88.0, 60.0).filtered(wave)[1024:]).max())

    assert gain(20.0) == pytest.approx(1.0, abs=0.05)
    assert gain(60.0) < 0.05
    assert gain(1.0) < 0.05
    assert np.abs(Conditioner(256.0, 8.0, 88.0, 60.0).filtered(floats(np.full((64, 1), 1e4)))).max() < 1e-3
    with pytest.raises(InputError, match=r"a rate of 20 Hz is too low for the decoder's band, which starts at 20 Hz"):
        Conditioner(20.0, 20.0, 450.0, 50.0)


@pytest.mark.parametrize(("frequency", "label"), [(12.0, "a"), (15.0, "b"), (0.0, IDLE)])
def test_the_flicker_looked_at_is_found_and_idleness_too(frequency: float, label: str) -> None:
    decisions = pushed(SsvepDecoder({"a": 12.0, "b": 15.0}, 256.0, 60.0), eeg(frequency), [128])
    assert np.mean([d.label == label for d in decisions]) > 0.8


def test_mains_hum_is_not_decoded_as_a_flicker_with_that_harmonic() -> None:
    targets = {"a": 30.0, "b": 20.0}
    hummed = pushed(SsvepDecoder(targets, 256.0, 60.0), eeg(20.0, hum=200.0), [128])
    assert np.mean([d.label == "b" for d in hummed]) > 0.8
    assert usable_harmonics([30.0, 20.0], 256.0, 60.0, 2) == [[1], [1]]
    assert usable_harmonics([30.0, 20.0], 256.0, 50.0, 2) == [[1, 2], [1, 2]]
    assert usable_harmonics([12.0, 15.0], 60.0, 50.0, 2) == [[1], [1]], "30 Hz is above 0.45 of 60 Hz"


@pytest.mark.parametrize("targets", [{}, {"a": 12.0}, {"a": 12.0, "b": 12.5}, {"a": 1.0, "b": 12.0}])
def test_targets_too_close_to_be_resolved_are_refused(targets: dict[str, float]) -> None:
    with pytest.raises(InputError, match="targets: "):
        SsvepDecoder(targets, 256.0, 60.0)


def test_calibration_on_too_few_windows_is_refused_with_the_counts() -> None:
    windows = EmgFrontEnd(RATE, 50.0).windows(emg())
    with pytest.raises(InputError, match=r"needs at least two labels with 5 windows .*; it has {'fist': \d+}"):
        fit(windows, CUES[:1])
    with pytest.raises(InputError, match="it has none"):
        fit(windows, [])


def test_trials_are_marked_intervals_or_of_fixed_length() -> None:
    pairs = [Decision(1.0, "0s", None), Decision(2.0, "0e", None), Decision(3.0, "fist_start", None),
             Decision(3.5, "1e", None), Decision(4.0, "fist_end", None), Decision(5.0, "2s", None)]  # fmt: skip
    assert trials_of(pairs, None) == [Trial("0", 1.0, 2.0), Trial("fist", 3.0, 4.0)]
    onsets = [Decision(1.0, "left", None), Decision(4.0, "right", None)]
    assert trials_of(onsets, 2.0) == [Trial("left", 1.0, 3.0), Trial("right", 4.0, 6.0)]
    with pytest.raises(InputError, match="give the duration of a trial: trial_s=SECONDS"):
        trials_of(onsets, None)


def test_windows_overlap_by_the_hop_across_chunks() -> None:
    cutter = SlidingWindow(4, 2)
    values = floats(np.arange(10.0), -1, 1)
    ends = [w.time for k in range(10) for w in cutter.push(SignalChunk(values[k : k + 1, 0], values[k : k + 1]))]
    assert ends == [3, 5, 7, 9]


def table(signal: SignalChunk, marks: Sequence[tuple[float, str]] = ()) -> str:
    """A signal as a table of samples with a marker column."""
    marked = {int(np.searchsorted(signal.times, time)): label for time, label in marks}
    titles = ",".join(["timestamps", *(f"ch{k}" for k in range(signal.values.shape[1])), "marker0"])
    rows = (
        f"{time:.6f},{','.join(f'{v:.3f}' for v in row)},{marked.get(k, 0)}"
        for k, (time, row) in enumerate(zip(signal.times.tolist(), signal.values.tolist(), strict=True))
    )
    return titles + "\n" + "\n".join(rows) + "\n"


def every_tick(at: ContextAt, seconds: float) -> list[OperatorContext]:
    return [at(0.02 * k) for k in range(round(50 * seconds))]


def test_decoded_emg_gives_commands_after_calibration(write: Write, at: ContextAt) -> None:
    marks = [m for cue in CUES for m in ((cue.start, f"{cue.label}_start"), (cue.end, f"{cue.label}_end"))]
    calibration = write(table(emg(), marks), "calibration.csv")
    played = write(table(emg(seed=3, cues=CUES[:3])), "played.csv")
    replay = open_emg(InputSpec("emg", played, options={"decoder": "lda", "calibration": calibration}))
    given = [command for context in every_tick(at, 10.0) for command in replay.poll(context)]
    assert type(given[0]) is Pause
    assert 0.5 < given[0].time < 1.2, "the fist begins at 0.5 s"
    assert given[0].confidence is not None
    assert replay.health(10.0).state is ChannelState.ENDED
    again = [command for context in every_tick(at, 10.0) for command in replay.poll(context)]
    assert [(type(c), c.time) for c in again] == [(type(c), c.time) for c in given], "after a reset the same"


def test_attended_flickers_select_robots(write: Write, at: ContextAt) -> None:
    file = write(table(eeg(15.0)))
    options = {"decoder": "ssvep", "targets": "robot1@12+robot2@15", "mains": "60", "channels": "ch0"}
    replay = open_bci(InputSpec("bci", file, options=options))
    given = [command for context in every_tick(at, 9.0) for command in replay.poll(context)]
    assert [command.robot for command in given if isinstance(command, Pick)] == [1]
    assert 1.0 < given[0].time < 4.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"decoder": "csp"}, "decoder: 'csp' is not one of lda, ssvep"),
        ({"decoder": "lda"}, "the key 'calibration' is missing"),
        ({"decoder": "ssvep"}, "targets: None is not LABEL@HZ+LABEL@HZ, such as 1@30+2@20"),
        ({"decoder": "ssvep", "targets": "a@x+b@2"}, "targets: 'a@x+b@2' is not LABEL@HZ"),
        (
            {"decoder": "ssvep", "targets": "a@12+b@15", "rate": "250", "period": "0.004"},
            "rate and period exclude each other",
        ),
    ],
)
def test_missing_options_of_a_decoder_are_named(write: Write, options: dict[str, str], message: str) -> None:
    file = write(table(eeg(0.0, 2.0)))
    with pytest.raises(InputError) as refusal:
        open_bci(InputSpec("bci", file, options=options))
    assert message in str(refusal.value)


def test_without_scikit_learn_the_message_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "sklearn.discriminant_analysis", None)
    with pytest.raises(InputError, match=r"decoder=lda needs scikit-learn: pip install 'higvf-console\[signals\]'"):
        fit([], CUES)


def test_calibration_with_other_channels_is_refused(write: Write) -> None:
    marks = [m for cue in CUES[:6] for m in ((cue.start, f"{cue.label}_start"), (cue.end, f"{cue.label}_end"))]
    calibration = write(table(emg(cues=CUES[:6]), marks), "calibration.csv")
    one: Floats = emg(cues=CUES[:1]).values[:, :1]
    played = write(table(SignalChunk(emg(cues=CUES[:1]).times, one)), "played.csv")
    with pytest.raises(InputError, match="has 2 channels and the recording 1; choose the same channels by channels="):
        open_emg(InputSpec("emg", played, options={"decoder": "lda", "calibration": calibration}))


def test_calibration_in_another_unit_is_refused(write: Write) -> None:
    marks = [m for cue in CUES[:6] for m in ((cue.start, f"{cue.label}_start"), (cue.end, f"{cue.label}_end"))]
    calibration = write(table(emg(cues=CUES[:6]), marks).replace("ch0", "ch0 [V]"), "calibration.csv")
    played = write(table(emg(cues=CUES[:1])).replace("ch0", "ch0 [uV]"), "played.csv")
    with pytest.raises(InputError, match=r"ch0 .*is in V and the signal to decode in uV; record both in one unit"):
        open_emg(InputSpec("emg", played, options={"decoder": "lda", "calibration": calibration}))


def test_the_shared_ssvep_recording_plays_through_the_channel(sample: Callable[[str], Path], at: ContextAt) -> None:
    file = str(sample("eeg_ssvep_muse/data_2017-09-14-21.20.04.csv"))
    replay = open_bci(InputSpec("bci", file, options={"decoder": "ssvep", "targets": "1@30+2@20", "mains": "60"}))
    given = [command for context in every_tick(at, 40.0) for command in replay.poll(context)]
    picked = [command.robot for command in given if isinstance(command, Pick)]
    assert picked[0] == 0, "the first flicker is 30 Hz"
    assert set(picked) == {0, 1}

"""Options that look like numbers are read as names where names are expected; misplaced options are refused."""

from collections.abc import Callable

import pytest

from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec
from higvf_interfaces.decisions.bci import open_bci
from higvf_interfaces.decisions.options import word
from higvf_interfaces.emulation import GAZE_ERRORS
from higvf_interfaces.fields import NAMES, option_fields
from higvf_interfaces.gaze.interface import open_gaze
from higvf_interfaces.live import lsl
from higvf_interfaces.live.lsl import StreamQuery, query_of
from tests.interfaces.formats.xdf_files import Stream, xdf


@pytest.mark.parametrize("text", ["46202862", "1e3", "007", "nan", "2"])
def test_a_name_that_looks_like_a_number_is_a_name(text: str) -> None:
    options = option_fields(InputSpec("bci", "lsl", dict.fromkeys(NAMES, text)), tuple(NAMES))
    assert {key: word(options, key) for key in NAMES} == dict.fromkeys(NAMES, text)
    assert query_of(options, StreamQuery()) == StreamQuery(text, text, text, text)


def test_a_name_that_a_scenario_gives_as_a_number_keeps_its_digits() -> None:
    options = option_fields(InputSpec("bci", settings={"stream": 46202862, "source_id": 20200713.0}), tuple(NAMES))
    assert (word(options, "stream"), word(options, "source_id")) == ("46202862", "20200713")


def test_a_stream_of_digits_can_be_chosen(write: Callable[..., str]) -> None:
    file = write(xdf(*(Stream(name, "Markers", "", 0.0, [1.0], ["stop"]) for name in ("20200713", "20200714"))))
    open_bci(InputSpec("bci", file, {"stream": "20200713"}))


@pytest.mark.parametrize(
    ("opened", "head"), [(open_gaze, "time,x [px],y [px]\n0,1,1\n"), (open_bci, "time,label\n1,stop\n")]
)
@pytest.mark.parametrize("key", lsl.OPTIONS)
def test_an_option_of_live_streams_is_refused_for_a_file(
    write: Callable[..., str], opened: Callable[[InputSpec], object], head: str, key: str
) -> None:
    file = write(head)
    with pytest.raises(InputError, match=f"{key} chooses a live stream, and this is a file; give lsl in its place"):
        opened(InputSpec("input", file, {key: "3"}))
    opened(InputSpec("input", file, settings={key: "3"}))  # a scenario may be made for the live stream


@pytest.mark.parametrize(
    ("opened", "key"),
    [
        *((open_gaze, key) for key in ("format", "stream", "start", *GAZE_ERRORS)),
        *((open_bci, key) for key in ("format", "stream", "start", "rate", "period")),
    ],
)
def test_an_option_of_recordings_is_refused_for_a_live_stream(opened: Callable[[InputSpec], object], key: str) -> None:
    with pytest.raises(InputError, match=f"{key} is for recordings, and this is a live stream; give a file"):
        opened(InputSpec("input", "lsl", {key: "1", "within": "0.1"}))


@pytest.mark.parametrize(
    ("options", "refusal"),
    [
        ({"decoder": "foo"}, "decoder: 'foo' is not one of lda, ssvep"),
        ({"targets": "1@30"}, "targets is for decoder=ssvep; give that, or leave targets out"),
        ({"channels": "TP9"}, "channels is for decoder=lda or ssvep"),
        ({"decoder": "lda", "window": "2"}, "window is for decoder=ssvep"),
        ({"decoder": "ssvep", "calibration": "today.xdf"}, "calibration is for decoder=lda"),
    ],
)
def test_an_option_of_another_decoder_is_refused(
    write: Callable[..., str], options: dict[str, str], refusal: str
) -> None:
    with pytest.raises(InputError, match=refusal):
        open_bci(InputSpec("bci", write("time,label\n1,stop\n"), options))

"""The suite of live streams counts its pushes, and its table agrees with its JSON."""

import pytest

from higvf_console.core.errors import HigvfError
from higvf_console.lab.bench import lsl as bench_lsl


def test_every_push_becomes_a_command_and_the_table_reports_it() -> None:
    pytest.importorskip("pylsl")
    figures = bench_lsl.run(pushes=10, hour_s=10.0)
    assert [taken["count"] for taken in figures["latency_ms"].values()] == [10, 10]
    assert figures["hour"]["samples"] == 1200
    text = bench_lsl.table(figures)
    assert "polled each tick" in text
    assert "1200 samples" in text


def test_a_stream_without_commands_is_an_error_and_no_number() -> None:
    assert bench_lsl.percentiles([1.0, 3.0]) == {"p50": 2.0, "p99": 2.98, "count": 2}
    with pytest.raises(HigvfError, match="no push came back as a command"):
        bench_lsl.percentiles([])

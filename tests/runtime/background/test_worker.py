"""Heavy work is done in another process, with limits; what exceeds them harms nobody else."""

import os
import time
from collections.abc import Callable, Generator
from concurrent.futures import CancelledError

import pytest

from higvf_console.core.commands import LoadScenario
from higvf_console.core.errors import ScenarioError
from higvf_console.runtime.background.worker import Worker
from higvf_console.runtime.dispatch import prepare
from higvf_console.scenario.scenario import load_scenario


@pytest.fixture(scope="module")
def worker() -> Generator[Worker]:
    one = Worker(most_memory=2 << 30, most_time=5.0)
    yield one
    one.close()


def test_a_result_and_a_refusal_come_back() -> None:
    worker = Worker()
    text = load_scenario("firefighting").text
    scenario, setup = worker.submit(prepare, LoadScenario(text=text, name="f.yaml"), 0).result()
    assert (scenario.title, len(setup.start.motion.position)) == ("Firefighting", 3)
    with pytest.raises(ScenarioError, match=r"f\.yaml: line 1: "):
        worker.submit(prepare, LoadScenario(text="[", name="f.yaml"), 0).result()
    worker.close()


@pytest.mark.parametrize(
    ("function", "argument"), [(bytes, 3 << 30), (time.sleep, 60.0), (os._exit, 3)], ids=["memory", "time", "death"]
)
def test_what_exceeds_a_limit_is_refused_and_the_next_job_is_done(
    worker: Worker, function: Callable[..., object], argument: object
) -> None:
    pid = worker.submit(os.getpid).result()
    with pytest.raises(ScenarioError, match=r"takes more than 5 s or 2\.1 GB"):
        worker.submit(function, argument).result()
    assert worker.submit(os.getpid).result() not in (pid, os.getpid())


def test_closing_ends_the_process_and_cancels_what_waits() -> None:
    one = Worker()
    pid = one.submit(os.getpid).result()
    busy, waiting = one.submit(time.sleep, 60.0), one.submit(os.getpid)
    one.close()
    with pytest.raises((ScenarioError, CancelledError)):
        busy.result(timeout=5.0)
    with pytest.raises(CancelledError):
        waiting.result(timeout=5.0)
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)

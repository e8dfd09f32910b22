"""Scenarios are prepared in the order of their commands, and handed over whole, or refused with the reason."""

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

import pytest

from higvf_console.core.commands import LoadScenario
from higvf_console.core.errors import ScenarioError
from higvf_console.runtime.background.loader import Loader


class FakeWorker:
    """Does a job when it is told to."""

    def __init__(self) -> None:
        self.jobs: list[tuple[tuple[Any, ...], Future[Any]]] = []

    def submit(self, _function: Callable[..., Any], *arguments: Any) -> "Future[Any]":
        self.jobs.append((arguments, Future()))
        return self.jobs[-1][1]


def file(name: str) -> LoadScenario:
    return LoadScenario(text="version: 1", name=name)


@pytest.fixture(name="worker")
def _worker() -> FakeWorker:
    return FakeWorker()


@pytest.fixture(name="loader")
def _loader(worker: FakeWorker) -> Loader:
    return Loader(worker)  # pyright: ignore[reportArgumentType]


def test_the_worker_loads_what_the_first_scenario_needs_before_any_is_asked_for(
    worker: FakeWorker, loader: Loader
) -> None:
    assert len(worker.jobs) == 1
    assert loader.take() == []


def test_a_scenario_is_handed_over_once_with_the_channel_that_asked_for_it(worker: FakeWorker, loader: Loader) -> None:
    loader.submit("console", file("a.yaml"), 7)
    arguments, outcome = worker.jobs[-1]
    assert arguments == (file("a.yaml"), 7)
    assert loader.take() == [], "it is not ready, and nobody waits"
    outcome.set_result("prepared")
    (loaded,) = loader.take()
    assert (loaded.said.channel, loaded.said.command, loaded.prepared) == ("console", file("a.yaml"), "prepared")
    assert loader.take() == []


def test_what_was_asked_first_is_handed_over_first_though_it_takes_longer(worker: FakeWorker, loader: Loader) -> None:
    loader.submit("console", file("a.yaml"), 0)
    loader.submit("script", file("b.yaml"), 0)
    (_, first), (_, second) = worker.jobs[1:]
    second.set_result("b")
    assert loader.take() == []
    first.set_result("a")
    assert [loaded.prepared for loaded in loader.take()] == ["a", "b"]


def test_what_cannot_be_read_is_refused_with_the_reason_and_the_next_is_handed_over(
    worker: FakeWorker, loader: Loader
) -> None:
    loader.submit("console", file("a.yaml"), 0)
    loader.submit("console", file("b.yaml"), 0)
    (_, first), (_, second) = worker.jobs[1:]
    first.set_exception(ScenarioError("a.yaml: line 1: no"))
    second.set_result("b")
    refused, loaded = loader.take()
    assert (refused.prepared, refused.refusal) == (None, "a.yaml: line 1: no")
    assert (loaded.prepared, loaded.refusal) == ("b", "")


def test_a_mistake_of_ours_is_no_refusal(worker: FakeWorker, loader: Loader) -> None:
    loader.submit("console", file("a.yaml"), 0)
    worker.jobs[-1][1].set_exception(KeyError("robots"))
    with pytest.raises(KeyError):
        loader.take()

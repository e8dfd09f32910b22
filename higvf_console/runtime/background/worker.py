"""A process for work that may take seconds or gigabytes, such as reading a file that somebody sent.

The control loop and the server share one interpreter, so that a large file read there would hold up both. The worker
has limits to its memory and its time; what exceeds them ends the worker, never the console, and a new one is started.
"""

import contextlib
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable
from concurrent.futures import Future
from queue import SimpleQueue
from typing import Any, BinaryIO, NamedTuple, TypeVar, cast

from higvf_console.core.errors import HigvfError, ScenarioError

MOST_MEMORY = 4 << 30  # bytes of address space that the worker may have
MOST_TIME = 30.0  # for one job [s]
_LENGTH = 8  # bytes that give the length of a message

_Result = TypeVar("_Result")


class _Job(NamedTuple):
    function: Callable[..., Any]
    arguments: tuple[Any, ...]
    outcome: "Future[Any]"


class Worker:
    """One process, and a thread that gives it one job after the other."""

    def __init__(self, most_memory: int = MOST_MEMORY, most_time: float = MOST_TIME) -> None:
        """Starts the thread, which starts the process.

        Args:
            most_memory: that a job may have, the interpreter's own included [bytes].
            most_time: that a job may take [s].
        """
        self._most_memory, self._most_time = most_memory, most_time
        self._jobs: SimpleQueue[_Job | None] = SimpleQueue()
        self._process: subprocess.Popen[bytes] | None = None
        self._closed = False
        self._thread = threading.Thread(target=self._work, name="worker", daemon=True)
        self._thread.start()

    def submit(self, function: Callable[..., _Result], *arguments: Any) -> "Future[_Result]":
        """Lets the process call a function, found by its module and name, with arguments that can be pickled.

        Returns:
            What it returns, in time; `ScenarioError` where it raised a `HigvfError`, or came to a limit.
        """
        outcome: Future[_Result] = Future()
        self._jobs.put(_Job(function, arguments, cast("Future[Any]", outcome)))
        return outcome

    def close(self) -> None:
        """Ends the process; jobs that wait are cancelled."""
        self._closed = True
        self._jobs.put(None)
        if self._process is not None:
            self._process.kill()
        self._thread.join()

    def _work(self) -> None:
        self._process = self._start()
        while (job := self._jobs.get()) is not None:
            if self._closed:
                job.outcome.cancel()
                continue
            try:
                job.outcome.set_result(self._done(job))
            except Exception as error:  # for whoever asked
                job.outcome.set_exception(error)
        self._process.kill()
        self._process.wait()

    def _start(self) -> "subprocess.Popen[bytes]":
        command = [sys.executable, "-m", "higvf_console.runtime.background.worker", str(self._most_memory)]
        return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def _done(self, job: _Job) -> Any:
        process = self._process
        if process is None or process.poll() is not None:
            self._process = process = self._start()
        late = threading.Timer(self._most_time, process.kill)
        late.start()
        try:
            _send(cast(BinaryIO, process.stdin), (job.function, job.arguments))
            succeeded, value = _receive(cast(BinaryIO, process.stdout))
        except (OSError, EOFError) as error:
            process.kill()
            process.wait()
            limits = f"{self._most_time:g} s or {self._most_memory / 1e9:.1f} GB of memory"
            raise ScenarioError(f"it takes more than {limits} to read") from error
        finally:
            late.cancel()
        if succeeded:
            return value
        raise ScenarioError(value)


def submitted(worker: Worker | None, function: Callable[..., _Result], *arguments: Any) -> "Future[_Result]":
    """What a function returns, in time: from the worker, or at once where there is none."""
    if worker is not None:
        return worker.submit(function, *arguments)
    outcome: Future[_Result] = Future()
    try:
        outcome.set_result(function(*arguments))
    except HigvfError as error:
        outcome.set_exception(error)
    return outcome


def _send(stream: BinaryIO, message: object) -> None:
    content = pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)
    stream.write(len(content).to_bytes(_LENGTH, "big") + content)
    stream.flush()


def _receive(stream: BinaryIO) -> Any:
    length = stream.read(_LENGTH)
    if len(length) < _LENGTH:
        raise EOFError
    content = stream.read(int.from_bytes(length, "big"))
    return pickle.loads(content)


def _serve(most_memory: int) -> None:
    """The process: does jobs until its input ends."""
    if sys.platform != "win32":
        import resource  # noqa: PLC0415 (not on Windows)

        resource.setrlimit(resource.RLIMIT_AS, (most_memory, most_memory))
    reading, writing = sys.stdin.buffer, sys.stdout.buffer
    sys.stdout = sys.stderr  # what a library prints must not get between the messages
    with contextlib.suppress(EOFError, KeyboardInterrupt):
        while True:
            function, arguments = _receive(reading)
            try:
                result: tuple[bool, object] = True, function(*arguments)
            except HigvfError as error:
                result = False, str(error)
            except MemoryError:
                break  # the other side reports the limit
            except Exception as error:  # a mistake of ours, which must not end the worker
                result = False, f"it cannot be read ({type(error).__name__}: {error})"
            _send(writing, result)


if __name__ == "__main__":
    _serve(int(sys.argv[1]))

"""A console in a process of its own and a page of it in headless Chromium, for benchmarks of both."""

import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from higvf_console.core.errors import HigvfError
from higvf_console.lab.bench.chromium import find_chromium, launched

PATIENCE_S = 300.0  # for a start that compiles the engine
_READY = "() => window.higvf && window.__viserMutable?.cameraControl"
_NO_HINTS = "localStorage.setItem('higvf-hints', '[\"away\"]')"

# Animation frames that the page comes to in some milliseconds, a second.
_FRAMES = """
(duration) => new Promise((done) => {
  const start = performance.now();
  let frames = 0;
  const count = (now) => {
    if (now - start >= duration) return done(1000 * frames / (now - start));
    frames++;
    requestAnimationFrame(count);
  };
  requestAnimationFrame(count);
})
"""
# A stroke of a mouse through the middle of the canvas, 125 events a second; answers when it ended [s since the epoch].
_STROKE = """
([width, points]) => new Promise((done) => {
  const canvas = window.__viserMutable.canvas;
  const box = canvas.getBoundingClientRect();
  const send = (type, share) => canvas.dispatchEvent(new PointerEvent(type, {
    bubbles: true, composed: true, cancelable: true, pointerId: 77, isPrimary: true, pointerType: "mouse",
    clientX: box.left + box.width * (0.5 + width * (share - 0.5)), clientY: box.top + box.height * 0.5,
    button: type === "pointermove" ? -1 : 0, buttons: type === "pointerup" ? 0 : 1,
  }));
  send("pointerdown", 0);
  let sent = 0;
  const timer = setInterval(() => {
    if (++sent < points) return send("pointermove", sent / points);
    clearInterval(timer);
    const now = (performance.timeOrigin + performance.now()) / 1000;
    send("pointerup", 1);
    done(now);
  }, 8);
})
"""


class Server(NamedTuple):
    """A console that runs.

    Attributes:
        url: its login link.
        process: its number, as the system counts.
    """

    url: str
    process: int


@contextmanager
def console_of(scenario: str) -> Generator[Server]:
    """Runs a scenario, a name or a file, in a console of its own.

    Raises:
        HigvfError: it does not start; the message is what it said.
    """
    command = [sys.executable, "-m", "higvf_console", "run", scenario, "--port", "auto", "--no-browser"]
    with tempfile.TemporaryFile("w+") as said:
        running = subprocess.Popen(command, stdout=said, stderr=subprocess.STDOUT, text=True)
        try:
            yield Server(_link(running, said), running.pid)
        finally:
            running.terminate()
            running.wait()


def _link(running: "subprocess.Popen[str]", said: Any) -> str:
    end = time.monotonic() + PATIENCE_S
    while running.poll() is None and time.monotonic() < end:
        said.seek(0)
        if found := re.search(r"^Console: (\S+)\n", said.read(), re.MULTILINE):
            return found[1]
        time.sleep(0.05)
    said.seek(0)
    raise HigvfError(f"the console does not start: {said.read().strip() or 'it says nothing'}")


def cpu_seconds(process: int) -> float:
    """Processor time that a process has taken so far [s].

    Raises:
        HigvfError: this system has no /proc that tells.
    """
    try:
        fields = Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    except OSError as error:
        raise HigvfError(f"suite ui reads processor time from /proc, as Linux has it ({error})") from error
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@contextmanager
def browser_at_hand() -> Generator[Any]:
    """A headless Chromium, as Playwright's `Browser`.

    Raises:
        HigvfError: Playwright or Chromium is missing; the message says how to get it.
    """
    if (path := find_chromium()) is None:
        raise HigvfError("suite ui needs Chromium: install the package 'chromium', or name it by HIGVF_CHROMIUM")
    with launched(path) as browser:
        yield browser


class ConsolePage:
    """A page of 1280 x 720 that steers."""

    def __init__(self, browser: Any, url: str) -> None:
        """Opens it and waits until it is ready to be drawn in."""
        self._context = browser.new_context(viewport={"width": 1280, "height": 720})
        self._context.add_init_script(_NO_HINTS)
        self._page = self._context.new_page()
        self._page.set_default_timeout(1e3 * PATIENCE_S)
        self._page.goto(url)
        self._page.wait_for_function(_READY, polling=50)

    def frame_rate(self, seconds: float) -> float:
        """Animation frames a second, over some seconds."""
        return float(self._page.evaluate(_FRAMES, 1e3 * seconds))

    def stroke(self, width: float, points: int = 16) -> float:
        """Draws a stroke across a share of the canvas; answers when it ended [s since the epoch]."""
        return float(self._page.evaluate(_STROKE, [width, points]))

    def reset(self) -> None:
        """Sets the run back to its start, without waiting for frames in which the buttons stand still."""
        for label in ("Reset run", "Press again to reset the run"):
            self._page.get_by_role("button", name=label, exact=True).dispatch_event("click")

    def close(self) -> None:
        """Closes it."""
        self._context.close()

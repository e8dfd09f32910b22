"""Starts a console in its own process and opens a page of it in headless Chromium, to measure both."""

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

PATIENCE_S = 300.0  # timeout of the start, which may compile the engine
_READY = "() => window.higvf && window.__viserMutable?.cameraControl"
_NO_HINTS = "localStorage.setItem('higvf-hints', '[\"away\"]')"

# Counts animation frames for `duration` ms; resolves to frames per second.
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
# Draws a mouse stroke across the middle of the canvas at 125 events/s; resolves to its end time [s since the epoch].
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
    """A running console.

    Attributes:
        url: login link.
        process: process id.
    """

    url: str
    process: int


@contextmanager
def console_of(scenario: str, *options: str) -> Generator[Server]:
    """Runs a scenario, given by name or file, in a console in its own process.

    Args:
        scenario: name or file.
        options: further ones of `higvf run`.

    Raises:
        HigvfError: the console does not start; the message holds its output.
    """
    command = [sys.executable, "-m", "higvf_console", "run", scenario, "--port", "auto", "--no-browser"]
    command += ["--start-at-once", *options]
    with tempfile.TemporaryFile("w+") as output:
        running = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, text=True)
        try:
            yield Server(_link(running, output), running.pid)
        finally:
            running.terminate()
            running.wait()


def _link(running: "subprocess.Popen[str]", output: Any) -> str:
    end = time.monotonic() + PATIENCE_S
    while running.poll() is None and time.monotonic() < end:
        output.seek(0)
        if found := re.search(r"^Console: (\S+)\n", output.read(), re.MULTILINE):
            return found[1]
        time.sleep(0.05)
    output.seek(0)
    raise HigvfError(f"the console does not start: {output.read().strip() or 'it printed nothing'}")


def cpu_seconds(process: int) -> float:
    """CPU time of a process so far [s].

    Raises:
        HigvfError: the system has no /proc.
    """
    try:
        fields = Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    except OSError as error:
        raise HigvfError(f"suite ui reads CPU times from /proc, which only Linux has ({error})") from error
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@contextmanager
def open_browser() -> Generator[Any]:
    """Launches headless Chromium and yields it as Playwright's `Browser`.

    Raises:
        HigvfError: Playwright or Chromium is not installed.
    """
    if (path := find_chromium()) is None:
        raise HigvfError("suite ui needs Chromium: install the package 'chromium', or set HIGVF_CHROMIUM to its path")
    with launched(path) as browser:
        yield browser


class ConsolePage:
    """A page of 1280 x 720 px that has control of the console."""

    def __init__(self, browser: Any, url: str) -> None:
        """Opens the page and waits until it accepts strokes."""
        self._context = browser.new_context(viewport={"width": 1280, "height": 720})
        self._context.add_init_script(_NO_HINTS)
        self._page = self._context.new_page()
        self._page.set_default_timeout(1e3 * PATIENCE_S)
        self._page.goto(url)
        self._page.wait_for_function(_READY, polling=50)

    def frame_rate(self, seconds: float) -> float:
        """Animation frames per second, averaged over `seconds`."""
        return float(self._page.evaluate(_FRAMES, 1e3 * seconds))

    def stroke(self, width: float, points: int = 16) -> float:
        """Draws a stroke over the share `width` of the canvas; returns its end time [s since the epoch]."""
        return float(self._page.evaluate(_STROKE, [width, points]))

    def reset(self) -> None:
        """Resets the run; dispatches the clicks directly, since waiting for stable buttons takes several frames."""
        for label in ("Reset run", "Press again to reset the run"):
            self._page.get_by_role("button", name=label, exact=True).dispatch_event("click")

    def close(self) -> None:
        """Closes the page."""
        self._context.close()

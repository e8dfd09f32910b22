"""Launches the system's Chromium headless and without a graphics card, for benchmarks and tests."""

import os
import shlex
import shutil
import tempfile
from collections.abc import Generator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

from higvf_console.core.errors import HigvfError

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
# Software WebGL, software compositing (a third of the work) and no background traffic of the browser.
_FLAGS = (
    "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist", "--disable-gpu-compositing", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--no-first-run",
)  # fmt: skip


def find_chromium() -> str | None:
    """Path of Chromium: the value of HIGVF_CHROMIUM, else the first of `NAMES` on the PATH; None if there is none."""
    return os.environ.get("HIGVF_CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)


@contextmanager
def launched(path: str) -> Generator[Any]:
    """Launches the Chromium at `path` and yields it as Playwright's `Browser`.

    Raises:
        HigvfError: Playwright is not installed.
    """
    try:
        playwright = import_module("playwright.sync_api")
    except ImportError as error:
        raise HigvfError(f"a browser needs Playwright: pip install 'higvf-console[dev]' ({error})") from error
    with tempfile.TemporaryDirectory() as folder, playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=_without_priority(path, Path(folder)), args=list(_FLAGS))
        try:
            yield browser
        finally:
            browser.close()


def _without_priority(path: str, folder: Path) -> str:
    """Path of a wrapper without the right to raise its priority: as root, Chromium would preempt all other programs."""
    setpriv = shutil.which("setpriv")
    if setpriv is None or os.geteuid() != 0:
        return path
    script = folder / "chromium"
    script.write_text(f'#!/bin/sh\nexec {setpriv} --bounding-set -sys_nice {shlex.quote(path)} "$@"\n', "utf-8")
    script.chmod(0o700)
    return str(script)

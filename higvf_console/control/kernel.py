"""The one decorator around Numba: `@kernel` compiles an equation to machine code, once, on disk.

Numba renews its cache when a function's own file changes, not when a callee's does; so the cache folder is named after
the digest of all sources that can hold a kernel. `error_model="numpy"` keeps one robot's 0/0 from raising for the whole
team; there is no `parallel` and no `fastmath`, so that results agree bit for bit across processes.
"""

import hashlib
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

_Function = TypeVar("_Function", bound=Callable[..., Any])
_KEPT_FOR = 14 * 86400.0  # [s]; caches of builds that nobody has run for so long are removed


def _cache_folder() -> Path:
    house = Path(__file__).parents[1]
    digest = hashlib.sha256()
    sources = [house / "core" / "arrays.py", house / "core" / "state.py", *house.glob("control/**/*.py")]
    sources += [source for source in house.glob("sim/**/*.py") if "@kernel" in source.read_text(encoding="utf-8")]
    for source in sorted(sources):
        digest.update(source.read_bytes())
    root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache", "higvf")
    folder = root / digest.hexdigest()[:16]
    folder.mkdir(parents=True, exist_ok=True)
    folder.touch()
    now = folder.stat().st_mtime
    for old in root.iterdir():
        if now - old.stat().st_mtime > _KEPT_FOR:
            shutil.rmtree(old, ignore_errors=True)
    return folder


os.environ["NUMBA_CACHE_DIR"] = str(_cache_folder())

import numba  # noqa: E402 (the cache folder must be named before)
from numba.core.config import reload_config  # noqa: E402

reload_config()


def kernel(function: _Function) -> _Function:
    """Compiles `function` on its first call, releases the GIL inside it, and keeps the machine code on disk."""
    return cast(_Function, numba.njit(cache=True, nogil=True, error_model="numpy")(function))


def closed(function: Callable[..., Any]) -> None:
    """Forbids any further compilation of a kernel: a wrong type is then an error at once, not a stall of seconds."""
    if hasattr(function, "disable_compile"):  # absent under NUMBA_DISABLE_JIT=1
        function.disable_compile()  # pyright: ignore[reportFunctionMemberAccess]

"""Machine code on disk: one file for each kernel and signature, in a folder named after the sources.

Numba's own cache is renewed when a function's own file changes, not when a callee's does, and a damaged file ends it in
a traceback. Here the folder's name is the digest of all sources that can hold a kernel, and `Store` survives damage.
"""
# Numba has no public way to do this.
# pyright: reportPrivateUsage=false, reportIncompatibleMethodOverride=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false

import hashlib
import os
import pickle
import platform
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba.core.caching import _Cache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from higvf_console.control.compilation.progress import compiling
from higvf_console.control.compilation.store import Store


def cache_folder() -> Path:
    """`higvf/DIGEST` in XDG_CACHE_HOME, or in ~/.cache."""
    root = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(root, "higvf", _digest_of_sources())


def _digest_of_sources() -> str:
    package = Path(__file__).parents[2]
    sources = [package / "core" / "arrays.py", package / "core" / "state.py"]
    sources += [*package.glob("control/**/*.py"), *package.glob("sim/**/*.py")]
    digest = hashlib.sha256()
    for source in sorted(sources):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


STORE = Store(cache_folder)  # of this process; touches the disk when the first kernel is called


class KernelCache(_Cache):
    """The compiled signatures of one function, as Numba's dispatcher asks for them."""

    suffix = ".kernel"

    def __init__(self, function: Callable[..., Any]) -> None:
        """Touches nothing yet."""
        self._function = function
        self._enabled = True

    @property
    def cache_path(self) -> str:
        """The folder of the files."""
        return str(STORE.folder)

    def load_overload(self, sig: Any, target_context: Any) -> CompileResult | None:
        """The machine code for a signature; None where it has to be compiled."""
        target_context.refresh()  # installs what the unpickled code calls
        name = self._file_name(sig, target_context.codegen())
        payload = STORE.read(name) if self._enabled else None
        if payload is not None:
            try:
                return self._rebuilt(target_context, pickle.loads(payload))
            except Exception as error:  # whatever another build left there
                STORE.discard(name, f"{type(error).__name__}: {error}")
        self._report()
        return None

    def save_overload(self, sig: Any, data: CompileResult) -> None:
        """Keeps the machine code for a signature."""
        if self._enabled and not data.library.has_dynamic_globals:
            STORE.write(self._file_name(sig, data.codegen), dumps(data._reduce()))

    def _rebuilt(self, target_context: Any, reduced: Any) -> CompileResult:
        return CompileResult._rebuild(target_context, *reduced)

    def _report(self) -> None:
        compiling(self._function.__name__)

    def enable(self) -> None:
        """Reads and writes from now on."""
        self._enabled = True

    def disable(self) -> None:
        """Neither reads nor writes from now on."""
        self._enabled = False

    def flush(self) -> None:
        """Nothing: the folder is named after the sources, so its files are never stale."""

    def _file_name(self, sig: Any, codegen: Any) -> str:
        """Unique for the function, its code and signature, the processor, and the versions of the compiler."""
        code = self._function.__code__
        where = (self._function.__module__, self._function.__qualname__, code.co_code, _digest_of(code.co_filename))
        versions = (numba.__version__, np.__version__, platform.python_version())
        key = repr((where, versions, codegen.magic_tuple(), str(sig)))
        return f"{self._function.__name__}-{hashlib.sha256(key.encode()).hexdigest()[:24]}{self.suffix}"


@lru_cache(maxsize=256)
def _digest_of(file: str) -> str:
    """Of a source file, which may lie outside this package; empty for what has none, such as a notebook's cell."""
    try:
        return hashlib.sha256(Path(file).read_bytes()).hexdigest()
    except OSError:
        return ""

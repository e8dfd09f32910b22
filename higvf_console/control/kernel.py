"""The one decorator around Numba: `@kernel` compiles an equation to machine code when it is first called.

Kernels call each other, and Python calls any of them. Numba itself is imported at the first call, so that modules with
equations are quick to import and change nothing. `compilation.dispatcher` says how kernels are compiled, and
`compilation.cache` where they are kept.
"""

import os
from collections.abc import Callable
from functools import cached_property, update_wrapper
from typing import TYPE_CHECKING, Any, TypeVar, cast

if TYPE_CHECKING:
    from higvf_console.control.compilation.dispatcher import Dispatchers

_Function = TypeVar("_Function", bound=Callable[..., Any])


def kernel(function: _Function) -> _Function:
    """Compiles `function` when it is first called; releases the GIL inside it, and keeps the machine code on disk.

    It stays plain Python where NUMBA_DISABLE_JIT=1, for a debugger or for coverage.
    """
    if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        return function
    return cast(_Function, Kernel(function))


def closed(function: Callable[..., Any]) -> None:
    """Forbids to compile a kernel for further types: a wrong one is then an error at once, not a stall of seconds."""
    if isinstance(function, Kernel):
        function.dispatchers.entry.disable_compile()


class Kernel:
    """A function that is compiled when it is needed: by a call from Python, or by a kernel that calls it."""

    def __init__(self, function: Callable[..., Any]) -> None:
        """Imports and compiles nothing yet."""
        update_wrapper(self, function)
        self.py_func = function
        self._call: Callable[..., Any] = self._first_call

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """The compiled function's result."""
        return self._call(*arguments, **named)

    def __reduce__(self) -> str:
        """Pickled by name, as functions are."""
        return self.py_func.__qualname__

    @property
    def _numba_type_(self) -> Any:
        """What Numba takes this object for where a kernel calls it."""
        return self.dispatchers.linked._numba_type_

    @cached_property
    def dispatchers(self) -> "Dispatchers":
        """Numba's objects for this function."""
        from higvf_console.control.compilation.dispatcher import dispatchers  # noqa: PLC0415 (loads the compiler)

        return dispatchers(self.py_func)

    def _first_call(self, *arguments: Any, **named: Any) -> Any:
        self._call = self.dispatchers.entry
        return self._call(*arguments, **named)

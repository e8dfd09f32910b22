"""Shares the work on a large entry between two processes: one lowers a kernel, the other links it into the entry.

Type inference and lowering are Python, and take most of the time. So while one process lowers the controller, another
lowers the safety filter and leaves it in the cache.
"""
# Numba has no public way to do this.
# pyright: reportPrivateUsage=false, reportIncompatibleMethodOverride=false
# pyright: reportUnknownVariableType=false

import itertools
import secrets
from collections.abc import Callable
from typing import Any

from llvmlite.binding import parse_bitcode
from numba import typeof
from numba.core.bytecode import FunctionIdentity
from numba.core.compiler import CompileResult, compile_result

from higvf_console.control.compilation.cache import KernelCache
from higvf_console.control.compilation.dispatcher import LinkedLibrary, uncollected
from higvf_console.control.kernel import Kernel


def lower(function: Callable[..., Any], *arguments: Any) -> None:
    """Lowers a kernel for arguments of these types, without calling it."""
    if isinstance(function, Kernel):
        with uncollected():
            function.dispatchers.linked.compile(tuple(typeof(argument) for argument in arguments))


def hand_over(function: Callable[..., Any]) -> None:
    """From now on the lowered code of a kernel is looked for in the cache, and left there."""
    if isinstance(function, Kernel):
        function.dispatchers.linked._cache = _HandoverCache(function.py_func)


def name_apart() -> None:
    """Lets the names in the code that this process lowers differ from those of other processes.

    Numba numbers them from 1 in each process, and two functions with one name would be taken for one.
    """
    FunctionIdentity._unique_ids = itertools.count(secrets.randbits(48))


class _HandoverCache(KernelCache):
    suffix = ".lowered"

    def _rebuilt(self, target_context: Any, reduced: Any) -> CompileResult:
        (name, _, code), fndesc, environment, signature, _, lifted, annotation, reload_init, environments = reduced
        for function in reload_init:
            function()
        library = LinkedLibrary(target_context.codegen(), name)
        library._final_module = parse_bitcode(code)
        library._finalize_final_module()
        return compile_result(
            typing_context=target_context.typing_context,
            target_context=target_context,
            entry_point=object(),
            type_annotation=annotation,
            library=library,
            signature=signature,
            objectmode=False,
            lifted=lifted,
            fndesc=fndesc,
            environment=environment,
            reload_init=reload_init,
            referenced_envs=environments,
        )

    def _report(self) -> None:
        """Nothing: the entry is reported."""

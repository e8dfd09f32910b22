"""How a kernel is compiled: callers take its code in unoptimised, and only what Python calls becomes machine code.

Numba by itself optimises every function together with all that it calls, and makes machine code and a wrapper for it.
But a kernel that only kernels call never runs alone: its code is linked into its callers and optimised there once more.
So a kernel has two dispatchers:

    linked   what other kernels call: type inference and lowering, and nothing else; its callees stay apart
    entry    what Python calls: the whole tree is linked, optimised once, and kept in the cache

`error_model="numpy"` keeps one robot's 0/0 from raising for the whole team; there is no `parallel` and no `fastmath`,
so that results agree bit for bit across processes.
"""
# Numba has no public way to do this.
# pyright: reportPrivateUsage=false, reportIncompatibleMethodOverride=false
# pyright: reportUnknownArgumentType=false, reportUnknownMemberType=false, reportUnknownVariableType=false

import gc
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import Any, NamedTuple

from llvmlite.binding import parse_assembly
from numba.core import types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, CompileResult, DefaultPassBuilder
from numba.core.registry import CPUDispatcher

from higvf_console.control.compilation.cache import KernelCache

_OPTIONS = {"nopython": True, "nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}
_WRAPPER = "cpython"  # in the names of the functions that Python can call
_OPTIMISATION = 2  # LLVM's level; Numba's 3 takes longer and makes the engine no faster


class Dispatchers(NamedTuple):
    """Numba's two views of one kernel."""

    linked: Any
    entry: Any


def dispatchers(function: Callable[..., Any]) -> Dispatchers:
    """For one function; nothing is compiled yet."""
    linked = _Linked(function, targetoptions={**_OPTIONS, "no_cpython_wrapper": True}, pipeline_class=_LinkedCompiler)
    entry: Any = _Entry(function, targetoptions=_OPTIONS, pipeline_class=_EntryCompiler)
    entry._cache = KernelCache(function)
    return Dispatchers(linked, entry)


class _Linked(CPUDispatcher):
    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Finds or compiles what a caller needs: one version for constants and variables, where Numba makes two."""
        plain = tuple(types.unliteral(kind) for kind in args)
        return super().get_call_template(plain, {name: types.unliteral(kind) for name, kind in kws.items()})

    def add_overload(self, cres: CompileResult) -> None:
        """Makes a signature known to callers; there is no machine code that Python could call."""
        key = object() if cres.entry_point is None else cres.entry_point  # by which callers find it
        self.targetctx.insert_user_function(key, cres.fndesc, [cres.library])
        self.overloads[tuple(cres.signature.args)] = cres._replace(entry_point=key)


class _Entry(CPUDispatcher):
    def compile(self, sig: Any) -> Any:
        with uncollected():
            return super().compile(sig)


@contextmanager
def uncollected() -> Generator[None]:
    """Pauses the garbage collector: the compiler makes millions of objects that stay, and it looks at all of them.

    That took a sixth of the time; without it the largest entry takes 0.7 GB of memory where it took 0.4.
    """
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


class _PlainLibrary(JITCodeLibrary):
    def _optimize_functions(self, ll_module: Any) -> None:
        """Leaves the passes over single functions out: those over the whole module, once, do the same."""
        ll_module.data_layout = self._codegen._data_layout


class LinkedLibrary(_PlainLibrary):
    """A kernel's code as it was lowered, apart from that of the kernels it calls: an entry links all of it, once."""

    def serialize_using_object_code(self) -> tuple[str, str, bytes]:
        """The code of the kernel and of all it calls for another process, see `handover`."""
        self._ensure_finalized()
        whole = self._final_module.clone()
        _link_callees(self, whole)
        return self.name, "bitcode", whole.as_bitcode()

    def finalize(self) -> None:
        """Nothing is linked or optimised: the entry does it."""
        self._raise_if_finalized()
        for library in self._linking_libraries:
            self._reload_init.update(library._reload_init)
            self._dynamic_globals += library._dynamic_globals
        self._finalize_final_module()

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True


class _EntryLibrary(_PlainLibrary):
    def finalize(self) -> None:
        self._raise_if_finalized()
        _link_callees(self, self._final_module)
        self._optimize_final_module()
        self._final_module.verify()
        self._finalize_final_module()

    def _optimize_final_module(self) -> None:
        cheap = {"opt": 0, "cost": "cheap", "loop_vectorize": False, "slp_vectorize": False}
        for options in (cheap, {"opt": _OPTIMISATION}):  # as Numba does it, but for the level
            passes, builder = self._codegen._module_pass_manager(**options)
            passes.run(self._final_module, builder)

    def serialize_using_object_code(self) -> tuple[str, str, tuple[bytes, bytes]]:
        """The machine code for the cache, without the intermediate code that only callers would need."""
        wrappers = [f.name for f in self._final_module.functions if not f.is_declaration and _WRAPPER in f.name]
        names = parse_assembly("\n".join(f'define void @"{name}"() {{ ret void }}' for name in wrappers))
        return self.name, "object", (self._get_compiled_object(), names.as_bitcode())


def _link_callees(library: JITCodeLibrary, module: Any) -> None:
    """Links into a module all that a library's code calls, callers first: what nobody has called yet is left out."""
    linked, waiting = set[int](), list(reversed(library._linking_libraries))
    while waiting:
        callee = waiting.pop()
        if id(callee) in linked:
            continue
        linked.add(id(callee))
        library._reload_init.update(callee._reload_init)
        module.link_in(callee._get_module_for_linking(), preserve=True)
        if isinstance(callee, LinkedLibrary):
            waiting += reversed(callee._linking_libraries)


class _LinkedCompiler(CompilerBase):
    library_class: type[JITCodeLibrary] = LinkedLibrary
    machine_code = False

    def define_pipelines(self) -> list[Any]:
        self.state.library = self.library_class(self.state.targetctx.codegen(), self.state.func_id.func_qualname)
        self.state.library.enable_object_caching()
        self.state.flags.no_compile = not self.machine_code
        return [DefaultPassBuilder.define_nopython_pipeline(self.state)]


class _EntryCompiler(_LinkedCompiler):
    library_class = _EntryLibrary
    machine_code = True

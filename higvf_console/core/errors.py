"""One family of errors: each names the value, the place and the choices."""

import difflib
from collections.abc import Sequence


class HigvfError(Exception):
    """Base of every error that the console raises on purpose."""


class ScenarioError(HigvfError):
    """A scenario file, or a value in it, cannot be used."""


class ScriptError(HigvfError):
    """A script of operator actions cannot be used."""


class InputError(HigvfError):
    """A recording or a device cannot be used as operator input."""


class PathError(HigvfError, ValueError):
    """A stroke does not make a path."""


class FilterError(HigvfError):
    """A safety filter was set up with a problem that it cannot represent."""


class MissingExtraError(HigvfError, ImportError):
    """A package of an extra is not installed; the message names the extra."""


class ArgumentError(HigvfError, ValueError):
    """An argument of a public function has a wrong shape or value; the message names it, and what is expected."""


class ArgumentTypeError(ArgumentError, TypeError):
    """An argument of a public function is of a kind that cannot be converted."""


class ConsoleError(HigvfError):
    """The console cannot be served: busy port, unassignable address, wrong viser."""


def closest(word: str, known: Sequence[str]) -> str:
    """' (did you mean ...?)' when a known word is near `word`, else nothing."""
    near = difflib.get_close_matches(word, known, n=1)
    return f" (did you mean '{near[0]}'?)" if near else ""

"""Packages of an extra: imported when they are first used, so that the engine runs without them.

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "images")
"""

from importlib import import_module
from types import ModuleType
from typing import Any

from higvf_console.core.errors import MissingExtraError


class _Optional(ModuleType):
    """Stands for a module until one of its attributes is read."""

    def __init__(self, name: str, extra: str) -> None:
        super().__init__(name)
        self._extra = extra

    def __getattr__(self, attribute: str) -> Any:
        return getattr(require(self.__name__, self._extra), attribute)


def optional(name: str, extra: str) -> ModuleType:
    """A stand-in for a module, which imports it on first use.

    Args:
        name: of the module.
        extra: of `higvf-console` that installs it.

    Returns:
        The stand-in; reading an attribute raises `MissingExtraError` where the module is not installed.
    """
    return _Optional(name, extra)


def require(name: str, extra: str, purpose: str = "this") -> ModuleType:
    """The module of that name.

    Args:
        name: of the module.
        extra: of `higvf-console` that installs it.
        purpose: what needs it, in the singular, for the message.

    Raises:
        MissingExtraError: it is not installed; the message names the extra.
    """
    try:
        return import_module(name)
    except ImportError as problem:
        missing = problem.name or name
        raise MissingExtraError(
            f"{purpose} needs the module '{missing}': pip install 'higvf-console[{extra}]'", name=missing
        ) from problem

"""A page for tests of the hand: it notes what is done in it."""

from collections.abc import Callable
from typing import Any

from higvf_console.ui.interaction.arena import PageActions
from higvf_console.ui.interaction.tools import Tool


def no_page(
    shown: list[Tool] | None = None, opened: list[str] | None = None, noted: list[str] | None = None
) -> PageActions:
    """Actions that note the tools shown, the tabs opened and the words noted."""

    def noting(notes: list[Any] | None) -> Callable[[Any, int], None]:
        return lambda what, _client: None if notes is None else notes.append(what)

    return PageActions(noting(shown), noting(opened), noting(noted))

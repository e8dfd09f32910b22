"""Cards over the arena: HTML that the console makes, and buttons in it that say what was pressed.

A button of a card has `data-act` and perhaps `data-value`; `data-fold` folds the card of the run, `data-close` closes
one that a page has opened.
"""

from collections.abc import Callable

import viser

from higvf_console.ui.page import page


def install(server: viser.ViserServer, on_act: Callable[[int, str, str], None]) -> None:
    """Lets every page show cards.

    Args:
        server: whose pages.
        on_act: called as `on_act(client_id, act, value)` on viser's event loop: it must return at once; a ValueError
            refuses what the page sent.
    """

    def act(client_id: int, body: page.Body) -> None:
        on_act(client_id, body["act"], body["value"])

    page.listen(server, "card", act)
    page.install(server, "cards", {})


def show(server: viser.ViserServer, kind: str, html: str) -> None:
    """Shows the card of the run on every page; empty = none."""
    page.call(server, "cards", "show", {"kind": kind, "html": html})


def open_card(server: viser.ViserServer, html: str, client_id: int) -> None:
    """Opens a card on one page."""
    page.call(server, "cards", "open", html, client_id)

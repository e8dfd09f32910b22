"""What a page is told when something that it did cannot be done; it stands in the message line of that page alone."""

from collections.abc import Callable
from typing import Any, Concatenate, ParamSpec

import viser

from higvf_console.ui.page import page

_STAY_S = 8.0
_COLOUR = (230, 159, 0)
_Rest = ParamSpec("_Rest")


def refuse(event: viser.GuiEvent[Any], text: str) -> None:
    """Tells the page of an event why nothing came of it, and logs it."""
    page.refusals_of(event.client).tell("widget", f"page {event.client_id}", text)
    tell(event.client, text)


def failed(event: viser.GuiEvent[Any], name: str, error: Exception) -> None:
    """Tells the page of an event that a widget failed, and logs why."""
    page.refusals_of(event.client).tell("failed widget", f"page {event.client_id}", name, failure=error)
    tell(event.client, f"{name}: it failed, and nothing was done; the reason is in the server's log.")


def tell(client: viser.ClientHandle | None, text: str) -> None:
    """Shows a notice on a page, if it is still there."""
    if client is not None:
        client.add_notification("Not possible", text, auto_close_seconds=_STAY_S, color=_COLOUR)


def telling(
    server: viser.ViserServer, callback: Callable[Concatenate[int, _Rest], None]
) -> Callable[Concatenate[int, _Rest], None]:
    """The callback that also tells the page why its message was refused.

    Args:
        server: whose pages send messages.
        callback: takes the page (client) and what it sent; a ValueError refuses that, and is raised again.
    """

    def heard(client_id: int, *sent: _Rest.args, **named: _Rest.kwargs) -> None:
        try:
            callback(client_id, *sent, **named)
        except ValueError as error:
            tell(server.get_clients().get(client_id), str(error))
            raise

    return heard

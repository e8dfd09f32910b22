"""A few words to the page that did something which cannot be done."""

import logging
from typing import Any

import viser

_STAY_S = 8.0
_COLOUR = (230, 159, 0)
_log = logging.getLogger(__name__)


def refuse(event: viser.GuiEvent[Any], text: str) -> None:
    """Tells the page of an event why nothing came of it."""
    _log.info("page %s: refused: %s", event.client_id, text)
    tell(event.client, text)


def tell(client: viser.ClientHandle | None, text: str) -> None:
    """Shows a notice on a page, if it is still there."""
    if client is not None:
        client.add_notification("Not possible", text, auto_close_seconds=_STAY_S, color=_COLOUR)

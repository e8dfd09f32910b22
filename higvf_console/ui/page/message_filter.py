"""What a page may say to viser: the messages that an honest page sends, and of a widget its value alone."""

import logging

import viser
from viser import _messages
from websockets.asyncio.server import ServerConnection

from higvf_console.ui.page.page import PageMessage

MAX_REFUSALS_LOGGED = 10  # of one page, so that a hostile one cannot fill the disk

# What an honest page sends. File uploads and the public share tunnel are not part of the console.
ALLOWED_MESSAGES = frozenset(
    {
        PageMessage,
        _messages.CommandTriggerMessage,
        _messages.GetRenderResponseMessage,
        _messages.GuiButtonHoldMessage,
        _messages.GuiFormDirtyMessage,
        _messages.GuiFormSubmitMessage,
        _messages.GuiUpdateMessage,
        _messages.LocalStorageGetItemResponseMessage,
        _messages.SceneNodeClickMessage,
        _messages.SceneNodeDragMessage,
        _messages.ScenePointerMessage,
        _messages.TransformControlsDragEndMessage,
        _messages.TransformControlsDragStartMessage,
        _messages.TransformControlsUpdateMessage,
        _messages.ViewerCameraMessage,
    }
)

_log = logging.getLogger(__name__)


class FilteredConnection(ServerConnection):
    """A WebSocket that passes on only what an honest page sends."""

    refused = 0

    async def recv(self, decode: bool | None = None) -> str | bytes:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The next frame that may pass."""
        while True:
            frame = await super().recv(decode)
            reason = refusal(frame)
            if reason is None:
                return frame
            self.refused += 1
            if self.refused <= MAX_REFUSALS_LOGGED:
                _log.warning("dropped a message of the page at %s: %s", self.remote_address, reason)


def refusal(frame: bytes | str) -> str | None:
    """Why a page may not send this frame; None when it may."""
    if isinstance(frame, str):
        return "a text frame"
    try:
        message = _messages.Message.deserialize(frame)
    except Exception as error:  # viser's decoder raises whatever the content makes it raise
        return f"not a message of viser {viser.__version__} ({type(error).__name__}: {error})"
    if type(message) not in ALLOWED_MESSAGES:
        return f"{type(message).__name__} is for the server to send"
    if isinstance(message, _messages.GuiUpdateMessage) and list(message.updates) != ["value"]:
        return f"a widget's {str(message.updates)[:80]} are for the server to set; a page may set 'value'"
    return None

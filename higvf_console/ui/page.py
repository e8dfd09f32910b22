"""The one door to the operator's page: scripts and calls go in, our own messages come out.

viser has no public way to do either, so this module alone uses its message classes and connections:

    install(server, "camera", {...})        runs browser_js/camera.js in every page, now and after each reconnect
    call(server, "keys", "stopped", True)   calls a method of an installed script
    listen(server, "key", callback)         hears what a script sent with `page.send("key", {...})`

viser replays scripts whenever a page reconnects; `browser_js/page.js` keeps one instance of each.
"""

import hashlib
import json
import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.resources import files
from typing import Any, TypeAlias

import viser
from viser import _messages
from viser.infra import WebsockClientConnection, WebsockServer

Body: TypeAlias = dict[str, Any]
_log = logging.getLogger(__name__)


@dataclass
class PageMessage(_messages.Message, include_in_scene_serialization=False):
    """What a script of ours sends: a topic and its content, to be validated by whoever listens."""

    topic: str
    body: Body


@dataclass
class _PageScript(_messages.RunJavascriptMessage, include_in_scene_serialization=False):
    """JavaScript that replaces an earlier one of the same slot, and stays out of recordings of the scene."""

    slot: str = ""

    def redundancy_key(self) -> str:
        return f"higvf {self.slot}"


# The page knows a message by the name of its class.
_PageScript.__name__ = _messages.RunJavascriptMessage.__name__


def install(server: viser.ViserServer, name: str, config: Mapping[str, object]) -> None:
    """Runs `browser_js/<name>.js` in every page, with `page` and `config` as its arguments.

    Args:
        server: whose pages shall run it.
        name: file name without ending; a later script of the same name replaces an earlier one.
        config: what the script is given; must be JSON.
    """
    base, script, settings = _source("page"), _source(name), json.dumps(config)
    version = hashlib.sha256((base + script + settings).encode()).hexdigest()[:12]
    source = f"({base})();window.higvf.install({json.dumps(name)}, {json.dumps(version)}, {script}, {settings});"
    _sockets(server).queue_message(_PageScript(source, f"install {name}"))


def call(server: viser.ViserServer, name: str, method: str, argument: object, client_id: int | None = None) -> None:
    """Calls a method of an installed script.

    Args:
        server: whose pages are meant.
        name: name of the script.
        method: name of the method.
        argument: its only argument; must be JSON.
        client_id: one page; None = every page, those that connect later included (they get the latest call).
    """
    source = f"window.higvf?.call({json.dumps(name)}, {json.dumps(method)}, {json.dumps(argument)});"
    message = _PageScript(source, f"call {name}.{method}")
    if client_id is None:
        _sockets(server).queue_message(message)
    elif client := _sockets(server)._client_state_from_id.get(client_id):  # pyright: ignore[reportPrivateUsage]
        client.message_buffer.push(message)


def listen(server: viser.ViserServer, topic: str, callback: Callable[[int, Body], None]) -> None:
    """Calls `callback(client_id, body)` for each message of a topic, in order, on viser's event loop.

    A callback must return at once. A ValueError that it raises refuses the message: it is logged and dropped.
    """

    def handle(client_id: int, message: PageMessage) -> None:
        if message.topic != topic:
            return
        try:
            callback(client_id, message.body)
        except ValueError as error:
            _log.warning("page %d: refused a %r message: %s", client_id, topic, error)

    _sockets(server).register_handler(PageMessage, handle)


def on_leave(server: viser.ViserServer, callback: Callable[[int], None]) -> None:
    """Calls `callback(client_id)` on viser's event loop when a page has gone; a reload is a new page."""

    def left(connection: WebsockClientConnection) -> None:
        callback(connection.client_id)

    _sockets(server).on_client_disconnect(left)


def _sockets(server: viser.ViserServer) -> WebsockServer:
    return server._websock_server  # pyright: ignore[reportPrivateUsage]


def _source(name: str) -> str:
    return (files("higvf_console.ui") / "browser_js" / f"{name}.js").read_text(encoding="utf-8").strip()

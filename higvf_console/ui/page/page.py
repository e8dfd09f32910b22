"""The one door to the operator's page: scripts and calls go in, our own messages come out.

viser has no public way to do either, so this module alone uses its message classes and connections:

    install(server, "camera", {...})        runs browser_js/camera.js in every page, now and after each reconnect
    call(server, "keys", "stopped", True)   calls a method of an installed script
    listen(server, "key", callback)         hears what a script sent with `page.send("key", {...})`
    gate(server, allows)                    keeps out what a page may not do

viser replays scripts whenever a page reconnects; `browser_js/page.js` keeps one instance of each.
"""
# viser's private interface has no types.
# pyright: reportUnknownMemberType=false

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.resources import files
from typing import Any, TypeAlias

import viser
from viser import _messages
from viser.infra import WebsockClientConnection, WebsockServer

from higvf_console.core.arguments import brief, not_one_of
from higvf_console.ui.page.access import Role
from higvf_console.ui.page.message_filter import FilteredConnection, settings_of
from higvf_console.ui.page.refusals import Refusals

Body: TypeAlias = dict[str, Any]
WIDGET = "widget"  # topic under which `gate` asks about viser's own widgets, palette and scene


@dataclass
class PageMessage(_messages.Message, include_in_scene_serialization=False):
    """What a script of ours sends: a topic and its content, which the listener validates."""

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

    A callback must return at once. The body has the fields of `message_table.BODIES`. A ValueError that it raises
    refuses the message: it is logged and dropped.
    """
    refusals = settings_of(server).refusals

    def handle(client_id: int, message: PageMessage) -> None:
        if message.topic != topic:
            return
        try:
            callback(client_id, message.body)
        except ValueError as error:
            refusals.tell(topic, f"page {client_id}", f"{topic}: {error}")
        except Exception as error:
            refusals.tell(f"failed {topic}", f"page {client_id}", f"{topic}: {error}", failure=error)

    _sockets(server).register_handler(PageMessage, handle)


def gate(
    server: viser.ViserServer,
    allows: Callable[[int, str, Body], bool],
    tell: Callable[[viser.ClientHandle | None, str], None],
) -> None:
    """Drops what a page may not do, and values that a widget cannot have.

    The widget shows its true value on that page again.

    Args:
        server: whose pages are meant; their camera and the like are never asked about.
        allows: asked as `allows(client_id, topic, body)` on viser's event loop; for viser's own messages the topic is
            `WIDGET` and the body has the "uuid" of the widget or palette command, where there is one.
        tell: tells a page why a widget cannot have the value that it sent.
    """
    sockets, refusals = _sockets(server), settings_of(server).refusals
    handle = sockets._handle_incoming_message  # pyright: ignore[reportPrivateUsage]

    async def handle_allowed(client_id: Any, message: Any) -> None:
        if isinstance(message, PageMessage):
            topic, body = message.topic, message.body
        else:
            topic, body = WIDGET, {"uuid": getattr(message, "uuid", None)}
        widget = isinstance(message, _messages.GuiUpdateMessage)
        if not isinstance(message, _messages.ViewerCameraMessage) and not allows(client_id, topic, body):
            if widget:
                _show_true_value(server, message.uuid, client_id)
        elif widget and (reason := _misfit(server, message)):
            refusals.tell("widget", f"page {client_id}", reason)
            _show_true_value(server, message.uuid, client_id)
            tell(server.get_clients().get(client_id), reason)
        else:
            await handle(client_id, message)

    sockets._handle_incoming_message = handle_allowed  # pyright: ignore[reportPrivateUsage]


def refusals_of(client: viser.ClientHandle | None) -> Refusals:
    """Where it is told that a page did what cannot be done; None = the page has gone."""
    server = getattr(client, "_viser_server", None)
    return Refusals() if server is None else settings_of(server).refusals


def uuid_of(command: viser.CommandHandle) -> str:
    """By what the palette names a command."""
    return command._impl.uuid  # pyright: ignore[reportPrivateUsage]


def on_leave(server: viser.ViserServer, callback: Callable[[int], None]) -> None:
    """Calls `callback(client_id)` on viser's event loop when a page has gone; a reload is a new page."""

    def left(connection: WebsockClientConnection) -> None:
        callback(connection.client_id)

    _sockets(server).on_client_disconnect(left)


def dropped(server: viser.ViserServer) -> dict[int, int]:
    """By page, how many messages were dropped since the last call because the page sent too many; from any thread."""
    counts: dict[int, int] = {}
    for client_id, connection in list(_sockets(server)._live_connections.items()):  # pyright: ignore[reportPrivateUsage]
        if isinstance(connection, FilteredConnection) and connection.pace.dropped:
            counts[client_id], connection.pace.dropped = connection.pace.dropped, 0
    return counts


def role_of(server: viser.ViserServer, client_id: int) -> Role:
    """The role of the login by which a page was opened; without a guard, everybody has the highest."""
    connection = _sockets(server)._live_connections.get(client_id)  # pyright: ignore[reportArgumentType, reportPrivateUsage, reportCallIssue]
    login = connection.login if isinstance(connection, FilteredConnection) else None
    return Role.EXPERIMENTER if login is None else login.role


def _misfit(server: viser.ViserServer, message: _messages.GuiUpdateMessage) -> str | None:
    """Why a widget cannot have the value that a page gives it; None where it can, or is gone."""
    widget: Any = server.gui._gui_input_handle_from_uuid.get(message.uuid)  # pyright: ignore[reportPrivateUsage]
    if widget is None:
        return None
    given, true = message.updates.get("value"), widget._impl.value
    name = getattr(widget, "label", "") or "value"
    kinds = {bool: bool, int: int, float: int | float, str: str}
    if type(true) in kinds and not (
        isinstance(given, kinds[type(true)]) and isinstance(given, bool) is (type(true) is bool)
    ):
        return f"{name}: {brief(given)} is not of the kind of {brief(true)}"
    options, least, most = (getattr(widget, name, None) for name in ("options", "min", "max"))
    if options is not None and given not in options:
        return f"{name}: {not_one_of(given, options)}"
    if (least is not None and given < least) or (most is not None and given > most):
        return f"{name}: {given} is not from {least} to {most}"
    return None


def _show_true_value(server: viser.ViserServer, uuid: str, client_id: int) -> None:
    widget = server.gui._gui_input_handle_from_uuid.get(uuid)  # pyright: ignore[reportPrivateUsage]
    client = _sockets(server)._client_state_from_id.get(client_id)  # pyright: ignore[reportArgumentType, reportPrivateUsage, reportCallIssue]
    if widget is not None and client is not None and not widget._impl.is_button:  # pyright: ignore[reportPrivateUsage]
        client.message_buffer.push(_messages.GuiUpdateMessage(uuid, {"value": widget.value}))


def _sockets(server: viser.ViserServer) -> WebsockServer:
    return server._websock_server  # pyright: ignore[reportPrivateUsage]


def _source(name: str) -> str:
    return (files("higvf_console.ui.page") / "browser_js" / f"{name}.js").read_text(encoding="utf-8").strip()

"""Files that a page sends: chosen by the operator, in pieces, with a limit to their size."""

import base64
import binascii
from collections.abc import Callable, Mapping
from typing import NamedTuple

import viser

from higvf_console.ui.page import page
from higvf_console.ui.page.message_filter import settings_of
from higvf_console.ui.page.message_table import PIECE_BYTES

MOST_BYTES = 16_000_000

Received = Callable[[int, str, bytes], None]  # client, name and content of a file


class FileKind(NamedTuple):
    """A kind of file that can be sent.

    Attributes:
        accept: endings, as a file chooser wants them.
        received: hears of a file, on viser's event loop: it must return at once. A ValueError refuses the file.
    """

    accept: str
    received: Received


class _Growing(NamedTuple):
    """A file that has not come as a whole."""

    name: str
    kind: str
    parts: int
    content: tuple[bytes, ...]


def install(
    server: viser.ViserServer, kinds: Mapping[str, FileKind], refused: Callable[[int, str, str], None]
) -> Callable[[str, int], None]:
    """Lets pages send files.

    Args:
        server: whose pages may.
        kinds: of files, by name.
        refused: hears of a file that cannot be used: the client, its name, and why.

    Returns:
        choose(kind, client_id): opens the file chooser of a page that has just been clicked.
    """
    growing: dict[int, _Growing] = {}
    refusals = settings_of(server).refusals

    def piece(client_id: int, body: page.Body) -> None:
        name, kind, content = body["name"][:200], body["kind"], body["content"]
        part, parts, size = body["part"], body["parts"], body["size"]
        if kind not in kinds:
            raise ValueError(f"no kind {kind!r} of files; kinds: {', '.join(kinds)}")
        if size > MOST_BYTES or not 0 < parts <= MOST_BYTES // PIECE_BYTES + 1:
            growing.pop(client_id, None)
            refused(client_id, name, f"{size / 1e6:.1f} MB are too many; at most {MOST_BYTES / 1e6:g} MB")
            return
        known = _Growing(name, kind, parts, ()) if part == 0 else growing.get(client_id)
        if known is None or (known.name, known.kind, known.parts, len(known.content)) != (name, kind, parts, part):
            growing.pop(client_id, None)
            raise ValueError(f"piece {part} of {name!r} came where another was due")
        try:
            known = known._replace(content=(*known.content, base64.b64decode(content, validate=True)))
        except binascii.Error as error:
            raise ValueError(f"piece {part} of {name!r} is damaged") from error
        growing[client_id] = known
        if len(known.content) == known.parts:
            del growing[client_id]
            try:
                kinds[known.kind].received(client_id, name, b"".join(known.content))
            except ValueError as error:
                refused(client_id, name, str(error))
            except Exception as error:  # a decoder of pictures raises whatever the content makes it raise
                refusals.tell("failed file", f"page {client_id}", f"file {name!r}", failure=error)
                refused(client_id, name, f"it cannot be read ({type(error).__name__})")

    def forget(client_id: int) -> None:
        growing.pop(client_id, None)

    def choose(kind: str, client_id: int) -> None:
        page.call(server, "files", "choose", {"kind": kind, "accept": kinds[kind].accept}, client_id)

    page.listen(server, "file", piece)
    page.on_leave(server, forget)
    page.install(server, "files", {"most": MOST_BYTES, "piece": PIECE_BYTES})
    return choose

"""What the page shows between the link and the console: that the engine is still being loaded."""

from collections.abc import Generator
from contextlib import contextmanager

import viser


@contextmanager
def loading(server: viser.ViserServer, text: str) -> Generator[None]:
    """Shows a line on every page for the time of a block.

    Args:
        server: whose pages, also those that open meanwhile.
        text: of the line.
    """
    line = server.gui.add_markdown(f"**{text}**")
    try:
        yield
    finally:
        line.remove()

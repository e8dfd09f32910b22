"""What the console asks of each of its panels.

A panel is one file of `panels/`. It is built with what it needs (viser's widgets, the session, where its commands go,
the `UiState`), shows snapshots, and knows no other panel: what two of them show is made in `widgets/`, what two of them
know is in `ui_state` or in the snapshot.
"""

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot


class Panel(Protocol):
    """A part of the page that shows the run."""

    def update(self, snapshot: "Snapshot", /) -> None:
        """Shows a snapshot: five times a second on the view thread, which alone changes what is shown.

        A widget that was just touched keeps its value until the session has answered (`widgets.callbacks.mirror`). An
        exception is reported on the page; the other panels go on.
        """
        ...

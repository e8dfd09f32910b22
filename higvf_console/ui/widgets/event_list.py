"""The last events as a list, and how many alarms wait, in words."""

from collections.abc import Sequence

from higvf_console.core.events import Event
from higvf_console.ui.widgets.html import block, clock, severity_colour, text

MOST_SHOWN = 30


def alarms_text(count: int) -> str:
    """So many alarms, in words."""
    return f"{count} alarm{'' if count == 1 else 's'}"


def log_html(events: Sequence[Event], unread: Sequence[Event] = (), most: int = MOST_SHOWN) -> str:
    """The last events, newest first, at most `most`; alarms that nobody has acknowledged stand out."""
    waiting = {id(alarm) for alarm in unread}
    lines = "".join(
        f'<div style="border-color:{severity_colour(event.severity)}">'
        f'<span class="dim">{clock(event.time)}</span>'
        f"<span{' class=alarm' if id(event) in waiting else ''}>{text(event.text)}</span></div>"
        for event in reversed(events[-most:])
    )
    return block(f'<div class="log">{lines}</div>')

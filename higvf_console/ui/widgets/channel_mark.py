"""How an input is marked wherever it is named."""

from higvf_console.core.interface import ChannelHealth, ChannelState
from higvf_console.ui.theme import CSS
from higvf_console.ui.widgets.html import text

# Shape and word tell the state; the colour only repeats it.
CHANNEL_MARK = {
    ChannelState.NEVER_SEEN: ("\u25cb", CSS.scorched_text),  # circle
    ChannelState.LIVE: ("\u25cf", CSS.fighting),  # disc
    ChannelState.STALE: ("\u25d0", CSS.warning),  # half a disc
    ChannelState.LOST: ("\u2715", CSS.alarm),  # cross
    ChannelState.RECOVERED: ("\u25b2", CSS.warning),  # triangle
    ChannelState.ENDED: ("\u25a0", CSS.scorched_text),  # square
}


def channel_html(name: str, health: ChannelHealth) -> str:
    """One input: a mark whose shape and colour tell its state, its name, and the state in words unless it is live."""
    mark, colour = CHANNEL_MARK[health.state]
    grave = health.state in (ChannelState.LOST, ChannelState.RECOVERED)
    word = f' <span class="{"alarm" if grave else "dim"}">{text(health.state.value)}</span>'
    return (
        f'<span class="channel" title="{text(health.detail)}"><span class="mark" style="color:{colour}">{mark}</span>'
        f"{text(name)}{'' if health.state is ChannelState.LIVE else word}</span>"
    )

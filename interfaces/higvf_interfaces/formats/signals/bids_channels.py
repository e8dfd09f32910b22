"""BIDS channel tables (`*_channels.tsv`): names, units and status of the channels of a recording."""

from pathlib import Path
from typing import NamedTuple

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.bids_files import sidecars, stem_of
from higvf_interfaces.formats.text import cell, look

_ENDINGS = ("_emg", "_eeg", "_ieeg", "_meg", "_physio")


class ChannelNote(NamedTuple):
    """Entry of a channel in the table."""

    type: str
    unit: str
    bad: bool


def beside(recording: Path) -> dict[str, ChannelNote]:
    """Read the channel table of a BIDS recording, the most specific that applies to it, by channel name; else empty.

    Raises:
        InputError: If the table has no column `name`.
    """
    tables = sidecars(recording, "channels", "tsv") if stem_of(recording).endswith(_ENDINGS) else []
    if not tables:
        return {}
    path = tables[-1]
    file = look(str(path))
    name, kind, unit, status = (file.find(title) for title in ("name", "type", "units", "status"))
    if name is None:
        raise InputError(f"{path}: a BIDS channel table needs the column 'name'; has: {file.titles}")
    return {
        cell(row, name): ChannelNote(cell(row, kind), cell(row, unit), cell(row, status).casefold() == "bad")
        for row in file.rows([])
    }

"""Pupil Core's `gaze_positions.csv` and its surface tracker's `gaze_positions_on_surface_NAME.csv`.

Coordinates are shares with the origin at the BOTTOM left: of the scene camera's image in the first table, of the
surface (a screen with markers, say) in the second, where `on_surf` says whether the eye was on it at all. Times count
from an arbitrary epoch. The vendor advises to trust confidences from 0.6.
"""

from collections.abc import Iterator

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.gaze.binocular import says_yes
from higvf_interfaces.formats.records import BOTTOM_LEFT, GazeStream, Row, Wanted, blocks_of
from higvf_interfaces.formats.text import Column, TextFile, cell, number

CORE, SURFACE = "pupil-core", "pupil-surface"
CORE_TITLE, SURFACE_TITLE = "Pupil Core gaze_positions.csv", "Pupil Core gaze on a surface"
_CLOCKS = ("gaze_timestamp", "timestamp", "world_timestamp")


def matches_core(file: TextFile) -> bool:
    """Whether the header names a normalised position in the scene."""
    return file.find(*_CLOCKS) is not None and file.find("norm_pos_x") is not None


def matches_surface(file: TextFile) -> bool:
    """Whether the header names a normalised position on a surface."""
    return file.find(*_CLOCKS) is not None and file.find("x_norm") is not None and file.find("on_surf") is not None


def stream_core(file: TextFile, _: Wanted) -> GazeStream:
    """Begins to read gaze in the scene camera's image.

    Raises:
        InputError: a column is missing.
    """
    return _stream(file, CORE, "scene-unit", ("norm_pos_x", "norm_pos_y"), None)


def stream_surface(file: TextFile, _: Wanted) -> GazeStream:
    """Begins to read gaze on a surface.

    Raises:
        InputError: a column is missing.
    """
    return _stream(file, SURFACE, "unit", ("x_norm", "y_norm"), file.find("on_surf"))


def _stream(file: TextFile, name: str, frame: str, point: tuple[str, str], on: Column | None) -> GazeStream:
    time, x, y = file.find(*_CLOCKS), file.find(point[0]), file.find(point[1])
    if time is None or x is None or y is None:
        raise InputError(f"{file.path}: needs the columns gaze_timestamp, {', '.join(point)}; has: {file.titles}")
    confidence = file.find("confidence")
    notes: list[str] = []

    def rows() -> Iterator[Row]:
        for row in file.rows(notes):
            here = on is None or says_yes(cell(row, on))
            yield (
                number(cell(row, time)),
                number(cell(row, x)),
                number(cell(row, y)),
                here,
                number(cell(row, confidence)),
            )

    return GazeStream(
        format=name,
        columns=tuple(column.title for column in (time, x, y, on, confidence) if column is not None),
        frame=frame,
        blocks=blocks_of(rows()),
        notes=notes,
        origin=BOTTOM_LEFT,
        has_confidence=confidence is not None,
    )

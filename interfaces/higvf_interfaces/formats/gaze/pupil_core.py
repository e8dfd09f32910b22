"""Pupil Core tables: `gaze_positions.csv`, and `gaze_positions_on_surface_NAME.csv` of the surface tracker.

Coordinates are normalised with the origin at the BOTTOM left: to the image of the scene camera in the first table, to
the surface (such as a screen with markers) in the second, whose column `on_surf`, in older exports `on_srf`, marks gaze
on the surface. Times count from an arbitrary epoch. The vendor recommends a minimum confidence of 0.6.
"""

from collections.abc import Iterator

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.gaze.binocular import says_yes
from higvf_interfaces.formats.records import BOTTOM_LEFT, GazeStream, Row, Wanted, blocks_of
from higvf_interfaces.formats.text import Column, TextFile, cell, number

CORE, SURFACE = "pupil-core", "pupil-surface"
CORE_TITLE, SURFACE_TITLE = "Pupil Core gaze_positions.csv", "Pupil Core gaze on a surface"
_ON_SURFACE = ("on_surf", "on_srf")
_CLOCKS = ("gaze_timestamp", "timestamp", "world_timestamp")


def matches_core(file: TextFile) -> bool:
    """Return whether the header has a normalised position in the scene."""
    return file.find(*_CLOCKS) is not None and file.find("norm_pos_x") is not None


def matches_surface(file: TextFile) -> bool:
    """Return whether the header has a normalised position on a surface."""
    return all(file.find(*names) is not None for names in (_CLOCKS, ("x_norm",), _ON_SURFACE))


def stream_core(file: TextFile, _: Wanted) -> GazeStream:
    """Open a table of gaze in the image of the scene camera.

    Raises:
        InputError: a column is missing.
    """
    return _stream(file, CORE, "scene-unit", ("norm_pos_x", "norm_pos_y"), None)


def stream_surface(file: TextFile, _: Wanted) -> GazeStream:
    """Open a table of gaze on a surface.

    Raises:
        InputError: a column is missing.
    """
    on = file.find(*_ON_SURFACE)
    if on is None:
        raise InputError(f"{file.path}: no column {' or '.join(_ON_SURFACE)}, so gaze off the surface is unknown")
    return _stream(file, SURFACE, "unit", ("x_norm", "y_norm"), on)


def _stream(file: TextFile, name: str, frame: str, point: tuple[str, str], on: Column | None) -> GazeStream:
    time, x, y = file.find(*_CLOCKS), file.find(point[0]), file.find(point[1])
    if time is None or x is None or y is None:
        raise InputError(f"{file.path}: needs the columns gaze_timestamp, {', '.join(point)}; has: {file.titles}")
    confidence = file.find("confidence")
    notes: list[str] = []

    def rows() -> Iterator[Row]:
        for row in file.rows(notes):
            here = on is None or says_yes(file, row, on)
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

"""The irregular obstacles of a scenario file: polygons point by point, and masks from image files."""

from collections.abc import Sequence
from pathlib import Path

from higvf_console.core.arrays import Floats
from higvf_console.core.errors import ScenarioError
from higvf_console.core.outline import enclosed
from higvf_console.core.quantity import Quantity
from higvf_console.core.reading.node import Node
from higvf_console.world.masks import MaskPlace, read_grey, trace
from higvf_console.world.polygons import (
    MOST_EDGES,
    closed_outline,
    crossing,
    oriented,
)

_SCALE = Quantity("m", 1e-4, 1e4, "", "Side of a pixel.")
_GREY = Quantity("", 0.0, 255.0, "", "Brightness below which a pixel is dark.")
_TOLERANCE = Quantity("m", 0.0, 1e6, "", "How far an outline may be off.")
_AREA = Quantity("m^2", 0.0, 1e12, "", "An area.")
_MASK_KEYS = ("image", "at_m", "metres_per_pixel", "threshold", "obstacle", "tolerance_m", "least_area_m2")


def read_polygons(node: Node) -> tuple[Floats, ...]:
    """The section `polygons`: each counter-clockwise, followed by its free areas, clockwise.

    Raises:
        ScenarioError: an outline is no polygon.
    """
    return tuple(chain for item in node.items() for chain in _polygon(item))


def _polygon(node: Node) -> tuple[Floats, ...]:
    entries = node.section(("points_m", "free_m"), ("points_m",))
    outline = _outline(entries["points_m"])
    areas = entries["free_m"].items() if "free_m" in entries else []
    free = [oriented(_outline(area), clockwise=True) for area in areas]
    for area, chain in zip(areas, free, strict=True):
        if not enclosed(outline, chain).all():
            raise area.error("a free area lies inside the polygon; a point of this one does not")
    if free and crossing([outline, *free]) is not None:
        raise entries["free_m"].error("free areas neither touch each other nor the edge of their polygon")
    return (outline, *free)


def _outline(node: Node) -> Floats:
    points = node.points()
    try:
        return closed_outline(points)
    except ScenarioError as error:
        raise node.error(str(error)) from error


def read_masks(node: Node, folders: Sequence[Path]) -> tuple[Floats, ...]:
    """The section `masks`, traced; images are looked for in `folders`, in this order.

    Raises:
        ScenarioError: an image is missing or cannot be used, or there is no obstacle in it.
    """
    return tuple(chain for item in node.items() for chain in _mask(item, folders))


def _mask(node: Node, folders: Sequence[Path]) -> tuple[Floats, ...]:
    entries = node.section(_MASK_KEYS, ("image", "at_m", "metres_per_pixel"))
    scale = entries["metres_per_pixel"].number(_SCALE)
    threshold = entries["threshold"].number(_GREY) if "threshold" in entries else 128.0
    bright = "obstacle" in entries and entries["obstacle"].choice(("dark", "bright")) == "bright"
    tolerance = entries["tolerance_m"].number(_TOLERANCE) if "tolerance_m" in entries else scale
    least_area = entries["least_area_m2"].number(_AREA) if "least_area_m2" in entries else 4.0 * scale**2
    image = entries["image"].text()
    try:
        dark = read_grey(image, folders) < threshold
    except ScenarioError as error:
        raise entries["image"].error(str(error)) from error
    chains = trace(~dark if bright else dark, MaskPlace(entries["at_m"].point(), scale), tolerance, least_area)
    count = sum(len(chain) for chain in chains)
    if not chains:
        raise node.error(
            f"no {'bright' if bright else 'dark'} shape of at least {least_area:g} m^2 at threshold {threshold:g}; "
            "change threshold, obstacle or least_area_m2"
        )
    if count > MOST_EDGES:
        raise node.error(
            f"its outlines have {count} edges, at most {MOST_EDGES} are possible; "
            f"raise tolerance_m ({tolerance:g} m) or least_area_m2 ({least_area:g} m^2)"
        )
    return chains


def check_edges(node: Node, polygons: Sequence[Floats]) -> None:
    """Refuses more edges than `MOST_EDGES`.

    Raises:
        ScenarioError: there are more; the message gives the number.
    """
    count = sum(len(chain) for chain in polygons)
    if count > MOST_EDGES:
        raise node.error(
            f"polygons and masks have {count} edges together, at most {MOST_EDGES} are possible; "
            "give polygons fewer points, or masks a larger tolerance_m"
        )

"""What the paper prints: Table II. The sums are those of its own entries; it prints 48253.9 for column 2."""

from typing import NamedTuple


class Column(NamedTuple):
    """A column of Table II.

    Attributes:
        title: as a heading.
        order: fires in the order in which they go out, from the text.
        loss_area: fires 1 to 5 [m^2].
        total: the sum that the paper prints [m^2].
    """

    title: str
    order: tuple[int, ...]
    loss_area: tuple[float, ...]
    total: float


COLUMNS = {
    "without_human": Column("Without human", (1, 2, 3, 4, 5), (3512.61, 7026.29, 16203.8, 4646.9, 20157.5), 51547.1),
    "change_priority": Column(
        "Change target priority", (1, 3, 2, 4, 5), (3512.61, 8639.3, 14491.39, 4273.0, 17335.6), 48253.9
    ),
    "find_hidden": Column(
        "Find undetected target", (1, 2, 3, 4, 5), (3512.61, 7026.29, 16203.8, 4646.9, 17920.2), 49309.8
    ),
}

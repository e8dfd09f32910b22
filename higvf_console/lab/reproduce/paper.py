"""Table II as the paper prints it.

The entries of column 2 sum to 48251.9; the paper prints 48253.9.
"""

from typing import NamedTuple


class Column(NamedTuple):
    """A column of Table II.

    Attributes:
        title: heading.
        order: order in which the fires go out, from the text.
        loss_area: loss areas of fires 1 to 5 [m^2].
        total: printed sum [m^2].
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

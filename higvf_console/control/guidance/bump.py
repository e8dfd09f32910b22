"""Smooth zero-in bump function S between the repulsive and the reactive boundary, [5], [6], [29]-[31]; Z = 1 - S."""

import math

from higvf_console.control.forms import PRINTED, Forms
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import BoundaryParameters


@kernel
def zero_in(distance: float, radius: float, boundaries: BoundaryParameters, forms: Forms) -> float:
    """Zero-in bump S: 0 inside the repulsive boundary Q, 1 outside the reactive boundary R, C-infinity between.

    With varphi = distance^2 / rho_R^2 - 1 and c = rho_Q^2 / rho_R^2 - 1, both dimensionless, S rises over the whole
    width between Q and R. In squared lengths, as printed, it jumps within 0.01 m.

    Args:
        distance: from the centre of the obstacle [m].
        radius: of the obstacle [m].
        boundaries: margins of Q and R [m] and the rates of the bump.
        forms: whether the dimensionless or the printed form is used.
    """
    reactive = radius + boundaries.reactive_margin
    repulsive = radius + boundaries.repulsive_margin
    varphi = (distance / reactive) ** 2 - 1.0
    c = (repulsive / reactive) ** 2 - 1.0
    if forms.bump == PRINTED:
        varphi, c = varphi * reactive * reactive, c * reactive * reactive
    if varphi >= 0.0:
        return 1.0
    if varphi <= c:
        return 0.0
    exponent = boundaries.bump_out / varphi - boundaries.bump_in / (c - varphi)
    return 0.0 if exponent > 700.0 else 1.0 / (1.0 + math.exp(exponent))

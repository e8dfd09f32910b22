"""The arena from above: a camera that cannot tilt, turn or drift.

viser has a perspective camera only, so it looks down from afar through a narrow angle, which leaves no visible
perspective; `browser_js/camera.js` puts it back whenever anything else moves it, zooms and pans it in the plane, and
fits the arena to the page.
"""

import math

import viser

from higvf_console.core.viewport import Arena
from higvf_console.ui.page import page

FIELD_OF_VIEW = math.radians(10.0)  # vertical
# Kept free round the arena when it is fitted [CSS px]: axis labels, and the tools above, the STOP button below.
PADDING = {"left": 44, "right": 28, "top": 52, "bottom": 104}
_ASPECT = 1.5  # of a page that is not known yet


def distance(arena: Arena, aspect: float) -> float:
    """Height above the ground from which the whole arena just fits a view of that width : height [m]."""
    return max(arena.width / aspect, arena.height) / (2 * math.tan(FIELD_OF_VIEW / 2))


def install(server: viser.ViserServer, arena: Arena) -> None:
    """Locks every page's camera straight above `arena` [m], fitted; call again for another arena."""
    # Where an exported scene starts, which runs without our script.
    height = distance(arena, _ASPECT) * 1.1
    centre = ((arena.x_min + arena.x_max) / 2, (arena.y_min + arena.y_max) / 2)
    server.initial_camera.up = (0.0, 1.0, 0.0)
    server.initial_camera.position = (*centre, height)
    server.initial_camera.look_at = (*centre, 0.0)
    server.initial_camera.fov = FIELD_OF_VIEW
    server.initial_camera.near = height * 0.2
    server.initial_camera.far = height * 2
    page.install(server, "camera", {"arena": arena._asdict(), "fov": FIELD_OF_VIEW, "padding": PADDING})


def fit_view(server: viser.ViserServer, client_id: int) -> None:
    """Shows the whole arena on one page, as the key F does."""
    page.call(server, "camera", "fit", None, client_id)

"""Two palettes, three sizes of text, one look for viser's own chrome.

viser shades the scene with the ACES film curve: a mesh or line painted #56b4e9 would not look like #56b4e9. Colours are
therefore written here as they shall be seen (bright saturated ones come out paler), and `mesh_rgb`, `line_rgb`,
`vertex_rgb` and `batch_rgb` answer with what viser must be sent for each kind of primitive.
"""

from typing import NamedTuple, TypeAlias

import numpy as np
import viser
from numpy.typing import NDArray

Rgb: TypeAlias = tuple[int, int, int]

PANEL_WIDTH = 380  # [CSS px]
LIGHT_GAIN = 2.0  # brightness of the one ambient light, relative to an unlit line


class Palette(NamedTuple):
    """Colours as they shall be seen: calm greys, and Okabe-Ito hues that colour-blind people tell apart.

    The defaults are those of the dark theme.
    """

    surround: str = "#141414"
    floor: str = "#1c2127"
    grid: str = "#272d35"
    border: str = "#4b5563"
    axis_text: str = "#8b96a5"
    obstacle: str = "#4a5562"
    obstacle_edge: str = "#7d8a99"
    boundary: str = "#4f5a67"
    fire: str = "#d55e00"
    fire_edge: str = "#ff9b54"
    fire_zone: str = "#e69f00"
    fire_text: str = "#1a0d04"
    fighting: str = "#009e73"
    progress: str = "#5ff0c0"
    scorched: str = "#2d3238"
    scorched_edge: str = "#69747f"
    scorched_text: str = "#9aa5b1"
    robot: str = "#56b4e9"
    robot_text: str = "#b8dcf2"
    trail: str = "#2f6f96"
    link: str = "#2c6b5a"
    clearance: str = "#5b94b5"
    operator: str = "#f0e442"
    stroke: str = "#f7f2b0"
    gaze: str = "#ffffff"
    field: str = "#3e566c"
    trouble: str = "#cc79a7"
    own_target: str = "#e69f00"
    neighbours: str = "#2fbf93"
    so_far: str = "#a7b1bd"
    formation: str = "#56b4e9"
    way_round: str = "#cc79a7"
    hold: str = "#c9d1d9"
    safety: str = "#ff6b4a"
    velocity: str = "#515b67"
    warning: str = "#e69f00"
    alarm: str = "#ff6b6b"
    panel: str = "#242424"
    text: str = "#d5dbe2"
    dim: str = "#9aa5b1"
    badge_text: str = "#0d1117"
    card: str = "#161b21"
    card_rule: str = "#343c46"
    key: str = "#2b323c"
    brand: str = "#3a86b4"


DARK = Palette()
# The same hues, darkened until they stand out from a light floor as clearly as the others do from a dark one.
LIGHT = Palette(
    surround="#ffffff",
    floor="#eff2f5",
    grid="#dce1e7",
    border="#9aa5b1",
    axis_text="#56616d",
    obstacle="#bcc5ce",
    obstacle_edge="#717d8a",
    boundary="#a3adb8",
    fire="#d55e00",
    fire_edge="#a34700",
    fire_zone="#e69f00",
    fire_text="#1a0d04",
    fighting="#00805c",
    progress="#007a57",
    scorched="#d6dce2",
    scorched_edge="#7f8a97",
    scorched_text="#5a6572",
    robot="#0072b2",
    robot_text="#00466f",
    trail="#8fbad6",
    link="#86bba9",
    clearance="#4a86aa",
    operator="#5a148a",
    stroke="#8f4fc4",
    gaze="#1b1f24",
    field="#9fb4c7",
    trouble="#a8487f",
    own_target="#b85000",
    neighbours="#00805c",
    so_far="#5f6b78",
    formation="#0072b2",
    way_round="#a8487f",
    hold="#2d343c",
    safety="#8c1414",
    velocity="#b9c2cc",
    warning="#8f5600",
    alarm="#b3261e",
    panel="#ffffff",
    text="#1f262d",
    dim="#5a6572",
    badge_text="#ffffff",
    card="#ffffff",
    card_rule="#d3dae1",
    key="#eef1f4",
    brand="#00527f",
)
# Each colour by the name of its variable in the style sheet, where the palette in use gives it its value.
CSS = Palette(*(f"var(--hg-{name})" for name in Palette._fields))
THEMES: dict[str, Palette] = {"Dark": DARK, "Light": LIGHT}
TEXT_SIZES: dict[str, float] = {"Small": 0.88, "Normal": 1.0, "Large": 1.18}


class Look(NamedTuple):
    """What the operator chose: colours, and the size of text relative to the usual one."""

    palette: Palette = DARK
    text: float = 1.0


USUAL_LOOK = Look()


class Nominal(NamedTuple):
    """Sizes on a screen that the arena just fills [px]; the scene turns them into metres."""

    text: float = 15.0
    axis_text: float = 13.0
    robot: float = 21.0
    trail: float = 1.5
    link: float = 1.0
    path: float = 3.0
    outline: float = 1.5
    boundary: float = 1.0
    field_spacing: float = 34.0

    def lettered(self, scale: float) -> "Nominal":
        """The same with text of another size."""
        return self._replace(text=scale * self.text, axis_text=scale * self.axis_text)


NOMINAL = Nominal()
NOMINAL_SCREEN_PX = (880.0, 620.0)


def cap_height(size: float) -> float:
    """Height of a digit in a text of a given size, as in other typefaces."""
    return 0.72 * size


# The curve of three.js' ACESFilmicToneMapping, and its inverse: https://github.com/mrdoob/three.js
_ACES_IN = np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]]) / 0.6
_ACES_OUT = np.array([[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]])


def hex_rgb(colour: str) -> Rgb:
    """ "#rrggbb" as three bytes."""
    return (int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16))


def _linear(encoded: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def _encoded(linear: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)


def _before_film(colour: str) -> NDArray[np.float64]:
    """Linear light (3,) in [0, inf) that the film curve turns into `colour`."""
    seen = np.linalg.solve(_ACES_OUT, _linear(np.array(hex_rgb(colour)) / 255))
    y = np.clip(seen, 0.0, 0.98)
    # y = (v (v + a) - b) / (v (c v + d) + e), solved for v
    a, b, c, d, e = 0.0245786, 0.000090537, 0.983729, 0.4329510, 0.238081
    p, q, r = 1 - c * y, a - d * y, -(b + e * y)
    return np.maximum(np.linalg.solve(_ACES_IN, (-q + np.sqrt(q * q - 4 * p * r)) / (2 * p)), 0.0)


def _bytes(values: NDArray[np.float64]) -> Rgb:
    red, green, blue = np.rint(np.clip(values, 0.0, 1.0) * 255).astype(int).tolist()
    return (red, green, blue)


def mesh_rgb(colour: str) -> Rgb:
    """What a mesh must be sent to be seen as `colour`."""
    return _bytes(_encoded(_before_film(colour) / LIGHT_GAIN))


def line_rgb(colour: str) -> Rgb:
    """What line segments, which no light reaches, must be sent to be seen as `colour`."""
    return _bytes(_encoded(np.clip(_before_film(colour), 0.0, 1.0)))


def vertex_rgb(colour: str) -> Rgb:
    """What one end of a line segment, whose bytes are linear, must be sent to be seen as `colour`."""
    return _bytes(_before_film(colour))


def batch_rgb(colour: str) -> Rgb:
    """What an instance of a batched mesh, whose bytes are linear, must be sent to be seen as `colour`."""
    return _bytes(_before_film(colour) / LIGHT_GAIN)


def mixed(colour: str, other: str, share: float) -> str:
    """`colour` with `share` of `other` in it."""
    blend = np.rint(np.array(hex_rgb(colour)) * (1 - share) + np.array(hex_rgb(other)) * share).astype(int)
    return "#" + "".join(f"{channel:02x}" for channel in blend)


def dress(server: viser.ViserServer, title: str) -> None:
    """Gives viser's chrome the console's look: docked right, no logo, no share button, flat light."""
    server.gui.set_panel_label(title)
    server.gui.main_panel.dock_right()
    wear(server, USUAL_LOOK)
    server.scene.world_axes.visible = False
    server.scene.set_up_direction("+z")
    server.scene.configure_default_lights(False)
    server.scene.configure_environment_map(None)
    server.scene.add_light_ambient("/light", intensity=np.pi * LIGHT_GAIN)


def wear(server: viser.ViserServer, look: Look) -> None:
    """Makes viser's chrome dark or light, and its panel as wide as the text needs; callable at any time."""
    server.gui.configure_theme(
        dark_mode=look.palette is not LIGHT,
        control_width="medium",
        show_logo=False,
        show_share_button=False,
        brand_color=hex_rgb(look.palette.brand),
    )
    widen(server, look)


def widen(server: viser.ViserServer, look: Look) -> None:
    """Makes the panel as wide as its text needs."""
    server.gui.main_panel.set_width(PANEL_WIDTH * max(look.text, 1.0))

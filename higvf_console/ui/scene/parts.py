"""How a layer of the scene is drawn with viser: flat meshes, batches of marks, line segments, at a height of its own.

viser sorts what is transparent by the height of its node, so a layer's height is its node's position. A node is made
once and then assigned to; one that has nothing to show is hidden, because viser cannot draw nothing.
"""

from collections.abc import Callable
from enum import IntEnum
from typing import Literal, TypeVar

import numpy as np
import viser
from numpy.typing import NDArray

from higvf_console.core.arrays import Floats
from higvf_console.core.viewport import Arena
from higvf_console.ui.scene.glyphs import Triangles
from higvf_console.ui.theme import NOMINAL, NOMINAL_SCREEN_PX, USUAL_LOOK, Look, batch_rgb, line_rgb, mesh_rgb

Node = TypeVar("Node", bound=viser.SceneNodeHandle)
# Shaded by the ambient light alone, as any other would be here, at two thirds of the work.
_MATERIAL: Literal["toon3"] = "toon3"
_NO_LINE = np.zeros((1, 2, 2))
_NO_SHAPE = Triangles(np.zeros((3, 2)), np.array([[0, 1, 2]]))


class Layer(IntEnum):
    """What lies over what, from the ground up."""

    FLOOR = 0
    IMAGE = 1
    GRID = 2
    HEAT = 3
    FIELD = 4
    FIRE_ZONE = 5
    BOUNDARY = 6
    LINK = 7
    TRAIL = 8
    FIRE = 9
    FIRE_EDGE = 10
    FIRE_MARK = 11
    OBSTACLE = 12
    GHOST = 13
    CLEARANCE = 14
    SIGHT = 15
    HALO = 16
    VELOCITY = 17
    REASON = 18
    ROBOT = 19
    PATH = 20
    CHEVRON = 21
    FIRE_TEXT = 22
    OBSTACLE_TEXT = 23
    ROBOT_TEXT_HALO = 24
    ROBOT_TEXT = 25
    STROKE = 26
    CURSOR = 27


class Canvas:
    """Where the layers are drawn, in which colours and sizes, and how many metres a nominal pixel is."""

    def __init__(self, server: viser.ViserServer, arena: Arena, look: Look = USUAL_LOOK) -> None:
        """Measures the arena."""
        self._scene = server.scene
        self._nodes: list[viser.SceneNodeHandle] = []
        self.arena = arena
        self.palette, self.sizes = look.palette, NOMINAL.lettered(look.text)
        self.px = max(arena.width / NOMINAL_SCREEN_PX[0], arena.height / NOMINAL_SCREEN_PX[1])  # [m]

    def add(self, make: Callable[[viser.SceneApi], Node]) -> Node:
        """A node that goes when the canvas is cleared."""
        node = make(self._scene)
        self._nodes.append(node)
        return node

    def clear(self) -> None:
        """Removes everything that was drawn."""
        while self._nodes:
            self._nodes.pop().remove()  # the latest first: a group takes what stands in it along

    def height(self, layer: Layer) -> tuple[float, float, float]:
        """Position of a layer's nodes; a quarter pixel apart, so that perspective does not move them visibly."""
        return (0.0, 0.0, 0.25 * self.px * layer)

    def group(self, name: str) -> "Group":
        """What is named below it moves with it."""
        return Group(self, name)

    def mesh(self, layer: Layer, name: str, shape: Triangles, colour: str) -> "FlatMesh":
        """A mesh of one colour."""
        return FlatMesh(self, layer, name, shape, colour)

    def lines(self, layer: Layer, name: str, colour: str | None, thickness: float) -> "Lines":
        """Line segments of `thickness` [px] and one colour; None = each end will be given its own."""
        return Lines(self, layer, name, colour, thickness)

    def marks(
        self, layer: Layer, name: str, shape: Triangles, *, count: int, colour: str, opacity: float = 1.0
    ) -> "Marks":
        """`count` copies of a shape."""
        return Marks(self, layer, name, shape, count=count, colour=colour, opacity=opacity)

    def picture(self, layer: Layer, name: str, extent: Arena | None = None, *, opaque: bool = False) -> "Picture":
        """A picture over some ground; None = the whole arena. One that is opaque is sent as JPEG."""
        return Picture(self, layer, name, extent or self.arena, opaque=opaque)


def raised(points: Floats) -> NDArray[np.float32]:
    """Ground points (..., 2) as scene points (..., 3) on their node's plane."""
    flat = np.zeros((*points.shape[:-1], 3), np.float32)
    flat[..., :2] = points
    return flat


def turned(heading: Floats) -> NDArray[np.float32]:
    """Quaternions wxyz (N, 4) of headings (N,) [rad]."""
    turns = np.zeros((len(heading), 4), np.float32)
    turns[:, 0], turns[:, 3] = np.cos(heading / 2), np.sin(heading / 2)
    return turns


class Group:
    """Nodes that move as one, so that a page never shows one of them a frame behind another."""

    def __init__(self, canvas: Canvas, name: str) -> None:
        """Starts at the origin."""
        self._node = canvas.add(lambda scene: scene.add_frame(name, show_axes=False))

    def move(self, origin: Floats) -> None:
        """Puts the origin of the nodes at a ground point (2,) [m]."""
        self._node.position = (float(origin[0]), float(origin[1]), 0.0)


class FlatMesh:
    """A mesh of one colour, whose shape and visibility may change."""

    def __init__(self, canvas: Canvas, layer: Layer, name: str, shape: Triangles, colour: str) -> None:
        """Draws the shape, if it has any triangles."""
        self._visible = True
        self._node = canvas.add(
            lambda scene: scene.add_mesh_simple(
                name,
                raised(_NO_SHAPE.vertices),
                _NO_SHAPE.faces.astype(np.uint32),
                color=mesh_rgb(colour),
                material=_MATERIAL,
                side="double",
                cast_shadow=False,
                receive_shadow=False,
                position=canvas.height(layer),
            )
        )
        self.reshape(shape)

    def reshape(self, shape: Triangles) -> None:
        """Shows another shape."""
        self._empty = not len(shape.faces)
        if not self._empty:
            self._node.vertices = raised(shape.vertices)
            self._node.faces = shape.faces.astype(np.uint32)
        self.show(self._visible)

    def show(self, visible: bool) -> None:
        """Shows or hides it."""
        self._visible = visible
        self._node.visible = visible and not self._empty


class Lines:
    """Line segments whose ends and visibility may change; while hidden, nothing is sent."""

    def __init__(self, canvas: Canvas, layer: Layer, name: str, colour: str | None, thickness: float) -> None:
        """Starts with no segment."""
        self._visible, self._empty = True, True
        self._late: tuple[Floats, NDArray[np.uint8] | None] | None = None  # drawn while hidden
        self._height = canvas.height(layer)[2]
        self._node = canvas.add(
            lambda scene: scene.add_line_segments(
                name,
                raised(_NO_LINE),
                # A page cannot turn one colour into many later: its shader would be without them.
                np.zeros((1, 2, 3), np.uint8) if colour is None else line_rgb(colour),
                thickness=thickness,
                thickness_units="screen",
                position=canvas.height(layer),
                visible=False,
            )
        )

    def draw(self, segments: Floats, colours: NDArray[np.uint8] | None = None) -> None:
        """Draws segments (s, 2, 2) [m], their ends in colours (s, 2, 3), in place of those before."""
        self._empty = not len(segments)
        self._late = None if self._empty else (segments, colours)
        self.show(self._visible)

    def move(self, origin: Floats) -> None:
        """Puts the segments' origin at a ground point (2,) [m]."""
        self._node.position = (float(origin[0]), float(origin[1]), self._height)

    def show(self, visible: bool) -> None:
        """Shows or hides them."""
        self._visible = visible
        if visible:
            self.send()
        self._node.visible = visible and not self._empty

    def send(self) -> None:
        """Sends what was drawn while they were hidden."""
        if self._late is not None:
            (segments, colours), self._late = self._late, None
            self._node.points = raised(segments)
            if colours is not None:
                self._node.colors = colours


class Marks:
    """Copies of one flat shape: one node, however many there are; while hidden, no places are sent."""

    def __init__(
        self, canvas: Canvas, layer: Layer, name: str, shape: Triangles, *, count: int, colour: str, opacity: float
    ) -> None:
        """Makes `count` copies, all at the origin."""
        self.count = count
        self._visible = count > 0
        self._late: tuple[Floats, Floats | None, Floats | None] | None = None  # placed while hidden
        self._colours = np.tile(np.array([batch_rgb(colour)], np.uint8), (count, 1))
        self._node = canvas.add(
            lambda scene: scene.add_batched_meshes_simple(
                name,
                raised(shape.vertices),
                shape.faces.astype(np.uint32),
                turned(np.zeros(max(count, 1))),
                np.zeros((max(count, 1), 3), np.float32),
                batched_scales=np.ones(max(count, 1), np.float32),
                batched_colors=self._colours if count else batch_rgb(colour),
                lod="off",
                opacity=None if opacity >= 1.0 else opacity,
                material=_MATERIAL,
                side="double",
                cast_shadow=False,
                receive_shadow=False,
                position=canvas.height(layer),
                visible=False,  # until they are in place
            )
        )

    def place(self, positions: Floats, heading: Floats | None = None, scale: Floats | None = None) -> None:
        """Moves the copies to positions (N, 2) [m], turned by (N,) [rad], scaled by (N,)."""
        self._late = (positions, heading, scale)
        self.show(self._visible)

    def resize(self, scale: Floats) -> None:
        """Scales the copies by (N,)."""
        if self.count:
            self._node.batched_scales = scale.astype(np.float32)

    def highlight(self, colour: str, chosen: NDArray[np.bool_], highlighted: str) -> None:
        """Paints all copies, the chosen ones (N,) differently."""
        if self.count:
            both = np.array([batch_rgb(colour), batch_rgb(highlighted)], np.uint8)
            self._node.batched_colors = both[chosen.astype(np.int64)]

    def show(self, visible: bool) -> None:
        """Shows or hides them."""
        self._visible = visible and self.count > 0
        if self._visible:
            self.send()
        self._node.visible = self._visible

    def send(self) -> None:
        """Sends the places that they were given while hidden."""
        if self._late is not None:
            (positions, heading, scale), self._late = self._late, None
            self._node.batched_positions = raised(positions)
            if heading is not None:
                self._node.batched_wxyzs = turned(heading)
            if scale is not None:
                self.resize(scale)


class Picture:
    """A picture over some ground, hidden until there is one; its colours are shown as they are."""

    def __init__(self, canvas: Canvas, layer: Layer, name: str, extent: Arena, *, opaque: bool = False) -> None:
        """Starts clear."""
        centre = ((extent.x_min + extent.x_max) / 2, (extent.y_min + extent.y_max) / 2, canvas.height(layer)[2])
        self._node = canvas.add(
            lambda scene: scene.add_image(
                name,
                np.zeros((1, 1, 3 if opaque else 4), np.uint8),
                extent.width,
                extent.height,
                format="jpeg" if opaque else "png",
                cast_shadow=False,
                receive_shadow=False,
                wxyz=(0.0, 1.0, 0.0, 0.0),  # viser hangs its pictures face down
                position=centre,
                visible=False,
            )
        )

    def paint(self, rgba: NDArray[np.uint8]) -> None:
        """Shows a picture (rows, columns, 4), or 3 where it is opaque; row 0 is the top."""
        self._node.image = rgba

    def show(self, visible: bool) -> None:
        """Shows or hides it."""
        self._node.visible = visible

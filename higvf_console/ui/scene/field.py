"""Arrows of the vector field that the operator chose, on a grid over the arena."""

import time as clock

import numpy as np

from higvf_console.control.guidance.field import FieldKind, field_at
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.state import SimState
from higvf_console.core.viewport import Arena
from higvf_console.ui.scene import shapes
from higvf_console.ui.scene.parts import Canvas, Layer
from higvf_console.ui.theme import NOMINAL
from higvf_console.world.setup import Setup

PERIOD = 0.2  # between two updates of the arrows [s]


class FieldLayer:
    """The arrows are computed a few times a second, and only while a field is shown and the team moves."""

    def __init__(self, canvas: Canvas, setup: Setup) -> None:
        """Starts hidden; the kernel is made ready here, so that the first arrows do not keep the view waiting."""
        self._setup = setup
        self._points = field_grid(canvas.arena, NOMINAL.field_spacing * canvas.px)
        self._length = 0.78 * NOMINAL.field_spacing * canvas.px
        self._arrows = canvas.lines(Layer.FIELD, "/field", canvas.palette.field, 1.4)
        self._shown: tuple[FieldKind | None, SimState | None] = (None, None)
        self._next = 0.0
        field_at(FieldKind.PATH, self._points, setup.start, setup.world, setup.params)

    def update(self, kind: FieldKind | None, state: SimState) -> None:
        """Shows the field of a kind; None hides the arrows."""
        now = clock.monotonic()
        same_kind, same_state = kind == self._shown[0], self._shown[1] is state
        if same_kind and (same_state or kind is None or now < self._next):
            return
        self._shown, self._next = (kind, state), now + PERIOD
        if kind is None:
            self._arrows.draw(floats([], 0, 2, 2))
            return
        vectors = field_at(kind, self._points, state, self._setup.world, self._setup.params)
        self._arrows.draw(shapes.arrows(self._points, vectors, self._length))


def field_grid(arena: Arena, spacing: float) -> Floats:
    """Points (G, 2), evenly spread and centred in the arena."""
    columns, rows = max(1, round(arena.width / spacing)), max(1, round(arena.height / spacing))
    xs = arena.x_min + (np.arange(columns) + 0.5) * arena.width / columns
    ys = arena.y_min + (np.arange(rows) + 0.5) * arena.height / rows
    return floats(np.stack(np.meshgrid(xs, ys), axis=2), -1, 2)

"""Fires: a disc of its radius, its number, the zone from which it is fought, how far that has come; ashes when out."""

from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Bools, Floats
from higvf_console.core.numbers import measured
from higvf_console.core.state import SimState, Trace
from higvf_console.ui.scene import shapes
from higvf_console.ui.scene.glyphs import Triangles, lettering, merged
from higvf_console.ui.scene.ground import joined
from higvf_console.ui.scene.parts import Canvas, Layer
from higvf_console.ui.theme import NOMINAL, Nominal, cap_height
from higvf_console.world.setup import Setup

_RIM = 0.07  # of the radius
_PRIORITY_GAP, _PRIORITY_DASH = 7.0, 6.0  # [px]
_DIGIT = 16.0  # height of a fire's number [px]
_ROOM = 12.0  # radius of a fire that its number fits in [px]


class FireLook(NamedTuple):
    """How each of M fires stands.

    Attributes:
        burning: (M,) it burns.
        fought: (M,) it burns, and enough robots are at it.
        progress: (M,) share of the work that is done, in [0, 1].
    """

    burning: Bools
    fought: Bools
    progress: Floats


def fire_look(state: SimState, trace: Trace, setup: Setup) -> FireLook:
    """How the fires stand."""
    motion = state.motion
    work = setup.params.fires.extinguish_time * motion.fire_radius
    progress = np.divide(motion.fire_progress, work, out=np.ones_like(work), where=work > 0.0)
    return FireLook(
        motion.fire_burning,
        motion.fire_burning & (trace.crew >= setup.world.fire_needs),
        np.clip(progress, 0.0, 1.0),
    )


class Fires:
    """Discs follow the radius each frame; lettering changes only when a fire goes out."""

    def __init__(self, canvas: Canvas, setup: Setup) -> None:
        """One instance a fire."""
        self._canvas, self._setup, ink = canvas, setup, canvas.palette
        count = len(setup.world.fire_position)
        disc = shapes.filled(shapes.circle(0, 0, 1, 96))
        self._zone = canvas.marks(Layer.FIRE_ZONE, "/fires/zone", disc, count=count, colour=ink.fire_zone, opacity=0.13)
        self._disc = canvas.marks(Layer.FIRE, "/fires/disc", disc, count=count, colour=ink.fire)
        rim = shapes.annulus(1 - _RIM, 1, 96)
        self._rim = canvas.marks(Layer.FIRE_EDGE, "/fires/rim", rim, count=count, colour=ink.fire_edge)
        self._progress = canvas.lines(Layer.FIRE_MARK, "/fires/progress", ink.progress, 4.0)
        self._numbers = canvas.mesh(Layer.FIRE_TEXT, "/fires/numbers", merged([]), ink.fire_text)
        self._scorched = canvas.mesh(Layer.FIRE, "/fires/scorched", merged([]), ink.scorched)
        self._scorched_edge = canvas.lines(Layer.FIRE_EDGE, "/fires/scorched_edge", ink.scorched_edge, NOMINAL.outline)
        self._ashes = canvas.mesh(Layer.FIRE_TEXT, "/fires/ashes", merged([]), ink.scorched_text)
        self._outside = canvas.mesh(Layer.FIRE_TEXT, "/fires/outside", merged([]), ink.fire_edge)
        self._chosen = canvas.lines(Layer.FIRE_MARK, "/fires/priority", ink.operator, 2.0)
        self._look: FireLook | None = None
        self._roomy = np.zeros(count, np.bool_)

    def _priority_rings(self, state: SimState) -> Floats:
        """Dashed rings (s, 2, 2) round the burning fires that a robot values more."""
        gap, dash = _PRIORITY_GAP * self._canvas.px, _PRIORITY_DASH * self._canvas.px
        fires = sorted({int(fire) for fire in state.intent.priority[:, 1] if state.motion.fire_burning[int(fire)]})
        places = np.column_stack([self._setup.world.fire_position, state.motion.fire_radius + gap]).tolist()
        rings = [shapes.dashed(shapes.circle(x, y, r), dash, dash) for x, y, r in (places[fire] for fire in fires)]
        return joined(rings)

    def update(self, state: SimState, trace: Trace, loss_area: Floats) -> None:
        """Shows the fires of a snapshot."""
        at, radius = self._setup.world.fire_position, state.motion.fire_radius
        if not len(at):
            return
        self._chosen.draw(self._priority_rings(state))
        look, before = fire_look(state, trace, self._setup), self._look
        self._look = look
        flames = np.where(look.burning, radius, 0.0)
        self._disc.place(at, scale=flames)
        self._rim.place(at, scale=flames)
        self._zone.place(at, scale=np.where(look.burning, radius + self._setup.params.fires.stand_off, 0.0))
        self._progress.draw(progress_arcs(at, radius, look, 3 * self._canvas.px))
        if before is None or not np.array_equal(before.fought, look.fought):
            self._rim.highlight(self._canvas.palette.fire_edge, look.fought, self._canvas.palette.progress)
        roomy = radius > _ROOM * self._canvas.sizes.text / NOMINAL.text * self._canvas.px
        same = before is not None and np.array_equal(before.burning, look.burning)
        if not same or not np.array_equal(roomy, self._roomy):
            self._roomy = roomy
            self._letter(at, radius, look.burning, loss_area)

    def _letter(self, at: Floats, radius: Floats, burning: Bools, loss_area: Floats) -> None:
        numbers, outside, ashes = fire_lettering(at, radius, burning, loss_area, self._canvas.px, self._canvas.sizes)
        self._numbers.reshape(numbers)
        self._outside.reshape(outside)
        self._ashes.reshape(ashes)
        outlines = [shapes.circle(x, y, r) for (x, y), r in zip(at[~burning], radius[~burning], strict=True)]
        self._scorched.reshape(merged([shapes.filled(outline) for outline in outlines]))
        self._scorched_edge.draw(joined([shapes.segments(outline) for outline in outlines]))


def progress_arcs(at: Floats, radius: Floats, look: FireLook, gap: float) -> Floats:
    """Arcs (s, 2, 2), clockwise from the top, round the fires that are being extinguished."""
    arcs: list[Floats] = []
    for fire in np.flatnonzero(look.burning & (look.progress > 0.0)):
        turn = np.pi / 2 - np.linspace(0.0, 2 * np.pi * look.progress[fire], 49)  # pyright: ignore[reportUnknownVariableType]
        arc = at[fire] + (radius[fire] + gap) * np.stack([np.cos(turn), np.sin(turn)], axis=1)  # pyright: ignore[reportUnknownArgumentType]
        arcs.append(shapes.segments(arc))
    return joined(arcs)


def fire_lettering(
    at: Floats, radius: Floats, burning: Bools, loss_area: Floats, px: float, sizes: Nominal = NOMINAL
) -> tuple[Triangles, Triangles, Triangles]:
    """The numbers of burning fires, those of small ones below them, and numbers and losses of those that are out."""
    larger = sizes.text / NOMINAL.text
    height, small = larger * _DIGIT * px, cap_height(sizes.axis_text) * px
    inside: list[Triangles] = []
    outside: list[Triangles] = []
    ashes: list[Triangles] = []
    for fire, (x, y) in enumerate(at):
        below = y - radius[fire] - 10 * larger * px
        roomy = radius[fire] > larger * _ROOM * px
        if not burning[fire]:
            ashes.append(lettering(f"{measured(loss_area[fire])} m²", x, below, small))
            below -= 14 * larger * px
        texts = ashes if not burning[fire] else inside if roomy else outside
        texts.append(lettering(str(fire + 1), x, y if roomy else below - 3 * px, height))
    return merged(inside), merged(outside), merged(ashes)

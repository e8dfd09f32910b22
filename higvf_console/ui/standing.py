"""Why the team stands still although its clock runs: one sentence, or none while something moves."""

import math
from typing import TYPE_CHECKING

import numpy as np

from higvf_console.core.state import NOBODY, PathStatus

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot

MOST_NAMED = 6  # robots that are named one by one; of more, the number is given


def standing_text(snapshot: "Snapshot") -> str:
    """Why nobody moves; empty while somebody does, and where the mode says it, such as paused or disarmed."""
    motion, intent, params = snapshot.state.motion, snapshot.state.intent, snapshot.setup.params
    disarmed = snapshot.team is not None and not snapshot.team.armed
    if not snapshot.phase.moves or intent.stopped or intent.paused or snapshot.frozen or disarmed:
        return ""
    slow = params.stall.stall_fraction * params.blending.cruise_speed
    if float(np.hypot(*motion.velocity.T).max(initial=0.0)) > slow:
        return ""
    left = params.fires.start_delay - snapshot.time
    if left > 0.0:
        return f"The team sets out in {math.ceil(left)} s."
    if motion.path_status == PathStatus.HOLDING:
        return "The team waits at the end of its path: draw another, or finish it."
    held = np.flatnonzero(snapshot.trace.deadlocked).tolist()
    if held:
        return f"{_capital(_subject(held))} {'is' if len(held) == 1 else 'are'} held by barriers."
    return _at_fires(snapshot)


def _at_fires(snapshot: "Snapshot") -> str:
    """Why nobody moves where neither a path nor a barrier is the reason."""
    motion, needs = snapshot.state.motion, snapshot.setup.world.fire_needs
    if not motion.fire_burning.any():
        return "No fire burns: the team waits for a path."
    wishes = [(fire, np.flatnonzero(motion.target == fire).tolist()) for fire in np.unique(motion.target).tolist()]
    wanted = [(fire, robots) for fire, robots in wishes if fire != NOBODY]
    if not wanted:
        return "No robot sees a fire: the team waits for a path."
    fought = [str(fire + 1) for fire, _ in wanted if snapshot.trace.crew[fire] >= needs[fire]]
    if fought:
        return f"The team puts out fire {' and '.join(fought)}."
    if len(wanted) > 1:
        return f"The team disagrees: {'; '.join(_wish(fire, robots) for fire, robots in wishes)}."
    fire, robots = wanted[0]
    return f"{_capital(_wish(fire, robots))}, which takes {needs[fire]} robots; {snapshot.trace.crew[fire]} there."


def _wish(fire: int, robots: list[int]) -> str:
    wants = "wants" if len(robots) == 1 else "want"
    return f"{_subject(robots)} {wants} {'no fire' if fire == NOBODY else f'fire {fire + 1}'}"


def _subject(robots: list[int]) -> str:
    """Robots (indices) as the subject of a sentence."""
    numbers = [str(robot + 1) for robot in robots]
    if len(numbers) == 1:
        return f"robot {numbers[0]}"
    if len(numbers) > MOST_NAMED:
        return f"{len(numbers)} robots"
    return f"robots {', '.join(numbers[:-1])} and {numbers[-1]}"


def _capital(sentence: str) -> str:
    return sentence[:1].upper() + sentence[1:]

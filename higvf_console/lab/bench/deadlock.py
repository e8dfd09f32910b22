"""Random scenes run to their end in the printed, the zero-in and the corrected forms: who arrives, who is stuck.

    spaced, crowded   scattered obstacles, smallest gap 45 m and 28 m     lab.scenes
    pockets           a U across the way                                  lab.pockets

A scene has arrived when the influenced robot has finished its path within the time limit; it ends there, or when the
path is given up. It is a violation when any clearance was ever negative.
"""

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from typing import NamedTuple

from higvf_console.control.forms import forms_named
from higvf_console.control.parameters import Parameters
from higvf_console.core.errors import HigvfError
from higvf_console.core.state import PathStatus
from higvf_console.lab.bench.pockets import pocket_scene
from higvf_console.lab.bench.scene_file import scene_setup
from higvf_console.lab.bench.scenes import TIME_LIMIT, Kind, Scene, open_scene
from higvf_console.lab.progress import ProgressBar
from higvf_console.sim.setup import Setup
from higvf_console.sim.simulation import roll
from higvf_console.sim.warm_up import warm_up
from higvf_console.world.placement import convergent

FORMS = ("printed", "zero_in", "corrected")
SCENES = {Kind.SPACED: 1000, Kind.CROWDED: 1000, Kind.POCKETS: 100}
_FORMS = {form: forms_named(form.replace("_", "-")) for form in FORMS}
_LOOK = 10  # ticks between two looks at a run
_BATCH = 5  # scenes that a process runs at a time
_TOLERANCE = 1e-6  # by which a clearance may be negative: rounding [m]


class Outcome(NamedTuple):
    """How one scene ended.

    Attributes:
        kind: of the scene.
        seed: of the scene.
        form: which equations ran.
        status: of the path at the end.
        seconds: session time at the end [s].
        deadlock: how long a robot was deadlocked [s].
        clearance: the smallest of the run [m].
    """

    kind: Kind
    seed: int
    form: str
    status: PathStatus
    seconds: float
    deadlock: float
    clearance: float

    @property
    def arrived(self) -> bool:
        """Whether the influenced robot finished its path."""
        return self.status == PathStatus.FINISHED

    @property
    def violated(self) -> bool:
        """Whether a clearance was negative."""
        return self.clearance < -_TOLERANCE


def make_scene(kind: Kind, seed: int) -> Scene:
    """The scene of that kind and seed."""
    return pocket_scene(seed) if kind == Kind.POCKETS else open_scene(kind, seed)


def scene_named(text: str) -> Scene:
    """The scene that a text such as "crowded:17" names.

    Raises:
        HigvfError: no kind and seed; the message gives the choices.
    """
    kind, _, seed = text.partition(":")
    if kind not in tuple(Kind) or not seed.isdecimal():
        raise HigvfError(f"no scene {text!r}; choose {', '.join(Kind)} and a seed, such as {Kind.CROWDED}:17")
    return make_scene(Kind(kind), int(seed))


def run_scene(scene: Scene, form: str) -> Outcome:
    """Runs a scene in one form until its path is finished or given up, or the time limit is over."""
    return _run(scene, form, scene_setup(scene, params_of(form, scene)))


def _run(scene: Scene, form: str, setup: Setup) -> Outcome:
    state, dt = setup.start, setup.params.safety.control_period
    deadlock, clearance = 0.0, float("inf")
    while state.motion.path_status == PathStatus.FOLLOWING and state.motion.tick * dt < TIME_LIMIT:
        state, rollout = roll(state, setup.world, setup.params, _LOOK)
        clearance = min(clearance, float(rollout.clearance.min()))
        deadlock += dt * float(rollout.deadlocked.sum())
    status = PathStatus(state.motion.path_status)
    return Outcome(scene.kind, scene.seed, form, status, state.motion.tick * dt, deadlock, clearance)


def params_of(form: str, scene: Scene) -> Parameters:
    """The default gains in one of `FORMS`; weights scaled where the printed intention update would diverge."""
    return convergent(Parameters(forms=_FORMS[form]), scene.robots, None, scene.influenced)[0]


def run_all(scenes: int | None = None, forms: Sequence[str] = FORMS) -> list[Outcome]:
    """Runs the suite on all cores; the outcomes in the order of forms, kinds and seeds.

    Args:
        scenes: how many of the spaced ones, and the same share of the others, at least one; None = all of `SCENES`.
        forms: which of `FORMS`.
    """
    share = 1.0 if scenes is None else scenes / SCENES[Kind.SPACED]
    jobs = [(kind, seed) for kind, count in SCENES.items() for seed in range(max(1, round(share * count)))]
    scene = make_scene(*jobs[0])
    first = scene_setup(scene, params_of(forms[0], scene))
    warm_up(first.start, first.world, first.params)  # once, before the processes start
    bar = ProgressBar("scenes", len(jobs))
    outcomes: list[Outcome] = []
    with ProcessPoolExecutor() as pool:
        batches = [jobs[k : k + _BATCH] for k in range(0, len(jobs), _BATCH)]
        for future in as_completed([pool.submit(_run_batch, batch, forms) for batch in batches]):
            found = future.result()
            outcomes += found
            bar.advance(len(found) // len(forms))
    kinds = tuple(Kind)
    return sorted(outcomes, key=lambda one: (forms.index(one.form), kinds.index(one.kind), one.seed))


def _run_batch(jobs: Sequence[tuple[Kind, int]], forms: Sequence[str]) -> list[Outcome]:
    """The outcomes of some scenes; a scene's world, the same in all forms, is made once."""
    outcomes: list[Outcome] = []
    for kind, seed in jobs:
        scene = make_scene(kind, seed)
        setup = scene_setup(scene, params_of(forms[0], scene))
        outcomes += [_run(scene, form, setup._replace(params=params_of(form, scene))) for form in forms]
    return outcomes

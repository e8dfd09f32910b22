"""Study of deadlocks: random scenes in the printed, the zero-in and the corrected forms of the equations.

    spaced, crowded   scattered obstacles, minimum gap 45 m and 28 m      lab.bench.scenes
    pockets           a U-shaped obstacle across the way                  lab.bench.pockets

A scene arrives if the influenced robot finishes its path within the time limit. Its run ends then, or when the path is
blocked. A scene is a violation if a clearance is ever negative.
"""

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from typing import NamedTuple

from higvf_console.control.forms import forms_named
from higvf_console.control.parameters import Parameters, defaults_at
from higvf_console.core.errors import HigvfError
from higvf_console.core.state import PathStatus
from higvf_console.lab.bench.pockets import pocket_scene
from higvf_console.lab.bench.scene_file import scene_setup
from higvf_console.lab.bench.scenes import TIME_LIMIT, Kind, Scene, open_scene, scaled
from higvf_console.lab.progress import ProgressBar
from higvf_console.sim.simulation import roll
from higvf_console.sim.warm_up import warm_up
from higvf_console.world.network import convergent
from higvf_console.world.setup import Setup, with_params

FORMS = ("printed", "zero_in", "corrected")
SCENES = {Kind.SPACED: 1000, Kind.CROWDED: 1000, Kind.POCKETS: 100}
_FORMS = {form: forms_named(form.replace("_", "-")) for form in FORMS}
_LOOK = 10  # ticks of one rollout, after which the path status is checked
_BATCH = 5  # scenes of one job of a process
_TOLERANCE = 1e-6  # rounding error of a clearance [m]


class Outcome(NamedTuple):
    """Outcome of one scene.

    Attributes:
        kind: kind of the scene.
        seed: seed of the scene.
        form: form of the equations.
        status: path status at the end.
        seconds: session time at the end [s].
        deadlock: total time for which a robot was deadlocked [s].
        clearance: minimum clearance of the run [m].
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


def make_scene(kind: Kind, seed: int, factor: float = 1.0) -> Scene:
    """The random scene of a kind and seed, at `factor` times its usual size."""
    scene = pocket_scene(seed) if kind == Kind.POCKETS else open_scene(kind, seed)
    return scene if factor == 1.0 else scaled(scene, factor)


def scene_named(text: str) -> Scene:
    """The scene that a text such as "crowded:17" names.

    Raises:
        HigvfError: the text is not KIND:SEED; the message lists the kinds.
    """
    kind, _, seed = text.partition(":")
    if kind not in tuple(Kind) or not seed.isdecimal():
        raise HigvfError(
            f"unknown scene {text!r}; give KIND:SEED with a kind of {', '.join(Kind)}, such as {Kind.CROWDED}:17"
        )
    return make_scene(Kind(kind), int(seed))


def run_scene(scene: Scene, form: str) -> Outcome:
    """Runs a scene in one form until its path is finished or blocked, or the time limit is over."""
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
    """The defaults at the scale of a scene in one of `FORMS`, with weights for which the printed update converges."""
    params = defaults_at(scene.scale)._replace(forms=_FORMS[form])
    return convergent(params, scene.robots, None, scene.influenced)[0]


def run_all(scenes: int | None = None, forms: Sequence[str] = FORMS, factor: float = 1.0) -> list[Outcome]:
    """Runs the suite on all cores; returns the outcomes in the order of forms, kinds and seeds.

    Args:
        scenes: number of spaced scenes, and the same share of each other kind, at least one; None = all of `SCENES`.
        forms: forms to run, of `FORMS`.
        factor: size of arena, robots and speeds, relative to the usual one.
    """
    share = 1.0 if scenes is None else scenes / SCENES[Kind.SPACED]
    jobs = [(kind, seed) for kind, count in SCENES.items() for seed in range(max(1, round(share * count)))]
    scene = make_scene(*jobs[0], factor)
    first = scene_setup(scene, params_of(forms[0], scene))
    warm_up(first.start, first.world, first.params)  # compiles once, before the processes start
    bar = ProgressBar("scenes", len(jobs))
    outcomes: list[Outcome] = []
    with ProcessPoolExecutor() as pool:
        batches = [jobs[k : k + _BATCH] for k in range(0, len(jobs), _BATCH)]
        for future in as_completed([pool.submit(_run_batch, batch, forms, factor) for batch in batches]):
            found = future.result()
            outcomes += found
            bar.advance(len(found) // len(forms))
    kinds = tuple(Kind)
    return sorted(outcomes, key=lambda one: (forms.index(one.form), kinds.index(one.kind), one.seed))


def _run_batch(jobs: Sequence[tuple[Kind, int]], forms: Sequence[str], factor: float) -> list[Outcome]:
    """Runs some scenes in all forms; the world of a scene is the same in all forms and is built once."""
    outcomes: list[Outcome] = []
    for kind, seed in jobs:
        scene = make_scene(kind, seed, factor)
        setup = scene_setup(scene, params_of(forms[0], scene))
        outcomes += [_run(scene, form, with_params(setup, params_of(form, scene))) for form in forms]
    return outcomes

"""Reports of the study of deadlocks: a table or JSON by form and kind, or the events of one scene."""

import json
import statistics
from collections.abc import Sequence
from typing import Any

from higvf_console.core.state import PathStatus
from higvf_console.lab.bench.deadlock import FORMS, Outcome, params_of, run_scene
from higvf_console.lab.bench.scene_file import scene_setup
from higvf_console.lab.bench.scenes import TIME_LIMIT, Kind, Scene
from higvf_console.runtime.run import Run

_MOST_SEEDS = 12  # seeds listed in one line of the table
_ENDS = {PathStatus.FINISHED: "arrived", PathStatus.BLOCKED: "blocked", PathStatus.FOLLOWING: "still under way"}
_HEAD = ("form", "kind", "scenes", "arrived", "violations", "deadlock mean s", "median s")


def plain(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """By form: the figures of the spaced scenes, with those of the other kinds under the name of the kind."""
    return {
        form: figures(_of(outcomes, form, Kind.SPACED))
        | {kind.value: figures(_of(outcomes, form, kind)) for kind in (Kind.CROWDED, Kind.POCKETS)}
        for form in FORMS
    }


def figures(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """Summary of the outcomes of one form and kind; `failed` lists the seeds that did not arrive."""
    arrivals = [outcome.seconds for outcome in outcomes if outcome.arrived]
    return {
        "scenes": len(outcomes),
        "arrival_share": len(arrivals) / len(outcomes),
        "violations": sum(outcome.violated for outcome in outcomes),
        "deadlock_s_mean": round(statistics.fmean(outcome.deadlock for outcome in outcomes), 3),
        "median_s": round(statistics.median(arrivals), 3) if arrivals else None,
        "failed": [outcome.seed for outcome in outcomes if not outcome.arrived],
    }


def as_json(outcomes: Sequence[Outcome]) -> str:
    """The result of `plain` as JSON."""
    return json.dumps(plain(outcomes), indent=2)


def table(outcomes: Sequence[Outcome]) -> str:
    """A table with one line for each form and kind, and the seeds that did not arrive below it."""
    lines, failures = [[*_HEAD]], list[str]()
    for kind in Kind:
        for form in FORMS:
            found = figures(_of(outcomes, form, kind))
            median = "-" if found["median_s"] is None else f"{found['median_s']:.1f}"
            figure = [f"{found['arrival_share']:.1%}", str(found["violations"]), f"{found['deadlock_s_mean']:.2f}"]
            lines.append([form, kind.value, str(found["scenes"]), *figure, median])
            if found["failed"] and form == "corrected":
                failures.append(f"{kind.value} seeds that did not arrive: {_seeds(found['failed'])}")
    widths = [max(len(line[column]) for line in lines) for column in range(len(_HEAD))]
    rows = ["  ".join(cell.rjust(width) for cell, width in zip(line, widths, strict=True)) for line in lines]
    return "\n".join(["Deadlocks in random scenes, by the forms of the equations", *rows, *failures])


def story(scene: Scene) -> str:
    """The outcome of a scene in each form, and the events of its run in the corrected form."""
    still = len(scene.circles) + len(scene.bars) + len(scene.polygons)
    lines = [
        f"Scene {scene.kind}:{scene.seed}: {len(scene.robots)} robots, {still} obstacles, {len(scene.fires)} fires; "
        f"robot {scene.influenced + 1} follows the path."
    ]
    for form in FORMS:
        end = run_scene(scene, form)
        lines.append(
            f"{form:9}  {_ENDS[end.status]} after {end.seconds:.1f} s, deadlocked {end.deadlock:.1f} s, "
            f"minimum clearance {end.clearance:.2f} m"
        )
    run = Run(scene_setup(scene, params_of("corrected", scene)))
    while run.state.motion.path_status == PathStatus.FOLLOWING and run.time < TIME_LIMIT:
        lines += [f"{event.time:8.2f} s  {event.text}" for event in run.step()]
    return "\n".join(lines)


def _seeds(failed: Sequence[int]) -> str:
    more = f" and {len(failed) - _MOST_SEEDS} more" if len(failed) > _MOST_SEEDS else ""
    return ", ".join(map(str, failed[:_MOST_SEEDS])) + more


def _of(outcomes: Sequence[Outcome], form: str, kind: Kind) -> list[Outcome]:
    return [outcome for outcome in outcomes if outcome.form == form and outcome.kind == kind]

"""`higvf bench --suite team`: e-pucks of Enki, a physics simulator that is not ours, and what is done to their link.

tasks   two fires and three drawn paths, with latency, noise and loss, in lockstep: contacts as the plant sees them
kills   console, poses, network and one robot cut off at random moments in real time, until the last wheel stands
"""

import math
import random
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from higvf_console.lab.team.driving import Conditions, Outcome, run
from higvf_console.lab.team.kills import BOUND, KINDS, Kill, kill
from higvf_console.lab.team.scenes import scenes

MINUTES, KILLS = 30.0, 10
_CONDITIONS = (
    Conditions(),
    Conditions(latency_s=0.05),
    Conditions(latency_s=0.15),
    Conditions(noise_m=0.002),
    Conditions(noise_m=0.005),
    Conditions(loss=0.1),
    Conditions(0.15, 0.005, 0.1),
)


class Figures(NamedTuple):
    """What was measured."""

    outcomes: list[Outcome]
    kills: list[Kill]

    @property
    def kept(self) -> bool:
        """Whether no body touched another, all tasks were done, and all wheels stood in time, and stayed so."""
        done = all(one.arrived and one.judged.contacts == 0 for one in self.outcomes)
        return done and all(one.stood_after < BOUND and not one.moved_again and one.contacts == 0 for one in self.kills)


def measure(minutes: float = MINUTES, kills: int = KILLS, kinds: Sequence[str] = KINDS, seed: int = 0) -> Figures:
    """Runs the suite.

    Args:
        minutes: of tasks to simulate, at least; all tasks in all conditions take about 35.
        kills: of each kind.
        kinds: those of `KINDS` to try.
        seed: of what is random on the link, and of the moments.

    Raises:
        HigvfError: Enki is not installed.
    """
    outcomes = list(_tasks(60.0 * minutes, seed))
    draw, slalom = random.Random(seed), scenes()[1]
    return Figures(outcomes, [kill(kind, slalom, draw) for kind in kinds for _ in range(kills)])


def _tasks(seconds: float, seed: int) -> Iterator[Outcome]:
    passed = 0.0
    while passed < seconds:
        for conditions in _CONDITIONS:
            for scene in scenes():
                if passed >= seconds:
                    return
                outcome = run(scene, conditions, seed)
                passed += outcome.seconds
                yield outcome
        seed += 1


def plain(figures: Figures) -> dict[str, Any]:
    """The figures, ready for JSON."""
    return {
        "suite": "team",
        "kept": figures.kept,
        "minutes": round(sum(one.seconds for one in figures.outcomes) / 60.0, 2),
        "tasks": [
            {
                "scene": one.scene,
                **one.conditions._asdict(),
                "arrived": one.arrived,
                "took_s": _rounded(one.took, 2),
                "path_error_mm": _rounded(1e3 * one.path_error, 1) if one.scene != "fires" else None,
                "contacts": one.judged.contacts,
                "least_gap_robots_mm": _millimetres(one.judged.least_robots_m),
                "least_gap_obstacles_mm": _millimetres(one.judged.least_obstacles_m),
                "infeasible_ticks": one.infeasible,
                "digest": one.digest,
            }
            for one in figures.outcomes
        ],
        "kills": [
            {
                "kind": kind,
                "count": len(found),
                "stood_after_s": _spread([one.stood_after for one in found]),
                "moved_again": sum(one.moved_again for one in found),
                "contacts": sum(one.contacts for one in found),
                "plant_held_up_s": round(max(one.held_up_s for one in found), 3),
            }
            for kind, found in _by_kind(figures.kills)
        ],
        "command_to_wheel_ms": _spread([1e3 * one for each in figures.kills for one in each.latencies_s]),
        "late_s": _rounded(sum(one.lost_s for one in figures.kills), 3),
    }


def table(figures: Figures) -> str:
    """The figures as text."""
    found = plain(figures)
    head = "scene     latency ms  noise mm  loss %  done  time s  path error mm  contacts  gap robots mm  gap obst. mm"
    lines = [f"E-pucks of Enki, {found['minutes']:g} simulated minutes; latency each way", head]
    for one in found["tasks"]:
        error = "-" if one["path_error_mm"] is None else f"{one['path_error_mm']:.1f}"
        took = "-" if one["took_s"] is None else f"{one['took_s']:.1f}"
        lines.append(
            f"{one['scene']:<8}  {1e3 * one['latency_s']:10.0f}  {1e3 * one['noise_m']:8.0f}  {100 * one['loss']:6.0f}"
            f"  {'yes' if one['arrived'] else 'NO':>4}  {took:>6}  {error:>13}  {one['contacts']:8d}"
            f"  {one['least_gap_robots_mm']:>13}  {one['least_gap_obstacles_mm']:>12}"
        )
    if found["kills"]:
        lines.append(f"Killed while they drive, in real time: until the last wheel stands (bound {BOUND:g} s)")
    for one in found["kills"]:
        stood = one["stood_after_s"]
        lines.append(
            f"{one['kind']:<8}  {one['count']:4d} times  p50 {stood['p50']:.3f} s  p99 {stood['p99']:.3f} s  max "
            f"{stood['max']:.3f} s  moved again {one['moved_again']}  contacts {one['contacts']}"
            f"  plant late by at most {one['plant_held_up_s']:.3f} s"
        )
    if wheel := found["command_to_wheel_ms"]:
        lines.append(
            f"From a command to the wheels, real time: p50 {wheel['p50']:.2f} ms  p99 {wheel['p99']:.2f} ms; "
            f"the consoles were late by {found['late_s']:g} s in all"
        )
    lines.append("All kept." if found["kept"] else "NOT KEPT: see above.")
    return "\n".join(lines)


def _by_kind(kills: Iterable[Kill]) -> list[tuple[str, list[Kill]]]:
    found: dict[str, list[Kill]] = {}
    for one in kills:
        found.setdefault(one.kind, []).append(one)
    return list(found.items())


def _spread(values: Sequence[float]) -> dict[str, float] | None:
    if not values:
        return None
    p50, p99 = np.percentile(values, (50, 99), method="higher").tolist()
    return {"p50": round(p50, 3), "p99": round(p99, 3), "max": round(max(values), 3)}


def _millimetres(gap: float | None) -> float | None:
    return None if gap is None else round(1e3 * gap, 1)


def _rounded(value: float, digits: int) -> float | None:
    return round(value, digits) if math.isfinite(value) else None

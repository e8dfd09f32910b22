"""Writes the present run as the text of a scenario file, which `scenario.parse_scenario` reads.

Burning fires keep their present radius; extinguished ones are omitted, and later fires move up. A path is written while
it is in force, an open one from the present place along it. Progress at fires, priorities and what the team has agreed
on belong to the run, not to the scenario, and are not written.
"""

import math
from collections.abc import Mapping
from contextlib import suppress
from typing import Any, cast

import numpy as np

from higvf_console.control.forms import FORMS, Forms
from higvf_console.control.guidance.paths import SEGMENTS, SHORTEST_PATH, path_points
from higvf_console.control.parameters import GROUPS, Parameters, defaults_at
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import ScenarioError
from higvf_console.core.quantity import quantities
from higvf_console.core.reading.document import yaml_text
from higvf_console.core.state import Motion, Path, PathEnding, PathKind, PathStatus, SimState
from higvf_console.core.viewport import Arena
from higvf_console.operator.path_commands import ending_word
from higvf_console.scenario.channel_settings import written_inputs
from higvf_console.scenario.courses import written_course
from higvf_console.scenario.ends import written_ends
from higvf_console.scenario.scenario import VERSION, Scenario, parse_scenario
from higvf_console.scenario.sections import Robots
from higvf_console.scenario.teams import written_teams
from higvf_console.world.editing.entities import centres
from higvf_console.world.layout import Layout
from higvf_console.world.obstacles import Obstacles, course_of
from higvf_console.world.polygons import obstacles_of
from higvf_console.world.setup import Setup

Section = dict[str, Any]


def scenario_yaml(setup: Setup, state: SimState, scenario: Scenario | None, *, rounded: bool = False) -> str:
    """The text of a scenario file that starts from the present state.

    Layout and start positions are written bit for bit; headings of unicycles, a sketched path and what is left of the
    courses of moving obstacles up to rounding.

    Args:
        setup: layout and world in force.
        state: the present state.
        scenario: where the run comes from, for what edits do not change; None = nowhere.
        rounded: whether lengths are rounded, to the millimetre at the usual scale, as people want to read them, where a
            run can still start from them.

    Raises:
        ScenarioError: no run can start from the present state, for example because a fire has grown too large.
    """
    layout, motion = setup.layout, state.motion
    time = motion.tick * setup.params.safety.control_period
    robots = _robots(centres(layout, motion), motion.heading, setup.params)
    content: Section = {"version": VERSION}
    if scenario is not None:
        content |= {"name": scenario.name, "title": scenario.title}
        content |= {"description": scenario.description, "briefing": scenario.briefing}
    content |= {"arena": _arena(layout.arena, layout.walls), "robots": robots.written()}
    if layout.links is not None:
        content["links"] = [[first + 1, second + 1] for first, second in layout.links]
    if layout.formation.tobytes() != robots.controlled(0, setup.params.robots.look_ahead).tobytes():
        content["formation_m"] = layout.formation.tolist()
    content |= {"fires": _fires(layout, motion), "obstacles": _obstacles(layout.obstacles, time)}
    content |= {"path": _path(state, setup.params.scale.length), "influenced": state.intent.influenced + 1}
    if scenario is not None:
        content["strokes"] = _strokes(scenario, len(motion.position))
    content |= {"parameters": _parameters(setup.params), "forms": _forms(setup.params.forms)}
    if scenario is not None:
        content |= {
            "filter": scenario.filter.value, "inputs": written_inputs(scenario.inputs, scenario.limits),
            "teams": written_teams(scenario.teams), "demo": list(scenario.demo), "ends": written_ends(scenario.ends),
            "duration_s": scenario.duration,
        }  # fmt: skip
    content = {key: value for key, value in content.items() if key == "links" or value not in ({}, [], "")}
    source = scenario.source if scenario is not None else "scenario.yaml"
    if rounded:
        text = yaml_text(rounded_lengths(content, setup.params.scale.decimals))
        with suppress(ScenarioError):
            parse_scenario(text, source)
            return text
    text = yaml_text(content)
    try:
        parse_scenario(text, source)
    except ScenarioError as error:
        raise ScenarioError(f"the present state cannot be a scenario's start: {error}") from error
    return text


def rounded_lengths(value: Any, decimals: int, *, length: bool = False) -> Any:
    """A part of a scenario whose lengths, those of the arena and of keys that end in `_m`, have so many decimals.

    The body of the robots keeps its size, from which all else follows.
    """
    match value:
        case dict():
            section = cast(dict[str, Any], value)
            return {
                key: part
                if key == "radius_m" and "speed_limit_m_per_s" in section
                else rounded_lengths(part, decimals, length=length or key.endswith("_m") or key == "arena")
                for key, part in section.items()
            }
        case list():
            return [rounded_lengths(part, decimals, length=length) for part in cast(list[Any], value)]
        case float() if length and math.isfinite(value):
            return round(value, decimals) + 0.0
        case _:
            return value


def _arena(arena: Arena, walls: bool) -> Section:
    if (arena.x_min, arena.y_min) == (0.0, 0.0):
        return {"size_m": [arena.x_max, arena.y_max], "walls": walls}
    return {**arena._asdict(), "walls": walls}


def _robots(centre: Floats, heading: Floats, params: Parameters) -> Robots:
    unicycles = params.robots.look_ahead > 0.0
    turned = np.array([math.remainder(angle, 2.0 * math.pi) for angle in heading.tolist()])
    return Robots(centre, 0.0, turned if unicycles else np.zeros(len(centre)), params.scale)


def _fires(layout: Layout, motion: Motion) -> list[Section]:
    return [
        {
            "at_m": list(fire.position), "radius_m": radius,
            "growth_m_per_s": fire.growth, "robots_needed": fire.needs,
        }
        for fire, radius, burns in zip(
            layout.fires, motion.fire_radius.tolist(), motion.fire_burning.tolist(), strict=True
        ) if burns
    ]  # fmt: skip


def _obstacles(obstacles: Obstacles, time: float) -> Section:
    """Where they are at a time [s]; of a course what is left of it."""
    now = obstacles.at(time)
    sections: Section = {
        "circles": [_circle(obstacles, now, row, time) for row in range(len(now.circles))],
        "bars": [_bar(obstacles, now, row, time) for row in range(len(now.bars))],
        "polygons": [_polygon(*chains) for chains in obstacles_of(now.polygons)],
    }
    return {name: section for name, section in sections.items() if section}


def _circle(start: Obstacles, now: Obstacles, row: int, time: float) -> Section:
    x, y, radius = now.circles[row].tolist()
    course = written_course(course_of(now.circle_courses, row), time, start.circles[row, :2])
    return {"at_m": [x, y], "radius_m": radius, **course}


def _bar(start: Obstacles, now: Obstacles, row: int, time: float) -> Section:
    ax, ay, bx, by, half_width = now.bars[row].tolist()
    middle = (start.bars[row, :2] + start.bars[row, 2:4]) / 2
    course = written_course(course_of(now.bar_courses, row), time, middle)
    return {"from_m": [ax, ay], "to_m": [bx, by], "half_width_m": half_width, **course}


def _polygon(outline: Floats, *free: Floats) -> Section:
    polygon: Section = {"points_m": outline.tolist()}
    return {**polygon, "free_m": [chain.tolist() for chain in free]} if free else polygon


def _path(state: SimState, scale: float) -> Section:
    path, motion = state.intent.path, state.motion
    if path.kind == PathKind.NONE or motion.path_status not in (PathStatus.FOLLOWING, PathStatus.BREAK_AWAY):
        return {}
    shape = _shape(path, motion.path_parameter, scale)
    if not shape:
        return {}
    way: Section = {"direction": "forward" if path.direction > 0.0 else "backward"}
    if path.ending != PathEnding.RELEASE:
        way["ending"] = ending_word(path)
    if path.pace != 1.0:
        way["pace"] = path.pace
    if path.duration < math.inf:
        way["duration_s"] = motion.path_left
    return shape | way


def _shape(path: Path, done: float, scale: float) -> Section:
    """Line, circle or sketch; of an open path that does not start again what is left from arc length `done` [m].

    What is left is no path if it is too short at a scale of lengths.
    """
    if path.kind == PathKind.LINE:
        x, y, cos, sin = path.shape.tolist()
        return {"line": {"at_m": [x, y], "angle_deg": math.degrees(math.atan2(sin, cos))}}
    if path.kind == PathKind.CIRCLE:
        x, y, radius, _ = path.shape.tolist()
        return {"circle": {"at_m": [x, y], "radius_m": radius}}
    start, end = 0.0, path.length
    if not path.closed and path.ending != PathEnding.LOOP:
        start, end = (done, end) if path.direction > 0.0 else (start, done)
    if end - start < SHORTEST_PATH * scale:
        return {}
    points = path_points(path, floats(np.linspace(start, end, SEGMENTS + 1)))
    return {"sketch": {"points_m": points.tolist(), "closed": bool(path.closed), "smoothing_m": 0.0}}


def _strokes(scenario: Scenario, robots: int) -> list[Section]:
    return [
        {
            "name": stroke.name,
            **({"robot": stroke.robot + 1} if stroke.robot is not None and stroke.robot < robots else {}),
            "points_m": stroke.points.tolist(),
        }
        for stroke in scenario.strokes
    ]


def _parameters(params: Parameters) -> Section:
    """What differs from the defaults; a speed limit that would follow from the cruise speed is written too."""
    sections: Section = {}
    usual = defaults_at(params.scale)
    for group in GROUPS:
        part, default = getattr(params, group), getattr(usual, group)
        changed = {name: getattr(part, name) for name in quantities(type(part))}
        sections[group] = {name: value for name, value in changed.items() if value != getattr(default, name)}
    if "cruise_speed" in sections["blending"]:
        sections["safety"]["speed_limit"] = params.safety.speed_limit
    return {group: section for group, section in sections.items() if section}


def _forms(forms: Forms) -> str | Mapping[str, str]:
    return next((name for name, known in FORMS.items() if known == forms), forms.words())

"""What explains a robot reads and is drawn right; pure, without a browser."""

import re
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from higvf_console.analysis.active_constraints import ActiveConstraint
from higvf_console.analysis.explain import Authority, Part
from higvf_console.analysis.sight import sights
from higvf_console.core.arrays import floats
from higvf_console.core.commands import OperatorCommand, Pick
from higvf_console.core.viewport import Viewport
from higvf_console.runtime.run import Run
from higvf_console.runtime.session import Session
from higvf_console.runtime.snapshot import Snapshot
from higvf_console.sim.certificates import Certificate
from higvf_console.ui.interaction.arena import ArenaInteraction
from higvf_console.ui.page.roles import Roles
from higvf_console.ui.scene.reasons import (
    LONGEST,
    READABLE,
    arrow,
    chain,
    part_colours,
    part_outline,
    pixels_per_speed,
    sight_lines,
)
from higvf_console.ui.theme import DARK, LIGHT, Palette, vertex_rgb
from higvf_console.ui.ui_state import UiState, UiStore
from higvf_console.ui.widgets.authority import SPAN, AuthorityHistory, bands_svg, legend_html
from higvf_console.ui.widgets.why_tables import (
    MOST_ROWS,
    certificate_html,
    parts_html,
    rows_html,
    sight_html,
    signed,
)
from tests.page_actions import no_page
from tests.teams import team

EVEN = floats([0.25] * 4)
SETUP = team(
    [(100.0, 300.0)], [(900.0, 300.0, 30.0), (100.0, 600.0, 20.0), (300.0, 600.0, 20.0)], [(500.0, 300.0, 40.0)],
    [(200.0, 450.0, 220.0, 450.0, 5.0)],
)  # fmt: skip


def test_a_chain_of_arrows_starts_at_the_robot_and_ends_where_the_sum_does() -> None:
    vectors = np.zeros((8, 2))
    vectors[Part.HUMAN], vectors[Part.SAFETY] = [30.0, 0.0], [0.0, 40.0]
    vectors[Part.TARGET] = [1.0, 0.0]  # too short to be drawn, but it moves the others
    segments, colours = chain(floats([10.0, 20.0]), vectors, 1.0)
    assert segments.shape == (6, 2, 2)
    assert segments[0] == pytest.approx(floats([[11, 20], [41, 20]]))
    assert segments[3] == pytest.approx(floats([[41, 20], [41, 60]]))
    assert (colours[:3] == vertex_rgb(part_colours(DARK)[Part.HUMAN])).all()
    assert (colours[3:] == vertex_rgb(part_colours(DARK)[Part.SAFETY])).all()


def test_the_arrows_of_a_slow_robot_are_long_enough_to_be_read_and_those_of_a_still_one_are_none() -> None:
    def longest(speed: float) -> float:
        vectors = floats([[speed, 0.0], [0.0, 0.3 * speed]])
        return speed * pixels_per_speed(vectors, 90.0)

    assert longest(90.0) == pytest.approx(LONGEST)
    assert longest(5.0) == pytest.approx(READABLE)
    assert longest(0.01) < 1.0


def test_the_barbs_of_an_arrow_lie_behind_its_tip_and_shrink_with_it() -> None:
    for length in (5.0, 50.0):
        barbs = arrow(floats([0, 0]), floats([length, 0]), 3.0, 7.0)[1:, 1]
        assert barbs[:, 0] == pytest.approx([length - min(7.0, 0.6 * length)] * 2)
        assert barbs[:, 1].sum() == pytest.approx(0.0)
    assert len(arrow(floats([0, 0]), floats([np.nan, 0]), 3.0, 7.0)) == 0


@pytest.mark.parametrize("palette", [DARK, LIGHT])
def test_no_two_parts_have_the_same_colour(palette: Palette) -> None:
    assert len(set(part_colours(palette).values())) == len(Part)


def test_lines_of_sight_run_through_to_fires_in_the_clear_and_are_dashed_to_hidden_ones() -> None:
    last = Run(SETUP).last
    found = sights(0, last, SETUP)
    seen, unseen = sight_lines(last.before.motion.position[0], found, last, SETUP, 5.0)
    assert [bool(sight.hidden_by) for sight in found] == [True, False, True]
    assert unseen[0, 0] == pytest.approx([100.0, 300.0])
    assert unseen[..., 0].max() < 870.0
    lengths = np.hypot(*(seen[:, 1] - seen[:, 0]).T)
    assert lengths[0] == pytest.approx(280.0)  # to the rim of fire 2, drawn through
    assert lengths[1:].max() < 10.0  # fire 3 is hidden in part


def test_the_outline_of_a_hider_is_that_of_its_obstacle() -> None:
    circle = part_outline(0, SETUP, 0)
    assert np.hypot(*(circle - [500, 300]).T) == pytest.approx(np.full(len(circle), 40.0))
    assert part_outline(1, SETUP, 0)[:, 1].max() == pytest.approx(455.0)


def test_the_table_of_parts_names_all_and_dims_those_that_do_nothing() -> None:
    parts = np.zeros((8, 2))
    parts[Part.HUMAN] = [30.0, -0.04]
    html = parts_html(1, parts, parts.sum(axis=0))
    assert "Why robot 2 moves" in html
    assert html.count('class="out"') == 7
    assert "Velocity</td><td>30.0</td><td>0.0</td><td>30.0" in html


@pytest.mark.parametrize(("value", "shown"), [(-0.04, "0.0"), (-0.06, "\u22120.1"), (12.34, "12.3")])
def test_numbers_have_a_true_minus_and_zero_has_none(value: float, shown: str) -> None:
    assert signed(value) == shown


def test_what_holds_a_robot_back_is_named_with_its_distance() -> None:
    rows = [ActiveConstraint(f"fire {k}", 12.34 + k, 12.0) for k in range(MOST_ROWS + 2)]
    html = rows_html(rows)
    assert "<b>fire 0</b>, 12.3 m" in html
    assert "and 2 more" in html
    assert "No barrier" in rows_html([])


def test_target_scores_say_what_hides_a_fire_and_which_one_is_wanted() -> None:
    last = Run(SETUP).last
    html = sight_html(sights(0, last, SETUP), cast(Snapshot, SimpleNamespace(last=last)), 0, SETUP)
    assert "<td>circle 1</td><td>0.0°" in html
    assert len(re.findall("target</span>", html)) == 1
    assert "No fire" in sight_html([], cast(Snapshot, SimpleNamespace(last=last)), 0, SETUP)


def test_a_condition_that_is_not_met_stands_out() -> None:
    good = Certificate("A", "a", "If it fails, A.", 0.5, 1.0)
    bad = Certificate("B", "b", "If it fails, B.", 0.0, 1e-6, least=True)
    assert "alarm" not in certificate_html([good])
    assert "&lt;" not in certificate_html([bad])
    assert "> 0</td>" in certificate_html([bad])
    assert "not met" in certificate_html([bad])
    assert ">If it fails, B.</td>" in certificate_html([bad])
    assert ">If it fails, A.</td>" not in certificate_html([good])


def test_the_history_of_authority_begins_anew_for_another_robot_or_a_reset_run() -> None:
    history = AuthorityHistory()
    for tick in range(2000):
        history.add(0.02 * tick, 0, EVEN, EVEN)
    time, own, _ = history.curves()
    assert time[-1] - time[0] == pytest.approx(SPAN, abs=0.25)
    assert own.shape == (len(time), len(Authority))
    assert len(time) < 200
    history.add(40.0, 1, EVEN, EVEN)
    assert len(history.curves()[0]) == 1
    history.add(0.0, 1, EVEN, EVEN)
    assert history.curves()[0].tolist() == [0.0]


def test_bands_fill_the_height_and_are_left_out_for_who_has_no_authority() -> None:
    time, authority = floats([0.0, 15.0]), floats([[0.0, 1.0, 0.0, 0.0], [0.0, 0.5, 0.5, 0.0]])
    svg = bands_svg("team", time, authority)
    assert svg.count("<polygon") == 2
    levels = [float(y) for y in re.findall(r",([\d.]+)", " ".join(re.findall('points="(.*?)"', svg)))]
    assert min(levels) == 4.0
    assert max(levels) == 56.0
    assert "<polygon" not in bands_svg("team", time[:0], authority[:0])
    assert legend_html().count("swatch") == len(Authority)


def test_a_click_on_the_steered_robot_shows_and_hides_its_reasons() -> None:
    setup = team([(100.0, 100.0), (300.0, 100.0)])
    given: list[OperatorCommand] = []
    session = SimpleNamespace(setup=setup, snapshot=SimpleNamespace(setup=setup, state=setup.start), viewport=None)
    roles = cast(Roles, SimpleNamespace(push=given.append, steers={0}.__contains__))
    ui = UiStore(UiState(explained=1))
    opened: list[str] = []
    hand = ArenaInteraction(cast(Session, session), ui, roles, no_page(opened=opened))
    hand.viewport(0, Viewport(1200.0, 700.0, 600.0, 350.0, 1.0))
    hand.click(0, floats([300.0, 100.0]))
    assert not ui.state.reasons
    assert opened == []
    hand.click(0, floats([100.0, 100.0]))
    assert ui.state.reasons
    assert ui.state.explained is None
    assert opened == ["Why"]
    hand.click(0, floats([100.0, 100.0]))
    assert not ui.state.reasons
    assert opened == ["Why"]
    assert given == [Pick(1), Pick(0), Pick(0)]

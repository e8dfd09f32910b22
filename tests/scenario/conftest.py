"""A scenario small enough to tick a few times."""

import pytest

from higvf_console.scenario.scenario import Scenario, parse_scenario

TEAM = """
version: 1
name: team
arena: {size_m: [1200, 700]}
robots: {start_m: [[700, 300], [670, 350], [730, 350]], jitter_m: 2}
fires:
  - {at_m: [500, 250], radius_m: 20, robots_needed: 2}
duration_s: 20
"""


@pytest.fixture(name="team")
def _team() -> Scenario:
    return parse_scenario(TEAM, "team.yaml")

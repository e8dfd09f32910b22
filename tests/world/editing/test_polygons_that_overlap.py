"""A scenario may have polygons that overlap: its world can be edited all the same."""

import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.commands import OperatorCommand
from higvf_console.core.edits import AddEntity, AddOutlines, ChangeEntity, MoveEntity
from higvf_console.runtime.run import Run
from higvf_console.scenario.scenario import parse_scenario
from tests.world.editing.actions import give, refused

SCENE = """
version: 1
arena: {size_m: [1200, 700]}
robots: {start_m: [[700, 300]]}
obstacles:
  circles: [{at_m: [900, 500], radius_m: 20}]
  polygons: [{points_m: [[0, 0], [100, 0], [100, 100]]}, {points_m: [[50, 20], [200, 20], [200, 90]]}]
"""


@pytest.mark.parametrize(
    "edit",
    [
        AddEntity("circle", floats([400.0, 400.0])),
        MoveEntity("circle", 0, floats([950.0, 500.0])),
        MoveEntity("polygon", 0, floats([300.0, 400.0])),
        ChangeEntity("polygon", 1, "angle", 20.0),
        AddOutlines((floats([[500, 500], [560, 500], [530, 560]]),)),
    ],
)
def test_polygons_that_overlap_already_hinder_no_edit(edit: OperatorCommand) -> None:
    scenario = parse_scenario(SCENE, "scene.yaml")
    assert not refused(give(Run(scenario.setup(), scenario.filter, scenario), edit))

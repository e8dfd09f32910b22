"""What the panel of tunables shows and understands; pure, without a browser."""

import math

import pytest

from higvf_console.control.parameters import Parameters
from higvf_console.ui.panels.tune import (
    UNLIMITED,
    about,
    changed_html,
    differences,
    hint_of,
    label_of,
    limits_of,
    marked,
    note_html,
    shown,
)
from higvf_console.ui.widgets.number import number_typed
from higvf_console.world.editing.parameters import FIXED, parameter_names, quantity_of

PARAMETERS = Parameters()
FASTER = PARAMETERS._replace(blending=PARAMETERS.blending._replace(cruise_speed=75.0))


@pytest.mark.parametrize("name", parameter_names())
def test_every_tunable_tells_its_unit_range_symbol_and_meaning(name: str) -> None:
    quantity, hint = quantity_of(name), hint_of(name, 1.0)
    assert label_of(name).removesuffix(")").endswith(quantity.unit)
    for part in (quantity.text, quantity.symbol, f"{quantity.low:g}", shown(quantity.high), quantity.unit):
        assert part in hint
    assert ("fixed during a run" in hint) == (name in FIXED)
    assert about(PARAMETERS, name.split(".", maxsplit=1)[0])


def test_no_limit_is_a_word_where_there_may_be_none() -> None:
    assert number_typed(shown(math.inf), limits_of("perception.perception_range")) == math.inf
    with pytest.raises(ValueError, match="not a number"):
        number_typed(UNLIMITED, limits_of("blending.cruise_speed"))


def test_what_differs_from_the_scenario_is_listed_with_both_values() -> None:
    assert differences(PARAMETERS, PARAMETERS) == ()
    assert differences(FASTER, PARAMETERS) == (("blending.cruise_speed", 60.0, 75.0),)
    html = changed_html(differences(FASTER, PARAMETERS))
    for part in ("Cruise speed (m/s)", "<td>60</td><td>75</td>"):
        assert part in html
    assert "Nothing" in changed_html(())


def test_a_tunable_that_differs_bears_a_mark() -> None:
    same, other = (marked("blending.cruise_speed", differs=differs) for differs in (False, True))
    assert same in other
    assert same != other


def test_the_note_tells_what_is_fixed_and_what_was_typed_wrong() -> None:
    assert "Control period is fixed" in note_html("safety", "")
    assert note_html("path", "") == ""
    assert "&lt;img" in note_html("path", "'<img>' is neither")

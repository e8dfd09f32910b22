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
    note_html,
    number_of,
    shown,
    step_of,
)
from higvf_console.ui.panels.widgets.typed import TYPED_S, Typed
from higvf_console.world.editing.parameters import FIXED, parameter_names, quantity_of

PARAMETERS = Parameters()
FASTER = PARAMETERS._replace(blending=PARAMETERS.blending._replace(cruise_speed=75.0))


@pytest.mark.parametrize("name", parameter_names())
def test_every_tunable_tells_its_unit_range_symbol_and_meaning(name: str) -> None:
    quantity, hint = quantity_of(name), hint_of(name, 1.0)
    assert label_of(name, differs=False).endswith(quantity.unit)
    for part in (quantity.text, quantity.symbol, f"{quantity.low:g}", shown(quantity.high), quantity.unit):
        assert part in hint
    assert ("fixed during a run" in hint) == (name in FIXED)
    assert about(PARAMETERS, name.split(".", maxsplit=1)[0])
    assert math.isinf(quantity.high) or step_of(quantity, 0.0) > 0.0


def test_no_limit_is_a_word_and_other_words_are_none() -> None:
    assert number_of(f" {UNLIMITED.upper()} ") == math.inf
    assert number_of(shown(math.inf)) == math.inf
    assert number_of("150.5") == number_of(150.5) == 150.5
    for typed in ("far", "", "12 m"):
        with pytest.raises(ValueError, match=f"neither a number nor '{UNLIMITED}'"):
            number_of(typed)
    for sent in (None, [1.0], math.nan, True):
        with pytest.raises(ValueError, match="is not a number"):
            number_of(sent)


def test_what_differs_from_the_scenario_is_listed_with_both_values() -> None:
    assert differences(PARAMETERS, PARAMETERS) == ()
    assert differences(FASTER, PARAMETERS) == (("blending.cruise_speed", 60.0, 75.0),)
    html = changed_html(differences(FASTER, PARAMETERS))
    for part in ("Cruise speed m/s", "<td>60</td><td>75</td>"):
        assert part in html
    assert "Nothing" in changed_html(())


def test_a_tunable_that_differs_bears_a_mark() -> None:
    same, other = (label_of("blending.cruise_speed", differs=differs) for differs in (False, True))
    assert same in other
    assert same != other


def test_the_note_tells_what_is_fixed_and_what_was_typed_wrong() -> None:
    assert "Control period is fixed" in note_html("safety", "")
    assert note_html("path", "") == ""
    assert "&lt;img" in note_html("path", "'<img>' is neither")


def test_an_arrow_of_a_field_adds_a_tenth_of_its_order_of_magnitude() -> None:
    quantity = quantity_of("blending.cruise_speed")
    assert step_of(quantity, 60.0) == pytest.approx(1.0)
    assert step_of(quantity, 0.02) == pytest.approx(0.001)


def test_a_value_is_meant_once_and_only_when_typing_has_ended() -> None:
    now = [0.0]
    typed = Typed[str, float](lambda: now[0])
    for second, value in ((0.0, 2.0), (0.5, 28.0)):
        now[0] = second
        typed.note("safety.robot_clearance", value)
    now[0] = 0.4 + TYPED_S
    assert typed.meant() == {}
    assert "safety.robot_clearance" in typed
    now[0] = 0.6 + TYPED_S
    assert typed.meant() == {"safety.robot_clearance": 28.0}
    assert typed.meant() == {}
    assert "safety.robot_clearance" not in typed

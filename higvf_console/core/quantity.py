"""A tunable number's unit, range, symbol and sentence, written once beside its default.

Parameters are NamedTuples whose fields are `Annotated[float, Quantity(...)]`. The kernels take them as they are; YAML
checks, sliders and documentation read the annotations:

    class BlendingParameters(NamedTuple):
        cruise_speed: Annotated[float, Quantity("m/s", 0.1, 400.0, "C", "Desired speed of the team.")] = 60.0
"""

import math
import reprlib
from collections.abc import Mapping
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

from higvf_console.core.errors import HigvfError, ScenarioError
from higvf_console.core.scale import USUAL_SCALE, Scale

_BRIEF = reprlib.Repr()
_BRIEF.maxlevel = 2
_BRIEF.maxlist = _BRIEF.maxdict = 12
_BRIEF.maxstring = _BRIEF.maxother = _BRIEF.maxlong = 120


class Quantity(NamedTuple):
    """What a number means: unit, closed range [low, high], the paper's symbol, one sentence, whether it has a scale."""

    unit: str
    low: float
    high: float
    symbol: str
    text: str
    scales: bool = True

    def at(self, scale: Scale) -> "Quantity":
        """The same quantity with the range that it has at a scale, to 6 digits."""
        factor = scale.factor(self.unit) if self.scales else 1.0
        if factor == 1.0:
            return self
        return self._replace(low=float(f"{self.low * factor:.6g}"), high=float(f"{self.high * factor:.6g}"))


COORDINATE = Quantity("m", -1e6, 1e6, "", "A coordinate.")


def quantities(parameters: type[Any]) -> dict[str, Quantity]:
    """The `Quantity` of every annotated field of a parameter NamedTuple, by field name."""
    found: dict[str, Quantity] = {}
    for name, hint in get_type_hints(parameters, include_extras=True).items():
        for extra in get_args(hint)[1:] if get_origin(hint) is Annotated else ():
            if isinstance(extra, Quantity):
                found[name] = extra
    return found


def shown(value: object) -> str:
    """A value as an error gives it: of what is long, the beginning."""
    return _BRIEF.repr(value)


def checked(name: str, value: object, quantity: Quantity, raises: type[HigvfError] = ScenarioError) -> float:
    """`value` as a float within its range.

    Raises:
        HigvfError: of class `raises`: not a number, or outside the range; the message gives value, range and unit.
    """
    number = math.nan
    if isinstance(value, int | float) and not isinstance(value, bool):
        try:
            number = float(value)
        except OverflowError:
            number = math.inf if value > 0 else -math.inf
    if not quantity.low <= number <= quantity.high:
        wanted = f"a number from {quantity.low:g} to {quantity.high:g} {quantity.unit}".rstrip(" -")
        raise raises(f"{name}: {shown(value)} is not {wanted}")
    return number


def with_values(parameters: Any, values: Mapping[str, object], place: str, scale: Scale = USUAL_SCALE) -> Any:
    """A copy of a parameter NamedTuple with `values` that are checked against the ranges at a scale.

    Raises:
        ScenarioError: an unknown name (the message lists the known ones) or a value out of range.
    """
    known = quantities(type(parameters))  # pyright: ignore[reportUnknownArgumentType]
    for name in values:
        if name not in known:
            raise ScenarioError(f"{place}.{name}: unknown key; known keys: {', '.join(known)}")
    return parameters._replace(
        **{name: checked(f"{place}.{name}", value, known[name].at(scale)) for name, value in values.items()}
    )

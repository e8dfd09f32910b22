"""The doubtful equations of the paper, each in its corrected form or as printed.

A form is a number, 0 corrected and 1 printed, so that the kernels carry all of them in the record of parameters. What
was wrong with an equation is said where it is computed; `higvf reproduce forms` shows each failure as a number.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from higvf_console.core.arguments import one_of
from higvf_console.core.errors import ScenarioError

CORRECTED, PRINTED = 0.0, 1.0
WORDS: Mapping[str, float] = MappingProxyType({"corrected": CORRECTED, "printed": PRINTED})


class Forms(NamedTuple):
    """Which form each doubtful equation takes.

    Attributes:
        formation: [12]; printed `-| |r| - d | r/|r|` attracts at every distance.
        intention: [15]; printed, a map that diverges unless its spectral radius is below 1.
        target: [11]; printed `-theta phi grad(phi)` is 1e6 to 1e8 where a human intention is 1.
        human: [9], [13], [14]; printed "zero-in": velocities fade near an obstacle, and nothing leads round it.
        speed: [17]; printed `C v/|v|` is 0/0 at the start.
        blending: [19]; printed, discontinuous at (0, 0).
        bump: [29]-[31]; printed, in squared lengths, so that the bump is a jump.
        fire_constraint: [27]; printed, without the growth of the fire.
        h_index: [27]; printed `h_ij` for `h_ik`: the margin of one obstacle in the rows of all.
    """

    formation: float = CORRECTED
    intention: float = CORRECTED
    target: float = CORRECTED
    human: float = CORRECTED
    speed: float = CORRECTED
    blending: float = CORRECTED
    bump: float = CORRECTED
    fire_constraint: float = CORRECTED
    h_index: float = CORRECTED

    def words(self) -> dict[str, str]:
        """Each equation's form in words, for reports."""
        return {name: "printed" if form else "corrected" for name, form in self._asdict().items()}


FORMS: Mapping[str, Forms] = MappingProxyType(
    {
        "corrected": Forms(),
        "zero-in": Forms(human=PRINTED),
        "printed": Forms(*[PRINTED] * len(Forms._fields)),
    }
)


def forms_named(name: str) -> Forms:
    """A set of forms by its name.

    Raises:
        ScenarioError: no such set; the message lists them.
    """
    return FORMS[one_of("forms", name, FORMS, ScenarioError)]


def name_of(forms: Forms) -> str:
    """The name of a set of forms; "mixed" for one that has none."""
    return next((name for name, known in FORMS.items() if known == forms), "mixed")

"""All cases in the order of the paper, and their selection by name."""

from collections.abc import Sequence

from higvf_console.core.errors import HigvfError, closest
from higvf_console.lab.reproduce.case import Case
from higvf_console.lab.reproduce.cases import (
    certificates,
    circles,
    composite,
    fields,
    firefighting,
    forms,
    physical,
    table2,
    table2_joint,
)

_PARTS = (fields, composite, circles, firefighting, table2, table2_joint, physical, forms, certificates)
CASES: dict[str, Case] = {case.name: case for part in _PARTS for case in part.CASES}


def choose(names: Sequence[str]) -> tuple[Case, ...]:
    """Selects cases by name, and those shown beside them; in the order of the paper, all of them without names.

    Raises:
        HigvfError: a name is unknown; the message suggests the closest and lists all.
    """
    for name in names:
        if name not in CASES:
            raise HigvfError(f"no case '{name}'{closest(name, tuple(CASES))}; known cases: {', '.join(CASES)}")
    wanted = {shown for name in names for shown in (name, *CASES[name].beside)}
    return tuple(case for name, case in CASES.items() if not names or name in wanted)

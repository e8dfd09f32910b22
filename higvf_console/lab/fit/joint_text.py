"""The result of `higvf fit --columns all` as plain text: mechanism, Table II, chosen world, margins, spread."""

from collections.abc import Mapping, Sequence
from typing import Any

from higvf_console.lab.fit.text import aligned, loss_table, quantity_table


def joint_summary(result: Mapping[str, Any]) -> str:
    """The text of all sections.

    Args:
        result: `Study.result` of `joint_study.joint_study`.
    """
    missed = [verdict["target"] for verdict in result["targets"] if not verdict["met"]]
    first = (
        f"{result['runs']} worlds, seed {result['seed']}: {result['worlds']} meet every number of Table II."
        " This is a fit to all columns, not a prediction.\n"
        f"Chosen: misfit {result['misfit']:.2f}, margin {result['margin']:.2f}; missed: {', '.join(missed) or 'none'}"
    )
    spread = quantity_table("worlds that meet Table II", result["spread"])
    return "\n\n".join([first, mechanism(result), loss_table(result), _parameters(result), _basins(result), spread])


def mechanism(result: Mapping[str, Any]) -> str:
    """What makes fire 5 late in column 1 of the chosen world, in one or two sentences."""
    if result["hidden_s"] > 0.0:
        return (
            f"After fire 4, fire 5 is hidden from the whole team for {result['hidden_s']:.1f} s, as the paper tells;"
            f" {result['hidden_worlds']} of {result['worlds']} worlds have this."
        )
    low, high = min(result["sight_rad"]), max(result["sight_rad"])
    return (
        f"When fire 4 goes out, the robots see a part of fire 5 ({low:.2f} to {high:.2f} rad): it is late because they"
        f" slide along the bar, not because it is hidden as the paper tells; {result['hidden_worlds']} of"
        f" {result['worlds']} worlds hide it from the whole team for a second or more."
    )


def _parameters(result: Mapping[str, Any]) -> str:
    change = f"{100.0 * result['neighbours']['change']:g} %"
    rows: list[Sequence[str]] = [("parameter", "chosen", "unit", f"misfit at -{change}", f"at +{change}")]
    for free in result["space"]:
        below, above = result["neighbours"]["misfit"][free["name"]]
        rows.append((free["name"], f"{result['chosen'][free['name']]:g}", free["unit"], f"{below:.2f}", f"{above:.2f}"))
    meet = f"{result['neighbours']['meet']} of {2 * len(result['space'])} neighbours meet every number"
    return f"{aligned(rows)}\n{meet}"


def _basins(result: Mapping[str, Any]) -> str:
    """Where the worlds that meet the table lie."""
    rows: list[Sequence[str]] = [("worlds that meet Table II", *(str(one["worlds"]) for one in result["basins"]))]
    rows.append(("smallest misfit", *(f"{one['misfit']:.2f}" for one in result["basins"])))
    for free in result["space"]:
        ranges = (one["parameters"][free["name"]] for one in result["basins"])
        rows.append((free["name"], *(f"{low:g} to {high:g}" for low, high in ranges)))
    return aligned(rows)

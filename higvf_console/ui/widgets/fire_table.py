"""The fires as a table."""

from typing import TYPE_CHECKING

from higvf_console.core.numbers import percent
from higvf_console.ui.scene.fires import fire_look
from higvf_console.ui.theme import CSS
from higvf_console.ui.widgets.html import DASH, area, block, dot

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot


def fire_table_html(snapshot: "Snapshot") -> str:
    """Number, state, radius, loss and crew of each fire."""
    look = fire_look(snapshot.state, snapshot.trace, snapshot.setup)
    rows, digits = list[str](), snapshot.setup.params.scale.decimals - 2
    for fire, radius in enumerate(snapshot.state.motion.fire_radius):
        burning, fought = bool(look.burning[fire]), bool(look.fought[fire])
        if not burning:
            state = f"{dot(CSS.scorched_edge)}out"
        elif fought or look.progress[fire] > 0.0:
            state = f"{dot(CSS.progress if fought else CSS.fire_edge)}{percent(look.progress[fire])} put out"
        else:
            state = f"{dot(CSS.fire_edge)}burning"
        crew = f"{snapshot.trace.crew[fire]}/{snapshot.setup.world.fire_needs[fire]}" if burning else DASH
        rows.append(
            f'<tr class="{"" if burning else "out"}"><td>{fire + 1}</td><td>{state}</td><td>{radius:.{digits}f}</td>'
            f"<td>{area(snapshot.loss_area[fire])}</td><td>{crew}</td></tr>"
        )
    head = "<tr><th>Fire</th><th>State</th><th>Radius m</th><th>Loss m²</th><th>Crew</th></tr>"
    return block(f"<table><thead>{head}</thead><tbody>{''.join(rows)}</tbody></table>")

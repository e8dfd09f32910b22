"""The words and colours of the panels' HTML: one style sheet, and everything escaped that goes into it."""

import math
from html import escape

from higvf_console.core.events import Severity
from higvf_console.core.numbers import measured, metres
from higvf_console.ui.theme import CSS, Look, Palette


def severity_colour(severity: Severity, palette: Palette = CSS) -> str:
    """The colour of an event that matters this much."""
    return {
        Severity.INFO: palette.robot,
        Severity.GOOD: palette.fighting,
        Severity.WARNING: palette.warning,
        Severity.ALARM: palette.alarm,
    }[severity]


# The variables are those of the theme in use; scripts of the page take them, too. Sizes of text are multiples of the
# block's own, in steps of a sixth.
_STYLE = """
:root { --mantine-color-dimmed: var(--hg-dim) !important; --mantine-color-text: var(--hg-text) !important; }
html { font-size: calc(92.5% * var(--hg-size)) !important; }
.hg { padding: 0 10px 8px; font-size: calc(13px * var(--hg-size)); line-height: 1.5; color: var(--hg-text);
  font-variant-numeric: tabular-nums; }
.hg .dim { color: var(--hg-dim); }
.hg dl { display: grid; grid-template-columns: 7em 1fr; gap: 1px 8px; margin: 0; }
.hg dt { color: var(--hg-dim); }
.hg dd { margin: 0; }
.hg .dot { display: inline-block; width: 9px; height: 9px; border-radius: 50%; margin-right: 6px; }
.hg .mark { display: inline-block; width: 1.15em; }
.hg .channel { margin-right: 12px; white-space: nowrap; }
.hg table { width: 100%; border-collapse: collapse; }
.hg th { font-weight: 500; color: var(--hg-dim); text-align: right; padding: 0 0 3px 6px; }
.hg td { text-align: right; padding: 2px 0 2px 6px; border-top: 1px solid var(--mantine-color-default-border); }
.hg th:nth-child(-n+2), .hg td:nth-child(-n+2) { text-align: left; padding-left: 0; }
.hg table.numbers th:nth-child(2), .hg table.numbers td:nth-child(2) { text-align: right; padding-left: 6px; }
.hg .title { font-weight: 600; margin: 6px 0 2px; }
.hg .held { display: grid; grid-template-columns: auto 1fr; gap: 10px; margin-top: 4px; }
.hg .swatch { display: inline-block; width: 12px; height: 9px; border-radius: 2px; margin-right: 5px; }
.hg .chosen { color: var(--hg-own_target); }
.hg tr.out td { color: var(--hg-dim); }
.hg tfoot td { font-weight: 600; }
.hg .log div { display: grid; grid-template-columns: 4em 1fr; gap: 8px; padding: 4px 0 4px 8px;
  border-left: 3px solid; margin-bottom: 4px; }
.hg .inputs { display: grid; grid-template-columns: 1.15em max-content 1fr; gap: 1px 8px; }
.hg .inputs .why { grid-column: 2 / -1; font-size: .92em; line-height: 1.4; margin-bottom: 4px;
  overflow-wrap: anywhere; }
.hg dl.wide { grid-template-columns: 10.3em 1fr; }
.hg table.team :is(th, td):nth-child(n+3) { text-align: right; white-space: nowrap; }
.hg .lamps { display: flex; flex-wrap: wrap; gap: 2px 14px; }
.hg .lamp { white-space: nowrap; }
.hg table.attention td:last-child { width: 34%; }
.hg .bar { display: block; height: 7px; min-width: 1px; border-radius: 2px; background: var(--hg-robot); }
.hg .actions div { display: grid; grid-template-columns: 4em 1fr; gap: 8px; padding: 2px 0; }
.hg .actions .undone { opacity: .55; text-decoration: line-through; }
.hg .chart text { font-size: 11px; fill: var(--hg-dim); }
.hg .chart .rule { stroke: var(--mantine-color-default-border); }
.hg .key { display: grid; grid-template-columns: 22px 1fr; gap: 3px 8px; align-items: center; }
.hg .key svg { width: 20px; height: 14px; overflow: visible; }
.hg .key svg.tool { width: 18px; height: 18px; fill: none; stroke: currentColor; stroke-width: 1.8;
  stroke-linecap: round; stroke-linejoin: round; }
.hg .key.words { grid-template-columns: max-content 1fr; align-items: baseline; }
.hg .warn { color: var(--hg-warning); font-weight: 600; }
.hg .ahead { min-height: 9.5em; }
.hg .good { color: var(--hg-progress); }
.hg .alarm { color: var(--hg-alarm); font-weight: 600; }
.hg .operator { color: var(--hg-operator); font-weight: 600; }
/* A page that watches may look at everything; what it cannot change is pale. */
.hg-watches :is(.hg-tools, .mantine-Button-root, .mantine-Input-wrapper, .mantine-Slider-root, .mantine-Checkbox-body)
  { opacity: .45; }
/* viser's own settings and developer tools are none of an operator's. */
.mantine-ActionIcon-root:has(.tabler-icon-adjustments) { display: none !important; }
[role=tab] { padding-inline: 4px !important; flex: 1 1 auto; justify-content: center; }
/* viser's page lies between the strip and, in portrait and on a phone, the panel; its messages go into the strip. */
[id="root"] { position: absolute; top: var(--hg-strip-height, 0px); bottom: var(--hg-sheet-height, 0px);
  left: 0; right: 0; height: auto !important; }
.mantine-Notifications-root { display: none; }
.mantine-Paper-root[style*="position: fixed"] { left: 0; width: 100% !important; max-height: 40% !important; }
.mantine-Paper-root[style*="position: fixed"] [style*="20em"] { width: 100% !important; }
/* Labels: words keep their usual spacing and break between words only. */
.mantine-Text-root:has(> label) { letter-spacing: normal !important; overflow-wrap: normal !important; }
.mantine-Text-root > label > wbr { display: none; }
.mantine-Flex-root > div:has(> .mantine-Text-root > label) { width: 9.4em !important; }
.mantine-Input-input { letter-spacing: normal !important; }
.mantine-ScrollArea-viewport:has([role=tab]) > div { padding-right: 8px; box-sizing: border-box; } /* the scroll bar */
"""


def style_html(look: Look) -> str:
    """The style sheet in a look."""
    colours = "".join(f"--hg-{name}:{colour};" for name, colour in look.palette._asdict().items())
    return f"<style>:root{{{colours}--hg-size:{look.text:g}}}{_STYLE}</style>"


TIMES, DASH = "\u00d7", "\u2013"


def block(content: str) -> str:
    """A panel's content in the console's style; the content is HTML already."""
    return f'<div class="hg">{content}</div>'


def text(value: object) -> str:
    """Anything as text that HTML cannot take for markup."""
    return escape(str(value), quote=True)


def dot(colour: str) -> str:
    """A small disc of a colour."""
    return f'<span class="dot" style="background:{colour}"></span>'


def clock(seconds: float) -> str:
    """Session time as minutes and seconds."""
    tenths = int(seconds * 10 + 0.5)
    return f"{tenths // 600}:{tenths // 10 % 60:02d}.{tenths % 10}"


def area(square_metres: float) -> str:
    """An area [m^2]."""
    return measured(square_metres)


def nearness(clearance: float) -> str:
    """The smallest of some clearances [m], infinite where nothing was near; a violation stands out."""
    if not math.isfinite(clearance):
        return "nothing near"
    shown = metres(clearance)
    return f'<span class="alarm">{shown}</span>' if clearance < 0.0 else shown

"""What a report says of gaze: attention, workload and a coarse heat map, ready for JSON."""

import math
from typing import Any

import numpy as np

from higvf_console.core.arrays import Floats
from higvf_console.core.reports import AttentionReport

_COLUMNS = 24  # of the heat map in a report, at most


def attention_section(report: AttentionReport | None) -> dict[str, Any] | None:
    """The section `attention`; None where there was no gaze. Fires and robots are in the order of their numbers."""
    if report is None:
        return None
    extent = report.extent
    return {
        "fires_s": _rounded(report.fires),
        "robots_s": _rounded(report.robots),
        "elsewhere_s": round(report.elsewhere, 3),
        "fixation_rate_per_s": round(report.fixation_rate, 3),
        "fixation_duration_s": _known(report.fixation_duration),
        "transition_entropy": _known(report.transition_entropy),
        "heat_map": {
            "from_m": [extent.x_min, extent.y_min],
            "to_m": [extent.x_max, extent.y_max],
            "rows_from_top_s": [_rounded(row) for row in coarse(report.heat, _COLUMNS)],
        },
    }


def coarse(heat: Floats, most: int) -> Floats:
    """The same times in fewer, larger cells: at most `most` columns, the last ones perhaps only partly filled."""
    block = max(1, math.ceil(heat.shape[1] / most))
    rows, columns = (math.ceil(side / block) for side in heat.shape)
    padded = np.zeros((rows * block, columns * block))
    padded[: heat.shape[0], : heat.shape[1]] = heat
    return padded.reshape(rows, block, columns, block).sum(axis=(1, 3))


def _rounded(times: Floats) -> list[float]:
    return [round(time, 3) for time in times.tolist()]


def _known(value: float) -> float | None:
    return round(value, 3) if math.isfinite(value) else None

"""Noise map of a design over speed and interference.

It uses the code of ``bushing-noise screen`` at few points. It takes seconds, so it is computed in a
separate process.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from models.rig import Rig
from noise.app.worker_process import report_share
from noise.base.labels import LABEL_LOOKS, MAP_LABELS, PERSISTS
from noise.pages.maps import ConditionMap, areas_of, axis_of
from noise.pages.page import map_html
from noise.screening.design import Design as Screened, Use
from noise.screening.grid import shared_grid
from noise.screening.mapping import map_design
from noise.screening.point import PointResult, batch_evaluator
from noise.screening.vibration import Condition


class ChartRequest(NamedTuple):
    """Request of a map: rig, support stiffness [Nm/rad], temperature [degree Celsius], detail."""

    rig: Rig
    support_stiffness: float
    temperature: float
    detail: int = 2


_DETAIL = (2.0, 2, 0), (0.5, 3, 30), (0.25, 5, 100)
"""Step of speeds [rad/s], interferences and simulations: each takes about three times as long."""

_HEIGHT = 200.0
"""Height of the map [px]."""

_MEANING = {PERSISTS: "quiet from rest, but a vibration goes on once it has started"}
_FASTEST = 13.0
"""Maximum speed of the map if the rig has no fitted speeds [rad/s]."""


def chart_of(request: ChartRequest) -> dict[str, object]:
    """Return the noise map as HTML, and its legend.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from models.rig_file import load_material_rig
    >>> from noise.app.design_chart import ChartRequest
    >>> rig = load_material_rig("PDMS")
    >>> found = chart_of(ChartRequest(replace(rig, fits=rig.fits[:1]), 2214.0, 23.0))
    >>> found["legend"], 'data-label="none"' in found["html"]
    ('none everywhere: no creak, squawk or squeal', True)
    """
    rig = request.rig
    fastest = rig.fastest_fitted if math.isfinite(rig.fastest_fitted) else _FASTEST
    step, n_fits, simulations = _DETAIL[request.detail]
    use = Use(
        speed=tuple((step * np.arange(1, round(fastest / step) + 1)).tolist()),
        interference=_rows(rig, n_fits),
        support_stiffness=(request.support_stiffness,),
        temperature=(request.temperature,),
    )
    grid = shared_grid([Screened("design", rig)], use)
    done, total = 0, simulations

    def advance(points: int) -> None:
        nonlocal done
        done += points
        report_share(done / total)

    evaluate = batch_evaluator(workers=1, advance=advance)

    def counted(rig: Rig, points: Sequence[Condition]) -> list[PointResult]:
        nonlocal total
        total = max(total, done + len(points))
        return evaluate(rig, points)

    labels = map_design(rig, grid, counted, design="design", most=simulations).label[0, 0]
    across = axis_of(grid.speed)
    up = axis_of([round(1e3 * fit, 6) for fit in grid.interference], named_over=_HEIGHT)
    areas = areas_of(labels, across, up, _HEIGHT)
    noises = ConditionMap("Noise", across, up, areas, height=_HEIGHT)
    shown = [label for label in MAP_LABELS if label != "none" and label in labels]
    legend = [f"{LABEL_LOOKS[label].mark} {_MEANING.get(label, label)}" for label in shown]
    return {
        "legend": ", ".join(legend) or "none everywhere: no creak, squawk or squeal",
        "html": map_html(noises),
    }


def _rows(rig: Rig, n: int) -> tuple[float, ...]:
    """Return the interferences of the rows [m]: the rig's fits, and middles of the widest gaps."""
    fits = [fit.interference for fit in rig.fits]
    if len(fits) > n:
        fits = [fits[i] for i in np.linspace(0, len(fits) - 1, n).round().astype(int)]
    while 1 < len(fits) < n:
        i = int(np.diff(fits).argmax())
        fits.insert(i + 1, 0.5 * (fits[i] + fits[i + 1]))
    return tuple(fits)

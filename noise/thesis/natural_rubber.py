"""Natural rubber before, on and after its transfer film (5.1.3, 5.2.2, 5.2.3)."""

from __future__ import annotations

from noise.thesis.row import Column, Published, Row, above, below, number
from noise.thesis.runs import (
    LONG,
    SHORT,
    Case,
    acceleration,
    mean_torque,
    oscillation,
    strongest_line,
    strongest_share,
)
from sim.analysis.regime import LEAST_OSCILLATION

__all__ = ["natural_rubber"]

_NEW, _FILM, _CLEANED = "natural-rubber", "natural-rubber-film", "natural-rubber-film-removed"
_INTERFERENCE_MM = 0.127


def natural_rubber() -> list[Row]:
    """Return where it vibrates, at which frequency, and what the film changes."""
    rows = []
    for support, mode in ((LONG, 250.0), (SHORT, 310.0)):
        case = Case(10.0, _INTERFERENCE_MM, support)
        rows += [
            _row("slip_frequency", f"{material}, {case}", "Hz", number(mode),
                 strongest_line(material, case), tolerance=0.05)
            for material in (_NEW, _CLEANED)
        ]  # fmt: skip
    slow, fastest = (Case(v, _INTERFERENCE_MM, LONG) for v in (1.0, 19.75))
    stiff = Case(1.0, _INTERFERENCE_MM, SHORT)
    film = Case(7.5, _INTERFERENCE_MM, LONG)
    return [
        *rows,
        _row("oscillation", f"{_CLEANED}, {slow}", "1", below(LEAST_OSCILLATION),
             oscillation(_CLEANED, slow)),
        _row("oscillation", f"{_CLEANED}, {stiff}", "1", above(LEAST_OSCILLATION),
             oscillation(_CLEANED, stiff)),
        _row("oscillation", f"{_CLEANED}, {fastest}", "1", above(LEAST_OSCILLATION),
             oscillation(_CLEANED, fastest)),
        _row("mean_torque_ratio", f"natural rubber, with transfer film / without, {film}", "1",
             number(3.5, "3 to 4"), mean_torque(_FILM, film) / mean_torque(_NEW, film),
             tolerance=1 / 7),
        _row("acceleration", f"{_FILM}, {film}", "m/s^2", number(50.0), acceleration(_FILM, film),
             tolerance=0.2),
        _row("strongest_share", f"{_FILM}, {film}: no tone", "1", below(0.25),
             strongest_share(_FILM, film)),
    ]  # fmt: skip


def _row(
    item: str, condition: str, unit: str, published: Published, value: float | None,
    tolerance: float = 0.01,
) -> Row:  # fmt: skip
    return Row(
        item, condition, unit, published, calibrated=value, judged=Column.CALIBRATED,
        measured=True, tolerance=tolerance, digits=3,
    )  # fmt: skip

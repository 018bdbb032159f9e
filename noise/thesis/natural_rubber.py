"""Natural rubber before, on and after its transfer film (5.1.3, 5.2.2, 5.2.3)."""

from __future__ import annotations

from collections.abc import Iterator

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
    sudden_share,
)
from sim.analysis.regime import LEAST_OSCILLATION
from sim.analysis.slips import LEAST_SUDDEN

_NEW, _FILM, _CLEANED = "natural-rubber", "natural-rubber-film", "natural-rubber-film-removed"
_INTERFERENCE_MM = 0.127


def natural_rubber() -> Iterator[Row]:
    """Return where it vibrates, at which frequency, and what the film changes.

    All numbers of these materials were chosen so that the measured ones come out.
    """
    for support, mode in ((LONG, 250.0), (SHORT, 310.0)):
        case = Case(10.0, _INTERFERENCE_MM, support)
        for material in (_NEW, _CLEANED):
            line = strongest_line(material, case)
            yield _row("slip_frequency", f"{material}, {case}", "Hz", number(mode), line, 0.05)
    for material, speed, support in (
        (_NEW, 7.0, LONG), (_NEW, 10.0, LONG), (_CLEANED, 10.0, LONG), (_CLEANED, 1.0, SHORT),
    ):  # fmt: skip
        case = Case(speed, _INTERFERENCE_MM, support)
        where, published = f"{material}, {case}", above(LEAST_SUDDEN, "stick-slip")
        yield _row("sudden_share", where, "1", published, sudden_share(material, case))
    for support, speeds in ((LONG, (1.0, 5.0, 10.0, 19.75)), (SHORT, (1.0, 5.0, 10.0))):
        cases = [Case(speed, _INTERFERENCE_MM, support) for speed in speeds]
        means = [mean_torque(_CLEANED, case) for case in cases]
        where = f"{_CLEANED}, {cases[0].place()}, largest over smallest, 1 to {speeds[-1]:g} rad/s"
        published = number(1.0, "constant")
        yield _row("mean_torque_ratio", where, "1", published, max(means) / min(means), 0.1)
    for speed, support, published in (
        (1.0, LONG, below(LEAST_OSCILLATION)),
        (1.0, SHORT, above(LEAST_OSCILLATION)),
        (19.75, LONG, above(LEAST_OSCILLATION)),
    ):
        case = Case(speed, _INTERFERENCE_MM, support)
        found = oscillation(_CLEANED, case)
        yield _row("oscillation", f"{_CLEANED}, {case}", "1", published, found)
    film = Case(7.5, _INTERFERENCE_MM, LONG)
    where = f"natural rubber, with transfer film / without, {film}"
    ratio = mean_torque(_FILM, film) / mean_torque(_NEW, film)
    yield _row("mean_torque_ratio", where, "1", number(3.5, "3 to 4"), ratio, 1 / 7)
    found, where = acceleration(_FILM, film), f"{_FILM}, {film}"
    yield _row("acceleration", where, "m/s^2", number(50.0), found, 0.2)
    found = strongest_share(_FILM, film)
    yield _row("strongest_share", f"{where}: no tone", "1", below(0.25), found)


def _row(
    item: str, condition: str, unit: str, published: Published, value: float,
    tolerance: float = 0.01,
) -> Row:  # fmt: skip
    return Row(
        item, condition, unit, published, calibrated=value, judged=Column.CALIBRATED,
        measured=True, tolerance=tolerance, digits=3, in_sample=True,
    )  # fmt: skip

"""Numbers of segments that a person has changed, calibrated as their table was."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.errors import BushingNoiseError
from models.recording import REFERENCE_PRESSURE
from noise.app.labels.corrections import news
from noise.labels.row_places import track
from noise.labels.said_segments import said_rows

if TYPE_CHECKING:
    from collections.abc import Sequence

    from noise.app.labels.corrections import Correction
    from noise.batch import Job

    Row = dict[str, object]

__all__ = ["full_scale_of", "measured_rows"]


def measured_rows(job: Job, said: Sequence[Correction], before: Sequence[Row]) -> list[Row]:
    """Measure a recording's segments where some are new; none where it cannot be.

    Parameters
    ----------
    job : Job
        The recording.
    said : sequence of Correction
        All its segments, as a person says they are.
    before : sequence of dict
        Its rows until now.
    """
    new = news(said, before)
    if not new:
        return []
    drawn, changed = (
        [(one.channel, one.start, one.end, one.label) for one in some] for some in (said, new)
    )
    try:
        measured = said_rows(job.path, job.name, drawn, new=changed)
        known = any(row.get("calibrated") is True for row in before)
        if known and not all(row["calibrated"] for row in measured):
            # `label` was told a calibration that the file does not have.
            scale = full_scale_of(before)
            measured = [] if scale is None else said_rows(job.path, job.name, drawn, scale, changed)
    except (BushingNoiseError, OSError):  # the correction counts without numbers, too
        return []
    if len(measured) == len(said):
        return measured
    # Of a part of the segments nothing tells the background; it is as `label` has found it.
    over = _over_background(before)
    for row in measured:
        level, above = row["level_dba"], over.get(track(row))
        if row["snr_dba"] is None and isinstance(level, float) and above is not None:
            row["snr_dba"] = round(level - above, 2)
    return measured


def full_scale_of(rows: Sequence[Row]) -> float | tuple[float, ...] | None:
    """Return the sound pressure of a full-scale sample that rows were calibrated by [Pa].

    Parameters
    ----------
    rows : sequence of dict
        Of one recording.

    Returns
    -------
    float or tuple of float or None
        One for each track of several [Pa]; None where their levels do not tell it.

    Examples
    --------
    >>> round(full_scale_of([{"level_db": 91.0, "level_dbfs": -3.0}]), 4)
    1.0024
    >>> full_scale_of([{"level_db": None, "level_dbfs": -3.0}]) is None
    True
    """
    by_track: dict[str, float] = {}
    for row in rows:
        level, level_dbfs = row.get("level_db"), row.get("level_dbfs")
        if isinstance(level, float) and isinstance(level_dbfs, float):
            by_track[track(row)] = REFERENCE_PRESSURE * 10.0 ** ((level - level_dbfs) / 20.0)
    if set(by_track) == {"all"}:
        return by_track["all"]
    numbers = [str(number) for number in range(1, len(by_track) + 1)]
    known = by_track and set(by_track) == set(numbers)
    return tuple(by_track[number] for number in numbers) if known else None


def _over_background(rows: Sequence[Row]) -> dict[str, float]:
    """Return the level of the background of each track, as `label` has found it [dB(A)]."""
    found = {}
    for row in rows:
        level, snr = row.get("level_dba"), row.get("snr_dba")
        if isinstance(level, float) and isinstance(snr, float):
            found[track(row)] = level - snr
    return found

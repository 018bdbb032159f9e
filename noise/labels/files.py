"""Recordings labelled in one call, as a notebook makes it."""

from __future__ import annotations

from contextlib import closing, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from models.errors import ParameterError
from noise.base.lock import locked
from noise.base.tables import check_table_path
from noise.batch import find_jobs, open_journal, perform_all
from noise.labels.kept_corrections import with_corrections
from noise.labels.labelling import Labelling
from noise.labels.table import LabelTable

if TYPE_CHECKING:
    from collections.abc import Sequence

    from noise.recordings.meaning import PascalPerFullScale

__all__ = ["label"]


def label(
    paths: str | Path | Sequence[str | Path],
    *,
    classifier: str | Path | None = None,
    inference: str | Path | None = None,
    full_scale: PascalPerFullScale | None = None,
    loudness: bool = False,
    out: str | Path | None = None,
    fresh: bool = False,
    workers: int = 1,
    scheduler: str | None = None,
) -> LabelTable:
    """Label recordings; a file that cannot be read is a row that says why.

    Parameters
    ----------
    paths : path or sequence of paths
        Recordings, or folders that are searched at any depth.
    classifier, inference : path, optional
        Files that ``bushing-noise train`` made; by default those that are shipped.
    full_scale : float or tuple of float, optional
        Sound pressure of a full-scale sample [Pa], for sound files that do not say it.
    loudness : bool
        Whether the loudness N5 of segments is told as well, by the extra ``sound-quality``.
    out : path, optional
        File for the table: .csv, .xlsx, .jsonl or .parquet. As with
        ``bushing-noise label --out``, a journal beside it keeps each recording that is done:
        whichever of the two is called next with the same table goes on where the last call ended,
        however it ended. What somebody has corrected in the table stays as it is.
    fresh : bool
        Whether to do all recordings again, whatever earlier calls with the same `out` did.
    workers : int
        Processes that share the work; with more than one, a script needs
        ``if __name__ == "__main__":`` around the call.
    scheduler : str, optional
        Address of a Dask cluster that does the work instead.

    Returns
    -------
    LabelTable
        A list of one dict a segment, by `noise.labels.labelling.COLUMNS`, in the files' order.

    Raises
    ------
    ParameterError
        A path does not exist, there are no recordings, a model or the cluster cannot be used,
        or the table cannot be written, or cannot be read and may have corrections in it.

    Examples
    --------
    >>> import tempfile
    >>> from models.rig_file import load_material_rig
    >>> from noise.recordings import write_recording
    >>> from sim.run import simulate
    >>> silent = simulate(load_material_rig("PDMS"), 5.0).recording
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = write_recording(Path(folder) / "run07", silent)
    ...     [(row["file"], row["label"], row["speed_rad_s_source"]) for row in label(folder)]
    [('run07.wav', 'none', 'logged')]
    """
    if workers < 1:
        raise ParameterError(f"workers = {workers} must be 1 or more")
    check_table_path(out)
    given = [paths] if isinstance(paths, str | Path) else paths
    jobs = find_jobs([Path(path) for path in given])
    work = Labelling(_absolute(classifier), _absolute(inference), full_scale, loudness=loudness)
    work.prepare()
    # Refused before the work.
    with_corrections(None if out is None else Path(out), [], [job.name for job in jobs])
    kept = nullcontext() if out is None else open_journal(Path(out), work, fresh=fresh)
    with kept as journal:
        outcomes = {} if journal is None else journal.known(jobs)
        left = [job for job in jobs if job.index not in outcomes]
        performed = perform_all(work, left, workers=workers, scheduler=scheduler, journal=journal)
        with closing(performed):
            for job, done in performed:
                outcomes[job.index] = done
        rows: list[dict[str, object]] = [
            dict(zip(work.columns, row, strict=True))
            for index in sorted(outcomes)
            for row in outcomes[index].rows
        ]
        if out is None:
            return LabelTable(rows)
        # Nobody may correct the table between the look at its corrections and the writing.
        with locked(Path(out)):
            table = LabelTable(with_corrections(Path(out), rows))
            table.write(out)
    return table


def _absolute(path: str | Path | None) -> Path | None:
    """Return a path that other processes and machines find."""
    return None if path is None else Path(path).absolute()

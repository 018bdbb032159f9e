"""Labelling of many recordings, also in several processes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any

from models.errors import ParameterError
from noise.base.files import locked
from noise.base.labels import SENSITIVITY, SURROUNDINGS
from noise.base.model_file import model_digest
from noise.base.tables import check_table_path
from noise.batch.journal import open_journal
from noise.batch.work import find_jobs, perform_all, table_rows
from noise.classifier import Classifier, load_classifier
from noise.classifier.model import CLASSIFIER
from noise.inference.model import INFERENCE
from noise.labels.corrections import sign_corrections, with_corrections
from noise.labels.rows import label_rows
from noise.labels.segments import Segment, label_recording
from noise.labels.table import COLUMNS, LabelTable
from noise.recordings.files import names_channels, open_blocks


def label(
    paths: str | Path | Sequence[str | Path],
    *,
    classifier: str | Path | None = None,
    full_scale: float | None = None,
    sensitivity: float = 1.0,
    surroundings: str | None = None,
    out: str | Path | None = None,
    fresh: bool = False,
    workers: int = 1,
) -> LabelTable:
    """Label recordings; a file that cannot be read is a row with the reason.

    Parameters
    ----------
    paths : path or sequence of paths
        Recordings, or folders, which are searched recursively.
    classifier : path, optional
        File that ``bushing-noise train`` made; by default the shipped one.
    full_scale : float, optional
        Sound pressure of a full-scale sample [Pa], for sound files that do not say it.
    sensitivity : float
        Factor on the odds of a noise, from 0.1 to 10 [-].
    surroundings : {"any", "car", "rig"}, optional
        Place of the recording, which decides the expected background sounds; by default ``rig`` if
        an operating condition is logged, else ``any``.
    out : path, optional
        File for the table: .csv, .xlsx, .jsonl or .parquet. As with
        ``bushing-noise label --out``, a journal beside it stores each finished recording: the next
        call of either with the same table resumes. Corrections in the table are preserved.
    fresh : bool
        Whether to discard the results of earlier calls with the same `out`.
    workers : int
        Number of processes; with more than one, a script needs
        ``if __name__ == "__main__":`` around the call.

    Returns
    -------
    LabelTable
        List of one dict per segment, by `noise.labels.table.COLUMNS`, in the order of the files.

    Raises
    ------
    ParameterError
        A path does not exist, there are no recordings, a model cannot be used, or the table cannot
        be written, or cannot be read and may have corrections in it.

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
    least, most = SENSITIVITY
    if not least <= sensitivity <= most:
        raise ParameterError(f"sensitivity = {sensitivity:g} must be from {least:g} to {most:g}")
    check_table_path(out)
    given = [paths] if isinstance(paths, str | Path) else paths
    jobs = find_jobs([Path(path) for path in given])
    if surroundings not in (None, *SURROUNDINGS):
        raise ParameterError(
            f"surroundings {surroundings!r} are unknown; there are {', '.join(SURROUNDINGS)}"
        )
    work = Labelling(
        None if classifier is None else Path(classifier).absolute(),  # for other processes
        full_scale,
        sensitivity,
        surroundings,
    )
    work.prepare()
    if out is not None:
        sign_corrections(Path(out), [job.name for job in jobs])
    with open_journal(None if out is None else Path(out), work, fresh=fresh) as journal:
        with closing(perform_all(work, jobs, journal, workers=workers)) as performed:
            results = {job.index: result for job, result in performed}
        rows = table_rows(work.columns, jobs, results)
        if out is None:
            return LabelTable(rows)
        # The lock prevents corrections between reading and writing the table.
        with locked(Path(out)):
            table = LabelTable(with_corrections(Path(out), rows))
            table.write(out)
            journal.mark_written()
    return table


@dataclass(frozen=True)
class Labelling:
    """Work of a batch: labelled segments of each recording.

    Parameters
    ----------
    classifier : Path, optional
        File that ``bushing-noise train`` made; by default the shipped one.
    full_scale : float, optional
        Sound pressure of a full-scale sample [Pa], for sound files that do not say it.
    sensitivity : float
        Factor on the odds of a noise [-].
    surroundings : str, optional
        As in `noise.labels.segments.label_recording`.

    Examples
    --------
    >>> Labelling().columns[:3]
    ('file', 'channel', 'start_s')
    """

    classifier: Path | None = None
    full_scale: float | None = None
    sensitivity: float = 1.0
    surroundings: str | None = None

    doing = "labelling"
    columns = COLUMNS

    def prepare(self) -> None:
        """Load the classifier."""
        _ = self._loaded

    def identity(self) -> dict[str, object]:
        """Return what determines the rows: options and digests of the models."""
        return {
            "full_scale": self.full_scale,
            "sensitivity": self.sensitivity,
            "surroundings": self.surroundings,
            "classifier": model_digest(self.classifier, CLASSIFIER),
            "inference": model_digest(None, INFERENCE),
        }

    def false_names(self) -> Mapping[str, Any]:
        """Return the false names in these surroundings by the card of the classifier; may be empty.

        Keys are sensitivities, as in `noise.training.classifier.cross_fitting.false_name_rates`.
        """
        counted = self._loaded.card.get("false_names")
        return counted[self.surroundings or "any"] if isinstance(counted, dict) else {}

    def rows(self, path: Path, name: str) -> tuple[list[dict[str, object]], bool]:
        """Return the rows of a recording and whether it is calibrated."""
        with open_blocks(path, full_scale=self.full_scale) as recording:
            per_track = not names_channels(path)
            segments: list[Segment] = label_recording(
                recording, self._loaded, per_track=per_track, surroundings=self.surroundings
            )
            return label_rows(name, recording, segments), recording.calibrated

    @cached_property
    def _loaded(self) -> Classifier:
        return load_classifier(self.classifier).sensitive(self.sensitivity)

    def __getstate__(self) -> dict[str, object]:
        """Pickle the fields without the loaded classifier."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

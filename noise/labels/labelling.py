"""Labelling of recordings in one call, and the work on each, here or in other processes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any

from models.errors import ParameterError
from noise.base.files import locked
from noise.base.labels import SURROUNDINGS
from noise.base.model_file import model_digest
from noise.base.tables import check_table_path
from noise.batch.journal import open_journal
from noise.batch.work import BatchRows, JobResult, find_jobs, perform_all
from noise.classifier import Classifier, load_classifier
from noise.classifier.model import CLASSIFIER
from noise.inference import Inference, load_inference
from noise.inference.model import INFERENCE
from noise.labels.corrections import sign_corrections, with_corrections
from noise.labels.levels import with_loudness
from noise.labels.rows import label_rows
from noise.labels.segments import Segment, label_recording
from noise.labels.table import COLUMNS, LabelTable
from noise.recordings.files import names_channels, open_blocks
from noise.recordings.meaning import PascalPerFullScale


def label(
    paths: str | Path | Sequence[str | Path],
    *,
    classifier: str | Path | None = None,
    inference: str | Path | None = None,
    full_scale: PascalPerFullScale | None = None,
    surroundings: str | None = None,
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
    surroundings : {"any", "car", "rig"}, optional
        What else may be heard; by default ``rig`` where an operating condition is logged, else
        ``any``.
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
        A list of one dict a segment, by `noise.labels.table.COLUMNS`, in the files' order.

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
    if surroundings not in (None, *SURROUNDINGS):
        raise ParameterError(
            f"surroundings {surroundings!r} are unknown; there are {', '.join(SURROUNDINGS)}"
        )
    work = Labelling(
        _absolute(classifier),
        _absolute(inference),
        full_scale,
        surroundings=surroundings,
        loudness=loudness,
    )
    work.prepare()
    if out is not None:
        sign_corrections(Path(out), [job.name for job in jobs])
    with open_journal(None if out is None else Path(out), work, fresh=fresh) as journal:
        refused: dict[int, JobResult] = {}
        left = [job for job in jobs if journal.find(job) is None]
        performed = perform_all(work, left, journal, workers=workers, scheduler=scheduler)
        with closing(performed):
            for job, done in performed:
                if done.error is not None:
                    refused[job.index] = done
        rows = list(BatchRows(work.columns, journal, jobs, refused))
        if out is None:
            return LabelTable(rows)
        # Nobody may correct the table between the look at its corrections and the writing.
        with locked(Path(out)):
            table = LabelTable(with_corrections(Path(out), rows))
            table.write(out)
            journal.mark_written()
    return table


def _absolute(path: str | Path | None) -> Path | None:
    """Return a path that other processes and machines find."""
    return None if path is None else Path(path).absolute()


@dataclass(frozen=True)
class Labelling:
    """A `noise.batch.Work`: the labelled segments of a recording.

    Parameters
    ----------
    classifier, inference : Path, optional
        Files that ``bushing-noise train`` made; by default those that are shipped.
    full_scale : float or tuple of float, optional
        Sound pressure of a full-scale sample [Pa], for sound files that do not say it.
    sensitivity : float
        Odds at which a noise is named, over the classifier's own [ratio].
    surroundings : str, optional
        What else may be heard, as `noise.labels.segments.label_recording` takes it.
    loudness : bool
        Whether the loudness N5 of each segment is told as well.

    Examples
    --------
    >>> Labelling().columns[:3]
    ('file', 'channel', 'start_s')
    """

    classifier: Path | None = None
    inference: Path | None = None
    full_scale: PascalPerFullScale | None = None
    sensitivity: float = 1.0
    surroundings: str | None = None
    loudness: bool = False

    doing = "labelling"

    @property
    def columns(self) -> tuple[str, ...]:
        """Of the label table."""
        return COLUMNS

    def prepare(self) -> None:
        """Load the classifier and, where the user names one, what infers conditions."""
        if self.loudness:
            from features.sound_quality import check_available

            check_available()
        _ = self._loaded, self._inference

    def identity(self) -> dict[str, object]:
        """Return what decides the rows: the options, and the models by their content."""
        return {
            "full_scale": self.full_scale,
            "sensitivity": self.sensitivity,
            "surroundings": self.surroundings,
            "loudness": self.loudness,
            "classifier": model_digest(self.classifier, CLASSIFIER),
            "inference": model_digest(self.inference, INFERENCE),
        }

    def false_names(self) -> Mapping[str, Any]:
        """Return the card's count of false names in these surroundings; empty where it has none.

        By sensitivity, as `noise.training.classifier.operating_point.false_name_rates` gives it.
        """
        counted = self._loaded.card.get("false_names")
        return counted[self.surroundings or "any"] if isinstance(counted, dict) else {}

    def rows(self, path: Path, name: str) -> tuple[list[dict[str, object]], bool]:
        """Return the rows of a recording, and whether it is calibrated."""
        with open_blocks(path, full_scale=self.full_scale) as recording:
            per_track = not names_channels(path)
            segments: list[Segment] = label_recording(
                recording, self._loaded, per_track=per_track, surroundings=self.surroundings
            )
            if self.loudness:
                segments = with_loudness(recording, segments)
            rows = label_rows(name, recording, segments, self._inference)
            return rows, recording.calibrated

    @cached_property
    def _loaded(self) -> Classifier:
        return load_classifier(self.classifier).sensitive(self.sensitivity)

    @cached_property
    def _inference(self) -> Inference | None:
        # The shipped one is loaded by the first noise whose condition is not logged.
        if self.inference is None:
            return None

        return load_inference(self.inference)

    def __getstate__(self) -> dict[str, object]:
        """Leave the loaded models here: elsewhere they are loaded again."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

"""Option ``--plot`` of the commands that go through recordings: a picture of each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from models.errors import BushingNoiseError, ParameterError
from noise.base.files import check_target, export_paths
from noise.base.progress import note, track
from noise.commands.options import Option

if TYPE_CHECKING:
    from noise.batch import Job
    from noise.recordings.meaning import PascalPerFullScale


_LONGEST = 600.0
"""Of a picture [s]; a longer recording is drawn as far as that."""


PLOT = Option("--plot FOLDER|PICTURE", Path).help(
    "draw each recording: spectrogram, A-weighted level over time (F), speed of the "
    "shaft and, where that was recorded and changes slowly, order map; .png files in a folder, "
    "or the one picture (.png, .svg or .pdf) where there is one recording; of the first "
    f"{_LONGEST / 60.0:g} minutes of each"
)


def check_plots(target: Path, jobs: Sequence[Job]) -> None:
    """Refuse pictures that cannot be written, before the work.

    Raises
    ------
    ParameterError
        There are several recordings for one picture, or two of one name, or the place cannot be
        written to.
    """
    from noise.pictures.figure import PICTURE_ENDINGS

    paths = export_paths(target, [job.name for job in jobs], PICTURE_ENDINGS, "--plot")
    if target.is_file() and target.suffix.lower() not in PICTURE_ENDINGS:
        raise ParameterError(f"--plot {target}: is a file; name a folder or a picture")
    for path in paths.values():
        check_target(path, "--plot")
        break


def draw_recordings(
    target: Path,
    jobs: Sequence[Job],
    rows: Sequence[Mapping[str, object]] = (),
    *,
    full_scale: PascalPerFullScale | None = None,
) -> list[Path]:
    """Draw recordings, with their labels where there are any; return the pictures.

    Parameters
    ----------
    target : Path
    jobs : sequence of Job
    rows : sequence of mapping
        Of the label table.
    full_scale : float or tuple of float, optional
        As for `noise.recordings.read_recording`.
    """
    from noise.pictures.figure import PICTURE_ENDINGS, write_picture
    from noise.pictures.recording import plot_recording
    from noise.recordings.files import open_blocks

    paths = export_paths(target, [job.name for job in jobs], PICTURE_ENDINGS, "--plot")
    refused = {row.get("file") for row in rows if row.get("error")}
    written = []
    for job in track(jobs, "drawing"):
        if job.name in refused:
            continue
        try:
            with open_blocks(job.path, full_scale=full_scale) as blocks:
                shown = blocks.part(0, round(_LONGEST * blocks.rate))
                of_it = [row for row in rows if row.get("file") == job.name]
                write_picture(paths[job.name], plot_recording(shown, of_it))
        except BushingNoiseError as error:
            note(f"{job.name} is not drawn: {error}")
            continue
        written.append(paths[job.name])
    return written

"""Files that ``render`` is to write: what is heard in each, and what was measured of it.

What was measured of recordings is kept until their set is written. What is simulated is not: to
write it, it has to be simulated again.
"""

from __future__ import annotations

import json
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple

from noise.batch.identity import call_identity, file_identity
from noise.commands.render_sources import RecordedSource

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from noise.audio.filters import SoundFilter
    from noise.audio.long_sound import AudibleSound
    from noise.audio.rendering import Survey
    from noise.batch.lines import Results
    from noise.commands.render_sources import Source

__all__ = ["Plan", "measuring_identity"]


class Plan(NamedTuple):
    """One file to be: what it is called, and the runs that are heard in it, through a filter."""

    name: str
    target: Path
    runs: tuple[tuple[Source, int], ...]
    through: SoundFilter

    @contextmanager
    def takes(self) -> Iterator[list[AudibleSound]]:
        """Open the recordings; they are read when they are listened to."""
        with ExitStack() as stack:
            whole = [source.heard(number, stack) for source, number in self.runs]
            if self.through:
                from noise.audio.filters import filtered

                whole = [filtered(one, self.through) for one in whole]
            yield whole

    def surveyed(self, kept: Results | None, **how: Any) -> tuple[Survey, list[Sequence[str]]]:
        """Measure it as `noise.audio.rendering.survey` does; return the notes of its takes, too."""
        from noise.audio.rendering import survey
        from noise.audio.survey_lines import survey_line, survey_of_line

        key = None if kept is None else self._key()
        if kept is not None and key in kept.found:
            line, notes = kept.found[key]
            return survey_of_line(line), notes
        with self.takes() as takes:
            of = survey(takes, **how)
            notes = [take.about.notes for take in takes]
        if kept is not None and key is not None:
            kept.add(key, survey_line(of), notes)
        return of, notes

    def _key(self) -> str | None:
        """Name of what is heard, with which files it is; None of what is simulated."""
        said: list[object] = [self.name]
        for source, _ in self.runs:
            if not isinstance(source, RecordedSource):
                return None
            path = source.path
            said += [str(path.absolute()), file_identity(path), str(source.full_scale)]
        return json.dumps(said)


def measuring_identity(options: Namespace) -> str:
    """Digest of all options that decide what is measured, but for the calibration."""
    return call_identity(
        "rendering",
        [options.rate, options.gap, options.fade, options.repeats],
        [options.sound_quality, options.match_loudness, options.band, options.notch],
    )

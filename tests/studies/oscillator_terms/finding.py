"""What the diagnosis of an oscillator says, and how it is put into words."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from tests.studies.oscillator_terms.oscillator import Oscillator

__all__ = ["Gap", "OscillatorDiagnosis", "TermFinding"]


@dataclass(frozen=True)
class Gap:
    """An estimate with its 90 % interval.

    Parameters
    ----------
    value, low, high : float
        Of an rms error in the response's unit, or of a share.
    """

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class TermFinding:
    """What one term of the library does for the model.

    Parameters
    ----------
    name, meaning : str
        Of the term.
    oscillator : Oscillator
        Parameters refitted with the term.
    coefficients : tuple of float
        Of the term, in the library's shares.
    gap_after : mapping of str to Gap
        Rms error with the term, in each set of held-out data.
    closed : mapping of str to Gap or None
        ``(before - after) / (before - floor)``; ``None`` where there is nothing to close.
    closed_by_effect : mapping of str to Gap or None
        ``(recalibrated - after) / (recalibrated - floor)``.
    beats_recalibration : bool
        Whether the held-out error is reproducibly below that of the parameters alone.
    as_good_as_first : bool
        Whether the data cannot tell the term from the first of the ranking.
    """

    name: str
    meaning: str
    oscillator: Oscillator
    coefficients: tuple[float, ...]
    gap_after: Mapping[str, Gap]
    closed: Mapping[str, Gap | None]
    closed_by_effect: Mapping[str, Gap | None]
    beats_recalibration: bool
    as_good_as_first: bool


@dataclass(frozen=True)
class OscillatorDiagnosis:
    """The answer for one record.

    Parameters
    ----------
    verdict : str
        ``"none"``, the name of a term, or ``"unknown"``.
    remainder : float
        What the best model leaves, in floors, on the first set of held-out data.
    remainder_is_real : bool
        Whether that is above the floor beyond doubt: something is in no term of the library.
    floor : Gap
        Rms error of the linear model on quiet data that it was not fitted to.
    nominal, recalibrated : Oscillator
        Linear models of the quiet and of the training data.
    gap_before, gap_recalibrated : mapping of str to Gap
        Their rms errors in each set of held-out data.
    hidden : mapping of str to float or None
        Share of the closable gap that recalibration alone closes: what would have passed for
        wrong parameters.
    findings : tuple of TermFinding
        Ranked by the error on the first set of held-out data.
    seconds : float
        What it took.
    """

    verdict: str
    remainder: float
    remainder_is_real: bool
    floor: Gap
    nominal: Oscillator
    recalibrated: Oscillator
    gap_before: Mapping[str, Gap]
    gap_recalibrated: Mapping[str, Gap]
    hidden: Mapping[str, float | None]
    findings: tuple[TermFinding, ...]
    seconds: float = field(compare=False)

    @property
    def first(self) -> TermFinding:
        """The term with the smallest held-out error."""
        return self.findings[0]

    @property
    def equivalent(self) -> tuple[str, ...]:
        """Terms that the data cannot tell from the first, itself included."""
        return tuple(one.name for one in self.findings if one.as_good_as_first)

    def shifts(self, model: Oscillator) -> dict[str, float]:
        """How far a model's parameters lie from the nominal ones, relative."""
        return {
            name: getattr(model, name) / getattr(self.nominal, name) - 1.0
            for name in ("frequency", "damping", "gain")
        }

    def sentence(self) -> str:
        """Put the verdict into one or two sentences."""
        if self.verdict == "none":
            return "No gap: the recalibrated linear model is as good as its floor."
        if self.verdict == "unknown":
            return (
                f"The linear model misses something that no term of the library explains; the "
                f"best, {self.first.name}, leaves {self.remainder:.1f} floors."
            )
        text = f"The linear model misses {self.first.name}: {self.first.meaning}."
        if len(self.equivalent) > 1:
            text += f" These data cannot tell it from {', '.join(self.equivalent[1:])}."
        if self.remainder_is_real:
            text += f" What remains, {self.remainder:.1f} floors, is in no term of the library."
        return text

    def table(self, unit: str = "", factor: float = 1.0) -> str:
        """All gaps as lines of text.

        Parameters
        ----------
        unit : str
            Of the errors as printed.
        factor : float
            From the response's unit to that one.

        Returns
        -------
        str
            One line a model, one pair of columns a set of held-out data.
        """
        sets = tuple(self.gap_before)
        lines = [self.sentence()]
        head = "".join(f"{name + ' ' + unit:>16}{'closed':>8}{'by term':>9}" for name in sets)
        lines.append(f"{'model':<22}{head}")

        def row(label: str, gaps: Mapping[str, Gap], finding: TermFinding | None = None) -> str:
            text = f"{label:<22}"
            for name in sets:
                text += f"{gaps[name].value * factor:16.4g}"
                shares = (finding.closed[name], finding.closed_by_effect[name]) if finding else ()
                for share, width in zip(shares or (None, None), (8, 9), strict=True):
                    text += f"{'-' if share is None else f'{100 * share.value:.1f} %':>{width}}"
            return text

        lines.append(row("nominal", self.gap_before))
        lines.append(row("recalibrated", self.gap_recalibrated))
        lines.extend(row(one.name, one.gap_after, one) for one in self.findings)
        lines.append(f"{'floor':<22}{self.floor.value * factor:16.4g}")
        for label, model in (
            ("recalibration", self.recalibrated),
            (self.first.name, self.first.oscillator),
        ):
            moved = ", ".join(f"{name} {100 * v:+.1f} %" for name, v in self.shifts(model).items())
            lines.append(f"{label} moves {moved}")
        for name, share in self.hidden.items():
            if share is not None:
                lines.append(f"recalibration alone would hide {100 * share:.0f} % on {name}")
        return "\n".join(lines)

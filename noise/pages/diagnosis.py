"""Report of a diagnosis, with ``diagnosis.json`` and ``improved.toml``.

The page begins with the verdict and its probability, the location, the closed share of the gap and
the next measurement; comparisons to see and hear follow, and tables of all figures. All gaps of the
waterfall come from one fit and the same held-out recordings, so that its steps add up.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path

from noise.base.files import atomic
from noise.diagnosis.fit.closing import CLOSABLE, closed_fraction
from noise.diagnosis.improved_file import NAME, improved_sentence
from noise.diagnosis.outcome import (
    SURE,
    Agreement,
    Diagnosis,
    EffectFinding,
    as_json,
)
from noise.diagnosis.sentences import (
    LIKELY,
    agreement_sentence,
    answer,
    closed_words,
    finding_of,
    fit_sentence,
    headline,
    is_named,
    parameters_off,
    stage_of_effect,
    strength_words,
)
from noise.diagnosis.signature import KINDS
from noise.diagnosis.words import (
    NOT_DETERMINED,
    STAGES,
    cause_of,
    gap_number,
    joined,
    number,
    p_number,
    parameter_name,
    percent,
)
from noise.pages import blocks as b
from noise.pages.clips import Clip, Entry
from noise.pages.page import page_html, write_page


def write_diagnosis(folder: Path, diagnosis: Diagnosis, improved: str | None = None) -> None:
    """Write ``report.html``, ``diagnosis.json`` and ``improved.toml``, all whole or none at all.

    Parameters
    ----------
    folder : Path
        Created if missing; older files of these names are replaced or removed.
    diagnosis : Diagnosis
    improved : str, optional
        Text of the improved rig file; without it an older file is removed.

    Raises
    ------
    ParameterError
        A file cannot be written, or a signal cannot be analysed.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> nothing = Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0)
    >>> with tempfile.TemporaryDirectory() as name:
    ...     write_diagnosis(Path(name), nothing)
    ...     sorted(path.name for path in Path(name).iterdir())
    ['diagnosis.json', 'report.html']
    """
    content = as_json(diagnosis, NAME if improved is not None else None)
    data = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)
    html = _html(diagnosis, improved is not None)
    with atomic(folder / "diagnosis.json") as json_part, ExitStack() as files:
        # Names of files may hold what no UTF-8 can.
        json_part.write_bytes(f"{data}\n".encode("utf-8", "backslashreplace"))
        if improved is not None:
            rig_part = files.enter_context(atomic(folder / NAME))
            rig_part.write_bytes(improved.encode("utf-8", "backslashreplace"))
        write_page(folder / "report.html", html)
        if improved is None:
            (folder / NAME).unlink(missing_ok=True)


def _html(diagnosis: Diagnosis, has_improved: bool) -> str:
    entries: dict[str, Entry] = {}
    clips: dict[str, Clip] = {}
    shown: Sequence[b.Block] = ()
    if diagnosis.illustrations:
        # Figures and sounds load much that a quick answer, which has none, need not wait for.
        from noise.pages.diagnosis_evidence import draw_comparisons

        entries, clips, shown = draw_comparisons(diagnosis)
    bench, judged = diagnosis.bench, bool(diagnosis.verdict)
    agreement = "" if bench else agreement_sentence(diagnosis)
    answers = [sentence for sentence in answer(diagnosis) if sentence != agreement]
    chain = b.Section(
        "Where it lies" if judged else "Each stage of the chain",
        [] if bench else [b.Other("chain", stages_chain(diagnosis)), b.Text(_GAP, "soft small")],
    )
    far = b.Section("How much the fit explains" if judged else "", waterfall(diagnosis))
    causes = b.Section("Which cause" if judged else "What else it could be", _likely(diagnosis))
    following = diagnosis.next_measurement or "No further measurement was proposed."
    notes: b.Block = b.Items(diagnosis.notes, "notes")
    if not diagnosis.notes:
        notes = b.Text("Nothing was noted about channels or conditions.", "notes")
    ahead = b.Section(
        "What to do next" if bench else "What to measure next", [b.Text(following, "next")]
    )
    return page_html(
        "diagnosis",
        headline(diagnosis),
        [
            b.Text(agreement, "where"),
            *(b.Text(sentence, "verdict") for sentence in answers[:1]),
            *(b.Text(sentence, "where") for sentence in answers[1:]),
        ],
        [
            chain,
            b.Group("", [] if bench else [far, causes], style="two"),
            b.Section("The improved rig", _improved(diagnosis) if has_improved else []),
            b.Group("", [ahead, b.Section("What to bear in mind", [notes])], style="two"),
            b.Section(
                "Measured against simulated",
                [b.Text(_fitted_words(diagnosis)), *shown] if shown else [],
            ),
            b.Section("Details", _details(diagnosis), "details"),
        ],
        footer="Spectra: levels in bands of a sixth of an octave, of the whole recording. Torques: "
        "each around a slip of its own, nearest to the middle of the recording.",
        tab=f"Diagnosis: {headline(diagnosis)}",
        entries=entries,
        clips=clips,
    )


_GAP = (
    "The gap is how far recordings and simulation differ: 1 is what repeats of one run differ by. "
    "Shares are of what the gaps of all stages have beyond 1, squared. The gap of a stage is that "
    "of the figure that differs most in it, relative to what is usual without a cause; p is that "
    "of its most surprising figure, which may be another. The table of recordings in the details "
    "compares whole channels, so its gaps are other ones."
)


def _improved(diagnosis: Diagnosis) -> list[b.Block]:
    words = improved_sentence(diagnosis.improvement) if diagnosis.improvement else ""
    return [
        b.Text(f"{NAME} beside this page is a rig file. {words}"),
        b.Text(
            f"bushing-noise diagnose with --rig {NAME} says what it leaves, bushing-noise screen "
            f"{NAME} what other designs would do."
        ),
        b.Text(
            "Do not trust it at speeds, interferences or supports beyond those recorded. An effect "
            "that closes the gap need not be its cause. It is the simplest fit that closes it, in "
            "forms that a rig file can state, compared with repeats of its own; so its gap is not "
            "that above. Pictures and sounds below are of it. How well each number is known stands "
            "in the file.",
            "soft small",
        ),
    ]


def stages_chain(diagnosis: Diagnosis) -> list[dict[str, object]]:
    """Return the texts of the stages from drive to measurement.

    Examples
    --------
    >>> from noise.diagnosis.outcome import StageFinding
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> found = {"drive": StageFinding(1.04, 0.02, 0.4)}
    >>> chain = stages_chain(Diagnosis((), (), None, found, (), {}, {}, "", (), 1.0, 1.0, 0.6, 1.0))
    >>> [(stage["name"], stage["gap"]) for stage in chain][:2]
    [('drive', 'gap 1.04, 2 % of all'), ('friction', 'not determined')]
    """
    chain, place = [], diagnosis.location
    named = diagnosis.verdict if is_named(diagnosis) else ()
    for name, what in STAGES.items():
        finding = diagnosis.stages.get(name)
        gap, p_value = NOT_DETERMINED, math.nan
        if finding is not None and finding.gap != 0.0:  # 0 if nothing of it was recorded
            p_value = finding.p_value
            if math.isfinite(finding.gap):
                gap = f"gap {gap_number(finding.gap, '.2f')}, {percent(finding.share)} of all"
        unsure = ", not certain" if SURE < p_value < 0.2 else ""
        known = f"{p_number(p_value)}{unsure}"
        causes = [cause_of(c).name for c in named if stage_of_effect(diagnosis, c) == name]
        guilty = place is not None and place.stage == name and place.p_value <= SURE
        chain.append(
            {"name": name, "what": what, "gap": gap, "guilty": guilty, "causes": causes,
             "p_value": known if math.isfinite(p_value) else ""}
        )  # fmt: skip
    return chain


_LIKELY_ENOUGH = 0.05
_FEWEST = 3
_BESIDE_EFFECTS = ("none", "parameters", "unknown")


def likely_causes(diagnosis: Diagnosis) -> tuple[dict[str, float], int]:
    """Return the probabilities of the likely causes, the verdict first, and the number of others.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> chances = {"none": 0.9, "parameters": 0.06, "mains_hum": 0.02, "clipping": 0.01}
    >>> likely_causes(Diagnosis((), (), None, {}, (), chances, {}, "", (), 1.0, 1.0, 0.6, 1.0))
    ({'none': 0.9, 'parameters': 0.06, 'mains_hum': 0.02}, 1)
    """
    fitted = {one.name: one.probability for one in diagnosis.effects}
    chances = fitted | dict(diagnosis.probabilities)
    order = sorted(chances, key=lambda name: (name not in diagnosis.verdict, -chances[name]))
    shown = {
        name: chances[name]
        for i, name in enumerate(order)
        if i < _FEWEST or name in fitted or chances[name] >= _LIKELY_ENOUGH
    }
    return shown, len(order) - len(shown)


def _is_verdict(diagnosis: Diagnosis, name: str) -> bool:
    if not diagnosis.verdict:
        return name == "none" and diagnosis.probabilities.get(name, 1.0) >= LIKELY
    return name in diagnosis.verdict and is_named(diagnosis)


def _likely(diagnosis: Diagnosis) -> list[b.Block]:
    """Return a table of the likely causes: probability, closed share, strength."""
    chances, more = likely_causes(diagnosis)
    if not chances:
        return [b.Text(NOT_DETERMINED.capitalize() + ".")]
    rows = [_cause_row(diagnosis, *one) for one in chances.items()]
    rest = f" {more} less probable cause{'s are' if more > 1 else ' is'} in diagnosis.json."
    return [
        b.Table(
            ("Cause", "Probability", "Explained", "Strength as fitted, 90 %"), rows, style="causes"
        ),
        b.Text(
            "An effect's probability is that it is at work, alone or with others. Explained is the "
            "share of the gap beyond 1, with its 90 % interval. A strength is that of the form "
            "that was fitted: another form may explain the same with another number."
            + (rest if more else ""),
            "soft small",
        ),
    ]


def _cause_row(diagnosis: Diagnosis, name: str, chance: float) -> list[b.Cell | str]:
    cause, finding = cause_of(name), finding_of(diagnosis, name)
    named = "cause" if _is_verdict(diagnosis, name) else ""
    arrow = "\N{BLACK RIGHT-POINTING TRIANGLE} " if named else ""
    closed, gaps, strength = "not fitted", "", ""
    if name in _BESIDE_EFFECTS:
        closed = ""
    elif finding is not None and finding.gap_before is not None:
        closed, strength = closed_words(finding), strength_words(finding)
        own = finding.closed_by_effect
        gaps = (
            f"gap {number(finding.gap_before)}, with parameters refitted "
            f"{number(finding.gap_recalibrated)}, with the effect {number(finding.gap_after)}; it "
            f"explains {'an unknown share' if own is None else percent(min(own, 1.0))} of what "
            "refitting leaves"
        )
    return [
        b.Cell(arrow + cause.name, cause.clause),
        b.Cell(percent(chance), bars=[b.Bar(0.0, 100.0 * chance, named)]),
        b.Cell(closed, gaps),
        strength,
    ]


_MOST_PLACES = 12


def parameter_rows(intervals: Mapping[str, tuple[float, float]]) -> list[list[str]]:
    """Return rows of the refitted parameters: name, interval, and whether it differs.

    Examples
    --------
    >>> parameter_rows({"kinetic_torque": (1.02, 1.1)})
    [['kinetic torque', '1.020 to 1.100', 'differs']]
    """
    differing, rows = parameters_off(intervals), []
    for name, (low, high) in intervals.items():
        agrees = "agrees with the rig file" if low <= 1.0 <= high else "no clear difference"
        words = "differs" if name in differing else agrees
        rows.append([parameter_name(name), f"{low:.3f} to {high:.3f}", words])
    return rows


_PARAMETERS = "Parameters as fitted, relative to the rig file, 90 % intervals"

_OF_ALL = (
    "Each interval is of its parameter alone, so one of several may miss 1 by chance. A parameter "
    "differs if its interval misses 1 when widened so that all of them together hold at 90 %; if "
    "only the interval shown misses 1, that is no clear difference."
)


def _details(diagnosis: Diagnosis) -> list[b.Block]:
    located = [diagnosis.location] if diagnosis.location is not None else []
    surest = [one for one in diagnosis.differences if one not in located]
    places = [
        [
            place.stage, ", ".join(place.channels),
            place.phase if place.phase != "all" else f"{place.band[0]:g} to {place.band[1]:g} Hz",
            place.conditions.replace("speed_rad_s", "speed [rad/s]"),
            p_number(place.p_value) + ", not certain" * (place.p_value > SURE),
        ]
        for place in sorted([*surest[:_MOST_PLACES], *located], key=lambda one: one.p_value)
    ]  # fmt: skip
    held_out = ", ".join(diagnosis.held_out) or "none, since nothing was fitted"
    facts = [
        ("Gap before any fit", f"{number(diagnosis.gap)} (repeats: {number(diagnosis.floor)}; "
         f"{p_number(diagnosis.p_value)})"),
        ("Held out", held_out),
        ("Time taken", f"{number(diagnosis.seconds, '.1f')} s"),
    ]  # fmt: skip
    tables: dict[str, tuple[Sequence[str], Sequence[Sequence[b.Cell | str]]]] = {
        "How far each recording is from the rig file": (
            ["Recording", "Speed [rad/s]", "Interference [mm]", "Gap, all channels",
             *(kind.capitalize() for kind in KINDS)],
            [_agreement_row(one) for one in diagnosis.agreement],
        ),
        "Where it differs most surely": (
            ("Stage", "Channel", "Band or phase", "Conditions", "p-value, corrected for all looks"),
            places,
        ),
        _PARAMETERS: (
            ("Parameter", "Interval", "Compared with 1"), parameter_rows(diagnosis.parameters),
        ),
    }  # fmt: skip
    missing = {
        "Where it differs most surely": "Nothing was compared."
        if diagnosis.bench
        else "Nowhere surely: no single channel, band or phase differs at p = 0.05 or below, all "
        "looks counted.",
        _PARAMETERS: NOT_DETERMINED.capitalize() + ".",
    }
    notes = {_PARAMETERS: _OF_ALL} if diagnosis.parameters else {}
    return [
        b.Items(facts),
        *(
            b.Group(
                title,
                [
                    b.Table(columns, rows) if rows else b.Text(missing.get(title, "")),
                    b.Text(notes.get(title, ""), "soft small"),
                ],
            )
            for title, (columns, rows) in tables.items()
        ),
    ]


def _agreement_row(one: Agreement) -> list[str]:
    """Return a row of a recording: name, speed, interference, gaps of all and of each channel."""
    channels = (gap_number(one.channels[k]) if k in one.channels else "not recorded" for k in KINDS)
    fit = f"{1e3 * one.interference:.3g}"
    return [one.recording, f"{one.speed:g}", fit, gap_number(one.gap), *channels]


def waterfall(diagnosis: Diagnosis) -> list[b.Block]:
    """Return bars from the nominal gap to the remaining one, with sentences.

    Examples
    --------
    >>> from noise.diagnosis.outcome import EffectFinding
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> hum = EffectFinding("mains_hum", "measurement", 0.9, gap_before=7.7, gap_recalibrated=4.1,
    ...                     gap_after=1.3, gap_floor=1.0, closed=0.955)
    >>> table, *_ = waterfall(Diagnosis(("mains_hum",), (), None, {}, (hum,), {}, {}, "", (), 7.7,
    ...                                 1.0, 0.0, 1.0))
    >>> [(name, cell.text) for name, cell in table.rows][1:3]
    [('parameters refitted', '4.10 (3.60 less)'), ('with mains hum', '1.30 (2.80 less)')]
    """
    verdict = diagnosis.verdict
    if not verdict:
        return []
    fitted = _shown_fit(diagnosis)
    before, floor = diagnosis.gap, diagnosis.floor
    steps: dict[str, float] = {}
    words = ""
    if fitted is not None:
        before = before if fitted.gap_before is None else fitted.gap_before
        floor = floor if fitted.gap_floor is None else fitted.gap_floor
        if fitted.gap_recalibrated is not None:
            steps["parameters refitted"] = fitted.gap_recalibrated
        if fitted.gap_after is not None and verdict != ("parameters",):
            steps[_effect_label(diagnosis, fitted)] = fitted.gap_after
            words = fit_sentence(fitted)
            if verdict == ("unknown",):
                names = joined([cause_of(name).name for name in (fitted.name, *fitted.fitted_with)])
                words = fit_sentence(fitted, f"The best fit that was tried, with {names},")
    if not (math.isfinite(before) and math.isfinite(floor)):
        return [b.Text(f"How large the gap is was {NOT_DETERMINED}.")]
    top = 1.04 * max(floor, before, *steps.values())

    def cell(low: float, high: float, look: str, words: str) -> b.Cell:
        bar = b.Bar(100.0 * low / top, 100.0 * (high - low) / top, look)
        return b.Cell(words, bars=[bar, b.Bar(100.0 * floor / top, 0.0, "mark")])

    rows, gap = [("nominal model", cell(0.0, before, "", f"{before:.2f}"))], before
    for label, after in steps.items():
        kind, way = ("cause", "less") if after <= gap else ("opened", "more")
        shown = abs(round(after, 2) - round(gap, 2))  # of the figures beside it
        change = f"{after:.2f} ({shown:.2f} {way})"
        rows.append((label, cell(min(gap, after), max(gap, after), kind, change)))
        gap = after
    if steps:
        rows.append(("what is left", cell(0.0, gap, "", f"{gap:.2f}")))
    if before - floor < CLOSABLE:
        words = words or (
            "On these recordings the gap as a whole is hardly larger than that of repeats; what "
            "differs shows in single figures."
        )
    elif steps and not words:
        share = percent(min(closed_fraction(before, gap, floor), 1.0))
        words = f"Refitted parameters explain {share} of the deviation beyond that of repeats."
    held_out = diagnosis.held_out if fitted is not None else ()
    of, unseen = "all recordings", "recordings that this fit did not use"
    if held_out:
        listed = f"{unseen}: {', '.join(held_out)}"
        of = listed if len(held_out) <= 6 else f"{len(held_out)} {unseen}"
    return [
        b.Table(
            ("Model", f"Gap; the line is that of repeats, {floor:.2f}"), rows, style="waterfall"
        ),
        b.Text(words or "How much of the gap can be closed was not determined."),
        b.Text(
            f"The gap here is that of {of}. The nominal model is the rig file as it is; then its "
            "stiffness, torques, damping and inertia are refitted; then the effect is added.",
            "soft small",
        ),
    ]


def _shown_fit(diagnosis: Diagnosis) -> EffectFinding | None:
    """Return the fit to show: the best of the verdict's effects, else of any."""
    among = [one for one in diagnosis.effects if one.name in diagnosis.verdict]
    if diagnosis.verdict in {("parameters",), ("unknown",)}:
        among = list(diagnosis.effects)
    after = [(one.gap_after, n) for n, one in enumerate(among) if one.gap_after is not None]
    if after:
        return among[min(after)[1]]
    return next((one for one in among if one.gap_recalibrated is not None), None)


def _effect_label(diagnosis: Diagnosis, fitted: EffectFinding) -> str:
    if diagnosis.verdict == ("unknown",):
        return "best fit tried"
    together = [
        one.name
        for name in diagnosis.verdict
        if (one := finding_of(diagnosis, name)) is not None and one.gap_after == fitted.gap_after
    ]
    if 1 < len(together) == len(diagnosis.verdict):
        return "with both effects" if len(together) == 2 else "with all effects"
    return f"with {joined([cause_of(name).name for name in together])}"


def _fitted_words(diagnosis: Diagnosis) -> str:
    """Return a description of the fitted model in the pictures; empty without one."""
    if all(one.after is None for one in diagnosis.illustrations):
        return ""
    if diagnosis.improvement is not None:
        return "The fitted model is the improved rig."
    if diagnosis.verdict in {("parameters",), ("unknown",)}:
        return "The fitted model has refitted parameters and no effect."
    named = joined([cause_of(name).name for name in diagnosis.verdict])
    return f"The fitted model has {named} and refitted parameters."

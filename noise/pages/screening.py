"""Report of a screen: ranking, maps of designs side by side, and sounds."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from noise.base.labels import LABEL_LOOKS, MAP_LABELS
from noise.base.progress import counted
from noise.pages import blocks as b
from noise.pages.clips import common_gain, make_clips
from noise.pages.page import page_html, write_page
from noise.pages.screen_maps import compare_designs
from noise.screening.environments import environment, in_environment
from noise.screening.standing import SHARED, Standing
from noise.screening.summary import (
    MARGIN_RULE,
    RANKING_RULE,
    conditions_words,
    detail_lines,
    margin_is_bound,
    percent,
    use_words,
)

if TYPE_CHECKING:
    from noise.screening.screen import Screening


RANKING = (
    "Rank", "Design", "Noise, of the conditions of use", "Mean loudness", "Loudest", "Margin",
    "In its use",
)  # fmt: skip


def ranking_rows(screening: Screening) -> list[list[b.Cell | str]]:
    """Return the rows of `RANKING`, quietest design first.

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> found = screen(["PDMS"], Use(speed=(1.0, 9.0), support_stiffness=(2214.0,)))
    >>> rank, design, noise, mean, loudest, *_ = ranking_rows(found)[0]
    >>> rank, design.text, noise.labels, mean, loudest
    ('1', 'PDMS', (('none', '100%'),), '0 sone', 'quiet')
    """
    return [_row(one) for one in screening.standings]


def _row(one: Standing) -> list[b.Cell | str]:
    loudest = "quiet" if one.loudest is None else f"{one.loudest_level:.0f} dB(A)"
    shares = {name: one.shares[name] for name in SHARED if one.shares.get(name)}
    ends = np.cumsum([0.0, *shares.values()])
    bars = [
        b.Bar(100.0 * begin, 100.0 * share, f"filled {name} {LABEL_LOOKS[name].pattern}")
        for begin, (name, share) in zip(ends, shares.items(), strict=False)
    ]
    return [
        str(one.rank),
        b.Cell(one.design, one.place),
        b.Cell(bars=bars, labels=tuple((name, percent(share)) for name, share in shares.items())),
        f"{one.mean_loudness:.3g} sone",
        loudest,
        _margin(one),
        b.Cell(use_words(one.mapped)[0], items=tuple(detail_lines(one))),
    ]


def _margin(one: Standing) -> str:
    margin = one.worst("margin_v_crit2")
    if math.isnan(margin):
        return ""
    if math.isinf(margin):
        return "nothing vibrates"
    text = f"{margin:+.3g} rad/s".replace("-", "\N{MINUS SIGN}")
    bound = margin_is_bound(margin, one.mapped.grid)
    return f"{text}, to slower speeds: vibration does not end within the map" if bound else text


def write_screening(
    path: Path,
    screening: Screening,
    *,
    sounds: int = 24,
    seed: int = 0,
    workers: int = 1,
) -> None:
    """Write the report of a screen atomically.

    Parameters
    ----------
    path : Path
    screening : Screening
    sounds : int
        How many are simulated at most, of all designs together; each takes up to 0.3 MB.
    seed : int
        Of all sounds alike.
    workers : int
        Threads; -1 is one a core.

    Raises
    ------
    ParameterError
        It cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> found = screen(["PDMS"], Use(speed=(1.0, 9.0), support_stiffness=(2214.0,)))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_screening(Path(folder) / "report.html", found, sounds=0)
    ...     "quiet" in (Path(folder) / "report.html").read_text(encoding="utf-8")
    True
    """
    rigs = {one.name: one.rig for one in screening.designs}
    laid = [
        in_environment(rigs[one.design], environment(one.environment)) for one in screening.maps
    ]
    compared, entries = compare_designs(
        screening, laid, number=sounds, seed=seed, workers=workers, pair=_pair(screening)
    )
    gain = common_gain(entries.values())
    clips = make_clips(entries, gain)
    html = page_html(
        "screening",
        _title(screening),
        [
            b.Text(f"{RANKING_RULE}." * (len(screening.designs) > 1), "summary"),
            b.Sounds(gain.sentences, MAP_LABELS),
        ],
        [
            b.Section("Not on this page", [b.Items(screening.refused)], "refused"),
            b.Section(
                "Ranking",
                [
                    b.Text(f"Compared: {conditions_words(screening)}. {MARGIN_RULE}.", "soft"),
                    b.Table(RANKING, ranking_rows(screening), head=1, style="ranking"),
                ],
            ),
            b.Section(
                "Which noise where",
                [b.Text(_SOUNDS if clips else "", "soft aloud"), b.Other("designs", compared)],
            ),
        ],
        footer=f"Screened in {screening.seconds:.1f} s. Labels are "
        "those of bushing-noise label, levels without room and microphone.",
        entries=entries,
        clips=clips,
        without_card=entries,
    )
    write_page(path, html)


_SOUNDS = (
    "Sounds, all simulated with one seed, are at the spots: where each noise of each design is "
    "loudest, amid the regions of each combination of noises, and far from these. A click plays "
    "the sound there, or the nearest of the same label. A and B run in step, and the keys A and B "
    "change over."
)


def _pair(screening: Screening) -> tuple[str, str]:
    """Return the first design and the best of the others."""
    first = screening.maps[0].design
    others = [one.design for one in screening.standings if one.design != first]
    return first, (others or [first])[0]


def _title(screening: Screening) -> str:
    names = list(dict.fromkeys(one.design for one in screening.maps))
    if len(names) <= 2:
        return f"Screen of {' and '.join(names)}"
    return f"Screen of {counted(len(names), 'design')}"

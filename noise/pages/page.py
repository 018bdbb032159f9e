"""Page: entries and their sounds laid into a template, in one file.

Such a page is mailed, projected in a meeting and opened again after years. So everything is inside
it, every name is escaped, and the page itself forbids the browser to fetch anything from elsewhere.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Collection, Mapping
from functools import lru_cache
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined

from noise.base.files import atomic
from noise.base.labels import LABEL_LOOKS
from noise.pages.cards import EntryDisplay, draw_entries, frequency_ticks, scale_picture
from noise.pages.clips import MOST_RAISED, Clip, Entry, equal_factors

MAP_SIZE = (500.0, 300.0)
"""Width and height of the drawing of a condition map [px]."""

PAGE_BYTES, CARD_BYTES, ORDERS_BYTES = 75_000.0, 45_000.0, 10_000.0
"""What a page takes up, and at most each of its sounds beside the sound itself and an order map
[byte]."""


def page_html(
    template: str,
    entries: Mapping[str, Entry],
    clips: Mapping[str, Clip],
    *,
    without_card: Collection[str] = (),
    **contents: object,
) -> str:
    """Return a page.

    Parameters
    ----------
    template : str
        Of the folder ``templates``; it extends ``base.html.j2``.
    entries : mapping of str to Entry
        By id; the template finds them as ``displays``.
    clips : mapping of str to Clip
        Of those that can be heard.
    without_card : collection of str
        Ids of sounds that the template shows no card of, so that the player brings their picture.
    **contents
        What else the template names.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> html = page_html("review.html.j2", {}, {}, title="<b>", summary="", gain=(), refused=(),
    ...                  shortened=None, compared=None, recorded_maps=(), unplaced=0,
    ...                  diagnoses=(), recorded=(), counts=())
    >>> "<h1>&lt;b&gt;</h1>" in html
    True
    """
    displays, scale_words = draw_entries(entries, clips)
    factors, target = equal_factors(
        {key: clip.samples.astype(float) / clip.full_scale for key, clip in clips.items()}
    )
    return (
        _environment()
        .get_template(template)
        .render(
            displays=displays,
            scale_words=scale_words,
            sounds={key: (clip, entries[key].data) for key, clip in clips.items()},
            about={
                key: _about(displays[key], factors.get(key), on_card=key not in without_card)
                for key in clips
            },
            equal=_equal_words(len(factors), len(clips), target),
            **contents,
        )
    )


def write_page(path: Path, html: str) -> None:
    r"""Write a page, whole or not at all.

    Raises
    ------
    ParameterError
        It cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_page(Path(folder) / "report.html", "run\udcff")
    ...     (Path(folder) / "report.html").read_text()
    'run\\udcff'
    """
    with atomic(path) as temporary:
        # Names of files may hold what no UTF-8 can.
        temporary.write_bytes(html.encode("utf-8", "backslashreplace"))


def as_base64(content: bytes) -> str:
    """Encode bytes for a ``data:`` address.

    Examples
    --------
    >>> as_base64(b"RIFF")
    'UklGRg=='
    """
    return base64.b64encode(content).decode()


def _about(display: EntryDisplay, factor: float | None, *, on_card: bool) -> dict[str, object]:
    """Tell the player of a sound."""
    facts = [fact.words for fact in display.facts.values()] if on_card else [display.note]
    told: dict[str, object] = {
        "title": display.title,
        "label": " + ".join(display.labels),
        "facts": " · ".join(facts),
        "duration": display.duration,
        "equal": factor,
    }
    if not on_card:
        told["picture"] = f"data:image/png;base64,{as_base64(display.picture)}"
    return told


def _equal_words(n_equal: int, n_sounds: int, target: float) -> str:
    """Say what the button of equal loudness does; nothing where there is nothing to compare."""
    if n_equal < 2:
        return ""
    left = n_sounds - n_equal
    rest = (
        f"; {left} shorter than 0.4 s or softer by {MOST_RAISED:g} dB stay as they are"
        if left
        else ""
    )
    return f"{target:.0f} LUFS (ITU-R BS.1770){rest}".replace("-", "\N{MINUS SIGN}", 1)


@lru_cache(maxsize=1)
def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("noise.pages"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals |= {
        "label_display": LABEL_LOOKS,
        "frequencies": frequency_ticks(),
        "map_size": tuple(round(length) for length in MAP_SIZE),
        "scale": scale_picture,
    }
    environment.filters |= {
        "base64": as_base64,
        # What the page's own policy lets the browser run.
        "sha256": lambda text: as_base64(hashlib.sha256(text.encode()).digest()),
        # Numbers keep their unit at the end of a line.
        "unbroken": lambda text: text.replace(" %", "\N{NO-BREAK SPACE}%").replace(
            "p = ", "p\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}"
        ),
    }
    return environment

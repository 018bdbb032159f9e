"""HTML page: a single file of blocks with all sounds, pictures, scripts and styles.

Pages are mailed, projected and archived. So they contain everything, names are escaped, and their
content security policy forbids network access.
"""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Collection, Mapping, Sequence
from functools import lru_cache
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined

from noise.base.files import atomic
from noise.base.labels import LABEL_LOOKS
from noise.pages import blocks as b
from noise.pages.cards import draw_entries, frequency_ticks, scale_picture
from noise.pages.clips import Clip, Entry
from noise.pages.maps import MAP_SIZE, ConditionMap


def page_html(
    kind: str,
    title: str,
    header: Sequence[b.Block],
    sections: Sequence[b.Block],
    *,
    footer: str = "",
    tab: str = "",
    entries: Mapping[str, Entry] | None = None,
    clips: Mapping[str, Clip] | None = None,
    without_card: Collection[str] = (),
) -> str:
    """Return a page as HTML.

    Parameters
    ----------
    kind : str
        Kind of page, for the style sheet.
    title : str
    header, sections : sequence of Block
        Blocks below the title, and sections.
    footer : str
    tab : str
        Title of the browser tab; by default `title`.
    entries : mapping of str to Entry, optional
        By id.
    clips : mapping of str to Clip, optional
        Playable sounds.
    without_card : collection of str
        Ids of sounds without a card, whose picture is in the player.

    Examples
    --------
    >>> from noise.pages import blocks as b
    >>> html = page_html("review", "<b>", [b.Text("nothing")],
    ...                  [b.Section("Runs", [b.Items(["run07"])])])
    >>> "<h1>&lt;b&gt;</h1>" in html, "<li>run07</li>" in html
    (True, True)
    """
    entries, clips = entries or {}, clips or {}
    displays, scale_words = draw_entries(entries, clips)
    about: dict[str, dict[str, object]] = {}
    for key in clips:
        display, on_card = displays[key], key not in without_card
        facts = [*display.facts.values()] if on_card else [display.note]
        about[key] = {
            "title": display.title, "label": " + ".join(display.labels),
            "facts": " · ".join(facts), "duration": display.duration,
        }  # fmt: skip
        if not on_card:
            about[key]["picture"] = f"data:image/png;base64,{as_base64(display.picture)}"
    return (
        _environment()
        .get_template("page.html.j2")
        .render(
            kind=kind,
            title=title,
            tab=tab or title,
            header=header,
            sections=sections,
            footer=footer,
            displays=displays,
            scale_words=scale_words,
            sounds=clips,
            about=about,
        )
    )


def write_page(path: Path, html: str) -> None:
    r"""Write a page atomically.

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


def map_html(shown: ConditionMap) -> str:
    """Return a condition map as HTML, such as for the app.

    Examples
    --------
    >>> from noise.pages.maps import axis_of
    >>> axis = axis_of([0.0, 10.0])
    >>> map_html(ConditionMap("Noise", axis, axis, ())).count("<svg")
    2
    """
    blocks = _environment().get_template("blocks.html.j2").module
    return str(blocks.patterns(LABEL_LOOKS)) + str(blocks.condition_map(shown))  # type: ignore[attr-defined]


def as_base64(content: bytes) -> str:
    """Encode bytes for a ``data:`` address.

    Examples
    --------
    >>> as_base64(b"RIFF")
    'UklGRg=='
    """
    return base64.b64encode(content).decode()


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
        "map_marks": {name: look.mark for name, look in LABEL_LOOKS.items()},
        "map_size": tuple(round(length) for length in MAP_SIZE),
        "scale": scale_picture,
    }
    environment.filters |= {
        "base64": as_base64,
        "macro": lambda block: getattr(block, "macro", type(block).__name__.lower()),
        # Modules of the app, whose files stand one after the other in the page.
        "inline": lambda text: re.sub(r"^import .*;\n|^export ", "", text, flags=re.MULTILINE),
        # What the page's own policy lets the browser run.
        "sha256": lambda text: as_base64(hashlib.sha256(text.encode()).digest()),
        # Numbers keep their unit at the end of a line.
        "unbroken": lambda text: text.replace(" %", "\N{NO-BREAK SPACE}%").replace(
            "p = ", "p\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}"
        ),
    }
    return environment

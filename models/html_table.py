"""Small tables by which objects show themselves in a notebook.

Plain HTML with a caption and header cells, which screen readers name: no style of its own but the
alignment, so that a notebook's light and dark themes stay, and nothing fetched from anywhere. All
text is escaped, since names of files and materials are the user's.
"""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["MOST_ROWS", "html_table"]

MOST_ROWS = 20
"""Of a table that is shown; a last row tells how many more there are."""

_LEFT = ' style="text-align: left"'


def html_table(caption: str, rows: Sequence[Sequence[str]], *, header: Sequence[str] = ()) -> str:
    """Return a table in HTML; the first cell of each row names it.

    Parameters
    ----------
    caption : str
        What the table shows.
    rows : sequence of sequence of str
        Texts, all rows of one length.
    header : sequence of str
        Names of the columns; by default there are none.

    Returns
    -------
    str

    Examples
    --------
    >>> print(html_table("Run 7", [["speed", "5 rad/s"]]))
    <table>
    <caption style="text-align: left">Run 7</caption>
    <tbody>
    <tr><th scope="row" style="text-align: left">speed</th><td ...>5 rad/s</td></tr>
    </tbody>
    </table>
    """
    lines = ["<table>", f"<caption{_LEFT}>{escape(caption)}</caption>"]
    if header:
        names = "".join(f'<th scope="col"{_LEFT}>{escape(name)}</th>' for name in header)
        lines.append(f"<thead><tr>{names}</tr></thead>")
    lines.append("<tbody>")
    for name, *values in rows[:MOST_ROWS]:
        cells = "".join(f"<td{_LEFT}>{escape(value)}</td>" for value in values)
        lines.append(f'<tr><th scope="row"{_LEFT}>{escape(name)}</th>{cells}</tr>')
    if len(rows) > MOST_ROWS:
        width = len(rows[0])
        more = f"and {len(rows) - MOST_ROWS} more"
        lines.append(f'<tr><td colspan="{width}"{_LEFT}>{more}</td></tr>')
    return "\n".join([*lines, "</tbody>", "</table>"])

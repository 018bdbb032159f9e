"""Display of a recording: a table of its channels, and a channel over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from models.drawing import CHANNEL_LOOKS, axes_or_new, thinned
from models.errors import ParameterError
from models.html_table import html_table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from models.recording import Recording

__all__ = ["draw_channel", "recording_html"]


def recording_html(recording: Recording) -> str:
    """Return a recording as a table: its condition, and the range of each channel.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> table = recording_html(Recording(np.ones((1, 480)), 48e3, (Channel("torque"),), name="a<b"))
    >>> "a&lt;b: 0.01 s at 48 kHz; condition not known" in table
    True
    """
    rows = []
    for channel, samples in zip(recording.channels, recording.samples, strict=True):
        unit = channel.unit if recording.calibrated else "full scale"
        if samples.size:
            rms = float(np.sqrt(np.mean(np.square(samples))))
            values = [f"{value:.4g}" for value in (samples.min(), samples.max(), rms)]
        else:
            values = 3 * ["none"]
        rows.append([channel.name, unit, *values])
    header = ["channel", "unit", "lowest", "highest", "root mean square"]
    return html_table(_title(recording), rows, header=header)


def draw_channel(recording: Recording, name: str | None = None, ax: Axes | None = None) -> Axes:
    """Draw a channel over time; parameters and errors are those of `Recording.plot`.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from models.recording import Channel, Recording
    >>> turning = Recording(np.ones((1, 480)), 48e3, (Channel("angle"),), calibrated=False)
    >>> draw_channel(turning, ax=Figure().subplots()).get_ylabel()
    'Angle of the shaft [full scale]'
    """
    if not recording.samples.size:
        raise ParameterError(f"recording {recording.name!r} holds nothing that could be drawn")
    if name is None:
        name = recording.channel_names[recording.first("pressure") or 0]
    samples = recording[name]
    channel = recording.channels[recording.channel_names.index(name)]
    look = CHANNEL_LOOKS[channel.kind]
    number = name.removeprefix(channel.kind).replace("_", " ")
    unit = look.unit if recording.calibrated else "full scale"
    time = np.arange(samples.size) / recording.rate
    with axes_or_new(ax) as axes:
        axes.plot(*thinned(time, samples), color=look.colour, linewidth=0.9)
        axes.set_xlabel("Time [s]")
        axes.set_ylabel(f"{look.name}{number} [{unit}]")
        title = ", ".join(filter(None, [recording.name, *recording.condition.words]))
        axes.set_title(title, loc="left")
        axes.set_xlim(0.0, recording.duration)
    return axes


def _title(recording: Recording) -> str:
    condition = recording.condition
    words = condition.words
    if condition.temperature is not None:
        words.append(f"{condition.temperature:g} °C")
    known = ", ".join(words) or "condition not known"
    lasting = f"{recording.duration:.4g} s at {recording.rate / 1e3:.6g} kHz"
    uncalibrated = "" if recording.calibrated else "; not calibrated"
    return f"{recording.name or 'Recording'}: {lasting}; {known}{uncalibrated}"

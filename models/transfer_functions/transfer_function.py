"""A transfer function: output per unit of input of something linear, line by line over frequency.

Whether modelled, measured by hits or estimated from recordings, it is this one type; what a way of
getting it leaves open, as how it goes on below its first line, is said where it is used.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.show import short_repr

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray
    from pandas import DataFrame


@short_repr
@dataclass(frozen=True, eq=False)
class TransferFunction:
    """Transfer function as a table over frequency.

    Parameters
    ----------
    frequencies : ndarray, shape (n,)
        [Hz], rising, evenly spaced or not.
    response : ndarray, shape (n,), complex
        Output per input [`output_unit` / `input_unit`], for signals that go as exp(+i omega t): a
        delay turns the phase back.
    coherence : ndarray, shape (n,), optional
        Between 0 and 1 [-]; None where it is not known.
    input_unit, output_unit : str
        Such as ``"N m"`` and ``"Pa"``; empty where the response is a ratio [-].
    name : str
        What messages call it, usually its file.

    Examples
    --------
    >>> f = np.array([1.0, 2.0])
    >>> TransferFunction(f, 1j * f, None, "N", "m/s^2").spacing
    1.0
    """

    frequencies: NDArray[np.float64]
    response: NDArray[np.complex128]
    coherence: NDArray[np.float64] | None = None
    input_unit: str = ""
    output_unit: str = ""
    name: str = "response"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TransferFunction) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self._content)  # alike in another process, where a copy of the rig works

    @property
    def _content(self) -> tuple[str | bytes, ...]:
        coherence = b"" if self.coherence is None else self.coherence.tobytes()
        arrays = (self.frequencies.tobytes(), self.response.tobytes(), coherence)
        return *arrays, self.input_unit, self.output_unit, self.name

    @property
    def spacing(self) -> float:
        """Mean distance of the lines [Hz]."""
        return float((self.frequencies[-1] - self.frequencies[0]) / (self.frequencies.size - 1))

    @property
    def unit(self) -> str:
        """Of the response, as titles tell it; ``-`` where it is a ratio."""
        return f"{self.output_unit} per {self.input_unit}" if self.input_unit else "-"

    def at(
        self, frequencies: NDArray[np.float64], *, falls_below: bool = False
    ) -> NDArray[np.complex128]:
        """Evaluate at other frequencies: straight lines between the table's, 0 above them.

        Parameters
        ----------
        frequencies : ndarray, shape (m,)
            [Hz]
        falls_below : bool
            Whether it falls as the square of frequency below the first line, as acceleration and
            sound of a structure that is held do; otherwise it stays what it is there.

        Returns
        -------
        ndarray, shape (m,), complex
            [`output_unit` / `input_unit`]

        Examples
        --------
        >>> measured = TransferFunction(np.array([2.0, 4.0]), np.array([8.0 + 0j, 8.0 + 0j]))
        >>> measured.at(np.array([1.0, 3.0, 5.0]), falls_below=True)
        array([2.+0.j, 8.+0.j, 0.+0.j])
        """
        real = np.interp(frequencies, self.frequencies, self.response.real, right=0.0)
        imaginary = np.interp(frequencies, self.frequencies, self.response.imag, right=0.0)
        found = real + 1j * imaginary
        if falls_below:
            first = self.frequencies[0]
            found = found * np.minimum(frequencies / max(first, 1e-9), 1.0) ** 2
        return np.asarray(found)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the magnitude over frequency; lines of a coherence below a half are pale.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a new figure.

        Returns
        -------
        matplotlib.axes.Axes

        Examples
        --------
        >>> from matplotlib.figure import Figure
        >>> f = np.array([1.0, 2.0])
        >>> TransferFunction(f, 1j * f, None, "N", "m/s^2").plot(Figure().subplots()).get_ylabel()
        'Magnitude [m/s^2 per N]'
        """
        from models.transfer_functions.transfer_function_display import draw_transfer_function

        return draw_transfer_function(self, ax)

    def to_pandas(self) -> DataFrame:
        """Return one row a line as a data frame of pandas, in the columns of its CSV file.

        Returns
        -------
        pandas.DataFrame
            ``frequency_hz``, ``real``, ``imag``, and ``coherence`` where it is known.

        Raises
        ------
        ParameterError
            pandas is not installed.

        Examples
        --------
        >>> from importlib.util import find_spec
        >>> f = np.array([1.0, 2.0])
        >>> if find_spec("pandas"):
        ...     assert TransferFunction(f, 1j * f).to_pandas()["imag"].tolist() == [1.0, 2.0]
        """
        from models.show import data_frame

        columns = {
            "frequency_hz": self.frequencies,
            "real": self.response.real,
            "imag": self.response.imag,
        }
        if self.coherence is not None:
            columns["coherence"] = self.coherence
        lines = zip(*(values.tolist() for values in columns.values()), strict=True)
        return data_frame([*columns], [dict(zip(columns, line, strict=True)) for line in lines])

"""Estimated forms of effects, by the name of the effect.

What is linear, added or a curve is there to be seen in the recordings themselves, more exactly than
any search over formulas finds it. What the contact does is not, as it changes its own input.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from noise.diagnosis.fit.forms.added import hum_forms, noise_forms
from noise.diagnosis.fit.forms.filters import beam_forms, radiation_forms, sensor_forms
from noise.diagnosis.fit.forms.form import Compared, Form, compared
from noise.diagnosis.fit.forms.impacts import impact_forms
from noise.diagnosis.fit.forms.modulation import gain_forms, speed_forms
from noise.diagnosis.fit.forms.overloads import overload_forms

if TYPE_CHECKING:
    from noise.diagnosis.fit.case_comparison import CaseComparison


def estimated_forms(comparison: CaseComparison, chosen: Sequence[int], name: str) -> list[Form]:
    """Estimate forms of an effect.

    Parameters
    ----------
    comparison : CaseComparison
    chosen : sequence of int
        Recordings to estimate from.
    name : str
        Of the effect.

    Returns
    -------
    list of Form
        None of effects that cannot be estimated.
    """
    if name not in _ESTIMATED:
        return []
    rates = Counter(comparison.recordings[i].rate for i in chosen)
    usual = rates.most_common(1)[0][0]
    having = compared(comparison, [i for i in chosen if comparison.recordings[i].rate == usual])
    return _ESTIMATED[name](having)


_ESTIMATED: dict[str, Callable[[Sequence[Compared]], list[Form]]] = {
    "background_noise": noise_forms,
    "beam_modes": beam_forms,
    "channel_delay": lambda c: sensor_forms("channel_delay", c, 0.01, 0.01),
    "clipping": overload_forms,
    "gain_error": lambda c: [*gain_forms(c), *sensor_forms("gain_error", c, 0.01, 0.01)],
    "mains_hum": hum_forms,
    "mount_resonance": lambda c: sensor_forms("mount_resonance", c, 0.02),
    "plate_modes": lambda c: radiation_forms("plate_modes", c, 0.04),
    "room_reflections": lambda c: [
        *radiation_forms("room_reflections", c, 0.05),
        *radiation_forms("room_reflections", c, 0.2),
    ],
    "slip_pulse": impact_forms,
    "speed_fluctuation": speed_forms,
}

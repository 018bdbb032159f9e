r"""How temperature acts on an elastomer: the shift of its rates, its stiffness, its friction.

Williams, Landel and Ferry (1955): what an elastomer does at a temperature theta and a rate w, it
does at a reference temperature at the rate a_T w, with

.. math::
    \log_{10} a_T = L(\theta) - L(\theta_{ref}), \qquad
    L = -\frac{c_1 (\theta - \theta_s)}{c_2 + \theta - \theta_s}, \qquad
    \theta_s = \theta_g + 50\ \mathrm{K}

(2.1), whose constants the thesis misprints as 8.88 and 101.5.

*Stiffness.* A spring of entropy beside a fractional element, at the rates of the rig's vibration:

.. math::
    k / k_{ref} = b \frac{1 + s\, a_T^\alpha}{1 + s}, \qquad c / c_{ref} = b\, a_T^\alpha, \qquad
    b = T / T_{ref}

with absolute temperatures in b (Ferry, *Viscoelastic Properties of Polymers*, chapter 11). s is
what the rubber is stiffer by at these rates than when deformed slowly: static tests gave k_EFF 2 to
15 % lower (Table 5.4), hence 0.1. alpha, the slope of a rubber's transition, is that of
`sim.effects.viscoelastic_stiffness`. The loss factor that follows, s tan(alpha pi / 2) / (1 + s) =
0.046, is what the damping fitted to the fluorocarbon gives at its first torsional mode, 0.05.

*Friction.* Grosch (1963) found friction at all temperatures on one bell over log(a_T v), which
Persson (2001) derives from losses; the torques at a sliding speed v are those fitted, times

.. math::
    \frac{B(a_T |v|)}{B(|v|)}, \qquad
    B(v) = p_0 + (1 - p_0) \exp\left[-\tfrac12 (\log_{10}(v / v_p) / w)^2\right]

v_p is the speed of most friction at the reference temperature. Lorenz, Oh, Nam, Jeon and Persson
(2015, J. Chem. Phys. 142, 194701) find 0.1 for 1 / (2 w^2). So the law keeps what was fitted to it,
and only its place on the bell moves: colder than at the peak friction falls with speed and sliding
becomes unstable, warmer it rises and is stable. Times and speeds of a law are not shifted one by
one: fitted over a single decade of speeds they saturate beyond it, on the wrong side (friction
would rise with warmth).

Limits: at the reference temperature all factors are one. Below the glass temperature an elastomer
is none, and that temperature is held; WLF is good to 100 K above it, beyond which the rates change
less. Nothing was measured at another temperature than 23 C, and the surface's own warmth, by up to
26 K in a run, left friction as it was (Appendix G), where this takes the stick-slip away: its size
is an upper bound. Not in it: interference that grows with thermal expansion, relaxation of the fit,
the modulus in the contact's own stiffness.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

__all__ = ["ABSOLUTE_ZERO", "TemperatureDependence"]

ABSOLUTE_ZERO = -273.15
"""[degree Celsius]"""

_ABOVE_GLASS = 50.0
"""Of the temperature theta_s to which the constants belong [K]."""

_WLF_HOLDS = 100.0
"""Above the glass temperature [K]."""


@dataclass(frozen=True)
class TemperatureDependence:
    """How an elastomer depends on temperature.

    Parameters
    ----------
    reference : float
        At which its stiffness, damping and friction are given [degree Celsius].
    glass_transition : float
        theta_g [degree Celsius].
    c1, c2 : float
        Of the shift about 50 K above the glass temperature [-] and [K].
    stiffening : float
        s: stiffness gained at the rates of the vibration, as a share of the static one.
    exponent : float
        alpha: of the rate [-].
    friction_peak : float, optional
        v_p: speed of most friction at the reference temperature [rad/s]; without one the torques
        stay, unless the friction law is a master curve itself.
    friction_width : float
        w: decades from the peak to 0.61 of its height [-].
    friction_floor : float
        p_0: friction far from the peak, as a share of that at the peak.

    Examples
    --------
    >>> rubber = TemperatureDependence(reference=23.0, glass_transition=-20.0)
    >>> rubber.log_shift(23.0), round(rubber.log_shift(5.0), 2), round(rubber.log_shift(80.0), 2)
    (0.0, 2.24, -3.58)
    >>> [round(k, 2) for k in (rubber.stiffness_factor(5.0), rubber.damping_factor(5.0))]
    [1.25, 4.4]
    """

    reference: float
    glass_transition: float
    c1: float = 8.86
    c2: float = 101.6
    stiffening: float = 0.1
    exponent: float = 0.3
    friction_peak: float | None = None
    friction_width: float = 2.24
    friction_floor: float = 0.3

    @property
    def range(self) -> tuple[float, float]:
        """Lowest and highest temperature at which WLF holds [degree Celsius]."""
        return self.glass_transition, self.glass_transition + _WLF_HOLDS

    def given_at(self, reference: float) -> TemperatureDependence:
        """Return the same dependence for numbers that are given at another temperature.

        Parameters
        ----------
        reference : float
            [degree Celsius]

        Examples
        --------
        >>> rubber = TemperatureDependence(23.0, -20.0, friction_peak=1.8)
        >>> other = rubber.given_at(40.0)
        >>> round(other.log_shift(5.0) + rubber.log_shift(40.0) - rubber.log_shift(5.0), 12)
        0.0
        """
        shift, peak = self.log_shift(reference), self.friction_peak
        return replace(
            self,
            reference=reference,
            stiffening=self.stiffening * float(10.0 ** (self.exponent * shift)),
            friction_peak=None if peak is None else peak * float(10.0**-shift),
        )

    def log_shift(self, temperature: float) -> float:
        """Return log10 of a_T at a temperature [degree Celsius], as a logarithm; 0 at reference."""
        return self._from_glass(temperature) - self._from_glass(self.reference)

    def stiffness_factor(self, temperature: float) -> float:
        """Return the factor on the stiffness at a temperature [degree Celsius]."""
        gained = self.stiffening * float(10.0 ** (self.exponent * self.log_shift(temperature)))
        return self._entropy(temperature) * (1.0 + gained) / (1.0 + self.stiffening)

    def damping_factor(self, temperature: float) -> float:
        """Return the factor on the elastomer's damping at a temperature [degree Celsius]."""
        return self._entropy(temperature) * float(
            10.0 ** (self.exponent * self.log_shift(temperature))
        )

    def _entropy(self, temperature: float) -> float:
        held = max(temperature, self.glass_transition)
        return (held - ABSOLUTE_ZERO) / (self.reference - ABSOLUTE_ZERO)

    def _from_glass(self, temperature: float) -> float:
        above = max(temperature, self.glass_transition) - self.glass_transition - _ABOVE_GLASS
        return -self.c1 * above / (self.c2 + above)

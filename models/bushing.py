r"""Rubber of the bushing: pressure of its sleeve on the shaft, and its temperature dependence.

Lame's solution of a thick-walled cylinder (Timoshenko and Goodier, Theory of Elasticity, section
28), following Recommendation 2 of the thesis. A sleeve of inner radius a and outer radius b is
widened by the interference delta at the shaft and held by a rigid housing, u(a) = delta and
u(b) = 0; if it were enclosed, its volumetric strain would be 2 a delta / (b^2 - a^2):

.. math::
    p = \frac{2 G a \delta}{b^2 - a^2} \left[\frac{\Lambda}{G} + \frac{b^2}{a^2}\right], \qquad
    \frac{\Lambda}{G} = \frac{1}{1 - 2 \nu} \;\text{(plane strain)}, \quad
    \frac{1 + \nu}{1 - \nu} \;\text{(plane stress)}

Rubber is nearly incompressible: in plane strain it cannot escape, and its stiffness is the bulk
modulus. A real sleeve bulges at its ends. Like the pressure of a bonded rubber layer (Gent and
Lindley, 1959; Chalhoub and Kelly, 1991), the hydrostatic part then follows from the balance of
volume along the axis z, with shear at the housing, to which the rubber is bonded, and none at the
shaft, where sliding turns all friction to the circumferential direction:

.. math::
    \ell^2 p'' = p - \bar p, \qquad
    \ell^2 = \frac{\pi}{2 A} \frac{\Delta}{G}
    \left[\frac{b^4}{4} - a^2 b^2 + \frac{3 a^4}{4} + a^4 \ln\frac{b}{a}\right],
    \qquad A = \pi (b^2 - a^2)

Delta is the excess of plane strain over plane stress. The mean over the length has the share
1 - tanh(x) / x, x = L / (2 l), of Delta, which connects both of Lame's cases.

Limits: no interference, no pressure; thin wall, the constrained modulus times delta / wall; thick
wall, 2 G delta / a in plane strain; nu -> 1/2 in plane strain, the bulk modulus times the
volumetric strain. The theory is linear: pressure, and friction at a constant coefficient, is
proportional to delta.

Temperature: an elastomer at a temperature theta and a rate w behaves as at a reference temperature
and the rate a_T w (Williams, Landel and Ferry, 1955), with

.. math::
    \log_{10} a_T = L(\theta) - L(\theta_{ref}), \qquad
    L = -\frac{c_1 (\theta - \theta_s)}{c_2 + \theta - \theta_s}, \qquad
    \theta_s = \theta_g + 50\ \mathrm{K}

(2.1); the thesis misprints the constants as 8.88 and 101.5.

*Stiffness.* An entropic spring parallel to a fractional element, at the rates of the rig's
vibration:

.. math::
    k / k_{ref} = b \frac{1 + s\, a_T^\alpha}{1 + s}, \qquad c / c_{ref} = b\, a_T^\alpha, \qquad
    b = T / T_{ref}

with absolute temperatures in b (Ferry, *Viscoelastic Properties of Polymers*, chapter 11). s is the
relative increase of stiffness from slow deformation to these rates: static tests gave k_EFF 2 to 15
% lower (Table 5.4), hence 0.1. alpha, the slope of a rubber's transition, is that of
`sim.effects.viscoelastic_stiffness`. The resulting loss factor, s tan(alpha pi / 2) / (1 + s) =
0.046, agrees with the fluorocarbon's fitted damping at its first torsional mode, 0.05.

**Friction.* Grosch (1963) found friction at all temperatures on one bell over log(a_T v), which
Persson (2001) derives from losses; the torques at a sliding speed v are the fitted ones times

.. math::
    \frac{B(a_T |v|)}{B(|v|)}, \qquad
    B(v) = p_0 + (1 - p_0) \exp\left[-\tfrac12 (\log_{10}(v / v_p) / w)^2\right]

v_p is the speed of highest friction at the reference temperature. Lorenz, Oh, Nam, Jeon and Persson
(2015, J. Chem. Phys. 142, 194701) find 0.1 for 1 / (2 w^2). So the fitted law stays, and only its
place on the bell moves: colder than at the peak friction falls with speed and sliding becomes
unstable, warmer it rises and sliding is stable. Times and speeds of a law are not shifted one by
one: fitted over a single decade of speeds, they saturate beyond it on the wrong side (friction
would rise with temperature).

Limits: at the reference temperature all factors are one. Below the glass temperature, where the
rubber is no elastomer, the factors are constant; WLF holds up to 100 K above it, beyond which the
rates change less. All measurements are at 23 C. Self-heating of the surface by up to 26 K in a run
did not change friction (Appendix G), whereas this model then ends the stick-slip, so its effect is
an upper bound. Not included: interference that grows with thermal expansion, relaxation of the fit,
and the modulus in the contact's own stiffness.
"""

import math
from dataclasses import dataclass, replace
from typing import Annotated

from models.errors import ParameterError
from models.schema import Quantity, refuse_impossible
from models.units import ABSOLUTE_ZERO

_SHORT = 1e-3
"""Value of L / (2 l) below which the bulk's share is replaced by its leading term."""


@dataclass(frozen=True)
class Sleeve:
    """Rubber sleeve bonded into a rigid housing and pressed on a rigid shaft.

    Parameters
    ----------
    inner_radius : float
        Radius of the shaft [m].
    wall : float
        Thickness [m].
    length : float
        Along the shaft [m]; ``math.inf`` is plane strain.
    youngs_modulus : float
        [Pa]
    poisson_ratio : float, optional
        Up to 0.5 (incompressible) [-].

    Raises
    ------
    ParameterError
        A value is not possible.

    Examples
    --------
    >>> sleeve = Sleeve(0.015, 0.0045, 0.0408, shore_modulus(75.0))
    >>> round(sleeve.pressure(0.279e-3) / 1e6, 2), round(sleeve.torsional_stiffness)
    (3.48, 664)
    """

    inner_radius: Annotated[float, Quantity("inner_radius_mm", 1e-3, "mm", low=1e-2, high=1e4)]
    wall: Annotated[float, Quantity("wall_mm", 1e-3, "mm", low=1e-5, high=1e5)]
    length: Annotated[
        float, Quantity("length_mm", 1e-3, "mm", low=1e-3, high=1e5, infinite="endless")
    ]
    youngs_modulus: Annotated[float, Quantity("youngs_modulus_MPa", 1e6, "MPa", low=1e-6, high=1e7)]
    poisson_ratio: Annotated[float, Quantity("poisson_ratio", high=0.5, closed=True)] = 0.4995

    def __post_init__(self) -> None:
        refuse_impossible(self, "sleeve")
        if math.isinf(self.length) and self.poisson_ratio == 0.5:
            raise ParameterError(
                "sleeve: an endless incompressible sleeve cannot deform; give a length, or a "
                "poisson_ratio below 0.5"
            )

    @property
    def outer_radius(self) -> float:
        """Radius of the housing [m]."""
        return self.inner_radius + self.wall

    @property
    def shear_modulus(self) -> float:
        """Shear modulus [Pa]."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))

    def pressure(self, interference: float) -> float:
        """Return the mean contact pressure on the shaft [Pa].

        Parameters
        ----------
        interference : float
            Widening of the inner radius [m].
        """
        a, b, nu = self.inner_radius, self.outer_radius, self.poisson_ratio
        stiffness = (1.0 + nu) / (1.0 - nu) + self._confinement() + (b / a) ** 2
        return 2.0 * self.shear_modulus * a * interference / (b * b - a * a) * stiffness

    def friction_torque(self, interference: float, friction_coefficient: float) -> float:
        """Return the friction torque under the mean pressure, mu p A r [Nm].

        Parameters
        ----------
        interference : float
            [m]
        friction_coefficient : float
            [-]

        Examples
        --------
        >>> sleeve = Sleeve(0.015, 0.0045, 0.0408, 7.05e6)
        >>> round(sleeve.friction_torque(0.279e-3, 0.05), 2)
        10.02
        """
        area = 2.0 * math.pi * self.inner_radius * self.length
        return friction_coefficient * self.pressure(interference) * area * self.inner_radius

    @property
    def torsional_stiffness(self) -> float:
        """Torsional stiffness between both faces, 4 pi G L / (1/a^2 - 1/b^2) [Nm/rad]."""
        a, b = self.inner_radius, self.outer_radius
        return 4.0 * math.pi * self.shear_modulus * self.length / (a**-2 - b**-2)

    @property
    def polar_area(self) -> float:
        """Length times polar moment of the section, to which the inertia is proportional [m5]."""
        return self.length * (self.outer_radius**4 - self.inner_radius**4)

    def _confinement(self) -> float:
        """Return the excess of the hydrostatic stiffness over plane stress, over G [-]."""
        a, b, nu = self.inner_radius, self.outer_radius, self.poisson_ratio
        area = math.pi * (b * b - a * a)
        flow = 0.25 * b**4 - (a * b) ** 2 + 0.75 * a**4 + a**4 * math.log(b / a)
        compliance = (1.0 - 2.0 * nu) * (1.0 - nu)
        most = 2.0 * nu * nu / compliance if compliance > 0.0 else math.inf  # Delta / G
        if most == 0.0:
            return 0.0
        shear = area * self.length**2 / (2.0 * math.pi * flow)  # x^2 Delta / G
        x = math.sqrt(shear / most)
        if x < _SHORT:
            return shear / 3.0
        return most * (1.0 - math.tanh(x) / x)


HARDNESS = Quantity("hardness_shore_A", 1.0, "Shore A", 20.0, 80.0)
"""Hardness of a rubber, within the range of `shore_modulus`."""


def shore_modulus(shore_a: float) -> float:
    """Return Young's modulus of a rubber from its hardness [Pa].

    Parameters
    ----------
    shore_a : float
        Shore A hardness [degree]; the relation holds from 20 to 80.

    Notes
    -----
    Gent (1958), On the relation between indentation hardness and Young's modulus: the durometer's
    indenter as a rigid punch in a linear half-space.

    Examples
    --------
    >>> [round(shore_modulus(hardness) / 1e6, 2) for hardness in (40.0, 60.0, 75.0)]
    [1.69, 3.61, 7.05]
    """
    return 1e6 * 0.0981 * (56.0 + 7.62336 * shore_a) / (0.137505 * (254.0 - 2.54 * shore_a))


_ABOVE_GLASS = 50.0
"""Reference temperature theta_s of the constants above the glass temperature [K]."""

_WLF_HOLDS = 100.0
"""Range of WLF above the glass temperature [K]."""


@dataclass(frozen=True)
class TemperatureDependence:
    """Temperature dependence of an elastomer.

    Parameters
    ----------
    reference : float
        Temperature of the stated stiffness, damping and friction [degree Celsius].
    glass_transition : float
        theta_g [degree Celsius].
    c1, c2 : float
        Constants of the shift about 50 K above the glass temperature [-] and [K].
    stiffening : float
        s: increase of stiffness at the rates of the vibration, over the static stiffness [-].
    exponent : float
        alpha: exponent of the rate [-].
    friction_peak : float, optional
        v_p: speed of highest friction at the reference temperature [rad/s]; without one the torques
        do not change.
    friction_width : float
        w: decades from the peak to 0.61 of its height [-].
    friction_floor : float
        p_0: friction far from the peak over that at the peak [-].

    Examples
    --------
    >>> rubber = TemperatureDependence(reference=23.0, glass_transition=-20.0)
    >>> rubber.log_shift(23.0), round(rubber.log_shift(5.0), 2), round(rubber.log_shift(80.0), 2)
    (0.0, 2.24, -3.58)
    >>> [round(k, 2) for k in (rubber.stiffness_factor(5.0), rubber.damping_factor(5.0))]
    [1.25, 4.4]
    """

    reference: Annotated[float, Quantity("reference_C", low=ABSOLUTE_ZERO, high=2000.0)]
    glass_transition: Annotated[
        float, Quantity("glass_transition_C", low=ABSOLUTE_ZERO, high=2000.0)
    ]
    c1: Annotated[float, Quantity("wlf_c1", high=100.0)] = 8.86
    c2: Annotated[  # above 50 the shift is finite at the glass temperature
        float, Quantity("wlf_c2_K", low=50.0, high=1e3, closed=False)
    ] = 101.6
    stiffening: Annotated[float, Quantity("stiffening", high=10.0, closed=True)] = 0.1
    exponent: Annotated[float, Quantity("stiffening_exponent", high=1.0, closed=True)] = 0.3
    friction_peak: Annotated[
        float | None, Quantity("friction_peak_rad_s", unit="rad/s", high=1e12)
    ] = None
    friction_width: Annotated[float, Quantity("friction_width", high=20.0)] = 2.24
    friction_floor: Annotated[float, Quantity("friction_floor", high=1.0, closed=True)] = 0.3

    @property
    def range(self) -> tuple[float, float]:
        """Lowest and highest temperature at which WLF holds [degree Celsius]."""
        return self.glass_transition, self.glass_transition + _WLF_HOLDS

    def at_reference(self, reference: float) -> "TemperatureDependence":
        """Return the same dependence for numbers stated at another temperature.

        Parameters
        ----------
        reference : float
            [degree Celsius]

        Examples
        --------
        >>> rubber = TemperatureDependence(23.0, -20.0, friction_peak=1.8)
        >>> other = rubber.at_reference(40.0)
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
        """Return log10 of a_T at a temperature [degree Celsius]; 0 at the reference."""
        return self._from_glass(temperature) - self._from_glass(self.reference)

    def stiffness_factor(self, temperature: float) -> float:
        """Return the factor on the stiffness at a temperature [degree Celsius]."""
        increase = self.stiffening * float(10.0 ** (self.exponent * self.log_shift(temperature)))
        return self._entropy(temperature) * (1.0 + increase) / (1.0 + self.stiffening)

    def damping_factor(self, temperature: float) -> float:
        """Return the factor on the elastomer's damping at a temperature [degree Celsius]."""
        return self._entropy(temperature) * float(
            10.0 ** (self.exponent * self.log_shift(temperature))
        )

    def _entropy(self, temperature: float) -> float:
        above_glass = max(temperature, self.glass_transition)
        return (above_glass - ABSOLUTE_ZERO) / (self.reference - ABSOLUTE_ZERO)

    def _from_glass(self, temperature: float) -> float:
        above = max(temperature, self.glass_transition) - self.glass_transition - _ABOVE_GLASS
        return -self.c1 * above / (self.c2 + above)

"""Reading of the figures: what they say of the thesis's own explanations."""

from __future__ import annotations

__all__ = ["READING"]

READING = """\
## Reading

**6.3.1, gradual release** (`partial_slip`) closes nothing of the critical speeds, its best fit
being almost none. It shortens the time in which the contact truly sticks, but not what a rig sees
of it: a contact that creeps while it is loaded still lets go at once, and its torque still drops.

**Viscoelastic stiffness** comes first, 0.30 of the gap, by its high stiffness at high frequency
alone: slips stay smaller and stick-slip ends earlier. But its interval reaches from -0.67 to 0.65,
its slip frequencies, which it was not fitted to, come out well above the mode, and V_crit2 at
3745 Nm/rad stays too low. `transfer_film` is next, with the same width.

**6.3.3, constant kinetic torque**: weakening alone closes nothing, its best fit being almost none;
with true stick a falling torque only prolongs stick-slip. So the tables do not ask for it by
itself. Yet no effect that keeps the torque constant brings V_crit2 right either, least of all at
3745 Nm/rad. `transfer_film` and `frictional_heating` part V_crit2 from V_crit1, by a torque that
changes within the run; Figure 5.3 (little variation) speaks against both, and they fail at the
other fits.

**What no effect alone closes** is the width of the quasi-harmonic range, least of all at
3745 Nm/rad (2.6 to 12.5 rad/s). The shipped contact comes near by release, memory, weakening and an
elastomer damped less than the beams, all at once: nine fitted numbers, in sample, found by the time
in stick rather than by slips. Simple pairs, which hold nothing but release or ageing and weakening,
do not get there with the damping as printed.
"""
"""Follows the tables."""

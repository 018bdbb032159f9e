"""Coulomb friction with true stick: the law of the thesis (Section 4.2).

While the surfaces stick, the torque is the holding torque, up to T_crit; while they slide, it is
T_kin at any speed. Only T_crit - T_kin matters for the vibration. A constant kinetic torque
sustains neither squawk nor squeal: it has no quasi-harmonic regime (6.3.1).
"""

from sim.friction.law import FrictionLaw

LAW = FrictionLaw(name="coulomb", tolerance=1e-7)

"""Program of the thesis's Appendix F, line by line, errors included.

The published simulations came from it, so what it gives is what they can be compared with; the
equations that it means to solve are solved exactly by `sim.solvers.stick_slip`. Every statement
keeps its line number. What is wrong in it, and stays so here:

- 400, 430, 460: stages 2 to 4 of the stick phase take ``T*W`` for the angle of the bushing's
  surface and forget ``T1(0)``, where it stood when it stuck. So after the first slip five sixths of
  the clamp's acceleration come from an elastomer that has not been twisted yet. This alone moves
  the critical velocity at 2214 Nm/rad from 3.5 to 5.5 rad/s.
- 340: ``T`` counts the step before it is taken, so the same stages are one step ahead.
- 550, 1000: a phase ends at the end of a step, which makes any scheme first order in the step.
- 560: the state before the critical torque was passed starts the slip, though ``TIME`` has gone on.
- 600: the surface starts to slip without acceleration.
- 610: ``KB*T1(0)`` stands for ``KB*T2(0)``.

Two things cannot be literal: the run lasts as long as it is asked to rather than 0.02 s (line 310,
with arrays and loops of 2000 steps; the thesis itself ran 82 and 820 ms), and numbers have double
precision.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

STEP = 2e-5
"""Line 140, H [s]; 6.3 misprints it as 0.2 ms."""

_CLAMP_INERTIA, _ELASTOMER_INERTIA = 1 / 1200, 1 / 65000
"""Line 200 [kg m2]."""


@dataclass(frozen=True, eq=False)
class ListingRun:
    """Output of the program, one row per step.

    Parameters
    ----------
    time : ndarray, shape (n,)
        [s]
    torque : ndarray, shape (n,)
        In the elastomer, of the row before (lines 320 and 650) [Nm].
    interface_angle, interface_speed : ndarray, shape (n,)
        Of the bushing's surface [rad], [rad/s].
    relative_speed : ndarray, shape (n,)
        Of the bushing's surface less the shaft's [rad/s]; negative while it slips.
    stuck : ndarray of bool, shape (n,)
        Which of the two loops wrote the row.
    """

    time: NDArray[np.float64]
    torque: NDArray[np.float64]
    interface_angle: NDArray[np.float64]
    interface_speed: NDArray[np.float64]
    relative_speed: NDArray[np.float64]
    stuck: NDArray[np.bool_]


def run_listing(
    speed: float,
    *,
    support_stiffness: float = 3745.0,
    damping: float = 0.085,
    elastomer_stiffness: float = 665.0,
    critical_torque: float = 10.7,
    kinetic_torque: float = 8.0,
    seconds: float = 0.02,
) -> ListingRun:
    """Run the program of Appendix F from rest.

    Parameters
    ----------
    speed : float
        W, of the shaft [rad/s] (line 230).
    support_stiffness : float
        KB [Nm/rad] (line 180); the program knows no fixed clamp.
    damping : float
        CE [Nm s/rad] (line 190).
    elastomer_stiffness : float
        KE [Nm/rad] (line 170).
    critical_torque, kinetic_torque : float
        TCRIT, TK [Nm] (lines 210 and 220).
    seconds : float
        Length of the run [s] (line 310).

    Returns
    -------
    ListingRun

    Examples
    --------
    The decimal point of the published critical damping, "0.7599", is misplaced:

    >>> runs = [run_listing(7.5, damping=c, seconds=0.3) for c in (0.0759, 0.0761)]
    >>> [bool(run.stuck[-5000:].any()) for run in runs]
    [True, False]
    """
    n = round(seconds / STEP)
    rows, stuck = np.empty((n, 5)), np.empty(n, dtype=np.bool_)
    _program(
        speed, elastomer_stiffness, support_stiffness, damping, kinetic_torque, critical_torque,
        rows, stuck,
    )  # fmt: skip
    time, torque, angle, interface_speed, relative = rows.T.copy()
    return ListingRun(time, torque, angle, interface_speed, relative, stuck)


@njit(cache=True)
def _program(W, KE, KB, CE, TK, TCRIT, rows, stuck) -> None:  # type: ignore[no-untyped-def] # noqa: ANN001
    H, HH, TIME = STEP, 0.5 * STEP, -STEP  # 140-160
    JC, JE = _CLAMP_INERTIA, _ELASTOMER_INERTIA  # 200
    T1, T1D, T1DD, T2, T2D = 0.0, W, 0.0, 0.0, 0.0  # 240-270
    T2DD = 1 / JC * (CE * (0.5 * W - T2D) + KE * (T1 - T2) - KB * T2)  # 280
    T, TORQUE = 0.0, 0.0  # as BASIC has variables that were never set
    written, n = 0, stuck.size
    while True:
        while True:  # 290
            TIME = TIME + H  # 300
            if written == n:  # 310
                return
            rows[written] = TIME, TORQUE, T1, T1D, T1D - W  # 320
            stuck[written] = True
            written += 1
            T = T + H  # 340
            Y2, F2 = T2D, T2DD  # 360-370
            X2_2 = T2 + HH * Y2  # 380
            Y2_2 = T2D + HH * F2  # 390
            F2_2 = 1 / JC * (CE * (0.5 * W - Y2_2) + KE * ((HH * W + T * W) - X2_2) - KB * X2_2)
            X2_3 = T2 + HH * Y2_2  # 410
            Y2_3 = T2D + HH * F2_2  # 420
            F2_3 = 1 / JC * (CE * (0.5 * W - Y2_3) + KE * ((HH * W + T * W) - X2_3) - KB * X2_3)
            X2_4 = T2 + H * Y2_3  # 440
            Y2_4 = T2D + H * F2_3  # 450
            F2_4 = 1 / JC * (CE * (0.5 * W - Y2_4) + KE * ((H * W + T * W) - X2_4) - KB * X2_4)
            T1_0, T2_0, T2D_0 = T1, T2, T2D
            T1D = W  # 470
            T1 = T1_0 + W * H  # 480
            T2 = T2_0 + H / 6 * (Y2 + 2 * Y2_2 + 2 * Y2_3 + Y2_4)  # 490
            T2D = T2D_0 + H / 6 * (F2 + 2 * F2_2 + 2 * F2_3 + F2_4)  # 500
            T2DD = 1 / JC * (CE * (0.5 * W - T2D) + KE * (T1 - T2) - KB * T2)  # 510
            TORQUE = CE / 2 * (W - T2D) + KE * (T1 - T2)  # 520
            if TORQUE > TCRIT:  # 540
                break
        T1, T1D, T2, T2D = T1_0, W, T2_0, T2D_0  # 560-590
        T1DD = 0.0  # 600
        T2DD = 1 / JC * (CE * (0.5 * T1D - T2D) + KE * (T1 - T2) - KB * T1)  # 610
        while True:  # 620
            TIME = TIME + H  # 630
            if written == n:  # 640
                return
            rows[written] = TIME, TORQUE, T1, T1D, T1D - W  # 650
            stuck[written] = False
            written += 1
            Y1, Y2, F1, F2 = T1D, T2D, T1DD, T2DD  # 690-720
            X1_2, X2_2 = T1 + HH * Y1, T2 + HH * Y2  # 730-740
            Y1_2, Y2_2 = T1D + HH * F1, T2D + HH * F2  # 750-760
            F1_2 = 1 / JE * (TK - CE / 2 * (Y1_2 - Y2_2) - KE * (X1_2 - X2_2))  # 770
            F2_2 = 1 / JC * (CE * (0.5 * Y1_2 - Y2_2) + KE * (X1_2 - X2_2) - KB * X2_2)  # 780
            X1_3, X2_3 = T1 + HH * Y1_2, T2 + HH * Y2_2  # 790-800
            Y1_3, Y2_3 = T1D + HH * F1_2, T2D + HH * F2_2  # 810-820
            F1_3 = 1 / JE * (TK - CE / 2 * (Y1_3 - Y2_3) - KE * (X1_3 - X2_3))  # 830
            F2_3 = 1 / JC * (CE * (0.5 * Y1_3 - Y2_3) + KE * (X1_3 - X2_3) - KB * X2_3)  # 840
            X1_4, X2_4 = T1 + H * Y1_3, T2 + H * Y2_3  # 850-860
            Y1_4, Y2_4 = T1D + H * F1_3, T2D + H * F2_3  # 870-880
            F1_4 = 1 / JE * (TK - CE / 2 * (Y1_4 - Y2_4) - KE * (X1_4 - X2_4))  # 890
            F2_4 = 1 / JC * (CE * (0.5 * Y1_4 - Y2_4) + KE * (X1_4 - X2_4) - KB * X2_4)  # 900
            T1 = T1 + H / 6 * (Y1 + 2 * Y1_2 + 2 * Y1_3 + Y1_4)  # 910
            T1D = T1D + H / 6 * (F1 + 2 * F1_2 + 2 * F1_3 + F1_4)  # 920
            T2 = T2 + H / 6 * (Y2 + 2 * Y2_2 + 2 * Y2_3 + Y2_4)  # 930
            T2D = T2D + H / 6 * (F2 + 2 * F2_2 + 2 * F2_3 + F2_4)  # 940
            T1DD = 1 / JE * (TK - CE / 2 * (T1D - T2D) - KE * (T1 - T2))  # 950
            T2DD = 1 / JC * (CE * (0.5 * T1D - T2D) + KE * (T1 - T2) - KB * T2)  # 960
            TORQUE = CE / 2 * (T1D - T2D) + KE * (T1 - T2)  # 980
            if T1D > W:  # 990
                break
        T1D = W  # 1010-1050
        T = 0.0  # 1060, 1070 goes on at 290

"""Forms that textbooks have and libraries of effects seldom do, for the kind of bench of that name.

Soft and lopsided limits, contacts by Dahl, LuGre and Bouc-Wen, friction by power laws and
saturation, diffuse rooms, modes that are moved instead of added, cogging and random speed, and
elastomers with two relaxation times.
"""

from __future__ import annotations

import numpy as np
from scipy.special import erf

from .. import contact, kernel
from ..structure import filtered
from .drive import _branches
from .form import DEVELOPMENT, SEALED, form, noise_in_band
from .friction import _AGE, _RATIO, _SLIDING, _aged
from .measurement import _each, _one_or_two
from .structure import _tail, _through

FOREIGN = {DEVELOPMENT: "foreign development", SEALED: "foreign sealed"}
_NEW, _KEPT = FOREIGN[DEVELOPMENT], FOREIGN[SEALED]


def _limited(s, a, case, shape):
    """Limits above and below that differ, the lower one at times out of reach; soft by `shape`.

    A soft limit acts on a signal that just reaches it, so that weak ones are mixed in by a share.
    """
    upper, share = 1.0 - 0.75 * a, min(1.0, 5.0 * a)
    lower = float(case.choice([upper, 0.5 * (1.0 + upper), 30.0]))

    def make(x, rate, rng):
        away = x - x.mean()
        size = np.abs(away).max()
        limited = np.where(
            away > 0.0,
            size * upper * shape(away / (size * upper)),
            size * lower * shape(away / (size * lower)),
        )
        return x + share * (limited - away)

    _each(s, _one_or_two(case), make)


@form("clipping", "measurement", _NEW)
def soft_lopsided_limit(s, a, case, run):
    sharp = case.uniform(3.0, 8.0)
    _limited(s, a, case, lambda u: u / (1.0 + np.abs(u) ** sharp) ** (1.0 / sharp))


@form("clipping", "measurement", _KEPT)
def rounded_by_the_error_function(s, a, case, run):
    _limited(s, a, case, lambda u: erf(0.5 * np.sqrt(np.pi) * u))


def _bristles(s, a, speed):
    s.law = contact.LUGRE
    s.contact = np.zeros(contact.N_CONTACT)
    numbers = [contact.STIFFNESS, contact.DAMPER, contact.SPEED, contact.DROP]
    s.contact[numbers] = 400.0 / a, 2e-5 / a, speed, 1.0
    s.contact[[contact.RENEWAL, contact.TIME, contact.EXPONENT]] = 1.0


@form("partial_slip", "friction", _NEW)
def dahl_contact(s, a, case, run):
    _bristles(s, a, 0.3)


@form("partial_slip", "friction", _NEW)
def bouc_wen_contact(s, a, case, run):
    s.creep = 0.9 * a * _RATIO ** case.uniform(1.2, 3.0)


@form("partial_slip", "friction", _KEPT)
def lugre_contact(s, a, case, run):
    _bristles(s, a, case.uniform(0.5, 1.5))


@form("partial_slip", "friction", _KEPT)
def iwan_contact(s, a, case, run):
    s.creep = 0.9 * a * (1.0 - (1.0 - _RATIO) ** case.uniform(0.4, 0.8))


@form("velocity_weakening", "friction", _NEW)
def saturating_fall(s, a, case, run):
    v = case.uniform(1.0, 12.0)
    s.weakening *= 1.0 - 0.45 * a * _SLIDING / (_SLIDING + v)


@form("velocity_weakening", "friction", _KEPT)
def falling_power(s, a, case, run):
    v = case.uniform(0.5, 3.0)
    s.weakening *= 1.0 - a + a * (1.0 + _SLIDING / v) ** -case.uniform(0.08, 0.25)


@form("velocity_strengthening", "friction", _NEW)
def rising_power(s, a, case, run):
    s.weakening *= 1.0 + 0.5 * a * (_SLIDING / 10.0) ** case.uniform(0.3, 1.0)


@form("velocity_strengthening", "friction", _KEPT)
def rise_that_saturates(s, a, case, run):
    v = case.uniform(2.0, 8.0)
    s.weakening *= 1.0 + 0.9 * a * _SLIDING / (_SLIDING + v)


@form("static_ageing", "friction", _NEW)
def logarithm_of_time(s, a, case, run):
    t = case.uniform(1e-4, 1e-3)
    _aged(s, a, np.minimum(np.log1p(_AGE / t) / np.log1p(0.05 / t), 1.0))


@form("static_ageing", "friction", _KEPT)
def two_times(s, a, case, run):
    fast, slow = case.uniform(3e-4, 1e-3), case.uniform(5e-3, 2e-2)
    _aged(s, a, 1.0 - 0.5 * np.exp(-_AGE / fast) - 0.5 * np.exp(-_AGE / slow))


@form("viscoelastic_stiffness", "friction", _NEW)
def two_relaxation_times(s, a, case, run):
    times = [case.uniform(1e-4, 4e-4), case.uniform(1e-3, 6e-3)]
    _branches(s, 0.35 * a * s.p[kernel.K_E] * np.array([1.0, 0.7]), times)


@form("viscoelastic_stiffness", "friction", _KEPT)
def two_times_far_apart(s, a, case, run):
    times = [case.uniform(3e-5, 1e-4), case.uniform(1e-2, 6e-2)]
    _branches(s, 0.4 * a * s.p[kernel.K_E] * np.array([1.0, 0.8]), times)


def _turned(s):
    return np.concatenate([[0.0], np.cumsum(s.omega[:-1])]) / s.rate


@form("speed_fluctuation", "drive", _NEW)
def random_speed(s, a, case, run):
    s.omega *= 1.0 + 0.12 * a * np.clip(
        noise_in_band(run, s.n + 1, s.rate, 2.0, case.uniform(20.0, 80.0), 1.0), -3.0, 3.0
    )


@form("speed_fluctuation", "drive", _KEPT)
def cogging_speed(s, a, case, run):
    poles = int(case.integers(12, 60))
    turn = poles * _turned(s) + 2.0 * np.pi * run.random()
    s.omega *= 1.0 + 0.15 * a * (np.cos(turn) + 0.3 * np.cos(2.0 * turn))


def _moved(case, a, low, high):
    """Of a mode whose zero stays where it was and whose peak is elsewhere."""
    first, zeta = case.uniform(low, high), case.uniform(0.01, 0.03)
    second = first * (1.0 + 0.25 * a * float(case.choice([-1.0, 1.0])))

    def response(f):
        x, y = f / first, f / second
        return (1.0 - x * x + 2j * zeta * x) / (1.0 - y * y + 2j * zeta * y)

    return response


@form("beam_modes", "structure", _NEW)
def moved_mode_of_the_beams(s, a, case, run):
    response = _moved(case, a, 500.0, 3000.0)

    def change(signals, turned):
        for name in ("acceleration", "pressure"):
            signals[name] = filtered(signals[name], turned.rate, response)

    s.structure.append(change)


@form("beam_modes", "structure", _KEPT)
def two_moved_modes(s, a, case, run):
    moved_mode_of_the_beams(s, a, case, run)
    moved_mode_of_the_beams(s, a, case, run)


@form("plate_modes", "radiation", _NEW)
def moved_mode_of_the_plate(s, a, case, run):
    _through(s, _moved(case, a, 300.0, 2500.0))


@form("plate_modes", "radiation", _KEPT)
def two_moved_modes_of_the_plate(s, a, case, run):
    one, other = _moved(case, a, 250.0, 900.0), _moved(case, a, 900.0, 3500.0)
    _through(s, lambda f: one(f) * other(f))


@form("room_reflections", "radiation", _NEW)
def diffuse_room(s, a, case, run):
    time = case.uniform(0.02, 0.1)

    def shape(rng, t, _rate):
        return rng.standard_normal(t.size) * (t > 1e-3)

    _tail(s, a, case, lambda t: np.exp(-t / time), shape)


@form("room_reflections", "radiation", _KEPT)
def diffuse_room_of_dull_walls(s, a, case, run):
    time = case.uniform(0.02, 0.1)

    def shape(rng, t, rate):
        return noise_in_band(rng, t.size, rate, 60.0, 2500.0) * (t > 1e-3)

    _tail(s, a, case, lambda t: np.exp(-t / time), shape)

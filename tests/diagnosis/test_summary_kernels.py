"""What compiled loops count is what its definition says, written out in numpy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.signal import detrend

from features.kernels.spectra import segment_spectra
from noise.diagnosis.evidence.channel_kernel import (
    band_power_sums,
    describe_distribution,
    detrend_and_window,
    line_ratios,
    power_quantiles,
)
from noise.diagnosis.evidence.channel_summary import quantile
from noise.diagnosis.evidence.contact_kernel import (
    describe_slips,
    gather_rings,
    gather_slipping,
    gather_sticking,
    mean_cycle,
)
from noise.diagnosis.evidence.path_kernel import cross_powers, quarter_moments

CLOSE = {"rel": 1e-9, "abs": 1e-12}

seeds = st.integers(0, 10_000)
# Few different values make ties, which sorting and thresholds stumble over.
signals = st.builds(
    lambda seed, n, steps: np.round(np.random.default_rng(seed).normal(1.0, 2.0, n) * steps)
    / steps,
    seeds, st.integers(16, 400), st.sampled_from([1.0, 3.0, 1e6]),
)  # fmt: skip


def _spectra(seed, n, m):
    real, imaginary = np.random.default_rng(seed).normal(size=(2, n, m))
    return real + 1j * imaginary


def _slips(n, rng):
    """Slips that do not touch, the first after the start and the last before the end."""
    edges = np.sort(rng.choice(np.arange(3, n - 3), 12, replace=False))
    return edges[::2].astype(np.int64), edges[1::2].astype(np.int64)


@settings(max_examples=80)
@given(signals)
def test_a_distribution_is_counted_as_defined(x):
    found = np.empty(12)
    describe_distribution(x, found)
    span = x.max() - x.min() + 1e-12
    high, low = x > x.max() - 0.05 * span, x < x.min() + 0.05 * span
    entries = [np.count_nonzero(stay[1:] & ~stay[:-1]) for stay in (high, low)]
    expected = [
        x.max(), x.min(), x.mean(), x.std(), np.mean((x - x.mean()) ** 3),
        np.mean(x > x.max() - 0.02 * span), np.mean(x < x.min() + 0.02 * span),
        np.mean(np.abs(np.diff(x)) < 1e-3 * span), high.sum(), entries[0], low.sum(), entries[1],
    ]  # fmt: skip
    assert found.tolist() == pytest.approx(expected, rel=1e-9, abs=1e-9)


@settings(max_examples=60)
@given(signals, st.floats(0.0, 1.0))
def test_a_quantile_is_that_of_numpy(x, share):
    assert quantile(x, share) == pytest.approx(float(np.quantile(x, share)), **CLOSE)
    found = np.empty(1)
    power_quantiles(x[:, None].astype(complex), 0, share, np.empty(x.size), found)
    assert found[0] == pytest.approx(float(np.quantile(x**2, share)), **CLOSE)


@settings(max_examples=30)
@given(signals)
def test_a_signal_is_windowed_about_its_trend(x):
    window, found = np.hanning(x.size), np.empty(x.size)
    detrend_and_window(x, window, found)
    assert found == pytest.approx(detrend(x) * window, rel=1e-9, abs=1e-9)


@settings(max_examples=40)
@given(seeds, st.lists(st.integers(0, 199), min_size=1, max_size=20))
def test_a_line_stands_out_of_the_median_of_what_lies_beside_it(seed, lines):
    power = np.random.default_rng(seed).exponential(size=200)
    found = np.empty(len(lines))
    line_ratios(power, np.array(lines), found, np.empty(16))
    for k, ratio in zip(lines, found, strict=True):
        if k + 13 > power.size:
            assert ratio == 1.0
            continue
        beside = [*range(max(k - 12, 1), max(k - 4, 1)), *range(k + 5, k + 13)]
        expected = power[max(k - 2, 0) : k + 3].max() / np.median(power[beside])
        assert ratio == pytest.approx(expected, **CLOSE)


@settings(max_examples=20)
@given(seeds)
def test_powers_of_bands_and_between_signals_are_sums_of_squares(seed):
    one, other = _spectra(seed, 5, 40), _spectra(seed + 1, 5, 40)
    first, last = np.array([0, 7, 20]), np.array([7, 20, 40])
    sums = np.empty((5, 3))
    band_power_sums(one, first, last, sums)
    parts = [np.sum(np.abs(one[:, a:b]) ** 2, axis=1) for a, b in zip(first, last, strict=True)]
    assert sums == pytest.approx(np.stack(parts, axis=1), **CLOSE)
    powers, cross = np.empty((3, 40)), np.empty(40, complex)
    cross_powers(one, other, powers, cross)
    expected = [np.mean(np.abs(x) ** 2, axis=0) for x in (one, other, other - one)]
    assert powers == pytest.approx(np.stack(expected), **CLOSE)
    assert np.allclose(cross, np.mean(np.conj(one) * other, axis=0), rtol=1e-9, atol=1e-12)


@settings(max_examples=30)
@given(signals)
def test_quarters_are_each_about_their_own_mean(x):
    found = np.empty(6)
    quarter_moments(x, found)
    m = x.size // 4
    quarters = x[: 4 * m].reshape(4, m).std(axis=1)
    expected = [x.var(), np.mean((x - x.mean()) ** 4), *quarters]
    assert found.tolist() == pytest.approx(expected, rel=1e-9, abs=1e-12)


@settings(max_examples=20)
@given(seeds, st.integers(256, 2000))
def test_segments_are_windowed_about_their_mean(seed, n):
    x = np.random.default_rng(seed).normal(3.0, 1.0, n)
    window = np.sin(np.pi * np.arange(256) / 256) ** 2
    window /= np.sqrt(np.sum(window**2))
    cut = np.stack([x[i : i + 256] for i in range(0, n - 255, 128)])
    expected = np.fft.rfft((cut - cut.mean(axis=1, keepdims=True)) * window, axis=1)
    assert np.allclose(segment_spectra(x, 256), expected, rtol=1e-9, atol=1e-12)


@settings(max_examples=30)
@given(seeds)
def test_what_a_contact_does_in_stick_is_gathered(seed):
    rng = np.random.default_rng(seed)
    torque, friction, rate, shaft, sliding, clamp, k, c, j = rng.normal(size=(9, 300))
    near = rng.random(300) < 0.2
    edges, critical, kinetic = np.array([0.0, 0.4, 0.9, 1.5]), 1.3, 0.8
    rows, target = np.empty((300, 6)), np.empty(300)
    classes, winding = np.empty((2, 3, 2)), np.empty((3, 3))
    n = gather_sticking(
        (torque, friction, rate, shaft, sliding, clamp), (k, c, j), near,
        (2.0, 1.1, critical, kinetic), edges, rows, target, classes, winding,
    )  # fmt: skip
    stick, ratio, rising = ~near & (np.abs(sliding) < 1.1), friction / critical, rate > 0.0
    wound = (torque - kinetic) / kinetic
    release = shaft * np.clip(ratio, 0.0, 1.2) ** 6
    expected = np.stack([shaft, k, k * wound, c, j, release], axis=1)[stick]
    assert n == np.count_nonzero(stick)
    assert rows[:n] == pytest.approx(expected, **CLOSE)
    assert np.array_equal(target[:n], sliding[stick])
    for way, chosen in enumerate((stick & rising, stick & ~rising)):
        place = np.digitize(ratio[chosen], edges)
        for i in range(3):
            here = sliding[chosen][place == i + 1] / 2.0
            assert classes[way, i].tolist() == pytest.approx([here.size, here.sum()], **CLOSE)
    late, early = stick & rising & (ratio > 0.85), stick & rising & (ratio < 0.7)
    for row, chosen in zip(winding, (stick, late, early), strict=True):
        u = (shaft - clamp)[chosen]
        sums = [chosen.sum(), rate[chosen] @ u, u @ u]
        assert row.tolist() == pytest.approx(sums, rel=1e-9, abs=1e-9)


@settings(max_examples=30)
@given(seeds)
def test_the_friction_torque_of_slips_is_gathered_by_speed(seed):
    rng = np.random.default_rng(seed)
    sliding, friction = rng.uniform(0.0, 8.0, 300), rng.normal(size=300)
    slipping, edges, limits = rng.random(300) < 0.6, np.array([1.0, 3.0, 6.0]), (2.0, 7.0)
    rows, target, classes = np.empty((300, 4)), np.empty(300), np.empty((2, 2, 3))
    n = gather_slipping(sliding, friction, slipping, limits, edges, rows, target, classes)
    faster = np.gradient(sliding) > 0.0
    inside = slipping & (sliding > limits[0]) & (sliding < limits[1])
    v = sliding[inside] / limits[1] - 0.5
    expected = np.stack([np.ones_like(v), v, v * v - 1.0 / 12.0, faster[inside] - 0.5], axis=1)
    assert rows[:n] == pytest.approx(expected, **CLOSE)
    assert np.array_equal(target[:n], friction[inside])
    for way, chosen in enumerate((slipping & faster, slipping & ~faster)):
        for i in range(2):
            here = friction[chosen & (sliding >= edges[i]) & (sliding < edges[i + 1])]
            sums = [here.size, here.sum(), here.size * here.var() if here.size else 0.0]
            assert classes[way, i].tolist() == pytest.approx(sums, rel=1e-9, abs=1e-9)


@settings(max_examples=30)
@given(seeds, st.integers(0, 40))
def test_each_slip_is_described_by_its_own_samples_and_those_near(seed, near):
    rng = np.random.default_rng(seed)
    torque, friction, sliding = np.round(rng.normal(size=(3, 200)), 1)
    starts, ends = _slips(200, rng)
    found = np.empty((4, starts.size))
    describe_slips(torque, friction, sliding, starts, ends, near, np.empty(200), found)
    for k, (a, b) in enumerate(zip(starts.tolist(), ends.tolist(), strict=True)):
        expected = [
            friction[max(a - near, 0) : a + 2].max(), torque[a : b + near].min(),
            sliding[a:b].max(), float(np.median(friction[a:b])),
        ]  # fmt: skip
        assert found[:, k].tolist() == pytest.approx(expected, **CLOSE)


@settings(max_examples=30)
@given(seeds)
def test_the_mean_cycle_leaves_out_what_reaches_into_another_slip(seed):
    rng = np.random.default_rng(seed)
    torque, sliding, shaft = rng.normal(size=(3, 200))
    starts, ends = _slips(200, rng)
    before, after = np.array([1, 5, 20]), np.array([0, 9])
    found = np.empty((5, 3))
    mean_cycle(torque, sliding, shaft, starts, ends, before, after, found)
    earlier, later = np.append(0, ends[:-1]), np.append(starts[1:], 200)
    at = [(starts - by)[starts - by > earlier] for by in before]
    at += [(ends + by)[ends + by < later] for by in after]
    creep = sliding / np.maximum(np.abs(shaft), 0.05)
    expected = [[i.size, torque[i].sum(), creep[i].sum()] for i in at]
    assert found == pytest.approx(np.array(expected), rel=1e-9, abs=1e-9)


@settings(max_examples=20)
@given(seeds)
def test_rings_are_about_the_mean_of_their_stick(seed):
    rng = np.random.default_rng(seed)
    signals = rng.normal(size=(4, 200))
    first, last = _slips(200, rng)
    rows, sums = np.empty((4, 200)), np.empty(4)
    n = gather_rings(tuple(signals), first, last, rows, sums)
    sticks = [signals[:, a:b] for a, b in zip(first, last, strict=True)]
    expected = np.concatenate([x - x.mean(axis=1, keepdims=True) for x in sticks], axis=1)
    assert rows[:, :n] == pytest.approx(expected, **CLOSE)
    assert sums == pytest.approx(np.sum([x.sum(axis=1) for x in sticks], axis=0), **CLOSE)

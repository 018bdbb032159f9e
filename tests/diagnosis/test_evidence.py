"""A case is one row of numbers, whatever it lacks and in whatever order it was recorded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from noise.diagnosis.evidence.summary import (
    CONTEXT,
    PARTS,
    evidence,
    evidence_names,
    scale_of,
)
from tests.helpers.small_rigs import table_of

NAMES = ("contact_peak", "pressure_gain_4", "torque_offset")
SCALE = np.ones(3)


def _part(row, part, name):
    return row[evidence_names(NAMES).index(f"{part}:{name}")]


def _ordered(table, order):
    return replace(
        table,
        measured=table.measured[order],
        nominal=table.nominal[order],
        scatter=table.scatter[order],
        conditions=tuple(table.conditions[i] for i in order),
    )


values = st.one_of(st.floats(-1e6, 1e6), st.just(np.nan), st.just(np.inf))


@settings(max_examples=60)
@given(st.lists(st.tuples(values, values, values), min_size=1, max_size=6), st.booleans())
def test_no_case_gives_a_number_that_is_none(rows, repeated):
    speeds = [2.0] * len(rows) if repeated else None
    row = evidence(table_of(NAMES, rows, speeds=speeds), NAMES, SCALE)
    assert row.shape == (len(evidence_names(NAMES)),)
    assert row.dtype == np.float32
    assert np.isfinite(row).all()


@settings(max_examples=40)
@given(st.permutations(range(6)), st.integers(0, 100))
def test_the_order_of_recordings_does_not_count(order, seed):
    measured = np.random.default_rng(seed).normal(size=(6, 3))
    measured[1, 2] = np.nan
    table = table_of(NAMES, measured, speeds=[1.0, 2.0, 2.0, 2.0, 3.0, 3.0])
    one, other = (evidence(t, NAMES, SCALE) for t in (table, _ordered(table, order)))
    assert one == pytest.approx(other, rel=1e-5, abs=1e-5)


def test_each_part_says_what_its_name_says():
    measured = [[1.0, 0.0, 0.0], [1.0, 0.0, 5.0], [1.0, 4.0, 5.0], [1.0, 4.0, 5.0]]
    table = table_of(NAMES, measured, scatter=0.0, speeds=[1.0, 2.0, 3.0, 4.0])
    row = evidence(table, NAMES, SCALE)
    assert _part(row, "middle", "contact_peak") == 1.0
    assert _part(row, "sure", "contact_peak") == pytest.approx(2.0)  # four of one, over root four
    assert _part(row, "spread", "contact_peak") == 0.0
    assert _part(row, "largest", "pressure_gain_4") == 4.0
    assert _part(row, "with_speed", "pressure_gain_4") == pytest.approx(4.0)
    assert _part(row, "with_speed", "contact_peak") == pytest.approx(0.0)
    assert row[len(PARTS) * len(NAMES) :][:3] == pytest.approx([4, table.rate, 4])
    assert len(row) == (len(PARTS) + 1) * len(NAMES) + len(CONTEXT) + 3


def test_the_scale_is_what_cases_without_a_cause_scatter_by_beyond_their_repeats():
    rng = np.random.default_rng(1)
    sizes = np.array([0.5, 3.0, 20.0])
    for scatter in (0.0, 0.4):
        tables = [
            table_of(NAMES, sizes * rng.normal(size=(5, 3)), scatter=scatter) for _ in range(200)
        ]
        beyond = np.sqrt(sizes**2 - scatter**2)
        assert scale_of(tables, NAMES) == pytest.approx(beyond, rel=0.15)
    some = scale_of(tables, (*NAMES, "of_nobody"))
    assert np.isfinite(some).all()
    assert (some > 0).all()

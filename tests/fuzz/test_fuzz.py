"""Whatever is damaged is read, or refused in one line, soon and in little memory."""

from __future__ import annotations

import sys

import pytest

from tests.fuzz.calls import CALLS
from tests.fuzz.corpus import corpus
from tests.fuzz.harness import try_inputs
from tests.fuzz.judged import input_of
from tests.fuzz.valid_files import write_valid_files

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="memory is counted as Linux does")

SEED, N = 20, 1000


def findings(inputs):
    *_, tally = try_inputs(inputs)
    assert tally.n == len(inputs)
    return [f"{found.name} ({found.call}): {found.fault}" for found in tally.findings]


def test_no_damaged_file_gives_more_than_one_line():
    failed_once = [entry.input for entry in corpus()]
    assert findings([*failed_once, *((SEED, number) for number in range(N))]) == []


@pytest.mark.slow
def test_no_damaged_file_gives_more_than_one_line_for_long():
    assert findings([(SEED + 1, number) for number in range(100_000)]) == []


def test_the_same_numbers_make_the_same_input(tmp_path):
    write_valid_files(tmp_path)
    made = [[input_of(SEED, number, tmp_path) for number in range(40)] for _ in range(2)]
    assert made[0] == made[1]
    assert len({one.content for one in made[0]}) > 30


def test_every_entry_of_the_corpus_has_a_call():
    assert {entry.input.call for entry in corpus()} <= set(CALLS)

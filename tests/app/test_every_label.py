"""Every label in a recording counts: in the app and on a page of a review, always.

A recording is filtered by each label in it, counted under each, and its title has all of them, that
of its longest segment first; `none` comes last.
"""

from __future__ import annotations

import numpy as np
import pytest

from noise.base.labels import LABELS
from noise.cli import main
from tests.helpers.labelled_folder import made_row, write_folder

MANY = 40
NAMES = [f"run{number:02d}.wav" for number in range(MANY)]


def segments_of(name, rng):
    """Up to six segments of any labels and lengths, one after the other."""
    edges = np.cumsum([0.0, *rng.permutation(np.arange(0.5, 6.0, 0.37))[: rng.integers(1, 7)]])
    spans = zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True)
    return [made_row(name, str(rng.choice(LABELS)), round(a, 3), round(b, 3)) for a, b in spans]


ROWS = {name: segments_of(name, rng) for name, rng in
        zip(NAMES, np.random.default_rng(4).spawn(MANY), strict=True)}  # fmt: skip


def title(name):
    """All labels of a recording, worked out from its segments alone."""
    by_length = sorted(ROWS[name], key=lambda row: row["start_s"] - row["end_s"])
    ordered = list(dict.fromkeys(row["label"] for row in by_length))
    return [label for label in ordered if label != "none"] + ["none"] * ("none" in ordered)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    rows = [row for name in NAMES for row in ROWS[name]]
    return write_folder(tmp_path_factory.mktemp("labels"), NAMES, rows)


def holders(label):
    return [name for name in NAMES if label in title(name)]


def test_on_a_page_of_a_review(browser, folder, tmp_path):
    # The table alone: what stands for recordings in the folder holds no sound.
    table, out = tmp_path / "labels.csv", tmp_path / "review.html"
    table.write_bytes((folder / "labels.csv").read_bytes())
    assert main(["review", str(table), "--out", str(out)]) == 0
    page = browser.new_page()
    page.goto(out.as_uri())
    for label in LABELS:
        button = page.locator(f"[data-show={label}]")
        assert button.inner_text().split() == [label, str(len(holders(label)))]
        button.click()
        cards = page.locator("[data-card]:visible")
        names = cards.locator("h3").all_inner_texts()
        assert sorted(names) == holders(label)
        for number, name in enumerate(names):
            badges = cards.nth(number).locator(".head .badge").all_inner_texts()
            assert [text.strip() for text in badges] == title(name)
    page.close()

"""The README, as somebody follows it who pastes one block after the other into an empty folder."""

import fnmatch
import re

import numpy as np
import pytest

from features.modal.hammer import estimate_transfer_function
from models.radiation.rig_response import impulse_responses
from models.rig_file import load_material_rig
from noise.app import jury
from noise.cli import main
from noise.commands import COMMANDS
from noise.demo import ARM, CASES, N_HITS
from noise.labels import table as label_table
from noise.recordings.hits import find_hits, read_hit
from noise.screening import tables
from tests.helpers.files import csv_rows
from tests.helpers.readme_blocks import (
    PAGES,
    README,
    ROOT,
    blocks,
    paths,
    prose,
    quoted,
    readme,
    walk,
)

BLOCKS = [block for page in (README, *PAGES) for block in blocks(readme(page=page))]
COMMAND_LINES = [line for block in BLOCKS if block.kind == "commands" for line in block.commands]

SCREEN_TABLES = (tables._MAP, tables._CRITICAL, tables._DESIGNS, tables._ADVICE)

DEAR = ("diagnose", "identify", "screen", "thesis", "train")
"""Commands that take a minute or more."""


NAMES = [case.name for case in CASES]


def refused(said):
    return [(" ".join(one.line), one.err) for one in said if one.code != 0]


def missing(folder, said):
    """Files that a command named on its standard output, and that are not there."""
    lines = [(one, line) for one in said for line in one.out.splitlines()]
    named = [(one, line) for one, line in lines if "." in line and "  " not in line]
    return [
        (" ".join(one.line), line)
        for one, line in named
        if one.line[0] not in ("screen", "thesis") and not (folder / line).exists()
    ]


def test_every_command_is_shown():
    assert {line[0] for line in COMMAND_LINES} == set(COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_option_is_one_of_its_command(command, capsys):
    assert main([command, "--help"]) == 0
    explained = capsys.readouterr().out
    given = [word for line in COMMAND_LINES if line[0] == command for word in line]
    assert [w for w in given if w.startswith("--") and w.split()[0] not in explained] == []


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    """The folder, and what the blocks said that were done in it, but for the dear commands."""
    folder = tmp_path_factory.mktemp("readme")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MPLBACKEND", "Agg")  # no window
        return folder, walk(folder, dear=DEAR)


@pytest.fixture
def demo(walked):
    return walked[0] / "bushing-noise-demo"


def test_blocks_run_in_order_from_an_empty_folder(walked):
    folder, said = walked
    assert refused(said) == []
    assert missing(folder, said) == []
    assert len(said) > 8


@pytest.mark.parametrize("page", [README, *PAGES, ROOT / "tests" / "README.md"], ids=str)
def test_links_lead_to_pages_and_headings(page):
    text = readme(page=page)
    for target in re.findall(r"\]\(([^)]+)\)", text):
        file, _, heading = target.partition("#")
        linked = (page.parent / file).resolve() if file else page
        assert linked.is_file(), target
        if heading:
            titles = re.findall(r"^#+ (.*)$", readme(page=linked), re.MULTILINE)
            assert heading in [
                re.sub(r"[^\w -]", "", one.lower()).replace(" ", "-") for one in titles
            ]


def test_the_readme_is_short():
    text = readme()
    assert len(text.encode()) <= 14_000
    paragraphs = [one for one in prose(text).split("\n") if one[:1].isalnum()]
    sentences = [one for part in paragraphs for one in re.split(r"(?<=[.!?:;])\s", part)]
    assert len(sentences) > 40
    assert [one for one in sentences if len(one.split()) > 35] == []


@pytest.mark.parametrize(
    ("page", "columns"),
    [
        ("labels", label_table.COLUMNS),
        ("screening", [name for table in SCREEN_TABLES for name in table]),
        ("app", jury.COLUMNS),
    ],
)
def test_every_column_of_a_table_is_explained(page, columns):
    text = readme(page=ROOT / "noise" / page / "README.md")
    cells = [line.split("|")[1] for line in text.splitlines() if line.startswith("| `")]
    explained = [name for cell in cells for name in re.findall(r"`([^`]+)`", cell)]
    lacking = [c for c in columns if not any(fnmatch.fnmatch(c, name) for name in explained)]
    assert lacking == []


def test_the_folder_holds_what_the_readme_says(demo):
    expected = {"report.html", "labels.csv", "features.csv", "recordings", "audio", "hits"}
    assert {path.name for path in demo.iterdir()} == expected
    for part in ("recordings", "audio"):
        found = {path.name for path in (demo / part).iterdir()}
        assert found == {f"{name}.{ending}" for name in NAMES for ending in ("wav", "json")}


def test_every_recording_carries_its_label_linked_to_its_condition(demo):
    rows = csv_rows(demo / "labels.csv")
    assert [row["file"] for row in rows] == [f"{name}.wav" for name in NAMES]
    assert [row["label"] for row in rows] == NAMES
    for row, case in zip(rows, CASES, strict=True):
        assert float(row["speed_rad_s"]) == pytest.approx(case.speed, rel=0.01)
        assert float(row["interference_mm"]) == pytest.approx(1e3 * case.interference)
        assert float(row["support_stiffness_Nm_rad"]) == case.support_stiffness
        assert row["material"] == case.material
        assert row["calibrated"] == "true"


def test_its_hits_give_the_response_of_the_modelled_structure(demo):
    hits = [read_hit(path, arm=ARM)[0] for path in find_hits([demo / "hits"])]
    assert len(hits) == N_HITS
    found = estimate_transfer_function(hits, input_unit="N m", output_unit="m/s^2")
    paths = impulse_responses(load_material_rig("fluorocarbon"), 0.279e-3, 2214.0, 90e3)
    band = (found.frequencies >= 100.0) & (found.frequencies <= 5000.0)
    n = 1 << 17
    exact = np.interp(
        found.frequencies[band],
        np.fft.rfftfreq(n, 1.0 / paths.rate),
        np.abs(np.fft.rfft(paths.torque_to_acceleration, n)),
    )
    off = 20.0 * np.log10(np.abs(found.response[band]) / exact)
    assert np.median(np.abs(off)) < 0.2
    assert np.median(found.coherence[band]) > 0.98


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.parent.name)
def test_all_blocks_of_a_reference_page_run(page, tmp_path, monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "Agg")
    said = walk(tmp_path, page=page)
    assert refused(said) == []
    assert missing(tmp_path, said) == []


@pytest.mark.slow
def test_all_blocks_run_and_do_what_the_text_says(tmp_path, monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "Agg")
    said = walk(tmp_path)
    assert refused(said) == []
    assert missing(tmp_path, said) == []
    named = [path for path in paths(readme()) if not path.startswith(("tests/", "sim/", "models/"))]
    assert len(named) > 3
    assert [path for path in named if not (tmp_path / path).is_file()] == []
    printed = " ".join(" ".join(one.out.split() + one.err.split()) for one in said)
    phrases = quoted(readme("Find out why a simulation differs"))
    assert len(phrases) >= 3
    assert [phrase for phrase in phrases if phrase not in printed] == []

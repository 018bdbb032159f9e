"""No sentence contradicts the table beside it: pages and terminal output of drawn outcomes."""

from __future__ import annotations

import html
import re
from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from noise.app.jury import VOTES, Jury, in_words, random_pairs, scale
from noise.base.labels import LABELS, NAMED, PERSISTS
from noise.diagnosis.fit.closing import closed_fraction
from noise.diagnosis.outcome import SURE, Agreement, EffectFinding, Location, StageFinding
from noise.diagnosis.sentences import AGREES, answer, finding_of, fit_sentence
from noise.identification.outcome import Identification, LawScore, Number
from noise.labels.summary import result_lines
from noise.pages.cards import draw_entries
from noise.pages.clips import Entry, label_counts, labels_sentence
from noise.pages.diagnosis import write_diagnosis
from noise.pages.identification import write_identification
from noise.screening.grid import Grid
from noise.screening.standing import standing_of
from noise.screening.summary import margin_words, use_words
from sim.analysis.regime import Regime
from tests.helpers.made_diagnoses import KINDS, PARAMETERS, PLACE, STAGES

OUTCOMES = 40
"""Drawn of each kind."""

CHANNELS = ("angle", "torque", "acceleration", "pressure", "torque")
"""Of the stages, in their order."""

SLIDING = Regime.STEADY_SLIDING

TAGS = re.compile(r"<[^>]*>")


class Page:
    """Sentences of a page, and cells of its tables by row."""

    def __init__(self, file):
        text = file.read_text(encoding="utf-8").replace("\u00a0", " ")
        text = text.partition("<body")[2]
        self.rows = [
            [html.unescape(TAGS.sub(" ", cell)) for cell in re.findall(r"<t[hd].*?</t[hd]>", row)]
            for row in re.findall(r"<tr.*?</tr>", text, re.DOTALL)
        ]
        self.facts = [
            html.unescape(TAGS.sub(" ", one))
            for one in re.findall(r"<(?:dd|li)\b.*?</(?:dd|li)>", text, re.DOTALL)
        ]
        self.chain = [
            " ".join(html.unescape(TAGS.sub(" ", one)).split())
            for one in re.findall(r"<li.*?</li>", text.partition('class="chain')[2], re.DOTALL)
        ]
        tables = re.compile(r"<table.*?</table>|<ol class=\"chain.*?</ol>", re.DOTALL)
        self.beside = html.unescape(TAGS.sub(" ", " ".join(tables.findall(text) + self.facts)))
        self.words = [html.unescape(TAGS.sub("", one)) for one in re.findall(r"<p.*?</p>", text)]

    def row(self, name):
        return next(row for row in self.rows if row and row[0].strip().strip("▶ ") == name)


def drawn_diagnosis(kind, rng):
    """A diagnosis of a kind with numbers of its own, those that hang on others as they do."""
    made = replace(KINDS[kind](), illustrations=(), improvement=None)
    n = int(rng.integers(1, 7))
    gaps = rng.lognormal(0.6, 0.8, n)
    found = tuple(
        Agreement(f"run{i}", float(rng.choice([0.5, 1.0, 2.5, 5.0])), 2.79e-4, float(gap),
                  {"torque": float(gap * rng.uniform(0.3, 1.5)), "pressure": float(gap)})
        for i, gap in enumerate(gaps)
    )  # fmt: skip
    stages = {
        name: StageFinding(float(rng.lognormal(0.5, 0.7)), share, float(10.0 ** -rng.uniform(0, 4)))
        for name, share in zip(STAGES, rng.dirichlet(np.full(5, 0.7)).tolist(), strict=True)
    }
    differences = tuple(
        Location(name, (channel,), (1e3 * (1 + i), 2e3 * (1 + i)), "all", "all", stage.p_value)
        for i, ((name, stage), channel) in enumerate(zip(stages.items(), CHANNELS, strict=True))
        if stage.p_value <= SURE
    )
    sure = replace(PLACE, stage=str(rng.choice(list(STAGES))))
    sure = replace(sure, p_value=stages[sure.stage].p_value)
    floor = 1.0
    before = float(rng.uniform(0.8, 12.0))
    recalibrated = before * float(rng.uniform(0.3, 1.0))
    effects = [fitted(one, before, recalibrated, floor, rng) for one in made.effects]
    if kind == "pair":  # of one fit
        effects = [
            replace(effects[0], name=one.name, stage=one.stage, probability=one.probability)
            for one in effects
        ]
    chances = {name: float(rng.uniform(0.0, 1.0)) for name in made.probabilities}
    effects = [replace(one, probability=chances.get(one.name, 0.3)) for one in effects]
    parameters = {
        name: tuple(sorted(1.0 + rng.uniform(-0.2, 0.2, 2))) for name in PARAMETERS
    } if made.parameters else {}  # fmt: skip
    return replace(
        made, agreement=found, stages=stages, location=sure if made.location else None,
        effects=tuple(effects), probabilities=chances, parameters=parameters,
        gap=before, floor=floor, p_value=float(10.0 ** -rng.uniform(0, 4)),
        differences=differences,
    )  # fmt: skip


def fitted(one: EffectFinding, before, recalibrated, floor, rng):
    after = float(rng.uniform(0.2, 1.1) * recalibrated)
    closed = closed_fraction(before, after, floor) if before > 1.1 * floor else None
    own = closed_fraction(recalibrated, after, floor) if recalibrated > 1.1 * floor else None
    spread = sorted(rng.uniform(0.0, 0.2, 2))
    return replace(
        one, gap_before=before, gap_recalibrated=recalibrated, gap_after=after, gap_floor=floor,
        closed=closed, closed_low=None if closed is None else closed - spread[1],
        closed_high=None if closed is None else closed + spread[0], closed_by_effect=own,
    )  # fmt: skip


def printed(diagnosis):
    """Sentences that the command prints."""
    sentences = [*answer(diagnosis)]
    finding = finding_of(diagnosis, diagnosis.verdict[0]) if diagnosis.verdict else None
    if finding is not None:
        sentences.append(fit_sentence(finding))
    return sentences


@pytest.mark.parametrize("kind", KINDS)
def test_numbers_of_a_diagnosis_stand_in_its_tables(kind, tmp_path):
    for seed in range(OUTCOMES):
        diagnosis = drawn_diagnosis(kind, np.random.default_rng([seed, len(kind)]))
        write_diagnosis(tmp_path, diagnosis)
        page = Page(tmp_path / "report.html")
        gaps = [float(page.row(one.recording)[3]) for one in diagnosis.agreement]
        for sentence in (*page.words, *printed(diagnosis)):
            check(sentence, page, diagnosis, gaps)
            check_rows(sentence, page, diagnosis)


def check_rows(sentence, page, diagnosis):
    """Stage, channel and figures of a sentence are those of one row."""
    for stage, share, p_value in re.findall(
        r"in the (\w+) \(([<>]? ?\d+ %) of the gap, (p [=<] [\d.e-]*\d)\)", sentence
    ):
        of_stage = next(one for one in page.chain if one.split()[0] == stage)
        assert f"{share} of all" in of_stage, sentence
        assert p_value in of_stage, sentence
    if found := re.search(r"Farthest is (run\d), most in the (\w+) \(([\d.]+) times\)", sentence):
        heads = [one.strip() for one in page.row("Recording")]
        row = page.row(found[1])
        assert float(row[3]) == max(float(page.row(one.recording)[3])
                                    for one in diagnosis.agreement), sentence  # fmt: skip
        assert row[heads.index(found[2].capitalize())].strip() == found[3], sentence
        assert float(found[3]) == max(float(one) for one in row[4:] if "not" not in one), sentence
    if diagnosis.verdict and (found := re.search(r"together deviate ([\d.]+) times", sentence)):
        whole = next(one for one in page.facts if "Gap before any fit" in one)
        gap = float(re.search(r"[\d.]+", whole)[0])
        assert float(found[1]) == pytest.approx(gap, abs=0.06), sentence


def check(sentence, page, diagnosis, gaps):
    beside = page.beside
    for p_value in (
        () if "p = 0.05 or below" in sentence else re.findall(r"p [=<] [\d.e-]*\d", sentence)
    ):
        assert p_value in beside, sentence
    of_interval = re.search(r"comes out|higher|lower", sentence)
    listed = re.sub(r"90 % interval|parameters explain ([<>] )?\d+ %", "", sentence)
    if diagnosis.verdict == ("unknown",):  # a fit that was tried has bars and no row
        listed = re.sub(r"explains (< )?\d+ % of the deviation( \([^)]*\))?", "", listed)
    if not of_interval:
        for share in re.findall(r"[\d.]+ %", listed):
            assert re.search(rf"(?<![\d.]){re.escape(share)}", beside), (share, sentence)
    for name in PARAMETERS if of_interval else ():
        pattern = rf"{name.replace('_', ' ')} comes out ([\d.]+) to ([\d.]+) % (higher|lower)"
        if found := re.search(pattern, sentence):
            sign = 1.0 if found[3] == "higher" else -1.0
            stated = sorted(1.0 + sign * float(end) / 100.0 for end in found.group(1, 2))
            cell = next(row[1] for row in page.rows if row[0].strip() == name.replace("_", " "))
            table = [float(end) for end in cell.split(" to ")]
            assert stated == pytest.approx(table, abs=0.006), sentence
    reach = r"deviates? ([\d.]+)(?: to ([\d.]+))? times as much as repeat measurements"
    if found := re.search(reach, sentence):
        assert float(found[2] or found[1]) == pytest.approx(max(gaps), abs=0.06), sentence
        assert float(found[1]) == pytest.approx(min(gaps), abs=0.06), sentence
    if found := re.search(r"describes (\w+) of (\d+) recordings", sentence):
        near = sum(one.gap <= AGREES for one in diagnosis.agreement)
        assert (found[1], int(found[2])) == (str(near or "none"), len(gaps)), sentence
    for gap in re.findall(r"([\d.]+) times (?:as much|with it)", sentence):
        numbers = [float(one) for one in re.findall(r"\d+\.\d+|\d+", beside)]
        assert min(abs(float(gap) - one) for one in numbers) < 0.06, sentence
    fit = re.search(r"(?:fit.*?|parameters) explains? (\d+) % of the deviation beyond", sentence)
    if fit and (bars := [row for row in page.rows if row[0].strip() == "what is left"]):
        before, after = float(page.row("nominal model")[1]), float(bars[0][1])
        closable = before - 1.0  # nothing where it is a floor as rounded
        share = min(closable, before - after)
        loose = 0.01 * closable + 0.02  # of the digits that sentence and table have
        best = min(diagnosis.effects, key=lambda one: one.gap_after)
        if best.name == diagnosis.verdict[0] or sentence in page.words:
            assert closable * float(fit[1]) / 100.0 == pytest.approx(share, abs=loose), sentence


def test_numbers_of_an_identification_stand_in_its_tables(tmp_path):
    for seed in range(OUTCOMES):
        rng = np.random.default_rng(seed)
        laws = tuple(
            LawScore(law, *map(float, rng.uniform(0.0, 1.0, 3)), {})
            for law in ("constant", "stribeck", "bristle")
        )
        value = float(rng.uniform(300.0, 900.0))
        stiffness, *torques = (
            Number(name, "Nm/rad", value, 0.95 * value, 1.04 * value, 3, 0.279e-3)
            for name in ("elastomer_stiffness", "critical_torque", "law_critical_torque")
        )
        chosen = str(rng.choice([one.law for one in laws]))
        found = Identification(
            'base = "fluorocarbon"\n', (stiffness, *torques), laws, chosen, (), margin=1.05,
            held_out=("run05.wav",),
        )  # fmt: skip
        write_identification(tmp_path, found)
        page = Page(tmp_path / "report.html")
        law = page.row(chosen)
        (sentence,) = (one for one in page.words if one.startswith("Law of friction:"))
        assert f"leaves {law[2].strip()} % of the oscillation unexplained" in sentence
        assert f"and {law[3].strip()} % of that of recordings" in sentence
        (sentence,) = (one for one in page.words if "stiffness of the elastomer" in one)
        assert f"{value:.4g} Nm/rad" in sentence
        assert sum("critical_torque_Nm of the rig file" in " ".join(row) for row in page.rows) == 1
        in_file = {"constant": "coulomb", "stribeck": "coulomb", "bristle": "stribeck_lorentzian"}
        assert f'law = "{in_file[chosen]}"' in law[5]
        cells = " ".join(page.row("elastomer stiffness"))
        for figure in re.findall(r"\d+\.\d+|\d{2,}", sentence.partition("mm")[2]):
            assert figure in cells, sentence


def test_what_is_said_of_a_design_is_what_its_map_shows():
    kinds = ("none", *NAMED, PERSISTS)
    for seed in range(5 * OUTCOMES):
        rng = np.random.default_rng(seed)
        speed = tuple(np.cumsum(rng.integers(1, 4, rng.integers(1, 9))).astype(float).tolist())
        grid = Grid(speed, (), (2.79e-4, 3.81e-4), (2214.0,), (23.0,), (speed[0], speed[-1]))
        share = rng.dirichlet(np.full(len(kinds), 0.5))
        labels = rng.choice(kinds, grid.shape, p=share)
        head, ranges = use_words(SimpleNamespace(grid=grid, label=labels))
        words = "; ".join([head, *ranges])
        assert words.startswith("quiet in its use") == bool((labels == "none").all()), words
        if found := re.match(r"noisy at (\d+)% of its use", words):
            noisy = np.mean(np.isin(labels, NAMED))
            assert float(found[1]) == pytest.approx(100.0 * noisy, abs=0.51), words
        for name, label in (*((one, one) for one in NAMED), ("goes on,", PERSISTS)):
            there = labels[0, 0] == label
            found = re.search(rf"{name} at (?:(\d+)|< 1)%, ([^;]*)", words)
            assert bool(found) == bool(there.any()), words
            if not found:
                continue
            if found[1]:
                assert float(found[1]) == pytest.approx(100.0 * there.mean(), abs=0.51), words
            # Where it occurs most often, the speeds are the first and last with that label.
            fit, first, last = re.match(
                r"most at ([\d.]+) mm, 2214 Nm/rad: (?:between ([\d.]+) and|at) ([\d.]+) rad/s$",
                found[2],
            ).groups()
            row = [f"{1e3 * one:g}" for one in grid.interference].index(fit)
            at = np.flatnonzero(there[row])
            assert at.size == there.sum(axis=1).max(), words
            assert [float(first or last), float(last)] == [speed[at[0]], speed[at[-1]]], words


def test_the_margin_of_a_design_is_that_of_its_map():
    regimes = [one.value for one in (Regime.STICK_SLIP, Regime.QUASI_HARMONIC, SLIDING)]
    for seed in range(5 * OUTCOMES):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(2, 7))
        speed = tuple(np.cumsum(rng.integers(1, 4, n)).astype(float).tolist())
        fits, supports = (2.79e-4, 3.81e-4), (2214.0, 3745.0)
        use = speed[int(rng.integers(0, 2))], speed[-1]
        grid = Grid(speed, (), fits, supports, (23.0,), use)
        # Nothing at the slowest at times; then stick, vibration and neither, as the speed rises.
        first = int(rng.integers(0, 2))
        edges = np.sort(rng.integers(0, n + 1, (1, 2, 2, 2)), axis=-1)
        edges[edges <= first] = 0
        kinds = (np.arange(n)[:, None] >= edges[..., None, :]).sum(axis=-1)
        kinds[..., :first] = 2
        regime = np.array(regimes)[kinds]
        one = SimpleNamespace(
            design="a", environment="dry", motion="steady", grid=grid, regime=regime,
            growth=np.ones(grid.shape), label=np.where(regime == SLIDING.value, "none", "creak"),
            sound=np.full(grid.shape, "none"), level=np.zeros(grid.shape),
            level_max=np.zeros(grid.shape),
        )  # fmt: skip
        last = edges[0, ..., 1]
        words = margin_words(standing_of(one))
        assert ("does not end within the map" in words) == (last.max() == n)
        # What the margin would be if vibration ended right there, and if it never did.
        low = speed[0] if first else 0.0
        margins = {
            min((max(use[0] - [*speed, end][i], low - use[1]) for i in last[last > 0]), default=0.0)
            for end in (speed[-1], np.inf)
        }
        vibrates = regime[..., grid.used] != SLIDING.value
        everywhere = vibrates.all(axis=-1).any()
        assert ("all speeds of use vibrate" in words) == everywhere
        assert ("would have to be slower by" in words) == (len(margins) > 1 and not everywhere)


def test_the_line_of_a_file_is_its_longest_row():
    for seed in range(OUTCOMES):
        rng = np.random.default_rng(seed)
        ends = np.cumsum(rng.uniform(0.3, 3.0, 4))
        rows = [
            {"file": "a.wav", "label": str(rng.choice((*NAMED, "none"))), "start_s": float(start),
             "end_s": float(end), "frequency_hz": 100.0 * i, "level_dba": 60.0 + i}
            for i, (start, end) in enumerate(zip([0.0, *ends[:-1]], ends, strict=True))
        ]  # fmt: skip
        for line in result_lines(rows):
            label, frequency, level = re.search(r"(\w+) (\d+) Hz +([\d.]+) dB", line).groups()
            row = rows[round(float(level)) - 60]
            assert (row["label"], row["frequency_hz"]) == (label, float(frequency)), line
            assert f"{row['start_s']:.2f}-{row['end_s']:.2f} s" in line


def test_the_words_of_a_jury_are_those_of_its_table():
    for seed in range(OUTCOMES // 5):
        rng = np.random.default_rng(seed)
        pairs = random_pairs("abcdef"[: int(rng.integers(2, 7))], rng)
        votes = rng.choice(list(VOTES), int(rng.integers(1, len(pairs) + 1))).tolist()
        rows = scale(Jury(1, "", "", "", tuple(pairs), tuple(votes)))
        words, placed = in_words(rows), [row for row in rows if row["value"] is not None]
        for place, row in (("first", placed[0]), ("last", placed[-1])):
            if found := re.search(rf"(\w) comes {place}: chosen in (\d+) of (\d+)", words):
                counts = [row[name] for name in ("chosen", "not_chosen", "no_difference")]
                assert (row["sound"], counts[0], sum(counts)) == (
                    found[1], int(found[2]), int(found[3]),
                ), words  # fmt: skip
        first, *others = placed
        close = [row["sound"] for row in others if row["high_95"] >= first["low_95"]]
        if found := re.search(r"Its lead over ([\w, ]+) is not clear", words):
            assert found[1].split(", ") == close
        assert ("clearly ahead" in words) == (not close), words


DRAWS = 500


def drawn_entry(number, rng):
    """An entry of a review with segments in a row, on one track or two."""
    rows = []
    for channel in ("all",) if rng.random() < 0.7 else ("1", "2"):
        edges = np.cumsum([0.0, *rng.uniform(0.2, 3.0, rng.integers(0, 4))])
        rows += [
            {"file": f"run{number}", "channel": channel, "start_s": float(start),
             "end_s": float(end), "label": str(rng.choice(LABELS)), "level_dba": 60.0}
            for start, end in pairwise(edges)
        ]  # fmt: skip
    return Entry(f"run{number}", tuple(rows), duration=12.0, calibrated=False)


def test_the_summary_of_a_review_is_what_its_cards_show():
    for seed in range(DRAWS):
        rng = np.random.default_rng(seed)
        entries = {f"s{n}": drawn_entry(n, rng) for n in range(int(rng.integers(1, 7)))}
        words = labels_sentence(list(entries.values()))
        displays, _ = draw_entries(entries, {})
        bands = [
            band.label for one in displays.values() for _, track in one.tracks for band in track
        ]
        bare = sum(not one.tracks for one in displays.values())
        assert int(re.match(r"(\d+) recording", words)[1]) == len(displays), words
        if bands:
            assert int(re.search(r"with (\d+) segment", words)[1]) == len(bands), words
        for label in LABELS:
            stated = re.search(rf"(\d+) {label}\b", words)
            assert int(stated[1] if stated else 0) == bands.count(label), words
        stated = re.search(r"(\d+) recordings? without a label", words)
        assert int(stated[1] if stated else 0) == bare * bool(bands), words
        for label, number in label_counts(entries.values()):
            cards = [one.labels for one in displays.values()]
            assert number == sum(label in labels if label else not labels for labels in cards)

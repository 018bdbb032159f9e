"""The review page as a file: what is on it, at which gain, how large, and what is refused."""

from __future__ import annotations

import base64
import io
import json
import re

import numpy as np
import pytest
import soundfile

from models.errors import ParameterError
from noise.cli import main
from noise.pages.cards import facts_of
from noise.pages.clips import Entry, Gain, common_gain, make_clips
from noise.pages.review import review
from noise.recordings import write_recording
from tests.helpers.made_reviews import (
    RATE,
    TONE,
    recording,
    row,
    sound,
    write_campaign,
)

TONE_48 = np.sin(2.0 * np.pi * TONE * np.arange(RATE) / RATE).astype(np.float32)


class Page:
    """A page taken apart."""

    def __init__(self, path):
        self.html = path.read_text(encoding="utf-8")
        self.about = json.loads(re.search(r'id="about">(.*?)</script>', self.html, re.S)[1])

    def sound(self, title):
        key = next(key for key, one in self.about.items() if one["title"].startswith(title))
        text = re.search(rf'id="sound-{key}"[^>]*>(.*?)</script>', self.html, re.S)[1]
        return soundfile.read(io.BytesIO(base64.b64decode(text)))


@pytest.fixture
def campaign(tmp_path):
    return write_campaign(tmp_path / "day1")


def level(samples):
    return 20.0 * np.log10(np.sqrt(np.mean(samples**2)))


def test_sounds_keep_their_levels_to_one_another_and_to_the_stated_full_scale(campaign):
    page = Page(review(campaign, campaign / "review.html").path)
    (creak, rate), (squeal, _) = (page.sound(f"recordings/{k}") for k in ("creak", "squeal"))
    full_scale = float(re.search(r"full scale = ([\d.]+) Pa", page.html)[1])
    assert rate == RATE
    inside = slice(RATE // 10, RATE)
    for heard, kind in ((creak, "creak"), (squeal, "squeal")):
        wanted = level(sound(kind)[inside])
        assert level(heard[inside] * full_scale) == pytest.approx(wanted, abs=0.02)


def test_what_is_not_calibrated_has_a_gain_of_its_own_and_says_so(tmp_path, campaign):
    write_recording(campaign / "phone.wav", recording("hiss", calibrated=False))
    soundfile.write(campaign / "phone.flac", 0.01 * sound("squeal"), RATE)
    page = Page(review(campaign, tmp_path, classify=False).path)
    assert "are not calibrated: how loud they were is not known" in page.html
    assert np.abs(page.sound("phone.wav")[0]).max() > 0.9
    assert np.abs(page.sound("recordings/creak")[0]).max() > 0.7


def test_of_many_recordings_shorter_stretches_are_played(tmp_path):
    for i in range(3):
        write_recording(tmp_path / "runs" / f"run{i}.wav", recording("hiss", seconds=3.2))
    whole = review(tmp_path / "runs", tmp_path / "whole.html", classify=False)
    short = review(tmp_path / "runs", tmp_path / "short.html", classify=False, megabytes=0.9)
    assert whole.longest == 10.0
    assert short.path.stat().st_size <= 0.9e6 < whole.path.stat().st_size
    page = Page(short.path)
    assert f"{short.longest:.2f}".rstrip("0") + " s from 0 s of 3.2 s" in page.html
    assert page.sound("run0")[0].size == round(short.longest * RATE)
    with pytest.raises(ParameterError, match=r"3 sounds of 1 s each do not fit.*need 0\.6 MB"):
        review(tmp_path / "runs", tmp_path / "none.html", classify=False, megabytes=0.4)


def test_of_a_long_recording_the_stretch_that_names_it_is_played(tmp_path):
    samples = recording("none", seconds=30.0)
    samples.samples[0, 20 * RATE : 22 * RATE] = sound("squeal", 2.0)
    write_recording(tmp_path / "long.wav", samples)
    table = [row("long.wav", "none", 0.0, 20.0), row("long.wav", "squeal", 20.0, 22.0)]
    (tmp_path / "labels.jsonl").write_text("\n".join(map(json.dumps, table)), encoding="utf-8")
    page = Page(review(tmp_path, tmp_path / "out", seconds=4.0).path)
    assert "4 s from 19 s of 30 s; labelled by the table" in page.html
    heard, _ = page.sound("long.wav")
    assert np.abs(heard[RATE + 100 : 3 * RATE - 100]).max() > 0.9
    assert np.abs(heard[: RATE // 2]).max() < 0.01
    assert 'class="band filled squeal lines"' in page.html
    assert (
        'title="squeal, 20 to 22 s" aria-label="squeal, 20 to 22 s" style="left: 25.0%' in page.html
    )


def test_what_no_table_labels_is_labelled_for_the_page_unless_told_not_to(tmp_path):
    write_recording(tmp_path / "run.wav", recording("squeal"))
    named = review(tmp_path / "run.wav", tmp_path / "a.html").path.read_text(encoding="utf-8")
    bare = review(tmp_path / "run.wav", tmp_path / "b.html", classify=False)
    assert "labelled for this page" in named
    assert "not labelled" in bare.path.read_text(encoding="utf-8")


def test_with_a_table_alone_the_recordings_below_its_folder_are_shown(campaign):
    made = review(campaign / "labels.csv", campaign / "review.html")
    assert made.sounds == 3
    assert made.refused == ()
    assert "labelled by the table" in Page(made.path).html


def test_recordings_of_the_same_name_are_told_apart_by_their_folders(tmp_path):
    for folder in ("old", "new"):
        write_recording(tmp_path / folder / "run.wav", recording("squeal"))
    made = review([tmp_path / "old", tmp_path / "new"], tmp_path / "out", classify=False)
    assert {one["title"] for one in Page(made.path).about.values()} == {
        str(tmp_path / folder / "run.wav") for folder in ("old", "new")
    }


def test_a_bad_file_is_named_on_the_page_and_the_exit_code_is_1(campaign, capsys):
    (campaign / "recordings" / "broken.wav").write_bytes(b"no sound")
    (campaign / "bad.csv").write_text("file,label\na.wav,bang\n", encoding="utf-8")
    assert main(["review", str(campaign), "--out", str(campaign / "out")]) == 1
    told = capsys.readouterr()
    page = Page(campaign / "out" / "report.html")
    assert told.out.split() == [str(campaign / "out" / "report.html")]
    for name in ("broken.wav", "bad.csv"):
        assert name in told.err
        assert re.search(rf"Not on this page.*{name}</b>: \w+", page.html, re.S)
    assert len(page.about) == 3


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        ("table.csv", "file,rms\na.wav,1\n", "has no column"),
        ("labels.csv", "file,label\na.wav,bang\n", "bang"),
        ("page.html", "<html>", "has no ending of a recording"),
    ],
)
def test_a_named_file_that_is_not_what_it_says_is_refused(campaign, name, content, reason):
    (campaign / "other").mkdir()
    path = campaign / "other" / name
    path.write_text(content, encoding="utf-8")
    made = review([campaign / "recordings", path], campaign / "review.html", classify=False)
    (refusal,) = made.refused
    assert refusal.name == str(path)
    assert reason in refusal.reason
    assert made.sounds == 3


def test_where_nothing_can_be_used_the_call_is_refused(tmp_path, capsys):
    (tmp_path / "broken.wav").write_bytes(b"no sound")
    (tmp_path / "empty").mkdir()
    out = str(tmp_path / "out")
    assert main(["review", str(tmp_path / "broken.wav"), "--out", out]) == 2
    assert main(["review", str(tmp_path / "empty"), "--out", out]) == 2
    assert main(["review", str(tmp_path / "gone"), "--out", out]) == 2
    told = capsys.readouterr().err
    assert "there is nothing else" in told
    assert "there are no recordings" in told
    assert "no such file" in told
    assert not (tmp_path / "out").exists()


def test_inferred_bounds_stand_in_plain_digits_and_say_what_is_assumed():
    told = row("run.wav", "squeal", speed_rad_s=None, material=None, material_source="missing") | {
        "support_stiffness_Nm_rad": 4763.6, "support_stiffness_Nm_rad_low": 2703.6,
        "support_stiffness_Nm_rad_high": 12345.6, "support_stiffness_Nm_rad_source": "inferred",
    }  # fmt: skip
    facts = facts_of(Entry("run.wav", (told,)))
    assert facts["stiffness"] == "2700 to 12000 Nm/rad (inferred)"
    assert facts["material"] == "assuming a fluorocarbon bushing like the shipped one"


def test_two_sounds_of_one_title_neither_clip_nor_wrap_whichever_is_louder():
    quiet, loud = (Entry("run", duration=1.0, sound=np.float32(a) * TONE_48) for a in (0.01, 3.0))
    for entries in ({"s1": loud, "s2": quiet}, {"s1": quiet, "s2": loud}):
        gain = common_gain(entries.values())
        clips = make_clips(entries, gain)
        for key, entry in entries.items():
            heard, _ = soundfile.read(io.BytesIO(clips[key].flac))
            assert gain.calibrated * heard == pytest.approx(
                entry.sound, abs=gain.calibrated / 2**15
            )


def test_a_sound_beyond_full_scale_is_clipped_and_does_not_wrap():
    clips = make_clips({"s1": Entry("run", duration=1.0, sound=2.0 * TONE_48)}, Gain(1.0, None))
    heard, _ = soundfile.read(io.BytesIO(clips["s1"].flac))
    assert np.abs(heard - np.clip(2.0 * TONE_48, -1.0, 1.0)).max() < 2.0**-14

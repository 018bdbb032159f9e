"""The row that names a recording, where several are as long."""

from __future__ import annotations

from noise.labels.summary import naming_row, result_lines


def track(channel, label, p, **more):
    row = {"file": "a.wav", "channel": channel, "label": label, "start_s": 0.0, "end_s": 2.0}
    return row | {f"p_{label}": p, "level_dba": 60.0 + p} | more


def test_of_tracks_of_one_length_the_surest_names_the_file_and_a_person_before_it():
    unsure, sure = track("1", "squawk", 0.55), track("2", "squeal", 0.97)
    assert naming_row([unsure, sure]) is sure
    assert next(result_lines([unsure, sure])).startswith("a.wav  squeal")
    by_hand = track("1", "creak", 0.01, label_source="human")
    assert naming_row([by_hand, sure]) is by_hand
    longer = track("1", "squawk", 0.55, end_s=3.0)
    assert naming_row([longer, sure]) is longer

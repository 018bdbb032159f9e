"""What ``bushing-noise diagnose`` prints, held against what other programs rely on."""

from __future__ import annotations

import json

KEYS = {
    "verdict", "equivalent", "location", "stages", "effects", "parameters", "next_measurement",
    "held_out", "seconds",
}  # fmt: skip
LOCATION = {"stage", "channels", "band_hz", "phase", "conditions", "p_value"}
EFFECT = {
    "name", "stage", "probability", "parameters", "gap_before", "gap_recalibrated", "gap_after",
    "gap_floor", "closed", "closed_low", "closed_high", "closed_by_effect",
}  # fmt: skip
STAGES = ["drive", "friction", "structure", "radiation", "measurement"]


def as_the_contract_has_it(told):
    assert set(told) >= KEYS
    assert list(told["stages"]) == STAGES
    for stage in told["stages"].values():
        assert set(stage) >= {"gap", "share", "p_value"}
        assert 0.0 <= stage["share"] <= 1.0
        assert 0.0 < stage["p_value"] <= 1.0
    assert told["location"] is None or set(told["location"]) >= LOCATION
    assert told["effects"]
    for effect in told["effects"]:
        assert set(effect) >= EFFECT
        assert effect["stage"] in STAGES
        assert 0.0 <= effect["probability"] <= 1.0
    chances = [effect["probability"] for effect in told["effects"]]
    assert chances == sorted(chances, reverse=True)
    assert isinstance(told["next_measurement"], str)
    assert told["seconds"] > 0.0
    for low, high in told["parameters"].values():
        assert 0.0 < low <= high
    text = json.dumps(told)
    assert "NaN" not in text
    assert "Infinity" not in text

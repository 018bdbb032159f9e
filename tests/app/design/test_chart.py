"""Maps of the design view as the page asks for them: coarse first, then finer."""

from __future__ import annotations

import re
import time

from tests.helpers.opened_app import PATIENCE

DESIGN = {"base": "PDMS", "values": {}}


def answered(app, path, body):
    """Poll as the page does until the answer is known."""
    end = time.monotonic() + 4 * PATIENCE
    while not (answer := app.json(f"api/design/{path}", body))["known"]:
        assert time.monotonic() < end
        time.sleep(0.2)
    return answer


def test_a_map_comes_from_a_process_beside_the_sound(app):
    coarse = answered(app, "chart", DESIGN | {"detail": 0})
    assert (coarse["error"], coarse["found"]["legend"]) == (
        "",
        "none everywhere: no creak, squawk or squeal",
    )
    low, high = re.search(r'data-speed="([\d.]+) ([\d.]+)"', coarse["found"]["html"]).groups()
    assert float(low) < 2.0 < 10.0 < float(high)

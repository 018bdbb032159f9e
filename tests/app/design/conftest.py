"""A rig file that is opened, for what drives the design view in a browser."""

from __future__ import annotations

import pytest

from tests.helpers.opened_app import served_app


@pytest.fixture
def app(tmp_path):
    rig = tmp_path / "mine.toml"
    rig.write_text('base = "fluorocarbon"\n[change]\ndamping = "x1.1"\n', encoding="utf-8")
    with served_app(rig) as running:
        yield running

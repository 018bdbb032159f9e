"""A folder of three tones, and the app that it is opened in."""

import pytest

from tests.helpers.opened_app import served_app
from tests.helpers.recording_page import write_sounds


@pytest.fixture
def folder(tmp_path):
    return write_sounds(tmp_path)


@pytest.fixture
def app(browser, folder):
    with served_app(folder) as running:
        yield running

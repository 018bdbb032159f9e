"""A browser for the tests of a file."""

import pytest

from tests.helpers.browser import chromium


@pytest.fixture(scope="module")
def browser():
    with chromium() as started:
        yield started

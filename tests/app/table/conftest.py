"""A folder of what stands for recordings, without a label table and with one."""

import pytest

from tests.helpers.corrected_table import NAMES
from tests.helpers.labelled_folder import made_row as row, write_folder


@pytest.fixture
def folder(tmp_path):
    return write_folder(tmp_path, NAMES)


@pytest.fixture
def tabled(folder):
    return write_folder(folder, NAMES, [row(name) for name in NAMES])

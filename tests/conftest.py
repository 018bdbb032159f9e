"""Settings of the whole test run."""

import gc
import os
import sys
from pathlib import Path

import pytest
from hypothesis import settings

# Before NumPy is loaded: each core has a test of its own, and threads of BLAS that wait for one
# another by counting would cost several times what they compute.
for _variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")

# Processes that tests start take the compiled modules of the first that needed them.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# On a server the same examples every time; at a desk new ones in each run. No example has a time
# limit: how long one takes says how busy the machine is.
settings.register_profile("server", derandomize=True, deadline=None, max_examples=30)
settings.register_profile("desk", deadline=None, max_examples=30)
settings.load_profile("server" if os.environ.get("CI") else "desk")


HERE = Path(__file__).parent
MAINTENANCE = [HERE / "exam", HERE / "training", HERE.parent / "noise" / "training"]


def pytest_ignore_collect(collection_path, config):
    """Load no file all of whose tests the marks leave out, unless it is named."""
    left_out = config.option.markexpr
    unwanted = any(collection_path.is_relative_to(folder) for folder in MAINTENANCE)
    if "not maintenance" in left_out and unwanted:
        return True
    if "not browser" in left_out and collection_path.match("*_in_browser.py"):
        return True
    return None


@pytest.hookimpl(wrapper=True)
def pytest_collect_file():
    """Look for tests alone: there are no examples here, and what helps tests is loaded by them."""
    return [found for found in (yield) if type(found) is pytest.Module]


@pytest.hookimpl(tryfirst=True)  # before those are left out that were not asked for
def pytest_collection_modifyitems(items):
    """Mark what drives a browser, and what only maintainers run."""
    for item in items:
        if any(item.path.is_relative_to(folder) for folder in MAINTENANCE):
            item.add_marker(pytest.mark.maintenance)
        if "browser" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.browser)


def pytest_collection(session):
    """Keep what is collected, which stays, out of the search for garbage."""
    gc.disable()


def pytest_collection_finish(session):
    gc.collect()
    gc.freeze()
    gc.enable()


@pytest.fixture(scope="module")
def browser():
    """Start a browser for the tests of a file; they skip where there is none."""
    from tests.helpers.browser import chromium

    with chromium() as started:
        yield started

"""Settings of the whole test run."""

import os

from hypothesis import settings

# On a server the same examples every time; at a desk new ones in each run.
settings.register_profile("server", derandomize=True)
if os.environ.get("CI"):
    settings.load_profile("server")

"""The local app in a process of its own, as ``bushing-noise open`` starts it."""

from __future__ import annotations

import json
import multiprocessing
import signal
import subprocess
import sys
import urllib.error
import urllib.request
from contextlib import contextmanager
from functools import cache
from typing import TYPE_CHECKING

from noise.app.opened import open_paths

if TYPE_CHECKING:
    from collections.abc import Iterator

PATIENCE = 30.0
"""Nothing that a test waits for takes longer [s]."""


class OpenedApp:
    """A server that runs, and requests to it."""

    def __init__(self, process, address):
        self.process = process
        self.address = address
        self.base, _, token = address.partition("/?token=")
        self.token = token

    def request(self, path, body=None, token=None, **headers):
        """Status and body of the answer to GET, or to POST where there is a body."""
        token = self.token if token is None else token
        url = f"{self.base}/{path}{'&' if '?' in path else '?'}token={token}"
        data = None if body is None else json.dumps(body).encode()
        asked = urllib.request.Request(url, data, headers, method="POST" if data else "GET")
        try:
            with urllib.request.urlopen(asked, timeout=PATIENCE) as answer:
                return answer.status, answer.read()
        except urllib.error.HTTPError as refused:
            return refused.code, refused.read()

    def json(self, path, body=None):
        """Body of an answer that has to be good."""
        status, said = self.request(path, body)
        assert status == 200, said
        return json.loads(said)

    def correct(self, number, label, start, end):
        """Say that one segment is all there is of a recording, as it is shown now."""
        path = f"api/recordings/{number}/segments"
        row = {"start_s": start, "end_s": end, "label": label, "label_source": "human"}
        return self.json(path, {"rows": [row], "version": self.json(path)["version"]})

    def kill(self):
        """End it as the system does that has no memory left."""
        self.process.kill()
        self.process.wait()


@contextmanager
def opened_app(*arguments) -> Iterator[OpenedApp]:
    """Start ``bushing-noise open``, and end it after the test."""
    command = [sys.executable, "-m", "noise", "open", "--no-browser", *map(str, arguments)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            yield OpenedApp(process, process.stdout.readline().strip())
        finally:
            if process.poll() is None:
                process.terminate()
                process.wait(PATIENCE)


@contextmanager
def served_app(*paths, save=None) -> Iterator[OpenedApp]:
    """Serve paths in a process that needs no time to start, and end it after the test."""
    app = started_app(*paths, save=save)
    try:
        yield app
    finally:
        app.process.terminate()
        app.process.join(PATIENCE)


def started_app(*paths, save=None):
    """Serve paths in a process that has read the program already; who starts it ends it."""
    hears, told = _processes().Pipe(duplex=False)
    process = _processes().Process(target=_served, args=(paths, save, told))
    process.start()
    told.close()  # so that what it dies of is no waiting
    return OpenedApp(process, hears.recv())


@cache
def _processes():
    context = multiprocessing.get_context("forkserver")
    views = [f"noise.app.{v}" for v in ("sounds", "label_view", "design_view", "jury_view")]
    context.set_forkserver_preload(["noise.app.server", *views, "uvicorn"])
    return context


def _served(paths, save, told):
    from noise.app.server import serve

    # Another test may have started the server of these processes with interrupts blocked.
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    serve(open_paths(paths, save=save), 0, told.send)

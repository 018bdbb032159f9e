"""Who gets an answer from the app, and to what; how it ends."""

from __future__ import annotations

import http.client
import json
import os
import signal
import subprocess
import sys
from urllib.parse import urlsplit

import pytest

from noise.cli import main
from tests.helpers.labelled_folder import made_row, write_folder
from tests.helpers.opened_app import PATIENCE, served_app, started_app

NAMES = ("a.wav", "b.wav", "<img src=x onerror=alert(1)>.wav")


@pytest.fixture(scope="module")
def app(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recordings")
    rows = [
        made_row("a.wav", "creak", 0.0, 1.0, level_dba=60.0, p_none=float("nan")),
        made_row("a.wav", "squeal", 1.0, 3.0, level_dba=50.0, support_stiffness_Nm_rad=1e999),
        made_row("b.wav", "none", level_dba=40.0),
    ]
    write_folder(folder, NAMES, rows)
    (folder.parent / "secret.wav").write_bytes(b"secret")
    with served_app(folder) as running:
        yield running


def listed(app, query):
    return [one["name"] for one in app.json(f"api/recordings?{query}")["rows"]]


@pytest.mark.parametrize(
    "path", ["", "api/recordings", "static/api.js", "api/recordings/0/segments"]
)
@pytest.mark.parametrize(
    "said",
    [
        {"token": ""},
        {"token": "x"},
        {"Host": "bushing.example"},
        {"Host": "127.0.0.1"},
        {"Origin": "http://bushing.example"},
        {"Origin": "null"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Cookie": "bushing-noise=x", "token": ""},
        {"Page-Token": "x"},
    ],
)
def test_what_does_not_come_from_the_printed_address_gets_nothing(app, path, said):
    status, answer = app.request(path, **said)
    assert status == 403
    assert answer.startswith(b"refused: wrong ")


def test_the_page_gets_answers_by_its_cookie_beside_those_of_other_programs(app):
    port = urlsplit(app.base).port
    where = urlsplit(app.base)
    for others, status in (("a,b=c; x", 200), ("", 200), (f"bushing-noise-{port}=x; ", 403)):
        asked = http.client.HTTPConnection(where.hostname, where.port, timeout=PATIENCE)
        cookie = f"{others}; bushing-noise-{port}={app.token}"
        asked.request("GET", "/api/recordings", headers={"Cookie": cookie})
        assert asked.getresponse().status == status


def test_a_correction_from_another_site_changes_nothing(app):
    before = app.json("api/recordings/1/segments")
    row = {"start_s": 0.0, "end_s": 1.0, "label": "creak"}
    rows = {"rows": [row], "version": before["version"]}
    assert app.request("api/recordings/1/segments", rows, token="x")[0] == 403
    assert app.request("api/recordings/1/segments", rows, Origin="http://x.example")[0] == 403
    assert app.json("api/recordings/1/segments") == before


@pytest.mark.parametrize(
    "path",
    [
        "static/../gate.py",
        "static/..%2fgate.py",
        "static/%2e%2e/gate.py",
        "static//etc/passwd",
        "../secret.wav",
        "a.wav",
        "labels.csv",
        "api/recordings/..%2f..%2fsecret.wav/segments",
        "api/recordings/9/segments",
        "api/recordings/-1/segments",
        "api/recordings/99999999999999999999/segments",
    ],
)
def test_nothing_but_what_was_opened_is_served(app, path):
    where = urlsplit(app.base)
    asked = http.client.HTTPConnection(where.hostname, where.port, timeout=PATIENCE)
    asked.request("GET", f"/{path}?token={app.token}")  # as it is written, without being resolved
    answer = asked.getresponse()
    assert answer.status in (400, 404)
    assert len(answer.read()) < 200


def test_a_recording_is_found_under_every_label_in_it(app):
    answer = app.json("api/recordings?label=creak")
    assert [one["name"] for one in answer["rows"]] == ["a.wav"]
    assert answer["rows"][0]["label"] == "squeal"
    assert answer["rows"][0]["labels"] == ["squeal", "creak"]
    assert answer["counts"]["creak"] == answer["counts"]["squeal"] == 1
    assert listed(app, "label=squeal") == ["a.wav"]
    assert listed(app, "label=unlabelled") == [NAMES[2]]


def test_the_list_is_sorted_with_nothing_last(app):
    assert listed(app, "sort=level&order=asc") == ["b.wav", "a.wav", NAMES[2]]
    assert listed(app, "sort=level&order=desc") == ["a.wav", "b.wav", NAMES[2]]
    assert listed(app, "text=A.W&sort=name") == ["a.wav"]


@pytest.mark.parametrize("query", ["label=hiss", "sort=size", "order=up"])
def test_what_is_asked_wrongly_is_said_in_one_line(app, query):
    status, said = app.request(f"api/recordings?{query}")
    assert status == 400
    assert query.split("=")[0] in json.loads(said)["error"]


def test_labelling_for_unknown_surroundings_is_refused(app):
    status, said = app.request("api/label", {"surroundings": "moon"})
    assert status == 400
    assert "any, car, rig" in json.loads(said)["error"]


def test_numbers_that_are_none_are_no_json(app):
    def refuse(word):
        raise AssertionError(word)

    (shown,) = app.json("api/recordings?text=a.wav")["rows"]
    _, said = app.request(f"api/recordings/{shown['id']}/segments")
    rows = json.loads(said, parse_constant=refuse)["rows"]
    assert [row["support_stiffness_Nm_rad"] for row in rows] == [None, "fixed"]


@pytest.mark.parametrize(
    "body", [b"{", b"[]", b"[" * 100_000, b"\xff", b'"' + b"x" * (5 << 20) + b'"']
)
def test_a_body_that_is_none_is_refused_and_the_server_lives(app, body):
    where = urlsplit(app.base)
    asked = http.client.HTTPConnection(where.hostname, where.port, timeout=PATIENCE)
    asked.request("POST", f"/api/undo?token={app.token}", body)
    assert asked.getresponse().status == 400
    assert app.json("api/recordings")["state"]["total"] == 3


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, "button"])
def test_it_ends_when_told_by_button_key_or_terminal(tmp_path, end):
    app = started_app(write_folder(tmp_path, ("a.wav",)))
    if end == "button":
        assert app.json("api/stop", {}) == {"stopped": True}
    else:
        os.kill(app.process.pid, end)
    app.process.join(PATIENCE)
    assert app.process.exitcode == 0


def test_the_address_is_there_before_the_simulator_is_loaded(tmp_path):
    loaded = "import sys, noise.app.server, noise.app.opened as o; a = noise.app.server.create_app("
    loaded += "o.open_paths([]), 't', 1); print(any(m.split('.')[0] == 'sim' for m in sys.modules))"
    done = subprocess.run(
        [sys.executable, "-c", loaded], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.stdout == "False\n"


def test_a_rig_that_cannot_be_is_refused_before_anything_is_served(tmp_path, capsys):
    rig = tmp_path / "wrong.toml"
    rig.write_text('base = "granite"\n', encoding="utf-8")
    assert main(["open", "--no-browser", str(rig)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "granite" in err

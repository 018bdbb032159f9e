"""The list of recordings in a browser: filter, find, order, scroll, keys; names that are markup."""

from __future__ import annotations

import numpy as np
import pytest

from models.recording import Channel, Recording
from noise.recordings import write_recording
from tests.helpers.labelled_folder import many_rows, write_folder
from tests.helpers.opened_app import served_app

MANY = 1000
EVIL = "<img src=x onerror=alert(1)>.wav"
MOUNT = """async () => {
  const { mountList } = await import("/static/labels/list.js");
  const holder = document.createElement("div");
  holder.style.height = "100%";
  document.getElementById("view-labels").replaceChildren(holder);
  window.opens = [];
  window.list = await mountList(holder, { onOpen: (id) => opens.push(id), onSeen: () => {} });
}"""
STYLE_ALONE = """
import { stylesheet } from "../dom.js";
export function mount() { stylesheet(new URL("./list.css", import.meta.url)); return {}; }"""
ROW = ".rows [role=option]:visible"
CHOSEN = ".rows [aria-selected=true]"


def written(folder, number):
    names = [EVIL, *(f"run{n:04d}.wav" for n in range(1, number))]
    return write_folder(folder, names, many_rows(names[1:], np.random.default_rng(0)))


@pytest.fixture(scope="module")
def app(tmp_path_factory):
    with served_app(written(tmp_path_factory.mktemp("many"), MANY)) as running:
        yield running


def mounted(browser, app, width=1280):
    """Open the page with nothing but the list in it."""
    page = browser.new_page(viewport={"width": width, "height": 800})
    page.set_default_timeout(120_000)  # labelling begins late where other work goes on
    page.complaints = []
    page.on("console", lambda message: page.complaints.append(message.text))
    page.on("pageerror", lambda error: page.complaints.append(str(error)))
    page.on("dialog", lambda dialog: page.complaints.append(dialog.message))
    # The view itself would open the first recording, which is none, at a time of its own.
    script = {"body": STYLE_ALONE, "content_type": "text/javascript"}
    page.route("**/static/labels/view.js", lambda route: route.fulfill(**script))
    page.goto(app.address)
    page.wait_for_function("() => document.querySelector('#view-labels:not([hidden])')")
    page.evaluate(MOUNT)
    page.wait_for_selector(f"{ROW} >> text=.wav")
    return page


@pytest.fixture
def page(browser, app):
    fresh = mounted(browser, app)
    yield fresh
    assert fresh.complaints == []
    fresh.close()


def shown(page):
    return [text.strip() for text in page.locator(ROW).all_text_contents()]


def test_a_name_is_found_and_one_that_is_markup_harms_nobody(page):
    page.get_by_role("searchbox").fill("onerror")
    page.wait_for_function("() => list.rows.length === 1")
    assert shown(page)[0].startswith(EVIL)
    assert page.locator("img").count() == 0


def test_keys_go_through_the_list_and_open(page):
    page.get_by_role("listbox").focus()
    for key in ("ArrowDown", "ArrowDown", "Enter", "End", "Enter"):
        page.keyboard.press(key)
    page.wait_for_function("() => opens.length === 2")
    assert page.evaluate("opens") == [2, MANY - 1]
    page.locator(CHOSEN).filter(has_text="run0999.wav").wait_for()


def test_labels_arrive_while_they_are_computed_and_the_table_holds_them(browser, tmp_path):
    hiss = np.random.default_rng(0).normal(size=(1, 8000))
    for name in ("a", "b"):
        write_recording(tmp_path / f"{name}.wav", Recording(hiss, 16_000.0, (Channel("pressure"),)))
    write_folder(tmp_path, ("bad.wav",))
    with served_app(tmp_path) as app:
        page = mounted(browser, app)
        app.correct(1, "creak", 0.0, 0.5)
        page.get_by_label("Where the sounds were recorded").select_option("car")
        page.get_by_role("button", name="Label 3", exact=True).click()
        page.wait_for_selector(f"{ROW} >> text=refused")
        page.wait_for_function("() => !list.running")
        texts = shown(page)
        assert "creak, corrected" in texts[1]
        assert any(label in texts[0] for label in ("none", "unknown"))
        assert app.json("api/recordings")["state"]["done"] == 3
        page.close()
    table = tmp_path.with_name(f"{tmp_path.name}-labels.csv").read_text().splitlines()
    assert len(table) == 4

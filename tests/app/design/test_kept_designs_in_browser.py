"""What outlives a reload, another base or a press in the design view, and what is saved."""

from __future__ import annotations

from tests.helpers.design_page import DESIGN, DesignPage


def test_a_reload_keeps_both_designs(browser, app):
    opened = DesignPage(browser, app)
    opened.type("speed", 7.5)
    opened.page.get_by_text("Friction law", exact=True).click()
    opened.page.locator("#design-law").select_option("lugre")
    opened.page.get_by_role("button", name="B", exact=True).click()
    opened.choose_base("PDMS")
    opened.type("change-wall", 1.25)
    stated = opened.page.evaluate(f"{DESIGN}.both()")
    assert stated["A"]["values"] == {"speed": 7.5, "law": "lugre"}
    assert stated["B"]["base"] == "PDMS"
    opened.reload()
    assert opened.page.evaluate(f"{DESIGN}.both()") == stated
    assert opened.page.locator("#view-design .slot[aria-pressed=true]").inner_text() == "B"
    assert (opened.value("base"), opened.value("change-wall")) == ("PDMS", "1.25")
    opened.page.get_by_role("button", name="A", exact=True).click()
    opened.until("document.querySelector('#design-law').value === 'lugre'")
    assert (opened.value("base"), opened.value("speed")) == ("rig 0", "7.5")
    opened.close()


def test_another_base_keeps_the_condition_and_tells_what_it_drops(browser, app):
    opened = DesignPage(browser, app)
    condition = {"speed": "7.5", "interference": "0.3", "support": "3745", "temperature": "40"}
    for key, value in condition.items():
        opened.type(key, value)
    opened.type("change-damping", 1.5)
    before = opened.page.evaluate(f"{DESIGN}.stated()")
    opened.choose_base("PDMS")
    opened.page.get_by_text("Dropped with mine.toml: Damping 1.5 x.").wait_for()
    assert {key: opened.value(key) for key in condition} == condition
    assert opened.value("change-damping") == "1"
    opened.type("change-wall", 1.25)
    after = opened.page.evaluate(f"{DESIGN}.stated()")
    opened.page.get_by_role("button", name="Undo").click()
    opened.page.get_by_text("Undone.").wait_for()
    assert opened.page.evaluate(f"{DESIGN}.stated()") == before
    assert (opened.value("base"), opened.value("change-damping")) == ("rig 0", "1.5")
    opened.page.get_by_role("button", name="Redo").click()
    opened.page.get_by_text("Redone.").wait_for()
    assert opened.page.evaluate(f"{DESIGN}.stated()") == after
    opened.close()

"""Tests of all pages of the site in Chromium."""

from __future__ import annotations

import itertools

import pytest

from reports.site.folder import compressed_size
from reports.site.lessons import LESSONS
from tests.reports.site_in_browser import FIXTURES, PHONE, marked, new_page

address, chromium, files, opened, running = FIXTURES


@pytest.mark.parametrize("stride", [4, pytest.param(1, marks=pytest.mark.slow)])
def test_every_page_loads_without_errors_and_fits_a_phone(files, opened, stride):
    """Open every lesson and every fourth of the other pages; the slow test opens all pages."""
    names = sorted(name for name in files if name.endswith(".html") and not name.startswith("reference/"))
    lessons = [name for name in names if name.startswith("lessons/")]
    for name in dict.fromkeys([*lessons, *names[::stride]]):
        page = opened(name, viewport=PHONE)
        assert page.title()
        page.evaluate("document.querySelectorAll('main details').forEach((each) => { each.open = true; })")
        wide = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
        assert wide <= 0, f"{name} is wider than a phone by {wide} px"
        page.context.close()


SMALL = """() => [...document.querySelectorAll('#lesson :is(button, select, input, summary, .drag)')]
  .flatMap((each) => {
  const target = each.matches('[type=checkbox]') ? each.closest('label') : each;
  const { height, width } = target.getBoundingClientRect();
  return width && height < 24 ? [`${target.outerHTML.slice(0, 80)}: ${height}`] : [];
})"""
UNNAMED = """() => [...document.querySelectorAll('#lesson .drag')].filter((each) => !['aria-label', 'aria-valuemin',
  'aria-valuenow', 'aria-valuetext'].every((name) => each.getAttribute(name)) ||
  each.getAttribute('aria-label') === each.dataset.name).map((each) => each.outerHTML)"""


@pytest.mark.parametrize("lesson", [marked(lesson.name) for lesson in LESSONS])
def test_controls_are_large_enough_for_fingers_and_the_picture_leaves_room_for_the_text(opened, lesson):
    page = opened(f"lessons/{lesson}.html", viewport=PHONE, reduced_motion="reduce")
    page.evaluate("document.querySelectorAll('#lesson details').forEach((each) => { each.open = true; })")
    assert page.evaluate(SMALL) == []
    assert page.evaluate(UNNAMED) == []
    assert page.locator(".stage-column").bounding_box()["height"] <= 0.4 * PHONE["height"]
    assert page.locator(".stage-column").evaluate("({ scrollWidth, clientWidth }) => scrollWidth - clientWidth") <= 0


def test_the_first_picture_enlarges_differences_that_are_too_small_to_be_seen(opened):
    page = opened("lessons/four_bar.html", viewport=PHONE, reduced_motion="reduce")
    lens = page.locator(".lens > svg").bounding_box()
    assert lens["y"] + lens["height"] < 0.4 * PHONE["height"]  # the magnifier is in the window
    assert "drawn 5 times as large" in page.inner_text(".remark >> nth=0")
    rocker = page.locator(".motion.method-1 .body").nth(2)
    angles = "element => element.getAttribute('transform').match(/rotate\\((.*)\\)/)[1] * Math.PI / 180"
    exact = page.locator(".motion.truth .body").nth(2).evaluate(angles)
    enlarged = rocker.evaluate(angles) - exact
    page.locator("input[value=enlarged]").uncheck()
    assert enlarged == pytest.approx(5 * (rocker.evaluate(angles) - exact), rel=1e-6)
    assert abs(enlarged) > 0.05


def test_the_keyboard_plays_a_motion_moves_the_time_and_switches_overlays(opened):
    page = opened("lessons/four_bar.html", reduced_motion="reduce")
    clock = page.locator(".clock")
    body = page.locator(".motion.truth .body").first
    page.locator(".play").focus()
    page.keyboard.press("Tab")
    page.keyboard.press("Home")
    start = (clock.inner_text(), body.get_attribute("transform"))
    page.keyboard.press("ArrowRight")
    assert (clock.inner_text(), body.get_attribute("transform")) != start
    box = page.locator("input[value=paths]")
    box.focus()
    page.keyboard.press("Space")
    assert page.locator(".trace").first.is_hidden()
    page.locator(".play").focus()
    page.keyboard.press("Enter")
    page.wait_for_function("Number(document.querySelector('.time input').value) > 3")
    page.keyboard.press("Enter")
    page.locator(".frame").focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_function("location.hash.includes('start=')")  # the mechanism is dragged


def test_texts_pictures_and_tables_are_shown_without_javascript(opened):
    page = opened("lessons/four_bar.html", java_script_enabled=False)
    assert "Three bars and four pins" in page.inner_text("main")
    assert page.locator(".motion.truth .body").count() == 3
    assert page.locator(".controls").first.is_hidden()
    page.locator("#part-2 summary").first.click()
    assert "closes a tenth of a gap" in page.inner_text("#part-2")
    page = opened("results/four_bar.html", java_script_enabled=False)
    assert page.locator("table").count() > 3
    assert page.locator("img").first.evaluate("image => image.complete && image.naturalWidth > 0")


@pytest.mark.parametrize("blocked", ["lesson.js", "motion.js"])
def test_controls_are_hidden_if_scripts_are_blocked(chromium, address, blocked):
    page = new_page(chromium)
    page.route(f"**/{blocked}", lambda route: route.abort())
    page.goto(f"{address}lessons/four_bar.html")
    page.wait_for_selector("html:not(.scripts)", state="attached")
    assert page.locator("button:visible:not(.scheme), input:visible, select:visible").count() == 0
    assert page.get_by_text("The engines in this page need JavaScript").is_visible()
    page.context.close()


@pytest.mark.parametrize("scene", ["free_four_bar", "driven_slider_crank"])  # close methods; twelve decades
def test_labels_of_a_chart_do_not_overlap_on_a_phone(opened, scene):
    page = opened(f"results/rows.html#scene={scene}", viewport=PHONE)
    page.wait_for_selector("html[data-ready]")
    labels = page.locator("#chart :is([aria-label=text], [aria-label='y-axis tick label']) text")
    boxes = [box for label in labels.all() if label.inner_html() and (box := label.bounding_box()) is not None]
    assert len(boxes) > 8
    assert max(box["x"] + box["width"] for box in boxes) <= PHONE["width"]
    for a, b in itertools.combinations(boxes, 2):
        aside = max(a["x"], b["x"]) - min(a["x"] + a["width"], b["x"] + b["width"])
        above = max(a["y"], b["y"]) - min(a["y"] + a["height"], b["y"] + b["height"])
        assert max(aside, above) > -0.01, (a, b)  # rounding of a label's place


def test_tables_are_sorted_and_filtered_and_the_address_stores_the_choice(opened):
    page = opened("results/index.html")
    table = page.locator("table").filter(has=page.locator("tbody tr:nth-child(6)")).first
    count = table.locator("tbody tr").count()
    page.locator(".filter input").first.fill(table.locator("tbody tr td").first.inner_text().split()[0])
    assert 0 < table.locator("tbody tr:visible").count() < count
    page.locator(".filter input").first.fill("")
    table.locator("th button").first.click()
    first = table.locator("tbody tr td:first-child").all_inner_texts()
    table.locator("th button").first.click()
    assert table.locator("tbody tr td:first-child").all_inner_texts() != first
    page = opened("results/rows.html")
    page.wait_for_selector("html[data-ready]")
    methods = set(page.locator("#rows tbody td:nth-child(2)").all_inner_texts())
    assert methods == {"as shipped", "documented settings", "with our code"}  # these methods are shown initially
    page.locator("input[name=all]").check()
    page.reload()
    page.wait_for_selector("html[data-ready]")
    assert "lagrange" in set(page.locator("#rows tbody td:nth-child(1)").all_inner_texts())
    page.locator("#rows th button").nth(5).click()
    errors = [
        float(cell) for cell in page.locator("#rows tbody td:nth-child(6)").all_inner_texts() if cell[0].isdigit()
    ]
    assert errors == sorted(errors)


def test_the_compressed_size_of_the_site_is_limited(files):
    assert compressed_size(files) < 6_000_000
    engines = ("packages/munk2d", "packages/mujoco", "live/")  # only lessons load these files
    assert compressed_size({name: text for name, text in files.items() if not name.startswith(engines)}) < 2_500_000

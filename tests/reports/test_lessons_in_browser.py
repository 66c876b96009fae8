"""Tests of the questions, links and exercises of lessons in Chromium."""

from __future__ import annotations

import base64

import numpy as np
import pytest

from reference.chapter.centrodes import instant_centre
from tests.reports.site_in_browser import BY_NAME, FIXTURES, PHONE, TALL, marked, new_page

address, chromium, files, opened, running = FIXTURES


def test_the_address_stores_only_changes_by_the_reader(opened):
    page = opened("lessons/four_bar.html", viewport=TALL)
    page.locator("#part-2 .set").click()
    assert page.evaluate("location.hash") == ""
    page.locator("#part-1 .drag").first.focus()
    page.keyboard.press("ArrowRight")
    assert page.evaluate("location.hash") == "#set&part=1&scene=0&0.coupler=2"
    linked = opened("lessons/four_bar.html#set&scene=0&0.coupler=2&steps=99&0.crank=77&nothing&=", viewport=TALL)
    values = "Object.fromEntries(crosscheck.form.shown().map(i => [i.name, i.value]))"
    assert linked.evaluate(values) == page.evaluate(values)
    assert "up to" in linked.inner_text(".legend .method-1")
    # The sentence of the marked experiment has the linked number, also without the number of an experiment.
    assert linked.inner_text("#part-1.shown .drag[data-name=coupler]") == "0.65"
    linked = opened("lessons/four_bar.html#set&part=4&scene=1&1.steps=1", viewport=TALL)
    steps = linked.text_content("#part-4.shown .drag[data-name=steps]")
    assert steps != linked.text_content("#part-5 .drag[data-name=steps]")
    assert steps == linked.evaluate("crosscheck.form.words('steps')")


@pytest.mark.parametrize("part", [4, 7])
def test_a_linked_experiment_stays_in_the_picture_of_a_phone(opened, part):
    """The page itself scrolls to the experiment, and scrolls again when it gets its height."""
    scene = BY_NAME["four_bar"].scenes.index(BY_NAME["four_bar"].scene(BY_NAME["four_bar"].experiments[part - 1].scene))
    page = opened(f"lessons/four_bar.html#set&part={part}&scene={scene}&{scene}.steps=1", viewport=PHONE)
    page.wait_for_timeout(300)  # later scroll events come within 100 ms
    shown = "document.querySelector('.part.shown').id"
    assert page.evaluate(shown) == f"part-{part}"
    page.mouse.move(195, 700)  # the text, which scrolls
    page.mouse.wheel(0, -1500)
    page.wait_for_function(f"{shown} !== 'part-{part}'")  # the reader's scrolling selects another one


def test_the_answer_to_a_guess_shows_its_own_run_beside_the_right_one(opened):
    page = opened("lessons/four_bar.html", viewport=TALL, reduced_motion="reduce")

    def rows(part, answer):
        page.locator(f"#part-{part} .answers button").nth(answer).click()
        page.wait_for_selector(f"#part-{part} .why[open] .compared:not([hidden])")
        cells = page.locator(f"#part-{part} .compared tbody tr").all()
        return [row.locator("th, td").all_inner_texts() for row in cells]

    assert [row[0] for row in rows(5, 0)] == ["before", "expected with your answer: The error grows a little", "now"]
    assert page.inner_text("#part-5 .measured").startswith("Not so.")
    assert page.locator("#part-5 [data-right].right").count() == 1
    before, own, right = rows(2, 0)
    assert own[0] == "your answer: Ten times as many iterations"
    assert own[1] == f"{before[1]}, as before"
    assert right[0].startswith("the right answer: One setting")
    assert "times smaller" in right[1]
    # The picture shows the run of the answer; a click on another run shows that run.
    page.wait_for_function("document.querySelector('.legend .method-1').innerText.includes('iterations 100')")
    page.locator("#part-2 .compared button").last.click()
    page.wait_for_function("document.querySelector('.legend .method-1').innerText.includes('error_bias 0 ')")


def test_an_answered_experiment_shows_its_run_again_when_the_reader_returns(opened):
    page = opened("lessons/four_bar.html", reduced_motion="reduce")
    page.locator("#part-3 .answers [data-right]").click()
    page.wait_for_selector("#part-3 .compared:not([hidden])")
    tenth = "document.querySelector('#part-3 .measured').textContent && crosscheck.form.words('steps') === '0.5 ms'"
    page.wait_for_function(tenth)
    page.mouse.move(300, 400)
    for part in (4, 3):
        for _ in range(60):
            away = page.locator(f"#part-{part} h2").bounding_box()["y"] - 120
            if abs(away) < 60:
                break
            page.mouse.wheel(0, np.clip(away, -150, 150))
            page.wait_for_timeout(50)
        page.wait_for_selector(f"#part-{part}.shown")
        assert page.evaluate(tenth) == (part == 3)
    # The keys Home and End select the first and the last value.
    number = page.locator("#part-3 .drag[data-name=timeConstant]")
    number.focus()
    page.keyboard.press("End")
    assert number.inner_text() == "50 ms"


BLOCKED = {
    "**/packages/mujoco.*": "MuJoCo: its file could not be loaded. Check the network or the browser's blocker, then "
    "reload the page. The picture shows the stored motion of Python.",
    "**/live/*.json": "The engines could not be run: the data of this motion could not be loaded. Check",
    "**/worker.js": "The engines could not be run: their script could not be loaded. Check the network",
}


@pytest.mark.parametrize("blocked", BLOCKED)
def test_a_blocked_download_has_a_readable_message(chromium, address, blocked):
    page = new_page(chromium)
    page.route(blocked, lambda route: route.abort())
    page.goto(f"{address}lessons/four_bar.html")
    shown = "words => document.querySelector('.status').innerText.includes(words)"
    page.wait_for_function(shown, arg=BLOCKED[blocked])
    text = page.inner_text("#lesson figure")
    assert "http" not in text
    assert "undefined" not in text
    page.context.close()


def test_numbers_and_the_legend_change_while_a_number_is_dragged(opened):
    page = opened("lessons/four_bar.html", viewport=TALL, reduced_motion="reduce")
    page.locator("#part-2 .set").click()
    page.wait_for_function("document.querySelector('.legend .method-1').innerText.includes('up to')")
    texts = page.evaluate(
        """() => {
          const number = document.querySelector('#part-2 .drag[data-name=bias]');
          number.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight' }));
          return [number.textContent, document.querySelector('.legend .method-1').innerText];
        }"""
    )
    assert texts[0] == "0.5"
    assert "error_bias 0.5" in texts[1]
    assert texts[1].endswith("…")


def test_an_exercise_accepts_its_answer_and_no_other_number(opened):
    page = opened("lessons/four_bar.html", viewport=TALL)
    exercise = page.locator("form[data-answer=rocker_angle]")
    for given, verdict in (("2,9", "Right. The page computes 2.9056."), ("-2.9", "The size is right"), ("3", "Not so")):
        exercise.locator("input").fill(given)
        exercise.locator("button").click()
        assert exercise.locator(".verdict").inner_text().startswith(verdict)


@pytest.mark.parametrize("lesson", [marked("parking")])
def test_the_keyboard_parks_the_skate_in_five_moves(opened, lesson):
    page = opened(f"lessons/{lesson}.html", viewport=TALL)
    page.locator(".lot").focus()
    for key, count in (("Left", 5), ("Up", 9), ("Right", 10), ("Down", 9), ("Left", 5)):
        for _ in range(count):
            page.keyboard.press(f"Arrow{key}")
    text = page.inner_text(".parking .count")
    assert text.startswith("Parked: 5 moves; turned by 100.0° and slid by 0.900 m in total.")
    assert "moves it by -0.042 m ahead and 0.190 m to the left in 4 moves" in text  # 0.45 m and 25 degrees
    linked = opened(f"lessons/{lesson}.html{page.evaluate('location.hash')}", viewport=TALL)
    assert linked.inner_text(".parking .count") == text


# The points of both paths in the coordinates of the drawing, and its scale [m of the paper for each m].
SVG_POINTS = """() => {
  const root = document.documentElement;
  const points = (path) => path.getAttribute('d').slice(1, -1).split('L').slice(0, -1).map((pair) => {
    const [x, y] = pair.split(' ').map(Number);
    const { x: u, y: v } = new DOMPoint(x, y).matrixTransform(path.transform.baseVal.consolidate().matrix);
    return [u, v];
  });
  return [Object.fromEntries([...document.querySelectorAll('path')].map((path) => [path.id, points(path)])),
    root.width.baseVal.valueInSpecifiedUnits / 1000 / root.viewBox.baseVal.width];
}"""


@pytest.mark.parametrize("lesson", [marked("cam")])
def test_a_drawn_motion_gives_two_shapes_to_download(opened, lesson, tmp_path):
    page = opened(f"lessons/{lesson}.html", viewport=TALL)
    box = page.locator(".lot").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    for index in range(41):  # an ellipse that is drawn clockwise
        page.mouse.move(x + 80 * np.cos(index * np.pi / 20), y + 30 * np.sin(index * np.pi / 20))
        if index == 0:
            page.mouse.down()
    page.mouse.up()
    assert "The moving shape rolls on the fixed one" in page.inner_text(".cam .count")
    for index in range(41):  # a path without symmetry
        angle, radius = index * np.pi / 20, 80 + 12 * np.sin(index * np.pi / 10) + 6 * np.cos(3 * index * np.pi / 20)
        page.mouse.move(x + radius * np.cos(angle), y - radius * np.sin(angle))
        if index == 0:
            page.mouse.down()
    page.mouse.up()
    assert page.locator(".widget select").input_value() != "-1"
    assert "crosses itself" not in page.inner_text(".cam .count")
    linked = opened(f"lessons/{lesson}.html{page.evaluate('location.hash')}", viewport=TALL)
    assert linked.inner_text(".cam .count") == page.inner_text(".cam .count")
    page.get_by_label("the body turns").select_option("once")
    page.locator("[data-motion=Ellipse]").click()
    for kind in ("svg", "dxf"):
        with page.expect_download() as download:
            page.locator(f"[data-file={kind}]").click()
        download.value.save_as(tmp_path / f"shapes.{kind}")
    t = np.linspace(0, 2 * np.pi, 361)
    pose = np.column_stack([0.5 * np.cos(t), 0.2 * np.sin(t), t])
    twist = np.column_stack([-0.5 * np.sin(t), 0.2 * np.cos(t), np.ones(361)])
    curves = dict(zip(("space", "body"), instant_centre(pose, twist), strict=True))
    ezdxf = pytest.importorskip("ezdxf", reason="ezdxf is not installed: pip install '.[dxf]'")
    lines = ezdxf.readfile(tmp_path / "shapes.dxf").modelspace()
    found = {line.dxf.layer.lower(): [(point.x, point.y) for point in line.points()] for line in lines}
    # The browser itself reads the SVG. Its transform keeps the shape and the scale: 1 m is 1000/10 mm = 100 mm.
    page.goto(f"data:image/svg+xml;base64,{base64.b64encode((tmp_path / 'shapes.svg').read_bytes()).decode()}")
    svg, viewed = page.evaluate(SVG_POINTS)
    assert viewed == pytest.approx(0.1)
    for name, curve in curves.items():
        one = curve[: {"space": 360, "body": 180}[name]]  # the body curve is traced twice in a turn
        assert np.abs(np.array(found[name]) - one).max() < 1e-6
        points = np.array(svg[name])
        assert np.abs((points - points[0]) * (1, -1) - (one - one[0])).max() < 1e-6


@pytest.mark.parametrize("lesson", [marked("cam")])
def test_the_keyboard_draws_a_motion(opened, lesson):
    page = opened(f"lessons/{lesson}.html", viewport=TALL)
    picture = page.get_by_role("application", name="The path of a point, which a pointer draws.")
    picture.focus()
    page.keyboard.press("PageUp")
    page.keyboard.press("PageUp")
    begin = page.inner_text(".cam .count")
    assert begin.startswith("The path at 30° is at (0.43, 0.10) m.")  # (0.5 cos 30°, 0.2 sin 30°) of the ellipse
    for key in ("ArrowUp", "ArrowUp", "ArrowLeft"):
        page.keyboard.press(key)
    moved = page.inner_text(".cam .count")
    assert moved.startswith("The path at 30° is at (0.41, 0.14) m.")
    assert "The moving shape rolls on the fixed one" in moved
    assert moved.split("m. ", 1)[1] != begin.split("m. ", 1)[1]  # both shapes have another size
    page.keyboard.press("PageDown")
    assert page.inner_text(".cam .count").startswith("The path at 15° is at")
    linked = opened(f"lessons/{lesson}.html{page.evaluate('location.hash')}", viewport=TALL)
    assert linked.inner_text(".cam .count") == moved.split("m. ", 1)[1]


@pytest.mark.parametrize("lesson", [marked("cam")])
def test_a_motion_about_one_point_gives_no_shapes_and_a_wrong_link_changes_nothing(opened, lesson):
    page = opened(f"lessons/{lesson}.html#set&part=3&scene=0&state=0,0,0,1,0,0,0,0,1", viewport=TALL)
    assert "0.600 m wide" in page.inner_text(".cam .count")  # 2 (0.5 - 0.2) m, of the ellipse at the start
    page = opened(f"lessons/{lesson}.html", viewport=TALL)
    page.locator("[data-motion=Circle]").click()
    assert page.locator(".widget select").input_value() != "1"
    page.get_by_label("the body turns").select_option("once")  # the page has selected a number that gives two shapes
    assert "only turns about one fixed point" in page.inner_text(".cam .count")
    assert page.locator("[data-file=dxf]").is_disabled()


def test_a_link_restores_the_numbers_of_an_erratum(opened):
    page = opened("lessons/skate.html", viewport=TALL)
    page.locator("#part-5 .why summary").click()
    values = page.locator("#part-5 tbody code")
    before = values.all_text_contents()
    page.locator("#part-5 .errata input[name=angle]").fill("2.5")
    page.wait_for_function("location.hash.includes('state=')")
    linked = opened(f"lessons/skate.html{page.evaluate('location.hash')}", viewport=TALL)
    assert linked.locator("#part-5 tbody code").all_text_contents() == values.all_text_contents() != before

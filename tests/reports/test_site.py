"""Tests of the site without a browser."""

from __future__ import annotations

import json
import os
import re
import sys
from html import unescape
from html.parser import HTMLParser
from types import ModuleType
from typing import Any
from urllib.parse import unquote, urlsplit

import numpy as np
import pytest

from engines.conformance import cases
from engines.lagrange import Lagrange
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.cli.site import texts_of
from reports.model.ending import BadInput, FileTrouble
from reports.site.build import MARKER, SiteSource, build, explored
from reports.site.folder import compressed_size, refuse_strangers, write_site
from reports.site.generator import NEEDED, Documents, build_html, reference_sources
from reports.site.lesson import Cause, Claim, Exercise, Experiment, Guess, Lesson, read_lesson
from reports.site.lessons import LESSONS
from reports.site.live.data import forces
from reports.site.live.scenes import FREE, SCENES
from reports.site.markdown import render_html, render_lecture, section
from reports.site.packages import NotFetched, Package, fetch_package, printed
from tests import ROOT

RESULTS = ROOT / "reports" / "results"
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text("utf-8")


class LinksOfPage(HTMLParser):
    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str | None] = {""}
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.links += [value or "" for name, value in attrs if name in ("href", "src")]
        self.anchors |= {value for name, value in attrs if name == "id"}


def require_packages():
    """Skip the test where a package of the extra `site` is missing."""
    for name in NEEDED:
        pytest.importorskip(name, reason=f"{name} is not installed: pip install '.[site]'")


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    cache = tmp_path_factory.mktemp("cache")
    options = {"answers": {}, "cache": cache, "foot": "Made by a test.", "contributing": CONTRIBUTING, "api": False}
    return SiteSource(**texts_of(RESULTS), **options)


@pytest.fixture(scope="module")
def files(source, tmp_path_factory):
    require_packages()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PATH", str(tmp_path_factory.mktemp("nothing")))
        return build(source)


def test_the_forces_at_the_coupler_sum_to_mass_times_acceleration():
    scene = FreeFourBar()
    mechanism = scene.mechanism()
    dense = scene.motion(np.array([0.5 - 1e-5, 0.5, 0.5 + 1e-5]))
    by_joint = {force["name"]: np.reshape(force["force"], (-1, 2)) for force in forces(mechanism, dense)}
    acceleration = (dense.twist[2] - dense.twist[0]) / 2e-5
    coupler = mechanism.bodies[1]
    wanted = coupler.mass * (acceleration[1, :2] - np.array(mechanism.gravity))
    # The force at C acts on the rocker. The coupler has the opposite force.
    assert by_joint["B"][1] - by_joint["C"][1] == pytest.approx(wanted, rel=1e-6)


LESSON = """# A title

```toml
page = "four_bar"
scenes = ["free_four_bar-let-go"]
```

## Heading

```toml
scene = "let go"
before = { density = [1.0, 100.0, 1.0] }
after = { bias = "the method's value" }
claims = [{ engine = "munk", most = 1 }]
causes = [{ change = { iterations = 1 }, engine = "mujoco", of = "gap", least = 2.0 }]
guesses = [{}, { times = { munk = 1.0 } }, { change = {} }]
overlays = ["centre"]
widget = "cam"
```

Words
more.

> What?
>
> - one
> - **two**
> - three

Because.

## Exercises

### Speed: `speed` [m/s]

How fast?

> 2 m/s.
"""


def test_a_lesson_is_read_from_its_file(tmp_path):
    (tmp_path / "new.md").write_text(LESSON, "utf-8")
    lesson = read_lesson(tmp_path / "new.md", SCENES)
    texts = {"heading": "Heading", "text": "Words\nmore.", "question": "What?", "after_words": "Because."}
    settings = {"before": {"density": (1.0, 100.0, 1.0)}, "after": {"bias": None}}
    expected = Experiment(
        "let go",
        claims=(Claim("munk", most=1.0),),
        causes=(Cause("mujoco", 2.0, of="gap", change={"iterations": 1}),),
        guesses=(Guess(), Guess(times={"munk": 1.0}), Guess({})),
        overlays=("centre",),
        widget="cam",
        answers=(("one", False), ("two", True), ("three", False)),
        **texts,
        **settings,
    )
    exercise = Exercise("Speed", "speed", "m/s", "How fast?", "2 m/s.")
    assert lesson == Lesson("new", "A title", "four_bar", (FREE,), (expected,), (exercise,))


@pytest.mark.parametrize(
    ("old", "new", "place", "reason"),
    [
        ("page =", "pages =", "the title", "the first TOML block has pages, scenes instead of page and scenes"),
        ("_bar-let", "_bar-set", "the title", "no scene has the key 'free_four_bar-set-go'"),
        ('"four_bar"', "4", "the title", "page is 4, which has a wrong type"),
        ('["free_four_bar-let-go"]', '"x"', "the title", "scenes is 'x', which has a wrong type"),
        (
            "## Heading\n",
            "Lost.\n\n## Heading\n",
            "the title",
            "text stands before the heading of the first experiment",
        ),
        ("\n### Speed", "\nLost.\n\n### Speed", "Exercises", "text stands before the heading of the first exercise"),
        ("Because.", "Because.\n\n> Quoted.", "Heading", "a part has one quotation, with a question and its answers"),
        ('scene = "let go"', "", "Heading", "an unknown field, or lacks a field: scene"),
        ('"let go"', '"driven"', "Heading", "the lesson has no scene 'driven'; its scenes are 'let go'"),
        ("overlays", "overlay", "Heading", "an unknown field, or lacks a field: overlay"),
        ('"centre"', '"centres"', "Heading", "overlays is 'centres'; there are reactions, centre, friction"),
        ('"munk"', '"pymunk"', "Heading", "engine is 'pymunk'; there are munk, mujoco, exact"),
        ("most = 1", 'most = "1"', "Heading", "most is '1', which has a wrong type"),
        ("iterations = 1", "iterations = 3", "Heading", "iterations has no value 3; there are None, 1, 2, 5"),
        ("iterations = 1", "sweeps = 1", "Heading", "no control is named 'sweeps'; there are steps, crank"),
        ('"cam"', '"cams"', "Heading", "the widget 'cams' has no script in assets"),
        ("[{}, {", "[{", "Heading", "2 guesses for 3 answers"),
        ("**two**", "two", "Heading", "a question has three answers, one of them right"),
        ("> - three\n", "", "Heading", "a question has three answers, one of them right"),
        ('widget = "cam"', 'text = "x"', "Heading", "text stands below the TOML block"),
        ('widget = "cam"', "widget = cam", "Heading", "Invalid value"),
        ("## Heading\n\n```toml", "## Heading\n\n```", "Heading", "a block ```toml must follow the heading"),
        ("> 2 m/s.", "2 m/s.", "Speed: `speed` [m/s]", "an exercise has a heading, an answer, a unit and a solution"),
    ],
)
def test_a_lesson_of_another_form_is_refused_in_one_line(old, new, place, reason, tmp_path):
    assert LESSON.count(old) == 1
    (tmp_path / "new.md").write_text(LESSON.replace(old, new), "utf-8")
    with pytest.raises(ValueError, match=r"^new\.md, ") as refused:
        read_lesson(tmp_path / "new.md", SCENES)
    assert str(refused.value).startswith(f"new.md, {place!r}: ")
    assert reason in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_section_ends_at_a_heading_of_its_rank_or_above_and_not_at_a_comment_in_code():
    page = "# Top\n## Part\nbefore\n```\n# a comment\n```\nafter\n### Below\nmore\n# Next\nother\n"
    assert section(page, "Part") == "before\n```\n# a comment\n```\nafter\n### Below\nmore"
    assert section(page, "Nothing") is None


def test_lessons_quote_sections_of_results_pages_with_working_links(files):
    for lesson in LESSONS:
        page = unescape(files[f"lessons/{lesson.name}.html"].decode())
        headings = [experiment.section for experiment in lesson.experiments if experiment.section]
        assert [heading for heading in headings if f"<summary>More: {heading}</summary>" not in page] == []
    page = files["lessons/four_bar.html"].decode()
    body = page.partition("<summary>More: Nine configurations</summary>")[2].partition("</details>")[0]
    assert "Fig. 18.66 of the chapter" in body
    assert re.findall(r'<img[^>]* src="(.*?)"', body) == ["../_images/four_bar_configurations.svg"]
    assert "<math" in body


def test_no_link_of_the_site_is_dead(files):
    pages = {name: LinksOfPage(text.decode()) for name, text in files.items() if name.endswith(".html")}
    assert {f"lessons/{lesson.name}.html" for lesson in LESSONS} < set(pages)
    dead = []
    for name, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme in ("http", "https", "data", "mailto"):
                continue
            target = os.path.normpath(os.path.join(os.path.dirname(name), unquote(parts.path))) if parts.path else name
            anchors = pages[target].anchors if target in pages and "=" not in parts.fragment else {parts.fragment}
            if (target not in files and target != ".") or parts.fragment not in anchors:
                dead.append(f"{name}: {link}")
    assert dead == []


def test_pages_load_nothing_from_other_servers_and_the_site_names_missing_packages(files):
    loading = re.compile(r'(?:src|<link[^>]*href)="(?:https?:)?//|@import|url\((?!["\']?data:)')
    texts = {name: text.decode() for name, text in files.items() if name.endswith((".html", ".css"))}
    assert [name for name, text in texts.items() if loading.search(text)] == []
    trouble = "the engine MuJoCo, compiled to WebAssembly by its maintainers): npm is not installed"
    assert "packages/munk2d.js" in files
    assert trouble in texts["about.html"]
    assert [
        name for name, text in texts.items() if name.startswith(("lessons/", "index")) and trouble not in text
    ] == []
    assert "npm is not installed" in texts["results/rows.html"]
    assert json.loads(files[MARKER])["troubles"]


def test_the_page_of_a_notebook_has_the_output_and_the_pictures_of_its_cells():
    codes = ["import matplotlib.pyplot as plt\nplt.plot([1, 2])\nprint('a <b>')", "1 / 0"]
    cells = [{"cell_type": "markdown", "source": ["# A $x$"]}, *({"cell_type": "code", "source": [c]} for c in codes)]
    pages = render_lecture(json.dumps({"cells": cells[:2]}))
    page = pages["lecture.md"]
    assert page.index("plt.plot") < page.index("```text\na <b>\n```") < page.index("](lecture_0.svg)")
    assert pages["lecture_0.svg"].rstrip().endswith("</svg>")
    assert page.endswith("</details>")  # the last cell is collapsed
    with pytest.raises(NotFetched, match="a cell fails: ZeroDivisionError"):
        render_lecture(json.dumps({"cells": cells}))
    with pytest.raises(NotFetched, match="a cell fails: it did not end within"):
        printed([sys.executable, "-c", "import time; time.sleep(60)"], "a cell fails", 0.1)


def test_formulas_become_mathml_and_code_does_not(files):
    page = render_html("A $x^2$ and `$HOME` costs 3 $ or 4 $.\n\n```\n$y$\n```\n")
    assert page.count("<math") == page.count("<msup>") == 1
    assert 'display="block"' in files["results/errata.html"].decode()
    with pytest.raises(BadInput, match="a command that latex2mathml does not know"):
        render_html("$\\nothing$")


def test_a_site_without_the_packages_of_its_extra_is_refused_in_one_line(monkeypatch):
    monkeypatch.setattr("reports.site.generator.find_spec", lambda asked: None)
    with pytest.raises(BadInput, match=rf"not installed \({', '.join(NEEDED)}\): pip install '\.\[site\]'"):
        build_html(Documents({}, {}, {}, lambda app: iter(())))


def test_a_package_with_a_wrong_digest_is_refused(tmp_path):
    path = tmp_path / "some-1.0.tgz"
    path.write_bytes(b"something else")
    with pytest.raises(NotFetched, match="an unexpected digest"):
        fetch_package(Package("some", "1.0", "AAAA", "MIT", "a test", ()), tmp_path)
    assert not path.exists()


def test_a_folder_with_other_files_is_refused_and_an_earlier_site_is_replaced(tmp_path):
    (tmp_path / "own.txt").write_text("mine")
    with pytest.raises(FileTrouble, match="files that no site wrote: give another --output"):
        refuse_strangers(tmp_path)
    with pytest.raises(FileTrouble, match="no folder"):
        refuse_strangers(tmp_path / "own.txt")
    new = tmp_path / "new"
    assert write_site(new, {MARKER: b"{}", "a/b.html": b"one"}) == compressed_size({MARKER: b"{}", "a/b.html": b"one"})
    write_site(new, {MARKER: b"{}", "c.html": b"two"})
    assert sorted(path.name for path in new.iterdir()) == ["c.html", MARKER]


HOWTOS = sorted((ROOT / "reports" / "site" / "howto").glob("*.md"))


@pytest.mark.parametrize("path", HOWTOS, ids=lambda path: path.stem)
def test_the_code_of_a_how_to_page_runs(path, capsys, monkeypatch):
    blocks = re.findall(r"```python\n(.*?)```", path.read_text("utf-8"), re.DOTALL)
    module = ModuleType("howto")  # dataclasses look up the module of a class
    monkeypatch.setitem(sys.modules, "howto", module)
    namespace: dict[str, Any] = vars(module)
    for block in blocks:
        exec(compile(block, path.name, "exec"), namespace)
    if "MULTIPLIERS" in namespace:  # the smallest engine
        results = [(case.check.name, case.result()) for case in cases(namespace["MULTIPLIERS"])]
        assert [(name, result.sentence) for name, result in results if result.status == "fails"] == []
        assert sum(result.status == "holds" for _, result in results) > 200
    if "SCENE" in namespace:
        run = Lagrange("dop853", "projection").build(namespace["SCENE"].mechanism(), 1e-2)(100, 1)
        assert np.abs(run.pose - namespace["SCENE"].motion(run.t).pose).max() < 1e-9
    if "mechanism" in namespace:
        errors = [float(number) for number in re.findall(r": (\S+) rad", capsys.readouterr().out)]
        assert len(errors) == 2
        assert errors[0] > errors[1] > 0  # as shipped, and tuned


def test_every_stored_row_has_its_cost_and_settings():
    data = explored(*((RESULTS / f"{name}.csv").read_text("utf-8") for name in ("errors", "timings", "descriptions")))
    rows = [dict(zip(data["columns"], row, strict=True)) for row in data["rows"]]
    assert len(rows) > 500
    free = ("free_four_bar", "pymunk", "default")
    (row,) = [r for r in rows if (r["scene"], r["engine"], r["variant"]) == free and abs(r["step"] - 1e-3) < 1e-6]
    assert row["angle"] == pytest.approx(0.19, rel=0.1)  # 0.19 rad is the value on the page of the four-bar
    assert row["cpu"] > 0
    assert "Pymunk(" in row["settings"]


def test_the_reference_contains_docstrings():
    require_packages()
    modules = ("mechanism", "numerics.integration", "chapter.skates")
    names = ("reference/index.rst", *(f"reference/reference.{module}.rst" for module in modules))
    sources = {name: text for name, text in reference_sources().items() if name in names} | {"index.md": b"# Site\n"}
    pages, _ = build_html(Documents(sources, {}, {"lessons": {}}, lambda app: iter(())))
    assert "Bodies, the joints between them" in pages["reference/reference.mechanism.html"].decode()
    for module in modules:  # "|y|" and "x_" are no references
        page = LinksOfPage(pages[f"reference/reference.{module}.html"].decode())
        assert [link for link in page.links if link.startswith("#") and link[1:] not in page.anchors] == []

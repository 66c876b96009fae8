"""No two pages have a document of the same name, whatever their scenes are called."""

from __future__ import annotations

from dataclasses import replace

import pytest

from reports.gate.pytest_plugin import _engines
from reports.model.catalogue import _without_doubles, generic_page, with_scenes
from reports.model.page import Page
from tests.toys import Disc, Toy


def called(name: str) -> Disc:
    """A disc in a scene of this name."""
    return type("Named", (Disc,), {"name": name})()


@pytest.mark.parametrize("names", [("x", "x_data"), ("x_data", "x"), ("x", "x_data", "x_data_data"), ("a/b", "a b")])
def test_pages_of_scenes_whose_names_are_alike_share_no_document(names):
    pages = with_scenes((), [called(name) for name in names], (Toy(),))
    assert [page.scenes[0].name for page in pages] == list(names)
    documents = [name for page in pages for name in page.documents]
    assert len(documents) == len(set(documents)) == 2 * len(names)


def test_a_scene_called_index_does_not_replace_the_index():
    assert generic_page(called("index"), (Toy(),)).documents == {"index_2.md", "index_2_data.md"}


def test_a_page_whose_document_is_another_pages_is_left_out_in_a_line():
    first = Page("x", "X", "One.", (called("one"),), (Toy(),))
    second = Page("x_data", "Y", "Two.", (called("two"),), (Toy(),))
    kept, troubles = _without_doubles([first, second, replace(second, name="index")])
    assert kept == (first,)
    assert troubles == (
        "crosscheck.pages: the page 'x_data' is left out, since it would have the file x_data.md, as 'x' has",
        "crosscheck.pages: the page 'index' is left out, since it would have the file index.md, as the index of all "
        "pages has",
    )
    alone = replace(second, scenes=())  # a page of words has no page of numbers
    assert _without_doubles([alone, replace(first, name="y")])[1] == ()


def test_engines_of_the_gate_are_names_or_references(tmp_path, monkeypatch):
    monkeypatch.setattr("sys.path", [*__import__("sys").path])
    assert _engines(["pymunk", "mujoco tuned"]) == ((), ("pymunk", "mujoco tuned"))
    (tmp_path / "own_toy.py").write_text("from tests.toys import Toy\nOWN = (Toy('a'), Toy('b'))\n")
    found = _engines([f"{tmp_path}/own_toy.py:OWN", "engines.pymunk:TUNED"])
    assert [engine.variant for engine in found[0]] == ["a", "b", "tuned"]
    assert found[1] == ("toy a", "toy b", "pymunk tuned")
    (tmp_path / "another.py").write_text("from tests.toys import Toy\nOTHER = Toy('tuned', name='pymunk')\n")
    with pytest.raises(pytest.UsageError, match="another engine is called 'pymunk tuned'; give it another name"):
        _engines([f"{tmp_path}/another.py"])
    with pytest.raises(pytest.UsageError, match="there is no such file"):
        _engines([f"{tmp_path}/missing.py"])

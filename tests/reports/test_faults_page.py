"""The faults of released engines: scripts print what the page says, wrong formulas are those of the engines, releases
are what was recorded."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

import re
import runpy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from engines import single_run
from reports.cli.selection import page_tasks
from reports.gate.prediction import all_tasks
from reports.model.page import Material
from reports.model.tasks import answered
from reports.pages.faults import experiments, scripts
from reports.pages.faults.experiments import CASES, KINDS, Bead, Equalities, Grooves, across, beside
from reports.pages.faults.page import BEADS, EQUALITIES, GROOVES, OFFSETS, PAGE, SCRIPTS
from reports.pages.faults.scripts import RELEASES, found_with, recorded
from reports.pages.rendering import render_page

# A velocity or an acceleration by two routes of some twenty operations, with masses and arms over two decades.
ROUNDING = 1e-12


@pytest.fixture(scope="module")
def material() -> Material:
    return Material({}, {task: answered(task) for task in all_tasks(PAGE)})


def not_here(name: str) -> str:
    """The sentence that names the extra which a script needs, if it is not installed."""
    engine = SCRIPTS[name].engine
    return engine.missing if engine is not None else ""


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_script_prints_what_its_task_keeps(name: str, material: Material, capsys: pytest.CaptureFixture[str]) -> None:
    if not_here(name):
        pytest.skip(not_here(name))
    answer = material.answers[SCRIPTS[name]]
    if name in scripts.MJX:  # it compiles for seconds, and JAX takes its settings from whoever imports it first
        assert re.search(r"expected \{expected!r\}, found \{float\(found\)!r\}", scripts.source(name).splitlines()[-1])
        return
    runpy.run_path(str(scripts.FOLDER / f"{name}.py"), run_name="__main__")
    printed = re.fullmatch(r"(?:MuJoCo|pymunk) [\d.]+: expected (\S+), found (\S+)\n", capsys.readouterr().out)
    assert printed is not None
    assert (float(printed[1]), float(printed[2])) == (answer.number("expected"), answer.number("found"))


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_script_imports_its_engine_alone(name: str) -> None:
    imported = re.findall(r"^(?:import|from) (\w+)", scripts.source(name), re.MULTILINE)
    assert imported in (["mujoco"], ["pymunk"], ["importlib", "jax", "mujoco", "mujoco"])


def test_a_script_with_another_text_is_another_task() -> None:
    one = scripts.script("pymunk_groove")
    assert one.key != scripts.Script(one.name, "other").key


@pytest.mark.parametrize("case", CASES)
def test_a_groove_drives_the_wrong_velocity_to_zero(case: str) -> None:
    answer = Grooves(case, 60).run()
    assert float(np.asarray(answer["missed"], dtype=float)) < ROUNDING
    # Right in one case of four only, and there to rounding.
    off = np.asarray(answer["off"], dtype=float)
    assert np.all(off < 1e-14) if case == "ground, centre" else np.all(off > experiments.WRONG)


def test_an_ideal_groove_keeps_the_velocity_across_it_at_zero() -> None:
    setup = beside(0.7)
    assert abs(across(setup, setup.predicted(experiments.right))) < 1e-15
    assert across(setup, setup.predicted(experiments.wrong)) == pytest.approx(
        across(setup, setup.measured()), abs=1e-15
    )
    # Where the arm lies along the groove or across it, pymunk's is right too.
    for anchor in ((0.6, 0.0), (0.0, 0.6)):
        setup = replace(beside(0.7), anchor=np.array(anchor), place=np.array([0.0, anchor[1]]))
        assert abs(across(setup, setup.measured())) < 1e-15


def test_more_iterations_do_not_mend_a_groove() -> None:
    text = scripts.source("pymunk_groove").replace("space.step", "space.iterations = 1000\nspace.step")
    space: dict[str, float] = {}
    exec(text, space)
    assert space["found"] == scripts.said("pymunk_groove")[1]


@pytest.mark.parametrize("kind", KINDS)
def test_an_equality_obeys_one_of_two_formulas_to_rounding(kind: str) -> None:
    answer = Equalities(kind, 40).run()
    off, missed = (np.asarray(answer[name], dtype=float) for name in ("off", "missed"))
    if kind in ("joint, curved", "tendon"):
        assert missed.max() < ROUNDING
        assert np.median(off) > 1e-3
    else:
        # The connect's own anchors make its three rows nearly dependent in a stretched pose.
        assert off.max() < 10 * ROUNDING
    if kind == "connect":
        assert np.median(missed) > 1e-3


def test_the_missing_term_written_by_a_callback_mends_the_bead() -> None:
    import mujoco

    def with_term(model, data) -> None:
        data.efc_aref[0] += 2 * data.qvel[0] ** 2

    # Set behind the compiler, which calls it too, before there is a constraint.
    text = scripts.source("mujoco_joint_equality").replace("mujoco.mj_forward", "set_it()\nmujoco.mj_forward")
    space = {"set_it": lambda: mujoco.set_mjcb_control(with_term)}
    try:
        exec(text, space)
    finally:
        mujoco.set_mjcb_control(None)
    # The softness of the stiffest setting.
    assert space["found"] == pytest.approx(space["expected"], rel=3e-4)  # type: ignore[arg-type]


def test_no_smaller_step_brings_the_bead_back_to_its_wire() -> None:
    coarse, fine = (float(np.asarray(Bead(step).run()["gap"], dtype=float)) for step in (1e-2, 1e-3))
    assert fine == pytest.approx(coarse, rel=1e-2)
    assert fine > 1e-4


def test_the_page_tells_what_was_run(material: Material) -> None:
    text = render_page(PAGE, material, "crosscheck run")["faults.md"]
    for name, task in SCRIPTS.items():
        assert scripts.source(name) in text
        answer = material.answers[task]
        told = f"found **{answer.number('found')!r}**" if not not_here(name) else not_here(name)
        assert told in text, name
    assert text.count("100 of 100") == 3
    assert "Not run yet" not in text


def test_the_page_stands_without_its_answers() -> None:
    text = render_page(PAGE, Material({}, {}), "crosscheck run")["faults.md"]
    assert text.count("Not run yet") + text.count("Not run here: mjx needs") == len(SCRIPTS)
    assert "nan" not in text


def test_a_script_whose_extra_is_missing_is_not_asked_for_and_its_page_and_answer_name_the_extra(monkeypatch) -> None:
    monkeypatch.setattr(single_run, "_is_found", lambda module: module != "jax")
    sentence = not_here("mjx_loop")
    assert "'.[mjx]'" in sentence
    task = SCRIPTS["mjx_loop"]
    assert task not in page_tasks(PAGE)
    assert set(SCRIPTS.values()) - set(page_tasks(PAGE)) == {task}
    assert answered(task).sentence == sentence
    assert sentence in render_page(PAGE, Material({}), "crosscheck run")["faults.md"]


def test_what_releases_find_is_in_step_with_the_scripts(material: Material) -> None:
    rows = {(row.script, row.package, row.version): row for row in recorded()}
    assert set(rows) == {(name, package, version) for package, version, names in RELEASES for name in names}
    for name, task in SCRIPTS.items():
        answer = material.answers[task]
        if not_here(name):
            continue
        own = [row for row in rows.values() if row.script == name and row.version == answer.values["version"]]
        for row in own:  # none if a newer release is installed than the newest that was recorded
            assert row.found == pytest.approx(answer.number("found"), rel=1e-12)


def test_each_fault_is_wrong_in_the_releases_that_the_page_names() -> None:
    def wrong(name: str) -> set[str]:
        return {row.version for row in recorded() if row.script == name and not row.right}

    every = {version for package, version, _ in RELEASES if package != "pymunk"}
    assert wrong("mujoco_loop") == {"3.0.0", "3.6.0"}
    assert wrong("mujoco_sparse") == {"4.0.0"}
    assert wrong("mujoco_joint_equality") == wrong("mujoco_tendon_equality") == every
    for name in ("pymunk_groove", "pymunk_groove_moving", "pymunk_kinetic_energy"):
        assert wrong(name) == {version for package, version, _ in RELEASES if package == "pymunk"}


@pytest.mark.slow
@pytest.mark.parametrize("release", RELEASES, ids=lambda release: " ".join(release[:2]))
def test_releases_find_again_what_was_recorded(release: tuple[str, str, tuple[str, ...]]) -> None:
    kept = {row.script: row for row in recorded() if (row.package, row.version) == release[:2]}
    for row in found_with(*release):
        assert row.found == pytest.approx(kept[row.script].found, rel=1e-12)


def test_all_tasks_of_the_page_are_run_and_shown() -> None:
    assert set(all_tasks(PAGE)) == {*SCRIPTS.values(), *GROOVES, *EQUALITIES, *BEADS, OFFSETS}
    assert {path.stem for path in Path(scripts.FOLDER).glob("*.py")} == set(SCRIPTS)

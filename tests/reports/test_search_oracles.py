"""Tests of the search's oracles: right adapters pass, and mistakes in adapters are found."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

import csv
import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from engines import ConvergenceOrder, Engine, EngineWrapper, Run
from engines.constrained import constrained
from engines.lagrange import Judge, Lagrange
from engines.mujoco import DEFAULT, EXTENDED, TUNED
from engines.mujoco import engine as mujoco_engine
from engines.mujoco.model import MuJoCoModel
from engines.mujoco.running import MuJoCoRun
from engines.mujoco.user_rows import RowWriter
from engines.pymunk import LEAPFROG
from engines.pymunk import TUNED as PYMUNK_TUNED
from engines.pymunk import declared as pymunk_declared
from engines.pymunk import model as pymunk_model
from engines.registry import INSTALLED, VARIANTS
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reports.gate.change import Altered
from reports.search import law, motions, plan
from reports.search.law import LAW_TOLERANCE
from reports.search.page import known_subjects
from reports.search.parts import ALL_KINDS, FIRST_KINDS
from reports.search.planted import PlantedFault
from reports.search.recipe import build
from reports.search.relations import RELATIONS
from reports.search.shrinking import replay_finding
from reports.search.subjects import DEFAULT_ORACLES, OUR_ERROR, Adapted, OracleResult
from tests.wrong.adapters import Spoiled

SEED = 1
HERE = Path(__file__).parent
FINDINGS = sorted((HERE / "findings").glob("*.json"))
ENGINES = {f"{engine.name} {engine.variant}": engine for engine in (*VARIANTS, *INSTALLED)}


def results(engine: Any, kinds: tuple[str, ...], cases: int, oracle: str = "instant") -> list[OracleResult]:
    subject = Adapted(engine)
    return [subject.ask(subject.draw(SEED, number, kinds, 0), number, (oracle,)) for number in range(cases)]


def faults(engine: Any, kinds: tuple[str, ...], cases: int, oracle: str = "instant") -> set[str]:
    return {check for result in results(engine, kinds, cases, oracle) for check in result.faults}


LINKED = ("pin", "rod", "gear", "weld")


@pytest.mark.parametrize(
    ("engine", "kinds"),
    [
        (DEFAULT, ("pin",)),
        (EXTENDED, ("pin", "slot", "skate")),
        (LEAPFROG, ("pin", "slot", "skate", "drive")),
        (EXTENDED, LINKED),
        (TUNED, ("pin", "spring", "damper", "torsion-spring", "torsion-damper", "force", "torque")),
        (LEAPFROG, (*LINKED, "spring", "torsion-spring", "force", "torque")),
    ],
    ids=lambda value: getattr(value, "variant", None),
)
def test_adapters_obey_the_law_that_they_declare(engine, kinds):
    some = results(engine, kinds, 16)
    assert sum(bool(result.errors) for result in some) >= 5
    assert {check for result in some for check in result.faults} == set()


@pytest.mark.parametrize("part", [0, *(pytest.param(part, marks=pytest.mark.slow) for part in range(1, 8))])
def test_earlier_false_positives_are_no_findings(part):
    """The errors in the cases of search_seeds.csv come from rounding, a declared compliance or a solver's tolerance."""
    rows = list(csv.DictReader((HERE / "search_seeds.csv").read_text(encoding="utf-8").splitlines()))
    judged = 0
    for row in rows[part::8]:
        engine, number = ENGINES.get(row["engine"]), int(row["number"])
        if engine is None or engine.missing:
            continue
        subject, kinds = Adapted(engine), ALL_KINDS if row["kinds"] == "all" else plan.supported_kinds(engine)
        case = subject.draw(int(row["seed"]), number, kinds, int(row["decades"]))
        result = subject.ask(case, number, DEFAULT_ORACLES)
        judged += bool(result.errors)
        assert result.faults == (), (row, result)
    assert judged >= 3


@pytest.mark.parametrize("path", FINDINGS, ids=lambda path: path.stem)
def test_an_open_finding_still_fails_and_a_repaired_one_does_not(path):
    finding: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    assert finding["reason"].startswith(("upstream: ", "ours: "))
    subject = next(known for known in known_subjects(['["mujoco alone"]']) if known.name == finding["subject"])
    result = replay_finding(finding, subject)
    assert (finding["check"] in result.faults) == finding["open"], result


def test_the_equations_of_motion_hold_to_rounding_for_masses_from_1e_13_to_1e9_kg():
    """The residual of M (a - free) = J^T f is relative to the terms of each equation."""
    mechanism = build(Adapted(TUNED).draw(1199539626, 8, ALL_KINDS, 4))
    rows, inertias = mechanism.rows(mechanism.pose), mechanism.inertias.reshape(-1)
    free = mechanism.unconstrained(mechanism.pose, mechanism.twist)
    solved = constrained(rows, mechanism.bias(mechanism.pose, mechanism.twist), mechanism.inertias, free)
    residual = inertias * (solved.motion - free).reshape(-1) - rows.T @ solved.force
    term_sizes = inertias * np.abs(solved.motion).reshape(-1) + np.abs(rows.T) @ np.abs(solved.force)
    assert np.max(inertias) > 1e15 * np.min(inertias)
    assert np.abs(residual[term_sizes > 0] / term_sizes[term_sizes > 0]).max() < 1e-14


def _changed_row(change: Callable[[RowWriter, Any, Any, Any], None]) -> Callable[[pytest.MonkeyPatch], None]:
    def put(monkeypatch: pytest.MonkeyPatch) -> None:
        right = RowWriter.write

        def wrong(self: RowWriter, q: Any, v: Any, jacobian: Any, reference: Any) -> None:
            right(self, q, v, jacobian, reference)
            change(self, v, jacobian, reference)

        monkeypatch.setattr(RowWriter, "write", wrong)

    return put


def _flipped_sign(self: RowWriter, v: Any, jacobian: Any, reference: Any) -> None:
    jacobian[-self.size * len(v) :: len(v)] *= -1.0  # this slice is the column of the first coordinate


def _flipped_velocity_term(self: RowWriter, v: Any, jacobian: Any, reference: Any) -> None:
    reference[-self.size :] *= -1.0


def _without_velocity_term(monkeypatch: pytest.MonkeyPatch) -> None:
    right = RowWriter.write
    monkeypatch.setattr(RowWriter, "write", lambda self, q, v, *arrays: right(self, q, 0.0 * v, *arrays))


def _late_reaction(monkeypatch: pytest.MonkeyPatch) -> None:
    right = MuJoCoRun.__call__

    def late(self: MuJoCoRun, samples: int, every: int) -> Trajectory:
        run = right(self, samples, every)
        return replace(run, reaction=np.roll(run.reaction, 1, axis=0))

    monkeypatch.setattr(MuJoCoRun, "__call__", late)


def _other_way(monkeypatch: pytest.MonkeyPatch) -> None:
    right = pymunk_model.motor
    monkeypatch.setattr(
        pymunk_model, "motor", lambda joint, *rest: right(replace(joint, turning_rate=-joint.turning_rate), *rest)
    )


def _faster(monkeypatch: pytest.MonkeyPatch) -> None:
    """Give the recorded velocities an error of three times the tolerance."""
    right = pymunk_declared.record

    def off(*arguments: Any, **named: Any) -> Any:
        run = right(*arguments, **named)
        return replace(run, after=run.after + 3 * LAW_TOLERANCE * np.abs(run.after).max() * np.eye(3)[0])

    monkeypatch.setattr(pymunk_declared, "record", off)


@pytest.mark.parametrize(
    ("engine", "kinds", "mistake", "check"),
    [
        (EXTENDED, ("slot",), _changed_row(_flipped_sign), "raised"),  # the mechanism does not have this row
        (EXTENDED, ("slot",), _changed_row(_flipped_velocity_term), "acceleration"),
        (EXTENDED, ("pin", "rod"), _without_velocity_term, "acceleration"),
        (DEFAULT, ("pin",), _late_reaction, "reaction"),
        (LEAPFROG, ("pin", "drive"), _other_way, "velocity"),
        (PYMUNK_TUNED, ("pin", "spring"), _faster, "velocity"),
    ],
)
def test_a_mistake_in_an_adapter_is_found(engine, kinds, mistake, check, monkeypatch):
    mistake(monkeypatch)
    assert check in faults(engine, kinds, 12)


def _heavier(model: MuJoCoModel) -> None:
    model.compiled.body_inertia[:] *= 1 + 1e-3


def _pulled_by_place(model: MuJoCoModel) -> None:
    model.compiled.opt.gravity[:2] *= 1 + 3e-6 * model.mechanism.pose[0, 0]


def _softer(model: MuJoCoModel) -> None:
    model.compiled.tendon_invweight0[:] *= 10


@pytest.mark.parametrize(
    ("engine", "seed", "number", "decades", "oracle", "change", "check"),
    [
        (TUNED, 163507254, 8, 2, "instant", _heavier, "acceleration"),
        (DEFAULT, 4242, 2, 0, "relations", _pulled_by_place, "mirrored"),
        pytest.param(
            *(replace(EXTENDED, estimates=False), 1199539626, 75, 2, "motions", _softer, "motion"),
            marks=pytest.mark.slow,  # it takes 20 s
        ),
    ],
    ids=["inertia", "gravity depends on position", "softer row"],
)
def test_a_change_of_mujocos_model_is_found_among_noise(
    engine, seed, number, decades, oracle, change, check, monkeypatch
):
    subject, right = Adapted(engine), mujoco_engine.build_model
    case = subject.draw(seed, number, ALL_KINDS, decades)
    assert subject.ask(case, number, (oracle,)).faults == ()

    def built(*arguments: Any) -> MuJoCoModel:
        model = right(*arguments)
        change(model)
        return model

    monkeypatch.setattr(mujoco_engine, "build_model", built)
    assert check in subject.ask(case, number, (oracle,)).faults


@dataclass(frozen=True)
class Beside(EngineWrapper):
    """An engine with the error `speed` in all velocities along x. `declares`: whether `stricter` returns the right
    engine."""

    engine: Any
    variant: str = "off"
    speed: float = 1e-4
    declares: bool = False

    def stricter(self, mechanism: Mechanism) -> Engine | None:
        return self.engine if self.declares else None

    def build(self, mechanism: Mechanism, dt: float) -> Any:
        def off(run: Trajectory) -> Trajectory:
            return replace(run, twist=run.twist + self.speed * np.eye(3)[0])

        return Spoiled(self.engine.build(mechanism, dt), off)


def test_the_residual_of_a_solver_is_no_fault_if_the_engine_declares_a_stricter_one():
    engine, number = Lagrange("rk4", "projection"), RELATIONS.index("turned")
    for declares, expected in ((False, ("turned",)), (True, ())):
        subject = Adapted(Beside(engine, declares=declares))
        assert subject.ask(subject.draw(SEED, 3, ("pin",), 0), number, ("relations",)).faults == expected


def test_a_constant_declared_compliance_skips_the_check_and_one_that_falls_with_the_step_does_not():
    """The compliance of a loop of pins is constant in MuJoCo's default, and falls as the square of the step in
    "tuned"."""
    shipped, tuned = (results(engine, ("pin",), 8, "motions") for engine in (DEFAULT, TUNED))
    soft = [any("give way" in reason for reason in result.skipped) for result in shipped]
    assert any(soft)
    assert any(result.errors for result, loop in zip(tuned, soft, strict=True) if loop)
    assert not any("give way" in reason for result in tuned for reason in result.skipped)
    assert faults(Altered(TUNED, PlantedFault("inertia", 1e-4)), ("pin",), 3, "motions")


@dataclass(frozen=True)
class Boasting(Lagrange):
    """A method of first order that declares order 4. `warns` selects the runs that warn, which are "fine" or "coarse"
    or none."""

    warns: str = ""

    def order(self, mechanism: Mechanism) -> ConvergenceOrder:
        return ConvergenceOrder(4)

    def build(self, mechanism: Mechanism, dt: float) -> Run:  # type: ignore[override]
        coarse = motions.MOTION_SPAN * mechanism.time_scale / motions.MOTION_SAMPLES / motions.COARSE_STEPS
        text = ("it is wrong",) if self.warns == ("fine" if dt < 0.75 * coarse else "coarse") else ()
        return Spoiled(super().build(mechanism, dt), lambda run: replace(run, warnings=text))


def test_an_error_that_does_not_fall_with_the_declared_order_is_found_unless_a_run_warns():
    assert faults(Boasting("euler", "projection"), ("pin",), 3, "motions") & {"motion", "reactions"}
    assert faults(Lagrange("rk4", "projection"), ("pin",), 3, "motions") == set()
    for warns in ("fine", "coarse"):
        for result in results(Boasting("euler", "projection", warns=warns), ("pin",), 3, "motions"):
            assert result.faults == ()
            assert any("something is wrong" in reason for reason in result.skipped)


def test_no_engine_is_compared_with_a_judge_that_misses_its_tolerance(monkeypatch):
    monkeypatch.setattr(motions, "TRUTH", Judge(tolerance=1e-2))
    monkeypatch.setattr(motions, "judge_motion", motions.judge_motion.__wrapped__)  # pyright: ignore[reportFunctionMemberAccess]
    for result in results(Boasting("euler", "projection"), ("pin",), 3, "motions"):
        assert not result.errors
        assert "the judge does not reach its tolerance of 1e-10" in result.skipped[0]


def test_an_exception_of_an_engine_and_one_of_an_oracle_are_different_checks(monkeypatch):
    def broken(*_: Any) -> Any:
        raise KeyError("body 7")

    [result] = results(Altered(Lagrange(), broken), FIRST_KINDS, 1, "motions")
    assert result.faults == ("raised",)
    assert "body 7" in result.words
    for module, engine, oracle in ((motions, Lagrange("rk4"), "motions"), (law, EXTENDED, "instant")):
        monkeypatch.setattr(module, "difference", broken)
        [result] = results(engine, ("pin",), 1, oracle)
        assert result.faults == (OUR_ERROR,)
        assert result.words.startswith("ours: KeyError")

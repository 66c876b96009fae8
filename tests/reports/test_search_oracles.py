"""The oracles of the search: right adapters pass, and every mistake that is put into one is found."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

import csv
import json
import re
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
from engines.pymunk.declared import GROOVE_LAW
from engines.registry import INSTALLED, VARIANTS
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reports.gate.change import Altered
from reports.model.ending import BadInput
from reports.search import law, motions, mujoco_alone, plan, release
from reports.search.law import LAW_TOLERANCE
from reports.search.mujoco_alone import HINGED_KINDS, to_mjcf
from reports.search.oracles import DEFAULT_ORACLES
from reports.search.page import known_subjects
from reports.search.parts import ALL_KINDS, FIRST_KINDS
from reports.search.planted import CONTROL_ENGINES, FAULT_SIZES, PLANTED_FAULTS, PlantedControl, PlantedFault
from reports.search.recipe import build
from reports.search.relations import RELATIONS
from reports.search.release import BESIDE_CURVED, CURVED, check_accelerations, process_of
from reports.search.shrinking import replay_finding
from reports.search.subjects import OUR_ERROR, Adapted, OracleResult
from tests.wrong.adapters import Spoiled

SEED = 1
HERE = Path(__file__).parent
FINDINGS = sorted((HERE / "findings").glob("*.json"))
ENGINES = {f"{engine.name} {engine.variant}": engine for engine in (*VARIANTS, *INSTALLED)}


def results(engine: Any, kinds: tuple[str, ...], cases: int, oracle: str = "instant") -> list[OracleResult]:
    subject = Adapted(engine)
    return [subject.ask(subject.draw(SEED, number, kinds, 0), number, (oracle,)) for number in range(cases)]


def faults(engine: Any, kinds: tuple[str, ...], cases: int, oracle: str = "instant") -> set[str]:
    """The checks that fail in any of these cases."""
    return {check for result in results(engine, kinds, cases, oracle) for check in result.faults}


# -------------------------------------------------------------------------------------------------- what is right

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
def test_adapters_obey_the_law_that_they_declare(engine: Any, kinds: tuple[str, ...]) -> None:
    result_value = results(engine, kinds, 16)
    assert sum(bool(result.errors) for result in result_value) >= 5, "nearly nothing was asked"
    assert {check for result in result_value for check in result.faults} == set()


@pytest.mark.parametrize("part", [0, *(pytest.param(part, marks=pytest.mark.slow) for part in range(1, 8))])
def test_cases_that_an_oracle_once_took_for_faults_are_none(part: int) -> None:
    """The corpus: seeds whose rounding, declared give or solver's tolerance is large. A fault that is found is added to
    it if it was none; a true one goes to `findings`."""
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
def test_a_finding_is_as_it_was_written_down(path: Path) -> None:
    """An open one is still there, one that is repaired does not come back; `reason` says whose it is."""
    finding: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    assert finding["reason"].startswith(("upstream: ", "ours: "))
    subject = next(
        known_subject
        for known_subject in known_subjects(['["mujoco alone"]'])
        if known_subject.name == finding["subject"]
    )
    result = replay_finding(finding, subject)
    assert (finding["check"] in result.faults) == finding["open"], result


def test_a_light_bodys_equations_are_solved_to_its_own_digits_beside_heavy_ones() -> None:
    """From masses of 1e-13 to 1e9 kg: the residual of M (a - free) = J^T f, relative to the terms of each line."""
    mechanism = build(Adapted(TUNED).draw(1199539626, 8, ALL_KINDS, 4))
    rows, inertias = mechanism.rows(mechanism.pose), mechanism.inertias.reshape(-1)
    free = mechanism.unconstrained(mechanism.pose, mechanism.twist)
    solved = constrained(rows, mechanism.bias(mechanism.pose, mechanism.twist), mechanism.inertias, free)
    rest = inertias * (solved.motion - free).reshape(-1) - rows.T @ solved.force
    term_sizes = inertias * np.abs(solved.motion).reshape(-1) + np.abs(rows.T) @ np.abs(solved.force)
    assert np.max(inertias) > 1e15 * np.min(inertias)
    assert np.abs(rest[term_sizes > 0] / term_sizes[term_sizes > 0]).max() < 1e-14


# ------------------------------------------------------------------------------------- mistakes put into adapters


def _changed_row(change: Callable[[RowWriter, Any, Any, Any], None]) -> Callable[[pytest.MonkeyPatch], None]:
    def put(monkeypatch: pytest.MonkeyPatch) -> None:
        right = RowWriter.write

        def wrong(self: RowWriter, q: Any, v: Any, jacobian: Any, reference: Any) -> None:
            right(self, q, v, jacobian, reference)
            change(self, v, jacobian, reference)

        monkeypatch.setattr(RowWriter, "write", wrong)

    return put


def _flipped_sign(self: RowWriter, v: Any, jacobian: Any, reference: Any) -> None:
    jacobian[-self.size * len(v) :: len(v)] *= -1.0  # of the first coordinate


def _flipped_velocity_term(self: RowWriter, v: Any, jacobian: Any, reference: Any) -> None:
    reference[-self.size :] *= -1.0


def _without_velocity_term(monkeypatch: pytest.MonkeyPatch) -> None:
    """As MuJoCo's own equality of a tendon leaves it out; here with the damping of slip, which is rounding."""
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
    """By three times the bound of the law."""
    right = pymunk_declared.record

    def off(*arguments: Any, **named: Any) -> Any:
        run = right(*arguments, **named)
        return replace(run, after=run.after + 3 * LAW_TOLERANCE * np.abs(run.after).max() * np.eye(3)[0])

    monkeypatch.setattr(pymunk_declared, "record", off)


@pytest.mark.parametrize(
    ("engine", "kinds", "mistake", "check"),
    [
        (EXTENDED, ("slot",), _changed_row(_flipped_sign), "raised"),  # a row that is none of the mechanism's
        (EXTENDED, ("slot",), _changed_row(_flipped_velocity_term), "acceleration"),
        (EXTENDED, ("pin", "rod"), _without_velocity_term, "acceleration"),
        (DEFAULT, ("pin",), _late_reaction, "reaction"),
        (LEAPFROG, ("pin", "drive"), _other_way, "velocity"),
        (PYMUNK_TUNED, ("pin", "spring"), _faster, "velocity"),
    ],
)
def test_a_mistake_in_an_adapter_is_found(
    engine: Engine, kinds: tuple[str, ...], mistake: Any, check: str, monkeypatch: pytest.MonkeyPatch
) -> None:
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
        (replace(EXTENDED, estimates=False), 1199539626, 75, 2, "motions", _softer, "motion"),
    ],
    ids=["an inertia", "a pull of the place", "a softer row"],
)
def test_in_cases_with_much_noise_a_change_of_mujocos_model_is_found(
    engine: Engine,
    seed: int,
    number: int,
    decades: int,
    oracle: str,
    change: Callable[[MuJoCoModel], None],
    check: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    subject, right = Adapted(engine), mujoco_engine.build_model
    case = subject.draw(seed, number, ALL_KINDS, decades)
    assert subject.ask(case, number, (oracle,)).faults == ()

    def built(*arguments: Any) -> MuJoCoModel:
        model = right(*arguments)
        change(model)
        return model

    monkeypatch.setattr(mujoco_engine, "build_model", built)
    assert check in subject.ask(case, number, (oracle,)).faults


def test_a_groove_off_the_centre_of_mass_misses_its_velocities_and_obeys_the_law_on_the_page_of_faults() -> None:
    """The wrong one of Chipmunk's own formula: K^-1 in two directions, of which the part along the normal is kept."""
    cases = [plan.GROOVE_SUBJECT.draw(SEED, number, ("pin", "slot"), 0) for number in range(9)]
    result = [plan.GROOVE_SUBJECT.ask(case, 0, ("instant",)).errors for case in cases if "slot" in case.kinds]
    assert sum(errors["velocity"][0] > 1e-3 for errors in result) >= 5
    assert max(errors[GROOVE_LAW][0] for errors in result) < 1e-10


# -------------------------------------------------------------------------------------------------- other descriptions


@dataclass(frozen=True)
class Beside(EngineWrapper):
    """Its velocities along x are off by this; those of `alike` are not, if it `tells`."""

    engine: Any
    variant: str = "off"
    speed: float = 1e-4
    tells: bool = False

    def stricter(self, mechanism: Mechanism) -> Engine | None:
        return self.engine if self.tells else None

    def build(self, mechanism: Mechanism, dt: float) -> Any:
        def off(run: Trajectory) -> Trajectory:
            return replace(run, twist=run.twist + self.speed * np.eye(3)[0])

        return Spoiled(self.engine.build(mechanism, dt), off)


def test_what_a_solver_leaves_is_no_fault_where_the_engine_declares_it() -> None:
    engine, number = Lagrange("rk4", "projection"), RELATIONS.index("turned")
    for tells, expected in ((False, ("turned",)), (True, ())):
        subject = Adapted(Beside(engine, tells=tells))
        assert subject.ask(subject.draw(SEED, 3, ("pin",), 0), number, ("relations",)).faults == expected


# -------------------------------------------------------------------------------------------------------------- motions


def test_joints_that_are_tied_to_the_step_are_asked_and_those_that_give_way_for_good_are_not() -> None:
    """A loop of pins: MuJoCo's springs fall as the square of the step where it is tuned, and stay as shipped."""
    shipped, tuned = (results(engine, ("pin",), 8, "motions") for engine in (DEFAULT, TUNED))
    soft = [any("give way" in reason for reason in result.skipped) for result in shipped]
    assert any(soft)
    assert any(result.errors for result, loop in zip(tuned, soft, strict=True) if loop)
    assert not any("give way" in reason for result in tuned for reason in result.skipped)
    assert faults(Altered(TUNED, PlantedFault("inertia", 1e-4)), ("pin",), 8, "motions")


@dataclass(frozen=True)
class Boasting(Lagrange):
    """A method of the first order that promises the fourth; it may warn in fine runs, or in coarse ones."""

    warns: str = ""

    def order(self, mechanism: Mechanism) -> ConvergenceOrder:
        return ConvergenceOrder(4)

    def build(self, mechanism: Mechanism, dt: float) -> Run:  # type: ignore[override]
        rough = motions.MOTION_SPAN * mechanism.time_scale / motions.MOTION_SAMPLES / motions.COARSE_STEPS
        text = ("it is wrong",) if self.warns == ("fine" if dt < 0.75 * rough else "coarse") else ()
        return Spoiled(super().build(mechanism, dt), lambda run: replace(run, warnings=text))


def test_a_motion_that_does_not_fall_with_the_promised_order_is_found_unless_a_run_warns() -> None:
    assert faults(Boasting("euler", "projection"), ("pin",), 3, "motions") & {"motion", "reactions"}
    assert faults(Lagrange("rk4", "projection"), ("pin",), 3, "motions") == set()
    for warns in ("fine", "coarse"):
        for result in results(Boasting("euler", "projection", warns=warns), ("pin",), 3, "motions"):
            assert result.faults == ()
            assert any("something is wrong" in reason for reason in result.skipped)


def test_nobody_is_held_against_a_motion_that_the_judge_does_not_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(motions, "TRUTH", Judge(tolerance=1e-2))
    monkeypatch.setattr(motions, "judge_motion", motions.judge_motion.__wrapped__)  # pyright: ignore[reportFunctionMemberAccess]
    for result in results(Boasting("euler", "projection"), ("pin",), 3, "motions"):
        assert not result.errors
        assert "the judge does not reach its tolerance of 1e-10" in result.skipped[0]


def test_an_exception_is_a_fault_of_whoever_raised_it(monkeypatch: pytest.MonkeyPatch) -> None:
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


# ------------------------------------------------------------------------------------------------------ planted faults

# Single precision hides more: 1e4 roundings of 1.2e-7 between two descriptions.
SINGLE: dict[str, float] = dict.fromkeys(RELATIONS, 1e-2) | {"in other masses": 1e-1}
PARTS = 6  # of the faults; each adapter has another part of them every day, and all of them in the slow tests
ADAPTERS = [name for name in CONTROL_ENGINES if name != "mjx"]


@pytest.mark.parametrize(
    ("name", "part"),
    [
        pytest.param(name, part, marks=() if part == index % PARTS else pytest.mark.slow)
        for index, name in enumerate(ADAPTERS)
        for part in range(PARTS)
    ],
)
def test_a_fault_of_a_millionth_is_found_in_every_adapter(name: str, part: int) -> None:
    """A fault in each kind and relation is found; the same cases without the fault have no finding."""
    if missing := next((engine.missing for engine in CONTROL_ENGINES[name] if engine.missing), ""):
        pytest.skip(missing)
    for fault in PLANTED_FAULTS[part::PARTS]:
        result = PlantedControl(
            name, fault, (SINGLE.get(fault, FAULT_SIZES[0]) if name == "box2d" else FAULT_SIZES[0],)
        ).run()
        if result["asked"]:
            assert result["check"], fault
        else:  # Box2D declares no law and promises no order: descriptions alone are compared
            assert not result["built"] or name == "box2d", fault


# --------------------------------------------------------------------------------------------------------- MuJoCo alone


def test_mujoco_alone_obeys_the_law_with_connects_welds_and_gears() -> None:
    for number in range(25):
        assert (
            check_accelerations(mujoco_alone.draw_model(SEED, number, HINGED_KINDS))["errors"]["acceleration"] < 1e-10
        )


def test_the_law_of_a_curved_tendon_is_the_second_derivative_of_its_curve() -> None:
    """For first = slope second + bend second^2 at second = 0, the rates of a sum are squared, not summed squares."""
    requested = 0
    for number in range(12):
        model = mujoco_alone.draw_model(SEED, number, ("tendon",))
        law = mujoco_alone.start_equations(model)
        accelerations = law.expected(np.zeros((len(model.links), 1)))
        for link in model.links:
            first, second = mujoco_alone.coupled_coordinates(model, link)
            turning = link.curve[1] * law.rates[second].sum() ** 2
            rest = accelerations[first].sum() - link.curve[0] / 2 * accelerations[second].sum() - turning
            assert abs(rest) < 1e-9 * max(1.0, np.abs(accelerations).max())
            requested += abs(turning) > 0.1 and len(second) == 2
    assert requested >= 3


def test_the_known_fault_of_curved_equalities_hides_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    """A mass that is off by a millionth, in models whose curved equalities lack their velocity term."""
    cases = [mujoco_alone.draw_model(1, number, ("joint", "tendon")) for number in range(20)]
    moving = [case for case in cases if CURVED in check_accelerations(case)["errors"]]
    assert len(moving) >= 5
    for case in moving:
        errors = check_accelerations(case)["errors"]
        assert errors[BESIDE_CURVED] < 1e-10 < errors[CURVED]

    def heavier(model: mujoco_alone.RawModel) -> str:
        return re.sub(r'mass="([^"]+)"', lambda one: f'mass="{1.000001 * float(one[1])!r}"', to_mjcf(model), count=1)

    monkeypatch.setattr(release, "to_mjcf", heavier)
    assert any(check_accelerations(case)["errors"][BESIDE_CURVED] > LAW_TOLERANCE for case in moving)


@pytest.mark.slow
@pytest.mark.parametrize(("version", "most"), [("3.6.0", 20), ("4.0.0", 2000)])
def test_the_fault_of_a_past_release_is_found(version: str, most: int) -> None:
    """Both are silent. 3.6.0 leaves the velocity term out of connects and welds; 4.0.0 factorises the Hessian of its
    Newton solver wrongly for some trees that branch, where the Jacobian is sparse."""
    try:
        process = process_of(version)
    except BadInput as reason:
        pytest.skip(f"MuJoCo {version} can't be installed here: {reason}")
    models = (mujoco_alone.draw_model(SEED, number, HINGED_KINDS) for number in range(most))
    try:
        wrong = next(
            model
            for model in models
            if not check_accelerations(model, version)["errors"]["acceleration"] <= LAW_TOLERANCE
        )
    finally:
        process.kill()
        process.communicate()
    assert check_accelerations(wrong)["errors"]["acceleration"] <= LAW_TOLERANCE  # the installed release is right there
    assert version != "4.0.0" or wrong.sparse

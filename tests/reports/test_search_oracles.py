"""What the search asks: right adapters pass, and every mistake that is put into one is found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from engines import Around, Promise, Run
from engines.lagrange import TRUTH, Judge, Lagrange
from engines.mujoco import DEFAULT, EXTENDED, TUNED
from engines.mujoco.running import MuJoCoRun
from engines.mujoco.user_rows import RowWriter
from engines.pymunk import EXTENDED as PYMUNK_EXTENDED
from engines.pymunk import LEAPFROG
from engines.pymunk import TUNED as PYMUNK_TUNED
from engines.pymunk import model as pymunk_model
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reports.gate.change import Altered
from reports.search import (
    instant_mujoco,
    instant_pymunk,
    mechanisms,
    motion_bounds,
    motions,
    plan,
    raw,
    raw_law,
    relations,
)
from reports.search.instant_pymunk import PUSHED
from reports.search.mechanisms import ALL
from reports.search.parts import EVERY
from reports.search.planted import Off
from reports.search.relations import NAMES
from reports.search.scripts import script
from reports.search.shrinking import shrunk
from reports.search.subjects import OURS, Adapted, Alone, Told
from tests.reports.test_search_scripts import differences
from tests.wrong.adapters import Spoiled, Wrong

SEED = 1


def told(engine: Any, kinds: tuple[str, ...], cases: int, oracle: str = "instant") -> list[Told]:
    subject = Adapted(engine)
    return [subject.ask(subject.draw(SEED, number, kinds, 0), number, (oracle,)) for number in range(cases)]


def faults(engine: Any, kinds: tuple[str, ...], cases: int, oracle: str = "instant") -> set[str]:
    """The checks that fail in any of these cases."""
    return {check for one in told(engine, kinds, cases, oracle) for check in one.faults}


# -------------------------------------------------------------------------------------------------- what is right


@pytest.mark.parametrize(
    ("engine", "kinds"),
    [(DEFAULT, ("pin",)), (EXTENDED, ("pin", "slot", "skate")), (LEAPFROG, ("pin", "slot", "skate", "drive"))],
    ids=lambda value: getattr(value, "variant", None),
)
def test_adapters_obey_the_law_that_they_declare(engine: Any, kinds: tuple[str, ...]) -> None:
    found = told(engine, kinds, 8)
    assert sum(bool(one.errors) for one in found) >= 5, "nearly nothing was asked"
    assert {check for one in found for check in one.faults} == set()


def test_mujoco_alone_obeys_it_with_connects_welds_and_gears() -> None:
    for number in range(25):
        assert raw_law.errors(raw_law.model(SEED, number, ("connect", "weld", "gear")))["acceleration"] < 1e-10


def test_a_groove_off_the_centre_of_mass_misses_its_velocities_and_obeys_the_law_on_the_page_of_faults() -> None:
    """The wrong one of Chipmunk's own formula: K^-1 in two directions, of which the part along the normal is kept."""
    cases = [plan.GROOVE.draw(SEED, number, ("pin", "slot"), 0) for number in range(9)]
    found = [plan.GROOVE.ask(case, 0, ("instant",)).errors for case in cases if "slot" in case.kinds]
    assert sum(each["velocity"][0] > 1e-3 for each in found) >= 5
    assert max(each[PUSHED][0] for each in found) < 1e-10


# ------------------------------------------------------------------------------------- mistakes put into adapters


def test_a_sign_flipped_in_a_row_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    right = RowWriter.write

    def flipped(self: RowWriter, q: Any, v: Any, jacobian: Any, reference: Any) -> None:
        right(self, q, v, jacobian, reference)
        jacobian[-self.size * len(v) :: len(v)] *= -1.0  # of the first coordinate

    monkeypatch.setattr(RowWriter, "write", flipped)
    assert "instant" in faults(EXTENDED, ("slot",), 8)  # MuJoCo then has a row that is none of the mechanism's


def test_a_velocity_term_of_the_wrong_sign_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    right = RowWriter.write

    def flipped(self: RowWriter, q: Any, v: Any, jacobian: Any, reference: Any) -> None:
        right(self, q, v, jacobian, reference)
        reference[-self.size :] *= -1.0

    monkeypatch.setattr(RowWriter, "write", flipped)
    assert "acceleration" in faults(EXTENDED, ("slot",), 8)


def test_a_motor_that_turns_the_wrong_way_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    right = pymunk_model.motor
    monkeypatch.setattr(
        pymunk_model,
        "motor",
        lambda joint, *given: right(replace(joint, turning_rate=-joint.turning_rate), *given),
    )
    assert "velocity" in faults(LEAPFROG, ("pin", "drive"), 12)


def test_a_reaction_read_at_the_wrong_time_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    right = MuJoCoRun.__call__

    def late(self: MuJoCoRun, samples: int, every: int) -> Trajectory:
        run = right(self, samples, every)
        return replace(run, reaction=np.roll(run.reaction, 1, axis=0))

    monkeypatch.setattr(MuJoCoRun, "__call__", late)
    assert "reaction" in faults(DEFAULT, ("pin",), 6)


def test_a_direction_of_the_world_that_is_taken_for_granted_is_found() -> None:
    subject = Adapted(Wrong("gravity points down"))
    case = next(case for case in (subject.draw(SEED, n, ("pin",), 0) for n in range(20)) if case.gravity[0])
    assert subject.ask(case, NAMES.index("turned"), ("relations",)).faults == ("turned",)


@dataclass(frozen=True)
class InItsUnits:
    """A fixed mass [kg], or arm [m], is taken for granted on every body beside what is told."""

    mass: float = 0.0
    arm: float = 0.0

    def __call__(self, mechanism: Mechanism) -> Mechanism:
        bodies = tuple(
            replace(body, mass=body.mass + self.mass, inertia=body.inertia + body.mass * self.arm**2)
            for body in mechanism.bodies
        )
        return replace(mechanism, bodies=bodies)


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("in other masses", InItsUnits(mass=0.01)),
        ("in other lengths", InItsUnits(arm=0.01)),
    ],
)
def test_a_number_with_a_unit_that_is_taken_for_granted_is_found(name: str, wrong: InItsUnits) -> None:
    def found(engine: Any) -> set[str]:
        subject, number = Adapted(engine), NAMES.index(name)
        cases = [subject.draw(SEED, case, ("pin",), 0) for case in range(8)]
        return {fault for case in cases for fault in subject.ask(case, number, ("relations",)).faults}

    assert found(Lagrange("rk4", "projection")) == set()
    assert found(Altered(Lagrange("rk4", "projection"), wrong)) == {name}


@pytest.mark.parametrize("name", ["in other masses", "in other lengths"])
def test_a_case_that_is_written_in_units_of_its_own_is_asked_in_others_too(name: str) -> None:
    subject, number = Adapted(Lagrange("rk4", "projection")), NAMES.index(name)
    cases = [case for n in range(12) if all((case := subject.draw(SEED, n, ("pin",), 2)).decades[:2])]
    told = [subject.ask(case, number, ("relations",)) for case in cases]
    assert {name} == {each for one in told for each in one.errors} > {fault for one in told for fault in one.faults}


@dataclass(frozen=True)
class Single(Lagrange):
    """Computes in single precision, as it says, and feels so much of its gravity's part along x."""

    precision: ClassVar[float] = 2.0**-23
    part: float = 1.0

    def build(self, mechanism: Mechanism, dt: float) -> Run:  # type: ignore[override]
        x, y = mechanism.gravity
        run = super().build(replace(mechanism, gravity=(self.part * x, y)), dt)
        return Spoiled(run, self._rounded)

    def _rounded(self, given: Trajectory) -> Trajectory:
        return replace(
            given, **{name: getattr(given, name).astype(np.float32).astype(float) for name in ("pose", "twist")}
        )


def test_single_precision_hides_its_rounding_and_no_hundredth_of_a_motion() -> None:
    def found(engine: Any) -> list[str]:
        subject, number = Adapted(engine), NAMES.index("turned")
        cases = [case for n in range(24) if (case := subject.draw(SEED, n, ("pin",), 0)).gravity[0]]
        return [fault for case in cases for fault in subject.ask(case, number, ("relations",)).faults]

    assert relations.bound(Single("rk4")) < 2e-3
    assert found(Single("rk4", "projection")) == []
    assert found(Single("rk4", "projection", part=1.03))


def test_joints_that_are_tied_to_the_step_are_asked_and_those_that_give_way_for_good_are_not() -> None:
    """A loop of pins: MuJoCo's springs fall as the square of the step where it is tuned, and stay as shipped."""
    kinds, cases = ("pin",), range(8)

    def gives_way(engine: Any) -> list[bool]:
        found = told(engine, kinds, len(cases), "motions")
        return [any("give way" in reason for reason in one.not_asked) for one in found]

    assert any(gives_way(DEFAULT))
    assert not any(gives_way(TUNED))
    loops = [
        one for one, soft in zip(told(TUNED, kinds, len(cases), "motions"), gives_way(DEFAULT), strict=True) if soft
    ]
    assert any(one.errors for one in loops)
    assert faults(Altered(TUNED, Off("inertia", 1e-4)), kinds, len(cases), "motions")


@dataclass(frozen=True)
class Boasting(Lagrange):
    """A method of the first order that promises the fourth."""

    def order(self, mechanism: Mechanism) -> Promise:
        return Promise(4)


def test_a_motion_that_does_not_fall_with_the_promised_order_is_found() -> None:
    assert faults(Boasting("euler", "projection"), ("pin",), 3, "motions") & {"motion", "reactions"}
    assert faults(Lagrange("rk4", "projection"), ("pin",), 3, "motions") == set()


@dataclass(frozen=True)
class Drifting(Lagrange):
    """Every sample moves a body away by so many times what rounding of steps may add up to."""

    times: float = 0.0

    def build(self, mechanism: Mechanism, dt: float) -> Run:  # type: ignore[override]
        steps = round(motion_bounds.SPAN * mechanism.time_scale / dt)

        def drifted(given: Trajectory) -> Trajectory:
            by = self.times * motion_bounds.drifted(mechanism, given, steps)
            pose = given.pose.copy()
            pose[1:, :, 0] += by
            return replace(given, pose=pose)

        return Spoiled(super().build(mechanism, dt), drifted)


@pytest.mark.parametrize(("seed", "number", "decades"), [(77777, 263, 0), (1167020602, 28, 2), (1167020602, 90, 2)])
def test_what_rounding_of_steps_adds_up_to_is_no_fault_and_little_more_is(seed: int, number: int, decades: int) -> None:
    """Strong dampers that hold still what they are on: it moves by 1e-9 to 1e-6 m, as far as places are rounded."""
    case = Adapted(Lagrange()).draw(seed, number, EVERY, decades)
    for integrator in ("rk4", "dop853"):
        one, off = (Adapted(Drifting(integrator, times=times)).ask(case, number, ("motions",)) for times in (0.0, 2.0))
        assert one.faults == ()
        assert "motion" in one.errors  # it is asked
        assert "motion" in off.faults


def test_nobody_is_held_against_a_motion_that_the_judge_does_not_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    engine = Boasting("euler", "projection")
    assert all(one.errors for one in told(engine, ("pin",), 3, "motions"))
    monkeypatch.setattr(motions, "TRUTH", Judge(tolerance=1e-2))
    judged = motions.judged.__wrapped__  # pyright: ignore[reportFunctionMemberAccess]
    monkeypatch.setattr(motions, "judged", judged)  # what the judge said before is kept
    for one in told(engine, ("pin",), 3, "motions"):
        assert not one.errors
        assert "the judge itself does not hold 1e-10" in one.not_asked[0]


def test_an_order_is_not_missed_where_a_textbook_method_does_not_show_its_own() -> None:
    """A spring of 0.5 GN/m shrinks to less than a micrometre within a step: where stages fall decides what it does."""
    case = Adapted(Lagrange()).draw(1167020602, 191, EVERY, 2)
    one = Adapted(Lagrange("dop853")).ask(case, 191, ("motions",))
    assert one.faults == ()
    assert "a textbook method shows no order" in one.not_asked[0]


@dataclass(frozen=True)
class Admitting(Boasting):
    """As wrong as that, and says so in the finer runs alone, or in the coarse one alone."""

    finer: bool = True

    def build(self, mechanism: Mechanism, dt: float) -> Run:  # type: ignore[override]
        rough = motion_bounds.SPAN * mechanism.time_scale / motion_bounds.SAMPLES / motion_bounds.COARSE
        words = ("it is wrong",) if (dt < 0.75 * rough) is self.finer else ()
        return Spoiled(super().build(mechanism, dt), lambda given: replace(given, warnings=words))


@pytest.mark.parametrize("finer", [True, False])
def test_a_motion_of_which_any_run_warns_is_not_held_against_the_engine(finer: bool) -> None:
    for one in told(Admitting("euler", "projection", finer=finer), ("pin",), 3, "motions"):
        assert one.faults == ()
        assert any("something is wrong" in reason for reason in one.not_asked)


def test_an_exception_that_is_no_refusal_is_a_fault() -> None:
    def loses(mechanism: Mechanism) -> Mechanism:
        raise KeyError("body 7")

    [one] = told(Altered(Lagrange(), loses), ALL, 1, "motions")
    assert one.faults == ("raised",)
    assert "body 7" in one.words


def test_an_exception_of_an_oracle_is_no_fault_of_the_engine(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*given: Any) -> float:
        raise KeyError("a row that is not there")

    monkeypatch.setattr(motions, "difference", broken)
    monkeypatch.setattr(instant_mujoco, "errors", broken)
    for engine, oracle in ((Lagrange("rk4"), "motions"), (EXTENDED, "instant")):
        [one] = told(engine, ("pin",), 1, oracle)
        assert one.faults == (OURS,)
        assert one.words.startswith("ours: KeyError")


# ------------------------------------------------------------- mistakes put into rods, gears, welds and force elements

LINKED = ("pin", "rod", "gear", "weld")
SPRUNG = ("pin", "spring", "damper", "torsion-spring", "torsion-damper", "force", "torque")


@pytest.mark.parametrize(
    ("engine", "kinds"),
    [(EXTENDED, LINKED), (EXTENDED, SPRUNG), (TUNED, SPRUNG), (LEAPFROG, LINKED), (LEAPFROG, SPRUNG)],
    ids=lambda value: getattr(value, "variant", None),
)
def test_adapters_obey_the_law_with_rods_gears_welds_and_forces(engine: Any, kinds: tuple[str, ...]) -> None:
    found = told(engine, kinds, 25)
    assert sum(bool(one.errors) for one in found) >= 5, "nearly nothing was asked"
    assert {check for one in found for check in one.faults} == set()


def test_a_rods_velocity_term_that_is_left_out_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """As MuJoCo's own equality of a tendon leaves it out; here with the damping of slip, which is rounding."""
    right = RowWriter.write
    monkeypatch.setattr(RowWriter, "write", lambda self, q, v, *arrays: right(self, q, 0.0 * v, *arrays))
    assert "acceleration" in faults(EXTENDED, ("pin", "rod"), 12)


def test_a_gear_whose_ratio_is_that_of_its_other_wheel_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    right = pymunk_model.gear
    monkeypatch.setattr(
        pymunk_model, "gear", lambda joint, *given: right(replace(joint, ratio=1 / joint.ratio), *given)
    )
    assert faults(LEAPFROG, ("pin", "gear"), 12)


def _row_flipped(right: Callable[..., Any]) -> Callable[..., Any]:
    """A rod whose arm on the second body has a sign of its row flipped: its anchor is on the other side."""

    def rod(joint: Any, *given: Any) -> Any:
        x, y = joint.second_point
        return right(replace(joint, second_point=(x, -y)), *given)

    return rod


@pytest.mark.parametrize(
    ("kind", "wrong"),
    [
        ("rod", _row_flipped),
        ("rod", lambda right: lambda joint, *given: right(replace(joint, length=1.0001 * joint.length), *given)),
        ("gear", lambda right: lambda joint, *given: right(replace(joint, ratio=-joint.ratio), *given)),
        ("gear", lambda right: lambda joint, *given: right(replace(joint, phase=joint.phase + 1e-4), *given)),
        ("weld", lambda right: lambda joint, *given: right(replace(joint, angle=joint.angle + 1e-4), *given)),
    ],
)
def test_a_mistake_in_a_rod_a_gear_or_a_weld_of_pymunk_is_found(
    kind: str, wrong: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pymunk_model, kind, wrong(getattr(pymunk_model, kind)))
    assert faults(LEAPFROG, ("pin", kind), 12)


def test_a_weld_that_leaves_out_its_row_of_angles_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    right = pymunk_model.weld
    monkeypatch.setattr(pymunk_model, "weld", lambda *given: right(*given)[:1])
    assert faults(LEAPFROG, ("pin", "weld"), 12)


@dataclass(frozen=True)
class Beside(Around):
    """Its reactions, or its velocities along x, are off by this."""

    engine: Any
    variant: str = "off"
    reaction: float = 0.0
    speed: float = 0.0

    def build(self, mechanism: Mechanism, dt: float) -> Any:
        def off(run: Trajectory) -> Trajectory:
            return replace(run, twist=run.twist + self.speed * np.eye(3)[0], reaction=run.reaction + self.reaction)

        return Spoiled(self.engine.build(mechanism, dt), off)


def test_what_rounding_leaves_where_rows_nearly_depend_on_each_other_is_no_fault_and_twice_as_much_is() -> None:
    """Eight runs of a step, whose weights are 66: a bound that knew neither rows nor weights took this for a fault."""
    case, own = mechanisms.recipe(77777, 456, EVERY), mechanisms.mechanism(77777, 456, EVERY)
    span = motion_bounds.SPAN * own.time_scale / motion_bounds.SAMPLES
    truth = TRUTH.build(own, span)(motion_bounds.SAMPLES, 1)
    promise = PYMUNK_EXTENDED.order(own)
    assert isinstance(promise, Promise)
    rounded = motion_bounds.rounded_reactions(own, promise, truth, span / motion_bounds.COARSE / 2)
    force = 2 * rounded * motion_bounds.force_size(own, truth)
    assert Adapted(PYMUNK_EXTENDED).ask(case, 456, ("motions",)).faults == ()
    assert Adapted(Beside(PYMUNK_EXTENDED, reaction=force)).ask(case, 456, ("motions",)).faults == ("reactions",)


def test_descriptions_that_differ_by_what_rounding_makes_are_no_fault_and_by_much_more_are() -> None:
    case, own = mechanisms.recipe(4242, 126, EVERY), mechanisms.mechanism(4242, 126, EVERY)
    speed = 1e-4 * float(np.abs(own.twist).max())
    assert Adapted(PYMUNK_EXTENDED).ask(case, 126, ("relations",)).faults == ()
    assert Adapted(Beside(PYMUNK_EXTENDED, speed=speed)).ask(case, 126, ("relations",)).faults == ("turned",)


@pytest.mark.parametrize(("seed", "number"), [(77777, 14), (4242, 146)])
def test_velocities_off_by_twice_what_the_law_lets_pass_are_found_beside_springs_and_in_poses_that_need_more_sweeps(
    seed: int, number: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = mechanisms.recipe(seed, number, EVERY)
    assert Adapted(PYMUNK_TUNED).ask(case, number, ("instant",)).errors["velocity"][0] < instant_pymunk.LAW / 10
    right = instant_pymunk.record

    def off(*given: Any, **named: Any) -> Any:
        told = right(*given, **named)
        return replace(told, after=told.after + 3 * instant_pymunk.LAW * np.abs(told.after).max() * np.eye(3)[0])

    monkeypatch.setattr(instant_pymunk, "record", off)
    assert Adapted(PYMUNK_TUNED).ask(case, number, ("instant",)).faults == ("velocity",)


# --------------------------------------------------------------------------------------------- faults of MuJoCo's own


def test_the_law_of_a_curved_tendon_is_the_second_derivative_of_its_curve() -> None:
    """Of first = slope second + bend second^2 with second zero: the rates of a sum are squared, not summed squares."""
    asked = 0
    for number in range(12):
        model = raw_law.model(SEED, number, ("tendon",))
        judge = raw_law.judged(model)
        found = judge.expected(np.zeros((len(model.equalities), 1)))
        for each in model.equalities:
            first, second = ([one - 1, one] if one else [0] for one in (each.first, each.second))
            slope, bend = each.curve[0] / 2, each.curve[1] / 2
            turning = 2 * bend * judge.rates[second].sum() ** 2
            left = found[first].sum() - slope * found[second].sum() - turning
            assert abs(left) < 1e-9 * max(1.0, np.abs(found).max())
            asked += abs(turning) > 0.1 and len(second) == 2
    assert asked >= 3


def test_curved_equalities_without_their_velocity_term_are_found_made_small_and_written_as_a_script(
    tmp_path: Path,
) -> None:
    """MuJoCo up to 4.0.1: polycoef beyond the slope. One body is left, and the script shows it without our code."""
    subject = Alone()
    number = next(n for n in range(20) if subject.ask(raw_law.model(SEED, n, ("joint",)), n, ("instant",)).faults)
    case = raw_law.model(SEED, number, ("joint",))

    def still(smaller: raw.Model) -> bool:
        try:
            return bool(subject.ask(smaller, number, ("instant",)).faults)
        except ValueError:
            return False

    small = shrunk(case, still, 20.0)
    assert len(small.links) <= 2
    assert len(small.equalities) == 1
    assert sum(abs(value) for link in small.links for value in (*link.offset, *link.centre, link.mass)) <= 1
    text = script(subject, small, "acceleration", number)
    assert differences(text, tmp_path)[0] > 1e-4  # of accelerations of about 0.01: rates are halves

"""What is searched: an engine through its adapter, or MuJoCo alone, with what is asked of a case and how it is told."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from engines import Around, Engine, Unsupported, method_name
from engines.box2d import Box2D
from engines.mjx import Mjx
from engines.mujoco import MuJoCo
from engines.pymunk import Pymunk
from reference.mechanism import Mechanism
from reports.search import (
    claims,
    instant_box2d,
    instant_mujoco,
    instant_pymunk,
    mechanisms,
    motions,
    raw,
    raw_law,
    relations,
)
from reports.search.law import Fault, NotAsked
from reports.search.mechanisms import of_a_shape
from reports.search.parts import EVERY, SINGULAR, Recipe, as_text, from_text
from reports.search.recipe import LEAST_RANK, build, dependence
from reports.search.release import release

ORACLES = ("instant", "relations", "motions")
CLAIMS = "claims"  # asked by its name alone: runs are as long as a user's, and cost as much
OURS = "our own error"  # of an oracle that raises: no fault of the engine
MOST = 0.1  # of what moves or acts, that rounding may be where rows nearly depend on each other
LAW = 1e-9  # of MuJoCo alone: rounding makes a thousandth of it


@dataclass(frozen=True)
class Told:
    """What was found of one case: (error, what it may be) by check, and why other checks were not asked."""

    errors: dict[str, tuple[float, float]]
    not_asked: tuple[str, ...] = ()
    words: str = ""  # of a fault that has no number

    @property
    def faults(self) -> tuple[str, ...]:
        """The checks that fail, the worst first."""
        over = {
            name: error / bound if bound > 0 else np.inf
            for name, (error, bound) in self.errors.items()
            if not error <= bound
        }
        return tuple(sorted(over, key=lambda name: -over[name]))


@dataclass(frozen=True)
class Adapted:
    """An engine, on recipes of joints."""

    engine: Engine

    @property
    def name(self) -> str:
        return method_name(self.engine)

    @property
    def kinds(self) -> tuple[str, ...]:
        return EVERY

    def draw(self, seed: int, number: int, kinds: tuple[str, ...], decades: int) -> Recipe:
        if is_shaped(self):
            return of_a_shape(self.engine, seed, number, kinds, decades)
        return _drawn(seed, number, kinds, decades)

    def ask(self, case: Recipe, number: int, oracles: Sequence[str]) -> Told:
        """All that these oracles ask of one case. Raises InvalidMechanism for a case that is none."""
        mechanism = _built(case)
        room = _room(mechanism) if {*SINGULAR} & {*case.kinds} else 1.0
        asked: dict[str, Callable[[], dict[str, tuple[float, float]]]] = {
            "instant": lambda: _instant(at_an_instant(self.engine, mechanism), mechanism, room),
            "relations": lambda: {
                name: (error, relations.bound(self.engine))
                for name, error in relations.errors(self.engine, case, number).items()
            },
            "motions": lambda: motions.errors(self.engine, mechanism),
            CLAIMS: lambda: claims.errors(self.engine, mechanism, number),
        }
        told = _asked({name: asked[name] for name in (*ORACLES, CLAIMS) if name in oracles}, self.engine)
        if room == 1 or CLAIMS in oracles:  # a claim leaves no room
            return told
        allowed = {name: (error, min(room * bound, max(MOST, bound))) for name, (error, bound) in told.errors.items()}
        return replace(told, errors=allowed)

    def text(self, case: Recipe) -> str:
        return as_text(case)

    def read(self, text: str) -> Recipe:
        return from_text(text)


@dataclass(frozen=True)
class Alone:
    """MuJoCo on models of its own format: no adapter takes part. See `raw`.

    `release`: another one than is installed, as "3.6.0"; see `reports.search.release`.
    """

    release: str = ""

    @property
    def name(self) -> str:
        return f"mujoco alone {self.release}".strip()

    @property
    def kinds(self) -> tuple[str, ...]:
        return raw.KINDS

    def draw(self, seed: int, number: int, kinds: tuple[str, ...], decades: int) -> raw.Model:
        return raw_law.model(seed, number, kinds)

    def ask(self, case: raw.Model, number: int, oracles: Sequence[str]) -> Told:
        def instant() -> dict[str, tuple[float, float]]:
            told = {"errors": raw_law.errors(case)} if not self.release else release(self.release).asked(case)
            if "raised" in told:
                raise Fault(told["raised"])
            return {name: (error, LAW) for name, error in told["errors"].items()}

        raw_law.judged(case)  # a case that is none is no fault
        return _asked({"instant": instant} if "instant" in oracles else {}, None)

    def text(self, case: raw.Model) -> str:
        return raw.as_text(case)

    def read(self, text: str) -> raw.Model:
        return raw.from_text(text)


Subject = Adapted | Alone
# One mechanism for all engines that are asked: its tables of curves that roll, and what the judge says of it, are kept.
_drawn, _built = lru_cache(motions.ASKED)(mechanisms.recipe), lru_cache(motions.ASKED)(build)


def _room(mechanism: Mechanism) -> float:
    """How many times as much rounding may do where rows nearly depend on each other: 1 for those drawn otherwise.

    With s the smallest singular value of the rows (each of length 1) beside the largest, multipliers solve a system of
    J M^-1 J^T, of condition 1 / s^2: so an engine that is right to rounding misses by eps / s^2, beside the largest of
    what it is compared with. Bounds allow for that with s = LEAST_RANK: 1e-9 is 4.5 eps / s^2.
    """
    rows = mechanism.rows(mechanism.pose) / np.tile([1.0, 1.0, mechanism.length_scale], len(mechanism.bodies))
    return max(1.0, (LEAST_RANK / dependence(rows)) ** 2)


def is_shaped(subject: Subject) -> bool:
    """Whether its cases are of few shapes, since a model takes seconds to build."""
    return isinstance(subject, Adapted) and subject.engine.building > 0


def _asked(oracles: dict[str, Callable[[], dict[str, tuple[float, float]]]], engine: Engine | None) -> Told:
    """What these say of an engine, None for MuJoCo alone; an exception is a fault of whoever raised it."""
    errors: dict[str, tuple[float, float]] = {}
    left, words = [], []
    with np.errstate(all="ignore"):
        for name, oracle in oracles.items():
            try:
                errors.update(oracle())
            except NotAsked as reason:
                left.append(f"{name}: {reason}")
            except Unsupported as reason:
                return Told(errors, (f"unsupported: {reason}",), "; ".join(words))
            except Fault as reason:
                errors[name] = (np.inf, 0.0)
                words.append(str(reason))
            except ImportError:  # no fault of an engine: the case is asked again where the module is there
                raise
            except Exception as error:  # whatever an adapter raises that is no refusal is a fault of its own
                own = engine is not None and _passed_through(error, engine)
                errors["raised" if own else OURS] = (np.inf, 0.0)
                words.append(f"{'' if own else 'ours: '}{type(error).__name__}: {error}"[:300])
    return Told(errors, tuple(left), "; ".join(words))


def _passed_through(error: Exception, engine: Engine) -> bool:
    """Whether an exception came out of the engine's own code, and not of what asks it alone."""
    owners = set()
    while True:
        module = type(engine).__module__
        # A package of an engine is all of it; beside modules of engines stand others, the judge's among them.
        owners.add(module if module.count(".") < 2 else module.rpartition(".")[0])
        if not isinstance(engine, Around):
            break
        engine = engine.engine
    called = [frame.f_globals.get("__name__", "") for frame, _ in traceback.walk_tb(error.__traceback__)]
    return any(name == owner or name.startswith(f"{owner}.") for name in called for owner in owners)


def at_an_instant(engine: Engine, mechanism: Mechanism) -> MuJoCo | Pymunk | Mjx | Box2D:
    """The engine that is stepped in the end: inside of those that choose and combine. Raises NotAsked."""
    stepped = engine.within(mechanism)
    if not isinstance(stepped, MuJoCo | Pymunk | Mjx | Box2D):
        raise NotAsked("it declares no law of an instant")
    return stepped


def _instant(
    engine: MuJoCo | Pymunk | Mjx | Box2D, mechanism: Mechanism, room: float
) -> dict[str, tuple[float, float]]:
    match engine:
        case MuJoCo():
            bound, found = instant_mujoco.bound(engine), instant_mujoco.errors(engine, mechanism)
        case Mjx():
            bound, found = instant_mujoco.bound(engine.settings), instant_mujoco.mjx_errors(engine, mechanism)
        case Box2D():
            bound, found = instant_box2d.bound(engine), instant_box2d.errors(engine, mechanism)
        case Pymunk() if room > 1:
            raise NotAsked("a sweep takes about the square of the rows' smallest singular value off their slowest mode")
        case Pymunk():
            bound, found = instant_pymunk.bound(engine), instant_pymunk.errors(engine, mechanism)
    return {name: (error, bound) for name, error in found.items()}

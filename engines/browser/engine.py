"""Physics engines of the browser under test: planck and p2 in JavaScript, Rapier and Jolt as WebAssembly.

A child process of Node runs `worlds.mjs`, which builds and steps the worlds. The child lives as long as this
process. `python -m engines.browser` installs the packages of npm into the user's cache folder.

The adapter switches off damping, which removes 10 % (p2) or 5 % (Jolt) of the velocity per second as shipped. Bodies do
not sleep or collide. A Pin is a revolute joint or a hinge, a Weld is a fixed joint, and a Rod is a distance joint. A
Slot is a prismatic joint if a Drive of rate zero keeps the angle. Otherwise a Slot is planck's wheel joint, or p2's
prismatic constraint without the rotational lock. A Drive is the motor of the Pin between the same two bodies.

Every step is semi-implicit Euler: first forces, then impulses of the joints, then positions. The engines correct gaps
in different ways. planck and Jolt move the bodies after the step (split impulses, `positionIterations` times). p2 has
implicit springs (Lacoursière's SPOOK, 1e6 N/m as shipped). Rapier has soft joints, which it solves in
`numSolverIterations` sub-steps. Therefore no order is declared.

Rapier, Jolt and p2 as shipped compute in single precision, and planck computes in double precision. planck reduces
speeds above 2 m or a quarter turn per step (Settings.maxTranslation, maxRotation), but its tuned variant has no limits.
Rapier reduces speeds above 400 m/s or an eighth of a turn per step. Rapier normalises cosine and sine after a step, so
a body with the angular velocity w turns too little, by the share (w h)^2 / 3 with the sub-step h. A run has a warning
if a speed may have been reduced.
"""

from __future__ import annotations

import itertools
import json
import math
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from engines.capability import Capability, Lack
from engines.contract import SINGLE_PRECISION, ConvergenceOrder, Enforcement, NotDeclared, Size, Unsupported
from engines.extrapolated import Extrapolated
from engines.motions import motors_of, over_three
from engines.package_versions import installed_version, npm_folder
from engines.sampling import unwrapped
from engines.single_run import ExtraEngine, Recorded
from reference.checks import Name, validated
from reference.joints import Drive, Gear, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import RunWarning

Settings = tuple[tuple[Name, float], ...]  # parameters of the engine by name
INSTALL = "python -m engines.browser"
STEP_COST = 20e-6  # approximate CPU time [s] of a step of three bodies
SPEED_CUT = RunWarning("upstream: the engine cut a velocity to its limit", "rate limit", "upstream")
# Largest velocities [m/s, rad/s] that an engine allows, as functions of the step [s].
SPEED_LIMITS: Mapping[str, Callable[[float], tuple[float, float]]] = {
    "planck": lambda dt: (2.0 / dt, math.pi / 2 / dt),
    "rapier": lambda dt: (400.0, math.pi / 4 / dt),
}
EQUAL_ANGLES = 1e-12  # rad


def _capability(engine: str, lacks_rod: str = "") -> Capability:
    """The joints that an adapter builds, without force elements; `lacks_rod`: why the adapter builds no rod."""
    lacks = {
        Gear: Lack(f"our adapter of {engine} builds no gear"),
        Skate: Lack(f"{engine} has no joint for a velocity across a blade"),
        Roll: Lack(f"in {engine} a disc rolls by contact and friction, and our adapter builds no contact"),
    }
    if lacks_rod:
        return Capability(engine, (Pin, Weld, Slot, Drive), (), {**lacks, Rod: Lack(lacks_rod)})
    return Capability(engine, (Pin, Weld, Slot, Drive, Rod), (), lacks)


def install() -> None:
    """Install the packages of all engines, or end the program with one line if npm is missing or fails."""
    folder = npm_folder()
    folder.mkdir(parents=True, exist_ok=True)
    packages = [f"{package}@{engine.release}" for engine in ENGINES for package in engine.packages]
    options = ["--prefix", str(folder), "--no-audit", "--no-fund", "--ignore-scripts", "--save-exact"]
    try:
        subprocess.run([shutil.which("npm") or "npm", "install", *options, *packages], check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        sys.exit(f"npm did not install the engines of the browser: {error}")


class Child:
    def __init__(self, engine: str, settings: Settings) -> None:
        script = Path(__file__).with_name("worlds.mjs")
        command = [shutil.which("node") or "node", str(script), str(npm_folder()), engine, json.dumps(dict(settings))]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.engine, self.settings, self.numbers = engine, settings, itertools.count()
        self.unused: list[int] = []  # worlds that the next request drops

    def close(self) -> None:
        for pipe in (self.process.stdin, self.process.stdout):
            if pipe is not None:
                with suppress(OSError):
                    pipe.close()

    def ask(self, operation: str, **request: Any) -> dict[str, Any]:
        """Send a request and return the answer. Raises Unsupported for a refusal, RuntimeError for an ended process."""
        assert self.process.stdin
        assert self.process.stdout
        unused, self.unused = self.unused, []
        self.process.stdin.write(json.dumps({"operation": operation, "unused": unused, **request}) + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError(f"Node ended with status {self.process.wait()} at {operation!r}")
        answer: dict[str, Any] = json.loads(line)
        if "error" in answer:
            raise Unsupported(f"the engine refuses it: {answer['error']}")
        return answer


_children: dict[tuple[str, Settings], Child] = {}


def child_of(engine: str, settings: Settings) -> Child:
    """The process of an engine with these settings, which is started at the first use and again after its end."""
    child = _children.get((engine, settings))
    if child is not None and child.process.poll() is None:
        return child
    if child is not None:
        child.close()
    child = _children[engine, settings] = Child(engine, settings)
    return child


def joint_requests(mechanism: Mechanism, engine: str) -> list[dict[str, Any]]:
    """Descriptions of joints for `worlds.mjs`; a drive is the motor of a pin or the fixed angle of a slot.

    Raises Unsupported for a drive without a pin or slot between the same bodies, and for a second drive.
    """
    motors = motors_of(mechanism, engine)
    requests = []
    for joint in mechanism.joints:
        if not isinstance(joint, Pin | Weld | Rod | Slot):
            continue
        first, second = (-1 if name is None else mechanism.body_index(name) for name in (joint.first, joint.second))
        request: dict[str, Any] = {"kind": type(joint).__name__, "first": first, "second": second}
        request |= {"points": (joint.first_point, joint.second_point), "motor": None, "angle": None}
        match joint:
            case Weld():
                request["angle"] = joint.angle
            case Rod():
                request["length"] = joint.length
            case Pin() | Slot():
                drive, sign = motors.get(joint.name, (None, 1.0))
                if isinstance(joint, Slot):
                    request |= {"line": joint.line_angle, "angle": _fixed_angle(joint, drive, sign, engine)}
                elif drive is not None:
                    request["motor"] = sign * drive.turning_rate
        requests.append(request)
    return requests


def _fixed_angle(slot: Slot, drive: Drive | None, sign: float, engine: str) -> float | None:
    """The relative angle [rad] that a slot keeps, or None if the second body turns. Raises Unsupported."""
    if drive is None:
        if engine in ("rapier", "jolt"):
            raise Unsupported(f"joint {slot.name!r}: our adapter of {engine} builds no slot in which a body turns")
        return None
    if drive.turning_rate:
        raise Unsupported(f"drive {drive.name!r}: our adapter of {engine} turns no block in a slot")
    angle = sign * drive.offset
    if engine == "rapier" and abs(angle) > EQUAL_ANGLES:
        raise Unsupported(f"drive {drive.name!r}: a prismatic joint of rapier keeps two bodies at equal angles")
    return angle


class BrowserWorld:
    def __init__(self, mechanism: Mechanism, dt: float, engine: str, settings: Settings) -> None:
        self.mechanism, self.dt, joints = mechanism, dt, joint_requests(mechanism, engine)
        self.child = child_of(engine, settings)
        self.number = next(self.child.numbers)
        bodies = [
            {"mass": body.mass, "inertia": body.inertia, "pose": body.pose, "twist": body.twist}
            for body in mechanism.bodies
        ]
        model = {"bodies": bodies, "joints": joints, "gravity": mechanism.gravity, "dt": dt}
        built = self.child.ask("build", id=self.number, **model)
        self.inertias = np.array([(mass, mass, inertia) for mass, inertia in built["inertias"]])
        count, rows = len(bodies), mechanism.row_count
        self.size = Size(count, 3 * count, rows, rows)

    def __del__(self) -> None:
        if hasattr(self, "number"):  # a request here could come between another request and its answer
            self.child.unused.append(self.number)

    def record(self, samples: int, every: int) -> Recorded:
        run = self.child.ask("run", id=self.number, samples=samples, every=every)
        pose, twist, before = (np.array(run[name], dtype=float) for name in ("poses", "twists", "before"))
        with np.errstate(all="ignore"):
            pose[..., 2] = unwrapped(pose[..., 2], twist[..., 2], self.mechanism.pose[:, 2], self.dt * every)
            acceleration = np.full_like(twist, np.nan)
            acceleration[1:] = (twist[1:] - before) / self.dt
            fastest = np.abs(np.concatenate([twist[1:], before])).max(axis=(0, 1), initial=0.0)
        limits = SPEED_LIMITS.get(self.child.engine, lambda dt: (math.inf, math.inf))(self.dt)
        cut = math.hypot(*fastest[:2]) > 0.999 * limits[0] or fastest[2] > 0.999 * limits[1]
        warnings = (SPEED_CUT,) if cut and not dict(self.child.settings).get("maxRotation") else ()
        gravity = np.array(self.mechanism.gravity)
        return Recorded(pose, twist, acceleration, run["seconds"], self.inertias, gravity, warnings)


@dataclass(frozen=True)
class BrowserEngine(ExtraEngine):
    """settings: parameters of the engine by name."""

    forces_by: ClassVar[Enforcement] = "ours"
    steps_in_child: ClassVar[bool] = True
    release: ClassVar[str]

    variant: Name
    settings: Settings = ()

    @property
    def missing(self) -> str:
        (package,) = self.packages
        if shutil.which("node") is None:
            return f"{self.name} needs Node, which is not installed, and then: {INSTALL}"
        with suppress(PackageNotFoundError):
            if installed_version(package) == self.release:
                return ""
        return f"{self.name} needs the package {package} {self.release} of npm: {INSTALL}"

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        return NotDeclared(f"the residual of {self.name}'s iterations follows no rule in the step")

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        return STEP_COST * over_three(mechanism)

    def model(self, mechanism: Mechanism, dt: float) -> BrowserWorld:
        return BrowserWorld(mechanism, dt, self.name, self.settings)


class Planck(BrowserEngine):
    """planck, the solver of Box2D 2.4 in JavaScript."""

    name = "planck"
    packages = ("planck",)
    release = "1.5.0"
    capability = _capability("planck")


class P2(BrowserEngine):
    name = "p2"
    packages = ("p2",)
    release = "0.7.1"
    capability = _capability("p2")

    @property
    def precision(self) -> float:  # pyright: ignore[reportIncompatibleVariableOverride]
        """p2 uses single precision unless the variable P2_ARRAY_TYPE is set before p2 is loaded."""
        return 0.0 if dict(self.settings).get("double") else SINGLE_PRECISION


class Rapier(BrowserEngine):
    name = "rapier"
    packages = ("@dimforge/rapier2d-compat",)
    release = "0.21.0"
    capability = _capability(
        "rapier", "rapier's joints of two points keep a largest distance or act as a spring (JointData)"
    )
    precision = SINGLE_PRECISION


class Jolt(BrowserEngine):
    """Jolt in WebAssembly, with bodies that move only in the plane (EAllowedDOFs_Plane2D)."""

    name = "jolt"
    packages = ("jolt-physics",)
    release = "1.1.0"
    capability = _capability("jolt")
    precision = SINGLE_PRECISION


ENGINES = (Planck, P2, Rapier, Jolt)
LIMITS = tuple((f"max{kind}", 1e9) for kind in ("Translation", "Rotation", "LinearCorrection", "AngularCorrection"))
PLANCK_TUNED = Planck(
    "tuned",
    (
        ("velocityIterations", 100.0),
        ("positionIterations", 100.0),
        ("linearSlop", 1e-12),
        ("angularSlop", 1e-12),
        *LIMITS,
    ),
)
VARIANTS = (
    Planck("default", (("velocityIterations", 8.0), ("positionIterations", 3.0))),
    PLANCK_TUNED,
    Extrapolated(PLANCK_TUNED, "extended", levels=(1, 2, 3, 4), powers=(1, 2, 3)),
    P2("default", (("iterations", 10.0), ("tolerance", 1e-7), ("stiffness", 1e6), ("relaxation", 4.0))),
    P2("tuned", (("iterations", 100.0), ("tolerance", 0.0), ("stiffness", 1e9), ("relaxation", 1.0), ("double", 1.0))),
    Rapier("default", (("motor", 1e9),)),
    Rapier("tuned", (("motor", 1e9), ("numSolverIterations", 32.0))),
    Jolt("default"),
    Jolt("tuned", (("mNumVelocitySteps", 100.0), ("mNumPositionSteps", 20.0), ("mBaumgarte", 1.0))),
)

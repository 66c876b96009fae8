"""The page on faults of released engines. A document upstream/NAME.md describes a fault, with scripts that show it.

A full run executes the scripts of SCRIPTS with the installed release, so repaired faults are not reported.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from engines import Engine, Unsupported
from engines.mjx import DEFAULT
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar, SpinningFourBar
from reference.scenes.slider_crank import DrivenSliderCrank
from reports.model.fingerprint import digest
from reports.model.page import Material, Page
from reports.model.tasks import Task, Values
from reports.pages.common import run_script
from reports.plots.theme import LIGHT, drawing, style_axes, svg

if TYPE_CHECKING:
    from matplotlib.figure import Figure

UPSTREAM = Path(__file__).parent / "upstream"  # texts for the engines' issue trackers
SCRIPT_BLOCK = re.compile(r"(?:## `|<summary>)(\w+)\.py(?:`|</summary>)\n\n```python\n(.*?)```", re.DOTALL)
RESULT = re.compile(r"expected (\S+), found (\S+)$")  # the end of a script's output


@cache
def scripts() -> Mapping[str, str]:
    return {
        name: text
        for path in sorted(UPSTREAM.iterdir())
        for name, text in SCRIPT_BLOCK.findall(path.read_text("utf-8"))
    }


def printed_apart(name: str) -> str:
    """The output of a script that runs in a separate process. Raises RuntimeError with the last line if the script
    fails."""
    run = subprocess.run([sys.executable, "-c", scripts()[name]], capture_output=True, text=True)
    if run.returncode:
        raise RuntimeError((run.stderr or run.stdout).strip().splitlines()[-1])
    # MJX prints a line on Warp, which is not used.
    return "\n".join(line for line in run.stdout.splitlines() if not line.startswith("Failed to import"))


@dataclass(frozen=True)
class FaultScript(Task):
    """A script that is run with the installed engine. The task's key contains a digest of the script's text."""

    name: str
    digest: str
    words: ClassVar[str] = "script {0.name}"

    @property
    def cost(self) -> float:
        return 6.0 if self.engine else 0.05  # measured; JAX compiles for seconds

    @property
    def engine(self) -> Engine | None:
        return DEFAULT if self.name.startswith("mjx") else None

    def run(self) -> Values:
        """`expected` and `found`, in the script's unit, and `version`, the version of the engine's package. Raises
        Unsupported if the engine is an extra that can't run here."""
        if self.engine is not None:  # JAX keeps the settings of its first import, so this needs another process
            DEFAULT.require()
            try:
                match = RESULT.search(printed_apart(self.name))
            except RuntimeError as reason:
                raise Unsupported(f"MJX does not run here: {reason}") from None
            if match is None:
                raise ValueError(f"{self.name} does not end in 'expected ..., found ...'")
            return {**_values(*match.groups()), "version": version("mujoco-mjx")}
        import mujoco

        names = run_script(f"{self.name}.py", scripts()[self.name])
        # pymunk.version is wrong in some releases (2.0.0 in 7.0.0). MuJoCo has two distribution names.
        release = mujoco.__version__ if self.name.startswith("mujoco") else version("pymunk")
        return {**_values(names["expected"], names["found"]), "version": release}


def _values(expected: Any, found: Any) -> dict[str, np.ndarray]:
    return {"expected": np.asarray(float(expected)), "found": np.asarray(float(found))}


def is_right(expected: float, found: float) -> bool:
    """Whether two numbers agree within 2e-4. MuJoCo's regularisation causes an error of 1e-4 at its stiffest
    setting."""
    return abs(found - expected) <= 2e-4 * max(1.0, abs(expected))


SCRIPTS: Mapping[str, FaultScript] = {
    name: FaultScript(name, digest(scripts()[name]))
    for name in (
        *("mujoco_loop", "mujoco_sparse", "mujoco_joint_equality", "mujoco_tendon_equality"),
        *("mujoco_site_near_origin", "pymunk_groove", "pymunk_groove_moving", "pymunk_kinetic_energy", "mjx_loop"),
    )
}


@dataclass(frozen=True)
class Offsets(Task):
    """The velocity across the groove that pymunk's GrooveJoint creates, for several distances of the anchor. A body of
    1 kg and 1 kg m^2 slides at 1 m/s along a groove in the ground. The anchor is at the distances `offsets` [m] from
    the centre of mass, at an angle of 45 degrees to the groove."""

    offsets: tuple[float, ...]
    seconds: ClassVar[float] = 3e-3
    words: ClassVar[str] = "grooves: anchor's offset"

    def run(self) -> Values:
        """`across` (offsets,): the velocity of the anchor across the groove [m/s] after one step."""
        return {"across": np.array(list(map(measured_across, self.offsets)))}


OFFSETS = Offsets(tuple(np.geomspace(0.05, 5.0, 13).round(6).tolist()))


def measured_across(offset: float) -> float:
    """The anchor's velocity across the groove [m/s] after one step of pymunk with `error_bias = 1`."""
    import pymunk
    from pymunk.constraints import GrooveJoint

    space, body, arm = pymunk.Space(), pymunk.Body(1, 1), float(offset / np.sqrt(2))
    body.velocity = 1, 0
    groove = GrooveJoint(space.static_body, body, (-100, arm), (100, arm), (arm, arm))
    groove.error_bias = 1.0
    space.add(body, groove)
    space.step(1e-2)
    return body.velocity.y + body.angular_velocity * arm


def predicted_across(offset: Any) -> Any:
    """The result of `measured_across` that follows from cpGrooveJoint's wrong formula for the impulse. The formula is n
    (n.K^-1 v) instead of n (n.v) / (n.K n). Here n = (0, 1) is the normal, and v = (1, 0) is the relative velocity of
    the anchors. For a pin at the anchors, K = J M^-1 J^T = [[1 + q, -q], [-q, 1 + q]] with q = offset^2 / 2. The
    impulse is then -q / (1 + 2 q)."""
    square = offset**2 / 2
    return -square / (1 + 2 * square) * (1 + square)


def draw_offsets(across: np.ndarray) -> Figure:
    with drawing(3.4, width=6.4) as figure:
        axes = figure.subplots()
        fine = np.geomspace(OFFSETS.offsets[0], OFFSETS.offsets[-1], 200)
        axes.loglog(fine, -predicted_across(fine), color=LIGHT.first, linewidth=2, label="the wrong formula")
        axes.loglog(OFFSETS.offsets, -across, "o", color=LIGHT.ink, markersize=5, label="pymunk, measured")
        axes.set_xlabel("anchor's distance from the centre of mass [m]")
        axes.set_ylabel("velocity across the groove\nafter a step, should be 0 [m/s]")
        style_axes(axes)
        axes.legend(loc="lower right")
    return figure


def figures(material: Material) -> dict[str, str]:
    answer = material.finished(OFFSETS)
    title = "Velocity that a groove creates across itself, against its anchor's offset"
    return {"groove": svg(draw_offsets(answer.array("across")), title)} if answer else {}


PAGE = Page(
    name="faults",
    title="Faults of released engines",
    lesson="Wrong in a release, not soft or coarse: the formula behind it, what it costs, what to send to its authors.",
    companions=(DrivenFourBar(), FreeFourBar(), SpinningFourBar(), DrivenSliderCrank()),
    figures=figures,
    context=lambda material: {
        "unfinished": [material.unfinished(task) for task in SCRIPTS.values() if not material.finished(task)]
    },
    further=lambda material: {f"upstream/{path.name}": path.read_text("utf-8") for path in sorted(UPSTREAM.iterdir())},
    tasks=(*SCRIPTS.values(), OFFSETS),
)

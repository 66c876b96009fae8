"""Faults of released engines: page.md and upstream/NAME.md are documents written once, with scripts that show them.

The scripts are in the documents only. Those of SCRIPTS are run with every full grid, so that a finding disappears with
the release that repairs its fault. A test runs every script and compares its output with its document.
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
from typing import Any, ClassVar

import numpy as np
from matplotlib.figure import Figure

from engines import Engine, Unsupported
from engines.mjx import DEFAULT
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar, SpinningFourBar
from reference.scenes.slider_crank import DrivenSliderCrank
from reports.model.fingerprint import digest
from reports.model.page import Material, Page
from reports.model.tasks import Task, Values
from reports.pages.common import run_script
from reports.plots.theme import LIGHT, drawing, style_axes, svg

UPSTREAM = Path(__file__).parent / "upstream"  # for each fault a text for the engine's issue tracker
SCRIPT_BLOCK = re.compile(r"(?:## `|<summary>)(\w+)\.py(?:`|</summary>)\n\n```python\n(.*?)```", re.DOTALL)
RESULT = re.compile(r"expected (\S+), found (\S+)$")  # ends the line that a script of SCRIPTS prints


@cache
def scripts() -> Mapping[str, str]:
    """Script name -> its text."""
    return {
        name: text
        for path in sorted(UPSTREAM.iterdir())
        for name, text in SCRIPT_BLOCK.findall(path.read_text("utf-8"))
    }


def printed_apart(name: str) -> str:
    """The output of a script in a separate process. Raises RuntimeError with its last line if it fails."""
    run = subprocess.run([sys.executable, "-c", scripts()[name]], capture_output=True, text=True)
    if run.returncode:
        raise RuntimeError((run.stderr or run.stdout).strip().splitlines()[-1])
    # Without the line that MJX prints about Warp, which is not used.
    return "\n".join(line for line in run.stdout.splitlines() if not line.startswith("Failed to import"))


@dataclass(frozen=True)
class FaultScript(Task):
    """A script, run with the installed engine; `digest`: of its text, so that an edited script is run again."""

    name: str
    digest: str
    words: ClassVar[str] = "script {0.name}"

    @property
    def cost(self) -> float:
        return 6.0 if self.engine else 0.05  # measured: compiling a program, and a model

    @property
    def engine(self) -> Engine | None:
        return DEFAULT if self.name.startswith("mjx") else None

    def run(self) -> Values:
        """`expected` and `found`, in the unit of the script, and `version` of the engine's package.

        Raises Unsupported if the script's package is an extra that is not installed.
        """
        if self.engine is not None:  # JAX has the settings of its first import, so it is imported in another process
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
        # pymunk.version is wrong in some releases (2.0.0 in 7.0.0), and MuJoCo's distribution has two names.
        release = mujoco.__version__ if self.name.startswith("mujoco") else version("pymunk")
        return {**_values(names["expected"], names["found"]), "version": release}


def _values(expected: Any, found: Any) -> dict[str, np.ndarray]:
    return {"expected": np.asarray(float(expected)), "found": np.asarray(float(found))}


def is_right(expected: float, found: float) -> bool:
    """Whether they agree within the error of MuJoCo's regularisation at its stiffest setting, 1e-4."""
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
    """The velocity across the groove that pymunk's GrooveJoint creates, for several offsets of its anchor [m].

    A body of 1 kg and 1 kg m^2 slides at 1 m/s along a groove in the ground. The anchor is at this distance from the
    centre of mass, at 45 degrees to the groove.
    """

    offsets: tuple[float, ...]
    seconds: ClassVar[float] = 3e-3
    words: ClassVar[str] = "grooves: anchor's offset"

    def run(self) -> Values:
        """`across` (offsets,) [m/s] after a step."""
        return {"across": np.array(list(map(measured_across, self.offsets)))}


OFFSETS = Offsets(tuple(np.geomspace(0.05, 5.0, 13).round(6).tolist()))


def measured_across(offset: float) -> float:
    """The anchor's velocity across the groove [m/s] after one step of pymunk, which closes no gap."""
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
    """That velocity by cpGrooveJoint's formula: the impulse n (n.K^-1 v) instead of n (n.v) / (n.K n), n the normal.

    K = J M^-1 J^T of the two anchors held together, v their relative velocity: here K = [[1 + q, -q], [-q, 1 + q]] with
    q = offset^2 / 2, v = (1, 0) and n = (0, 1), so that the impulse is -q / (1 + 2 q).
    """
    square = offset**2 / 2
    return -square / (1 + 2 * square) * (1 + square)


def draw_offsets(measured: np.ndarray) -> Figure:
    """The velocity across the groove against the offset of the anchor, measured and by the wrong formula."""
    with drawing(3.4, width=6.4) as figure:
        axes = figure.subplots()
        fine = np.geomspace(OFFSETS.offsets[0], OFFSETS.offsets[-1], 200)
        axes.loglog(fine, -predicted_across(fine), color=LIGHT.first, linewidth=2, label="the wrong formula")
        axes.loglog(OFFSETS.offsets, -measured, "o", color=LIGHT.ink, markersize=5, label="pymunk, measured")
        axes.set_xlabel("anchor's distance from the centre of mass [m]")
        axes.set_ylabel("velocity across the groove\nafter a step, should be 0 [m/s]")
        style_axes(axes)
        axes.legend(loc="lower right")
    return figure


def figures(material: Material) -> dict[str, str]:
    """The chart of the groove, if it was measured."""
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

"""Faults of released engines: page.md and upstream/NAME.md are documents written once, with the scripts that show them.

The scripts stand in the documents alone. Those of SCRIPTS are tasks of the grid, so that a finding disappears with the
release that mends its fault; a test runs every script and compares what it prints with what its document says.
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

UPSTREAM = Path(__file__).parent / "upstream"  # a file to paste into a tracker, for each fault
SCRIPT = re.compile(r"(?:## `|<summary>)(\w+)\.py(?:`|</summary>)\n\n```python\n(.*?)```", re.DOTALL)
RESULT = re.compile(r"expected (\S+), found (\S+)$")  # the end of the line that a script of SCRIPTS prints


@cache
def scripts() -> Mapping[str, str]:
    """The text of each script by its name."""
    return {name: text for path in sorted(UPSTREAM.iterdir()) for name, text in SCRIPT.findall(path.read_text("utf-8"))}


def printed_apart(name: str) -> str:
    """What a script prints in a process of its own. Raises RuntimeError with its last line if it fails."""
    run = subprocess.run([sys.executable, "-c", scripts()[name]], capture_output=True, text=True)
    if run.returncode:
        raise RuntimeError((run.stderr or run.stdout).strip().splitlines()[-1])
    # MJX prints a line about Warp, which is not used.
    return "\n".join(line for line in run.stdout.splitlines() if not line.startswith("Failed to import"))


@dataclass(frozen=True)
class Script(Task):
    """A script with the engine that is installed; `digest` is that of its text, so that an edited one is run again."""

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
        """`expected` and `found`, in the unit that the script says, and `version` of the engine's package.

        Raises Unsupported where the script's package is an extra that is not installed.
        """
        if self.engine is not None:  # JAX takes its settings from whoever imports it first, so it is not imported here
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
    """Within what MuJoCo's softness costs at the stiffest setting, 1e-4."""
    return abs(found - expected) <= 2e-4 * max(1.0, abs(expected))


SCRIPTS: Mapping[str, Script] = {
    name: Script(name, digest(scripts()[name]))
    for name in (
        *("mujoco_loop", "mujoco_sparse", "mujoco_joint_equality", "mujoco_tendon_equality"),
        *("mujoco_site_near_origin", "pymunk_groove", "pymunk_groove_moving", "pymunk_kinetic_energy", "mjx_loop"),
    )
}


@dataclass(frozen=True)
class Offsets(Task):
    """The velocity that pymunk's GrooveJoint makes across itself, with the anchor at several offsets [m].

    A body of 1 kg and 1 kg m^2 slides at 1 m/s along a groove in the ground; its anchor lies at the offset from the
    centre of mass, half along and half across the groove.
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
    """The same by cpGrooveJoint's law, an impulse n (n.K^-1 v) along the normal n instead of n (n.v) / (n.K n).

    K = J M^-1 J^T of the two anchors held together, v their relative velocity: here K = [[1 + q, -q], [-q, 1 + q]] with
    q = offset^2 / 2, v = (1, 0) and n = (0, 1), so that the impulse is -q / (1 + 2 q).
    """
    square = offset**2 / 2
    return -square / (1 + 2 * square) * (1 + square)


def draw_offsets(measured: np.ndarray) -> Figure:
    """What the groove makes of a body that slides along it, against the offset of its anchor."""
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
    """The groove's chart, if it was measured."""
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

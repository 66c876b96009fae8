"""What `crosscheck export` and `view` ask of MuJoCo: files that run without this suite, and its viewer."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import os
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass

from engines import Unsupported
from engines.mujoco.methods import VARIANTS
from engines.mujoco.written_urdf import urdf
from reference.mechanism import Mechanism


@dataclass(frozen=True)
class Mjcf:
    """MJCF by a variant's settings, with the start as a keyframe."""

    suffix: str = ".xml"

    def write(self, mechanism: Mechanism, dt: float, variant: str) -> str:
        """The file's text. Raises Unsupported where no file can hold it, ValueError for an unknown variant."""
        known = {engine.variant: engine for engine in VARIANTS}
        if variant not in known:
            raise ValueError(f"--variant is {variant!r}; it must be one of {', '.join(known)}")
        return known[variant].text(mechanism, dt)

    def commented(self, text: str, lines: Sequence[str]) -> str:
        """The text with a comment before it."""
        told = "\n".join(lines).replace("--", "- -")
        return f"<!--\n{told}\n-->\n{text}"


@dataclass(frozen=True)
class Urdf(Mjcf):
    """URDF, which knows no settings: of any variant the same."""

    suffix: str = ".urdf"

    def write(self, mechanism: Mechanism, dt: float, variant: str) -> str:
        """The file's text. Raises Unsupported for what URDF has no word for."""
        return urdf(mechanism)


def show(text: str) -> None:
    """MJCF in MuJoCo's viewer, from its start, until the window is closed. Raises Unsupported where there is none."""
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise Unsupported("there is no display")
    try:
        import mujoco
        import mujoco.viewer  # an extra of MuJoCo's: it asks for a window system
    except ImportError as reason:
        raise Unsupported(f"MuJoCo's viewer is not installed: {reason}") from None
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    with mujoco.viewer.launch_passive(model, data, show_left_ui=False, show_right_ui=False) as window:
        while window.is_running():
            begin = time.monotonic()
            mujoco.mj_step(model, data)
            window.sync()
            time.sleep(max(0.0, model.opt.timestep - (time.monotonic() - begin)))


MJCF, URDF = Mjcf(), Urdf()

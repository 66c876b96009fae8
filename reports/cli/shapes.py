"""`crosscheck shapes MOTION.csv` writes two shapes that generate the motion when one rolls on the other."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from reference.chapter.centrodes import Centrodes, Shapes, as_csv, as_dxf, as_svg, from_poses, poses_from_csv, shapes_of
from reference.checks import InvalidMechanism
from reports.cli.options import refuse_existing
from reports.model.ending import BadInput, FileTrouble, visible
from reports.pages.centrodes.page import returned
from reports.run.files import write_whole

WRITERS = {"csv": as_csv, "svg": as_svg, "dxf": as_dxf}
DEFAULT_KINDS = ("csv", "svg")  # The kind dxf is left out, since it needs the extra `dxf`.
MOST_POINTS = 1_000_000  # No workshop can cut more points, and memory can hold them.
MOST_BYTES = 2**27  # Largest size of the table of poses, about a hundred bytes for each of a million poses.
COARSE = 1e-3  # If the relative error of the shapes is larger, a sentence says that the table has too few poses.


def shapes(
    motion: Annotated[Path, typer.Argument(help="CSV of poses with the columns t, x, y, angle (s, m, m, rad).")],
    folder: Annotated[Path, typer.Option(help="Where MOTION_shapes.csv, .svg or .dxf are written.")] = Path(),
    points: Annotated[int, typer.Option(help="Points of each shape.")] = 400,
    kind: Annotated[
        list[str] | None,
        typer.Option(help="Kind of file: csv, svg, dxf (repeatable; csv and svg if none is named)."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False,
) -> None:
    """Write the two shapes that generate a motion when the one rolls on the other. The shapes are the centrodes of the
    motion, which are the curves of the instant centre in space and in the body."""
    kinds = dict.fromkeys(kind or DEFAULT_KINDS)
    if unknown := [word for word in kinds if word not in WRITERS]:
        raise BadInput(f"--kind is {unknown[0]!r}; there are {', '.join(WRITERS)}")
    if "dxf" in kinds and find_spec("ezdxf") is None:
        raise BadInput(
            "--kind dxf needs the package ezdxf, which is not installed: pip install 'planar-crosscheck[dxf]'"
        )
    if not 2 <= points <= MOST_POINTS:
        raise BadInput(f"--points is {points}; give from 2 to {MOST_POINTS}")
    targets = {name: folder / f"{motion.stem}_shapes.{name}" for name in kinds}
    refuse_existing(targets.values(), "--folder", force)
    text = _read_text(motion)
    try:
        curves = from_poses(*poses_from_csv(text))
        pair = shapes_of(curves, points)
        files = {path: WRITERS[name](pair) for name, path in targets.items()}
    except InvalidMechanism as reason:
        raise BadInput(f"{motion}: {' '.join(str(reason).split())}") from None
    lines = _describe(curves, pair)
    write_whole(files, "give another --folder")
    for line in (*lines, *(f"written: {path}" for path in files)):
        print(visible(line))


def _describe(curves: Centrodes, pair: Shapes) -> list[str]:
    size = float(np.ptp(np.vstack([pair.space, pair.body]), axis=0).max())
    lines = [
        f"{len(curves.theta)} poses over {np.ptp(curves.theta):.4g} rad; both shapes are "
        f"{curves.space_arc[-1]:.6g} m long"
    ]
    if np.isfinite(pair.error):
        lines.append(f"with every second pose alone they would move by {pair.error:.2g} m")
    try:
        distance, angle = returned(curves)
        lines.append(f"rolling the one on the other gives the motion back to {distance:.2g} m over {angle:.4g} rad")
    except InvalidMechanism as reason:
        lines.append(f"they could not be rolled on each other to check them: {' '.join(str(reason).split())}")
    if not pair.error <= COARSE * size:
        lines.append("the poses stand too far apart for these curves: give more of them")
    return lines


def _read_text(path: Path) -> str:
    try:
        with path.open("rb") as file:
            data = file.read(MOST_BYTES + 1)
        if len(data) > MOST_BYTES:
            raise FileTrouble(f"{path} is longer than {MOST_BYTES} bytes: give fewer poses")
        return data.decode("utf-8-sig")
    except OSError as reason:
        raise FileTrouble(f"{path} can't be read: {reason.strerror or reason}") from None
    except UnicodeDecodeError:
        raise FileTrouble(f"{path} can't be read: it is no text; give CSV in UTF-8") from None

"""`crosscheck shapes MOTION.csv`: any motion as two shapes that generate it by rolling, written to files."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reports.cli.options import refuse_existing
from reports.model.ending import BadInput, FileTrouble, visible
from reports.run.files import write_whole

if TYPE_CHECKING:
    from reference.chapter.centrodes import Centrodes, Shapes

KINDS = ("csv", "svg", "dxf")
USUAL = ("csv", "svg")  # dxf needs a package that an installation has only with the extra `dxf`
MOST_POINTS = 1_000_000  # far more than a workshop can cut, far less than memory can hold
MOST_BYTES = 2**27  # of the table of poses, a hundred for each of a million
# Of the shapes' size: above this the table is too coarse for what it describes, and the user must know.
COARSE = 1e-3


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
    """Write the two shapes that generate a motion when the one rolls on the other.

    They are the curves of the instant centre of the poses in MOTION.csv (its centrodes), in space and in the body.
    """
    kinds = dict.fromkeys(kind or USUAL)
    for word in kinds:
        if word not in KINDS:
            raise BadInput(f"--kind is {word!r}; there are {', '.join(KINDS)}")
    if "dxf" in kinds and find_spec("ezdxf") is None:
        raise BadInput(
            "--kind dxf needs the package ezdxf, which is not installed: pip install 'planar-crosscheck[dxf]'"
        )
    if not 2 <= points <= MOST_POINTS:
        raise BadInput(f"--points is {points}; give from 2 to {MOST_POINTS}")
    targets = {name: folder / f"{motion.stem}_shapes.{name}" for name in kinds}
    refuse_existing(targets.values(), "--folder", force)
    text = _text(motion)
    # Here, since numpy and scipy take longer to load than all else.
    from reference.chapter.centrodes import as_csv, as_dxf, as_svg, from_poses, poses_from_csv, shapes_of
    from reference.checks import InvalidMechanism

    writers = {"csv": as_csv, "svg": as_svg, "dxf": as_dxf}
    try:
        curves = from_poses(*poses_from_csv(text))
        found = shapes_of(curves, points)
        files = {path: writers[name](found) for name, path in targets.items()}
    except InvalidMechanism as reason:
        raise BadInput(f"{motion}: {_one_line(reason)}") from None
    told = _told(curves, found)
    write_whole(files, "give another --folder")
    for line in (*told, *(f"written: {path}" for path in files)):
        print(visible(line))


def _told(curves: Centrodes, found: Shapes) -> list[str]:
    """What to say of the shapes before they are cut: how long, how exact, and whether they give the motion back."""
    import numpy as np

    from reference.checks import InvalidMechanism
    from reports.pages.centrodes.page import returned

    size = float(np.ptp(np.vstack([found.space, found.body]), axis=0).max())
    lines = [
        f"{len(curves.theta)} poses over {np.ptp(curves.theta):.4g} rad; both shapes are "
        f"{curves.space_arc[-1]:.6g} m long"
    ]
    if np.isfinite(found.error):
        lines.append(f"with every second pose alone they would move by {found.error:.2g} m")
    try:
        distance, angle = returned(curves)
        lines.append(f"rolling the one on the other gives the motion back to {distance:.2g} m over {angle:.4g} rad")
    except InvalidMechanism as reason:
        lines.append(f"they could not be rolled on each other to check them: {_one_line(reason)}")
    if not found.error <= COARSE * size:
        lines.append("the poses stand too far apart for these curves: give more of them")
    return lines


def _one_line(reason: Exception) -> str:
    return " ".join(str(reason).split())


def _text(path: Path) -> str:
    """A file's text. Raises FileTrouble, saying why it can't be read."""
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

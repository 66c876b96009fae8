"""Any motion as two shapes that generate it by rolling, written as CSV, SVG or DXF text (the caller stores it)."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from reference.chapter.centrodes import Centrodes
from reference.checks import LARGEST_COUNT, InvalidMechanism, Positive, Valid, index_of, validated
from reference.kinds import NOT_FINITE, from_to, of_shape
from reference.plane import rotated
from reference.rolling.curves import Array

COLUMNS = ("t", "x", "y", "angle")
Places = Annotated[Array, of_shape("n", 2)]
Poses = Annotated[Array, of_shape("n", 3)]
Points = Annotated[int, from_to(2, LARGEST_COUNT)]


@dataclass(frozen=True, eq=False)
class Shapes(Valid):
    """Points (n, 2) [m] equally far apart along two boundaries: point i of the one meets point i of the other."""

    space: Places  # in the world's frame: the fixed part
    body: Places  # in the body's frame: the moving part
    pose: Poses  # (n, 3) m, m, rad: where the moving part is at each contact
    error: Annotated[float, NOT_FINITE]  # m, see Centrodes.error


@validated
def shapes_of(motion: Centrodes, points: Points = 400) -> Shapes:
    """The two shapes of centrodes, with `points` points each (at least 2)."""
    space, body = motion.space_curve, motion.body_curve
    arcs = np.linspace(0.0, space.limits[1], points)
    theta = space.parameter(arcs)
    fixed, moving = space.point_of(theta), body.point_of(-theta)
    pose = np.column_stack([fixed - rotated(theta, moving), theta])
    return Shapes(fixed, moving, pose, motion.error)


@validated
def poses_from_csv(text: str) -> tuple[Array, Array]:
    """Times (n,) [s] and poses (n, 3) [m, m, rad] from CSV with the columns t, x, y, angle in any order.

    Raises InvalidMechanism that names the missing column or the row that is no number.
    """
    reader = csv.DictReader(io.StringIO(text), skipinitialspace=True)
    names = [name.strip() for name in reader.fieldnames or []]
    missing = [name for name in COLUMNS if name not in names]
    if missing:
        raise InvalidMechanism(f"poses: the first line has no column {missing[0]!r}; it must name t, x, y and angle")
    reader.fieldnames = names
    rows = []
    for number, row in enumerate(reader, start=2):
        try:
            rows.append([float(row[name]) for name in COLUMNS])
            if not np.isfinite(rows[-1]).all():
                raise ValueError
        except (TypeError, ValueError):
            raise InvalidMechanism(
                f"poses: line {number} is {list(row.values())}; t, x, y, angle must be finite numbers"
            ) from None
    table = np.array(rows).reshape(-1, 4)
    return table[:, 0], table[:, 1:]


@validated
def as_csv(shapes: Shapes) -> str:
    """Columns space_x, space_y, body_x, body_y [m] and the moving part's x, y [m] and angle [rad] at that contact."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["space_x", "space_y", "body_x", "body_y", "x", "y", "angle"])
    writer.writerows([float(v) for v in row] for row in np.hstack([shapes.space, shapes.body, shapes.pose]))
    return out.getvalue()


@validated
def as_svg(shapes: Shapes, width: Positive = 200.0) -> str:
    """Both curves to one scale, `width` [mm] wide; the moving part where it is at the first contact, y upwards."""
    moved = placed_body(shapes, 0)
    corners = np.vstack([shapes.space, moved])
    low, size = corners.min(axis=0), np.ptp(corners, axis=0)
    margin = 0.05 * float(size.max())
    scale = width / (float(size[0]) + 2 * margin)
    height = (float(size[1]) + 2 * margin) * scale

    def path(points: Array) -> str:
        x = (points[:, 0] - low[0] + margin) * scale
        y = height - (points[:, 1] - low[1] + margin) * scale
        return "M" + " L".join(f"{a:.4f},{b:.4f}" for a, b in zip(x, y, strict=True))

    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.4f}mm" height="{height:.4f}mm" '
        f'viewBox="0 0 {width:.4f} {height:.4f}" fill="none" stroke-width="{width / 400:.4f}">\n'
        f'<path id="space" stroke="#1b4965" d="{path(shapes.space)}"/>\n'
        f'<path id="body" stroke="#c1121f" d="{path(moved)}"/>\n</svg>\n'
    )


@validated
def placed_body(shapes: Shapes, index: int) -> Array:
    """The moving part's points (n, 2) [m] in the world, when contact `index` touches."""
    x, y, angle = shapes.pose[index_of("placed_body", "index", index, len(shapes.pose))]
    cosine, sine = np.cos(angle), np.sin(angle)
    return shapes.body @ np.array([[cosine, sine], [-sine, cosine]]) + [x, y]


@validated
def as_dxf(shapes: Shapes) -> str:
    """A drawing in metres with two polylines, on the layers SPACE (world's frame) and BODY (body's own frame)."""
    from ezdxf.filemanagement import new  # only this writer needs it, and it takes longer to load than all else

    document = new("R2010", setup=False, units=6)  # 6: metres
    for layer, color, points in (("SPACE", 5, shapes.space), ("BODY", 1, shapes.body)):
        document.layers.add(layer, color=color)
        document.modelspace().add_lwpolyline([(float(x), float(y)) for x, y in points], dxfattribs={"layer": layer})
    out = io.StringIO()
    document.write(out)
    return out.getvalue()

"""Where methods fail on the N-four-bar: at its singular positions, as shipped and hardened, and with more loops."""

from __future__ import annotations

from dataclasses import replace

from engines import mujoco
from engines.lagrange import Lagrange
from reference.scenes.n_four_bar import NFourBar
from reports.model.page import Failure, Material, Observation
from reports.pages.common import ALL, cells
from reports.write.tables import number

SHIPPED_RK4 = replace(mujoco.DEFAULT, variant="RK4 alone", integrator="RK4")


SOFT = cells(NFourBar(), (mujoco.DEFAULT, SHIPPED_RK4), (1, 3, 10, 30))
ONCE = NFourBar(duration=1.2, horizon=1.2)  # one singular position, not yet the second


def forces_without_a_limit(material: Material) -> list[Observation]:
    """How the largest reaction grows towards a singular position, with how little the loops are still open."""
    scene = NFourBar()
    first = scene.singular_times(5.0)[0]
    found = []
    for before in (1e-1, 1e-2, 1e-3, 1e-4):
        reaction = abs(scene.motion([first - before]).reaction).max()
        found.append(
            Observation("the reference", f"{number(before, 1)} s before", f"largest reaction {reaction:.3g} N")
        )
    return found


FAILURES: tuple[Failure, ...] = (
    Failure(
        title="Through the singular position, as shipped",
        expected=(
            f"The cranks first lie along the couplers after {NFourBar().singular_times(5.0)[0]:.4f} s. All of them go "
            "on together; that is a pendulum's motion, known exactly. The branch is told as an outcome of its own."
        ),
        cells=SOFT,
        remark=(
            "The loops have a time constant of 0.02 s, whatever the step. So near the line each crank goes its own "
            "way. The error falls neither with the step nor with a better integrator. A user with an inaccurate closed "
            "loop was told that the defaults are fairly soft and to make the equality constraints stiffer "
            "([mujoco#2172](https://github.com/google-deepmind/mujoco/issues/2172)). Another reports a loop that "
            "breaks at a step of 0.5 ms with a thousand iterations "
            "([mujoco#2698](https://github.com/google-deepmind/mujoco/issues/2698)). Neither speaks of a singular "
            "position, and both are older than MuJoCo 3.7, whose loops have the velocity term that was missing before "
            "([changelog](https://mujoco.readthedocs.io/en/stable/changelog.html))."
        ),
    ),
    Failure(
        title="Forces that have no limit",
        expected=(
            "An inner crank carries twice the coupler's weight of an outer one. Alone they would accelerate "
            r"differently, and the forces along the couplers that keep them together grow like $1 / \cos\varphi$, "
            r"where $\varphi$ is the angle from upright. The motion is smooth: the truth passes the line at finite "
            "speed."
        ),
        cells=cells(ONCE, ALL, (1, 10, 100)),
        observations=forces_without_a_limit,
        remark=(
            "A smaller step brings a sample closer to the line, where a larger force is needed. For that reason pymunk "
            "tuned fails at the smallest step, and passes at the two larger ones. The errors of "
            "pymunk as shipped and of MuJoCo tuned fall with the step. That of MuJoCo as shipped has a plateau. That "
            "of MuJoCo extended is small throughout but has no order. Extrapolation (pymunk extended) needs an error "
            "that is smooth in the step. What a number of sweeps leaves is not, and it says so. In another "
            "library a closed loop was seen to drift exponentially until it was NaN ([RigidBodyDynamics.jl#480]"
            "(https://github.com/JuliaRobotics/RigidBodyDynamics.jl/issues/480)); nothing there says that a singular "
            "position was the cause."
        ),
    ),
    Failure(
        title="Exact multipliers at a singular position",
        expected="The rows lose rank there; between samples a step may land anywhere near it.",
        cells=cells(
            ONCE,
            (Lagrange("rk4", "none"), Lagrange("rk4", "baumgarte"), Lagrange("rk4", "projection")),
            (1, 3, 10),
        ),
        remark=(
            "With fixed steps a method of order 4 steps over the instant and keeps its order, since a stage seldom "
            "falls on it. An integrator with error control would make ever smaller steps there, because of the forces. "
            "So the truth is not taken from such an integrator, but from the equation of the symmetric motion."
        ),
    ),
)

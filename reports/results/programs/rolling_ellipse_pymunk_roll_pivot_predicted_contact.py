"""rolling_ellipse by the method pymunk roll: pivot, predicted contact, with this suite: below 0.01 rad."""

from engines.pymunk.methods import ROLL_PIVOT
from reference.scenes.rolling.scenes import RollingEllipse

scene = RollingEllipse()
every = 1  # 10: below 1e-4
run = ROLL_PIVOT.build(scene.mechanism(), dt=scene.spacing / every)
trajectory = run(samples=scene.samples, every=every)
truth = scene.motion(trajectory.t)
error = abs((trajectory.pose - truth.pose))[..., 2].max()
print(f"largest angle error: {error:.1e} rad")
# 5.5e-03 rad when this was written

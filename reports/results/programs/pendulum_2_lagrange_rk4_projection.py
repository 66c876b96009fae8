"""pendulum_2 by the method lagrange rk4 projection, with this suite: below 1e-4 rad."""

from engines.lagrange import Lagrange
from reference.scenes.pendulum.scenes import LinkPendulum

scene = LinkPendulum()
every = 1  # 3: below 1e-6
run = Lagrange(integrator="rk4").build(scene.mechanism(), dt=scene.spacing / every)
trajectory = run(samples=scene.samples, every=every)
truth = scene.motion(trajectory.t)
# Beyond its horizon the motion's own errors grow exponentially.
error = abs((trajectory.pose - truth.pose)[trajectory.t <= scene.horizon])[..., 2].max()
print(f"largest angle error: {error:.1e} rad")
# 1.6e-05 rad when this was written

"""Sleigh in MuJoCo by the method *tuned*: a tendon whose coefficients our code writes before each step."""

import math

import mujoco

duration = 3.0  # s
steps = 300
dt = duration / steps  # s
BLADE = -0.5  # m, position on the body's x axis, behind the centre of mass

model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{dt}" gravity="0 0 0"/>
  <worldbody>
    <body pos=".5 0 0">
      <inertial pos="0 0 0" mass="2" diaginertia="1 1 .3"/>
      <joint name="x" type="slide" axis="1 0 0"/>
      <joint name="y" type="slide" axis="0 1 0"/>
      <joint name="turn" axis="0 0 1"/>
    </body>
  </worldbody>
  <tendon>
    <fixed name="across"><joint joint="x" coef="0"/><joint joint="y" coef="1"/><joint joint="turn" coef="-.5"/></fixed>
  </tendon>
  <equality>
    <tendon tendon1="across" solref="-1e-12 {-0.9999 / dt}" solimp=".9999 .9999 .001 .5 1"/>
  </equality>
</mujoco>""")
data = mujoco.MjData(model)
data.qvel[:] = 1, 1, 2


def aim():
    """Write a skate's row at the heading after this step; only the tendon's rate is constrained, not its length."""
    angle = data.qpos[2] + dt * data.qvel[2]
    model.wrap_prm[:] = -math.sin(angle), math.cos(angle), BLADE


for _ in range(steps):
    aim()
    mujoco.mj_step(model, data)
end = 0.5 + data.qpos[0], data.qpos[1], data.qpos[2]
print("sleigh: x = {:.10f} m, y = {:.10f} m, angle = {:.10f} rad".format(*end))
# Exact: sleigh: x = 2.7696089798 m, y = 4.1825116239 m, angle = 1.1378398769 rad

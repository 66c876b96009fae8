"""Free four bar in MuJoCo by the method *extended*."""

import mujoco

duration = 1.0  # s
steps = 3000
dt = duration / steps  # s
constant = max(5 * dt, 0.0679200480357)  # s, of the loop's spring: at least a fifth of the motion's time scale
solref = f"{-1 / constant**2} {-2 / constant}"

model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{dt}" gravity="0 -9.81 0" integrator="RK4" jacobian="dense" tolerance="1e-28">
    <flag contact="disable" island="disable"/>
  </option>
  <worldbody>
    <body name="crank" pos="0 0.2 0">
      <inertial pos="0 0 0" mass="0.4" diaginertia="0.00533333333333 0.00533333333333 0.00533333333333"/>
      <joint name="crank" axis="0 0 1" pos="0 -0.2 0"/>
      <body name="coupler" pos="0.2 0.4 0">
        <inertial pos="0 0 0" mass="0.565685424949" diaginertia="0.0150849446653 0.0150849446653 0.0150849446653"/>
        <joint name="coupler" axis="0 0 1" pos="-0.2 -0.2 0"/>
      </body>
    </body>
    <body name="rocker" pos="0.8 0.4 0">
      <inertial pos="0 0 0" mass="1.1313708499" diaginertia="0.120679557323 0.120679557323 0.120679557323"/>
      <joint name="rocker" axis="0 0 1" pos="0.4 -0.4 0"/>
    </body>
  </worldbody>
  <equality>
    <connect body1="rocker" body2="coupler" anchor="-0.4 0.4 0"
             solref="{solref}" solimp=".9999 .9999 .001 .5 1"/>
  </equality>
</mujoco>""")
for scale in (model.body_invweight0, model.dof_invweight0):
    scale[:] *= 1e-8  # the regularisation of a constraint is proportional to these
data = mujoco.MjData(model)
mujoco.mj_step(model, data, nstep=steps)
mujoco.mj_forward(model, data)  # positions at the end of the step, not in the last stage of RK4
end = (*data.body("rocker").xpos[:2], 2.35619449019 + data.joint("rocker").qpos[0])
print("rocker: x = {:.10f} m, y = {:.10f} m, angle = {:.10f} rad".format(*end))
# Exact: rocker: x = 0.8234486517 m, y = 0.4221481755 m, angle = 2.2991675519 rad

"""N four bar 2 in MuJoCo, as the method *extended* does it."""

import mujoco

duration = 10.0  # s
steps = 1000
dt = duration / steps  # s
constant = max(5 * dt, 0.0638550856814)  # s: the loop's spring may be slow, a fifth of the motion's time scale
solref = f"{-1 / constant**2} {-2 / constant}"

model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{dt}" gravity="0 -9.81 0" integrator="RK4" jacobian="dense" tolerance="1e-28">
    <flag contact="disable" island="disable"/>
  </option>
  <worldbody>
    <body name="crank 0" pos="0 0.5 0">
      <inertial pos="0 0 0" mass="1" diaginertia="0.0833333333333 0.0833333333333 0.0833333333333"/>
      <joint name="crank 0" axis="0 0 1" pos="0 -0.5 0"/>
      <body name="coupler 0" pos="0.5 0.5 0">
        <inertial pos="0 0 0" mass="1" diaginertia="0.0833333333333 0.0833333333333 0.0833333333333"/>
        <joint name="coupler 0" axis="0 0 1" pos="-0.5 0 0"/>
      </body>
    </body>
    <body name="crank 1" pos="1 0.5 0">
      <inertial pos="0 0 0" mass="1" diaginertia="0.0833333333333 0.0833333333333 0.0833333333333"/>
      <joint name="crank 1" axis="0 0 1" pos="0 -0.5 0"/>
      <body name="coupler 1" pos="0.5 0.5 0">
        <inertial pos="0 0 0" mass="1" diaginertia="0.0833333333333 0.0833333333333 0.0833333333333"/>
        <joint name="coupler 1" axis="0 0 1" pos="-0.5 0 0"/>
      </body>
    </body>
    <body name="crank 2" pos="2 0.5 0">
      <inertial pos="0 0 0" mass="1" diaginertia="0.0833333333333 0.0833333333333 0.0833333333333"/>
      <joint name="crank 2" axis="0 0 1" pos="0 -0.5 0"/>
    </body>
  </worldbody>
  <equality>
    <connect body1="coupler 0" body2="crank 1" anchor="0.5 0 0"
             solref="{solref}" solimp=".9999 .9999 .001 .5 1"/>
    <connect body1="coupler 1" body2="crank 2" anchor="0.5 0 0"
             solref="{solref}" solimp=".9999 .9999 .001 .5 1"/>
  </equality>
</mujoco>""")
for scale in (model.body_invweight0, model.dof_invweight0):
    scale[:] *= 1e-8  # MuJoCo makes a constraint softer in proportion to these
data = mujoco.MjData(model)
data.joint("crank 0").qvel = -1
data.joint("crank 1").qvel = -1
data.joint("crank 2").qvel = -1
data.joint("coupler 0").qvel = 1
data.joint("coupler 1").qvel = 1
mujoco.mj_step(model, data, nstep=steps)
mujoco.mj_forward(model, data)  # places of the bodies at the end, not in the last stage of RK4
end = (*data.body("crank 0").xpos[:2], 1.57079632679 + data.joint("crank 0").qpos[0])
print("crank 0: x = {:.10f} m, y = {:.10f} m, angle = {:.10f} rad".format(*end))

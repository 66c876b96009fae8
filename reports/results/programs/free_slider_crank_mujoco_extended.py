"""Free slider crank in MuJoCo by the method *extended*."""

import mujoco

duration = 2.0  # s
steps = 6000  # 6000: below 1e-6; 20000: below 1e-9
dt = duration / steps  # s
constant = max(5 * dt, 0.02)  # s, of the loop's spring: at least a fifth of the motion's time scale
solref = f"{-1 / constant**2} {-2 / constant}"

model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{dt}" gravity="0 -9.81 0" integrator="RK4" jacobian="dense" tolerance="1e-28">
    <flag contact="disable" island="disable"/>
  </option>
  <worldbody>
    <body name="crank" pos="0.131637384284 0.0719138307906 0">
      <inertial pos="0 0 0" mass="0.3" diaginertia="0.00225 0.00225 0.00225"/>
      <joint name="crank" axis="0 0 1" pos="-0.131637384284 -0.0719138307906 0"/>
      <body name="rod" pos="0.626438759525 0 0">
        <inertial pos="0 0 0" mass="1" diaginertia="0.0833333333333 0.0833333333333 0.0833333333333"/>
        <joint name="rod" axis="0 0 1" pos="-0.494801375242 0.0719138307906 0"/>
      </body>
    </body>
    <body name="slider" pos="1.25287751905 0 0">
      <inertial pos="0 0 0" mass="0.5" diaginertia="0.001 0.001 0.001"/>
      <joint name="slider along" type="slide" axis="1 0 0"/>
    </body>
  </worldbody>
  <equality>
    <connect body1="slider" body2="rod" anchor="0 0 0"
             solref="{solref}" solimp=".9999 .9999 .001 .5 1"/>
  </equality>
</mujoco>""")
for scale in (model.body_invweight0, model.dof_invweight0):
    scale[:] *= 1e-8  # the regularisation of a constraint is proportional to these
data = mujoco.MjData(model)
data.joint("crank").qvel = 10
data.joint("slider along").qvel = -1.82091696617
data.joint("rod").qvel = -12.6604086179
mujoco.mj_step(model, data, nstep=steps)
mujoco.mj_forward(model, data)  # positions at the end of the step, not in the last stage of RK4
end = (*data.body("rod").xpos[:2], -0.144328214646 + data.joint("crank").qpos[0] + data.joint("rod").qpos[0])
print("rod: x = {:.10f} m, y = {:.10f} m, angle = {:.10f} rad".format(*end))
# Exact: rod: x = 0.5738685427 m, y = 0.1423535788 m, angle = -0.2887009293 rad

"""Pendulum 2 in MuJoCo, as the method *tuned* does it."""

import mujoco

duration = 2.0  # s
steps = 200  # 200: below 1e-4; 600: below 1e-6; 2000: below 1e-9
dt = duration / steps  # s

model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{dt}" gravity="0 -9.81 0" integrator="RK4" jacobian="dense">
    <flag contact="disable" island="disable"/>
  </option>
  <worldbody>
    <body name="link 1" pos="0.5 0 0">
      <inertial pos="0 0 0" mass="1" diaginertia="0.0833333333333 0.0833333333333 0.0833333333333"/>
      <joint name="link 1" axis="0 0 1" pos="-0.5 0 0"/>
      <body name="link 2" pos="1 0 0">
        <inertial pos="0 0 0" mass="1" diaginertia="0.0833333333333 0.0833333333333 0.0833333333333"/>
        <joint name="link 2" axis="0 0 1" pos="-0.5 0 0"/>
      </body>
    </body>
  </worldbody>
</mujoco>""")
data = mujoco.MjData(model)
mujoco.mj_step(model, data, nstep=steps)
mujoco.mj_forward(model, data)  # places of the bodies at the end, not in the last stage of RK4
end = (*data.body("link 2").xpos[:2], data.joint("link 1").qpos[0] + data.joint("link 2").qpos[0])
print("link 2: x = {:.10f} m, y = {:.10f} m, angle = {:.10f} rad".format(*end))
# Exact: link 2: x = 0.1154304525 m, y = -1.4556620515 m, angle = -1.1634342519 rad

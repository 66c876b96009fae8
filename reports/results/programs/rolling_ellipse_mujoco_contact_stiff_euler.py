"""Rolling ellipse in MuJoCo by the method *contact, stiff Euler*: a contact as stiff as the step allows."""

import mujoco

duration = 1.0  # s
steps = 300
dt = duration / steps  # s

model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{dt}" gravity="0 -9.81 0" cone="elliptic" jacobian="dense" tolerance="1e-15">
    <flag island="disable"/>
  </option>
  <worldbody>
    <body name="roller" pos="0 0.3 0">
      <inertial pos="0 0 0" mass="1" diaginertia="0.085 0.085 0.085"/>
      <joint axis="1 0 0" type="slide"/>
      <joint axis="0 1 0" type="slide"/>
      <joint axis="0 0 1"/>
      <geom name="ellipse" type="ellipsoid" size="0.5 0.3 0.3" mass="0" contype="0" conaffinity="0"/>
    </body>
    <geom name="ground" type="plane" size="1 1 1" zaxis="0 1 0" contype="0" conaffinity="0"/>
  </worldbody>
  <contact>
    <pair geom1="ground" geom2="ellipse" condim="3" friction="10 10" margin="3e-13"
          solref="{2 * dt} 1" solimp=".9999 .9999 .001 .5 1" solreffriction="-1e-9 {-1 / dt}"/>
  </contact>
</mujoco>""")
data = mujoco.MjData(model)
data.qvel[:] = -1.2, 0, 4
mujoco.mj_step(model, data, nstep=steps)
end = data.qpos[0], 0.3 + data.qpos[1], data.qpos[2]
print("roller: x = {:.10f} m, y = {:.10f} m, angle = {:.10f} rad".format(*end))
# Exact: roller: x = -0.0762588581 m, y = 0.3158659144 m, angle = 0.2497114923 rad

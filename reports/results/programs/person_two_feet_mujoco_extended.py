"""Person two feet in MuJoCo by the method *extended*."""

import mujoco

duration = 0.3  # s
steps = 300
dt = duration / steps  # s
constant = max(5 * dt, 0.0418969173324)  # s, of the loop's spring: at least a fifth of the motion's time scale
solref = f"{-1 / constant**2} {-2 / constant}"

model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{dt}" gravity="0 -9.81 0" integrator="RK4" jacobian="dense" tolerance="1e-28">
    <flag contact="disable" island="disable"/>
  </option>
  <worldbody>
    <body name="left shank" pos="0.0133977825401 0.243725534496 0">
      <inertial pos="0 0 0" mass="3.4875" diaginertia="0.058948724672 0.058948724672 0.058948724672"/>
      <joint name="left shank" axis="0 0 1" pos="-0.0133977825401 -0.243725534496 0"/>
      <body name="left thigh" pos="0.132913681022 0.395999961865 0">
        <inertial pos="0 0 0" mass="7.5" diaginertia="0.143838310793 0.143838310793 0.143838310793"/>
        <joint name="left thigh" axis="0 0 1" pos="-0.12268221746 -0.209874465504 0"/>
        <body name="trunk" pos="0.125186378723 0.474202297801 0">
          <inertial pos="0 0 0" mass="50.85" diaginertia="3.17771821302 3.17771821302 3.17771821302"/>
          <joint name="trunk" axis="0 0 1" pos="-0.0314978422857 -0.313927794162 0"/>
        </body>
      </body>
    </body>
    <body name="right shank" pos="0.378884420819 0.211926056024 0">
      <inertial pos="0 0 0" mass="3.4875" diaginertia="0.058948724672 0.058948724672 0.058948724672"/>
      <joint name="right shank" axis="0 0 1" pos="0.121115579181 -0.211926056024 0"/>
      <body name="right thigh" pos="-0.118796565061 0.403515182527 0">
        <inertial pos="0 0 0" mass="7.5" diaginertia="0.143838310793 0.143838310793 0.143838310793"/>
        <joint name="right thigh" axis="0 0 1" pos="0.0263044208188 -0.241673943976 0"/>
      </body>
    </body>
  </worldbody>
  <equality>
    <connect body1="right thigh" body2="left thigh" anchor="-0.0200878557576 0.184558761449 0"
             solref="{solref}" solimp=".9999 .9999 .001 .5 1"/>
  </equality>
</mujoco>""")
for scale in (model.body_invweight0, model.dof_invweight0):
    scale[:] *= 1e-8  # the regularisation of a constraint is proportional to these
data = mujoco.MjData(model)
mujoco.mj_step(model, data, nstep=steps)
mujoco.mj_forward(model, data)  # positions at the end of the step, not in the last stage of RK4
end = (
    *data.body("trunk").xpos[:2],
    1.47079632679 + data.joint("left shank").qpos[0] + data.joint("left thigh").qpos[0] + data.joint("trunk").qpos[0],
)
print("trunk: x = {:.10f} m, y = {:.10f} m, angle = {:.10f} rad".format(*end))
# Exact: trunk: x = 0.2845902970 m, y = 0.7027151569 m, angle = 1.5201414546 rad

"""Two four-bars side by side in MuJoCo, as the method *tuned* does it."""

import math

import mujoco

duration = 0.6  # s, before the bars lie in line for the first time
steps = 600
dt = duration / steps  # s
solref = f"{5 * dt} 1"  # each loop's spring: critically damped, with a time constant of five steps

BAR = '<inertial pos="0 0 0" mass="1" diaginertia="0.0833333333333 0.0833333333333 0.0833333333333"/>'
CRANK = '<joint name="crank {0}" axis="0 0 1" pos="0 -0.5 0"/>'
COUPLER = """<body name="coupler {0}" pos="0.5 0.5 0">
        {1}
        <joint name="coupler {0}" axis="0 0 1" pos="-0.5 0 0"/>
      </body>"""
CLOSED = f'anchor="0.5 0 0" solref="{solref}" solimp=".9999 .9999 .001 .5 1"'
model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{dt}" gravity="0 -9.81 0" integrator="RK4" jacobian="dense" tolerance="1e-15">
    <flag contact="disable" island="disable"/>
  </option>
  <worldbody>
    <body name="crank 0" pos="0 0.5 0">{BAR}{CRANK.format(0)}{COUPLER.format(0, BAR)}</body>
    <body name="crank 1" pos="1 0.5 0">{BAR}{CRANK.format(1)}{COUPLER.format(1, BAR)}</body>
    <body name="crank 2" pos="2 0.5 0">{BAR}{CRANK.format(2)}</body>
  </worldbody>
  <equality>
    <connect body1="coupler 0" body2="crank 1" {CLOSED}/>
    <connect body1="coupler 1" body2="crank 2" {CLOSED}/>
  </equality>
</mujoco>""")
data = mujoco.MjData(model)
for number in range(3):
    data.joint(f"crank {number}").qvel = -1  # rad/s
for number in range(2):
    data.joint(f"coupler {number}").qvel = 1  # against its crank: couplers do not turn
mujoco.mj_step(model, data, nstep=steps)
mujoco.mj_forward(model, data)  # places of the bodies at the end, not in the last stage of RK4
end = (*data.body("crank 2").xpos[:2], math.pi / 2 + data.joint("crank 2").qpos[0])
print("crank 2: x = {:.10f} m, y = {:.10f} m, angle = {:.10f} rad".format(*end))
# Exact: crank 2: x = 2.4421637980 m, y = 0.2334334504 m, angle = 0.4857445341 rad

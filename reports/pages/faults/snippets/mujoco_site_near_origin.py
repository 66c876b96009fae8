import mujoco

# A body of 1e-7 kg m^2 on a hinge; a spring of 1 N pulls straight across an arm of 0.99 micrometres.
model = mujoco.MjModel.from_xml_string("""
<mujoco>
  <option gravity="0 0 0"/>
  <worldbody>
    <site name="wall" pos="1 0 0"/>
    <body>
      <joint type="hinge" axis="0 0 1"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1e-7 1e-7 1e-7"/>
      <site name="arm" pos="0 0.99e-6 0"/>
    </body>
  </worldbody>
  <tendon>
    <spatial stiffness="1" springlength="0"><site site="wall"/><site site="arm"/></spatial>
  </tendon>
</mujoco>""")
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
expected = -9.9  # rad/s^2: 1 N times 0.99e-6 m over 1e-7 kg m^2
found = data.qacc[0]
print(f"MuJoCo {mujoco.__version__}: expected {expected!r}, found {float(found)!r}")

import mujoco

# A point on a string of 1 m goes round at 1 m/s.
model = mujoco.MjModel.from_xml_string("""
<mujoco>
  <option gravity="0 0 0"/>
  <worldbody>
    <site name="middle"/>
    <body pos="1 0 0">
      <joint type="slide" axis="1 0 0"/>
      <joint type="slide" axis="0 1 0"/>
      <geom size="0.1"/>
      <site name="point"/>
    </body>
  </worldbody>
  <tendon>
    <spatial name="string"><site site="middle"/><site site="point"/></spatial>
  </tendon>
  <equality>
    <tendon tendon1="string" solimp="1 1 0.001 0.5 2"/>
  </equality>
</mujoco>""")
data = mujoco.MjData(model)
data.qvel[:] = 0, 1
mujoco.mj_forward(model, data)
expected = -1.0  # m/s^2, towards the middle: v^2 / r
found = data.qacc[0]
print(f"MuJoCo {mujoco.__version__}: expected {expected!r}, found {float(found)!r}")

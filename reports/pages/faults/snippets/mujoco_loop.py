import mujoco

# A ball on an arm of 1 m, held to the world by a connect, goes round at 1 rad/s.
model = mujoco.MjModel.from_xml_string("""
<mujoco>
  <option gravity="0 0 0"/>
  <worldbody>
    <body name="ball" pos="1 0 0">
      <joint type="slide" axis="1 0 0"/>
      <joint type="slide" axis="0 1 0"/>
      <joint type="hinge" axis="0 0 1"/>
      <geom size="0.1"/>
    </body>
  </worldbody>
  <equality>
    <connect body1="ball" anchor="-1 0 0" solimp="1 1 0.001 0.5 2"/>
  </equality>
</mujoco>""")
data = mujoco.MjData(model)
data.qvel[:] = 0, 1, 1
mujoco.mj_forward(model, data)
expected = -1.0  # m/s^2, towards the middle: omega^2 r
found = data.qacc[0]
print(f"MuJoCo {mujoco.__version__}: expected {expected!r}, found {float(found)!r}")

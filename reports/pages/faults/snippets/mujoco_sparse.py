import mujoco

# Five wheels on arms: a tree that branches, and two gears between its branches. The same model in two storage formats.
MODEL = """
<mujoco>
  <option gravity="0 -9.81 0" jacobian="{}"/>
  <default><geom type="capsule" fromto="0 0 0 1 0 0" size="0.1" contype="0" conaffinity="0"/></default>
  <worldbody>
    <body><joint name="0" axis="0 0 1"/><geom/>
      <body pos="1 0 0"><joint name="1" axis="0 0 1"/><geom/>
        <body pos="1 0 0"><joint name="2" axis="0 0 1"/><geom/></body>
        <body pos="1 0 0"><joint name="3" axis="0 0 1"/><geom/></body>
      </body>
      <body pos="1 0 0"><joint name="4" axis="0 0 1"/><geom/></body>
    </body>
  </worldbody>
  <equality>
    <joint joint1="4" joint2="0"/>
    <joint joint1="4" joint2="2"/>
  </equality>
</mujoco>"""
acceleration = {}
for jacobian in ("dense", "sparse"):
    model = mujoco.MjModel.from_xml_string(MODEL.format(jacobian))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    acceleration[jacobian] = data.qacc
expected, found = (acceleration[jacobian][4] for jacobian in ("dense", "sparse"))  # rad/s^2
print(f"MuJoCo {mujoco.__version__}: expected {float(expected)!r}, found {float(found)!r}")

import mujoco


def with_term(model, data):
    data.efc_aref[0] += 2 * data.qvel[0] ** 2  # p''(x) x'^2 of p(x) = x^2


# A bead on the wire y = x^2, at its lowest point at 1 m/s: it goes round a circle of radius 1/2.
model = mujoco.MjModel.from_xml_string("""
<mujoco>
  <option gravity="0 0 0"/>
  <worldbody>
    <body>
      <joint name="x" type="slide" axis="1 0 0"/>
      <joint name="y" type="slide" axis="0 1 0"/>
      <geom size="0.1"/>
    </body>
  </worldbody>
  <equality>
    <joint joint1="y" joint2="x" polycoef="0 0 1 0 0" solimp="1 1 0.001 0.5 2"/>
  </equality>
</mujoco>""")
model.dof_invweight0[:] *= 1e-12  # as good as rigid: what is left is not softness
data = mujoco.MjData(model)
mujoco.set_mjcb_control(with_term)  # when the model is made: the compiler calls it too
data.qvel[:] = 1, 0
mujoco.mj_forward(model, data)
mujoco.set_mjcb_control(None)
expected = 2.0  # m/s^2: y'' = 2 x'^2 + 2 x x''
found = data.qacc[1]
print(f"MuJoCo {mujoco.__version__}: expected {expected!r}, found {float(found)!r}")

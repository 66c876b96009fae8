import mujoco


def with_term(model, data):
    # the second derivative of |r| at a steady velocity
    data.efc_aref[0] -= (data.qvel @ data.qvel - data.ten_velocity[0] ** 2) / data.ten_length[0]


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
model.tendon_invweight0[:] *= 1e-12  # as good as rigid: what is left is not softness
data = mujoco.MjData(model)
mujoco.set_mjcb_control(with_term)  # when the model is made: the compiler calls it too
data.qvel[:] = 0, 1
mujoco.mj_forward(model, data)
mujoco.set_mjcb_control(None)
expected = -1.0  # m/s^2, towards the middle: v^2 / r
found = data.qacc[0]
print(f"MuJoCo {mujoco.__version__}: expected {expected!r}, found {float(found)!r}")

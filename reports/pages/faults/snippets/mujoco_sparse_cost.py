import mujoco

# Five wheels on arms, for a second, in two storage formats: a tree that branches, and two gears between its branches.
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
end = {}
for jacobian in ("dense", "sparse"):
    model = mujoco.MjModel.from_xml_string(MODEL.format(jacobian))
    data = mujoco.MjData(model)
    gap, most = 0.0, 0
    for _ in range(round(1 / model.opt.timestep)):
        mujoco.mj_step(model, data)
        gap, most = max(gap, abs(data.efc_pos[: data.ne]).max()), max(most, data.solver_niter[0])
    end[jacobian] = data.qpos, gap, most, data.time
print(f"MuJoCo {mujoco.__version__}")
print(f"{'jacobian':10}{'time [s]':>9}{'gap [rad]':>11}{'iterations':>12}{'angles, from dense [rad]':>26}")
for jacobian, (pose, gap, most, time) in end.items():
    print(f"{jacobian:10}{time:9.3f}{gap:11.1e}{most:12d}{abs(pose - end['dense'][0]).max():26.1e}")

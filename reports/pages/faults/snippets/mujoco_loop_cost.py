from math import cos, pi, sin

import mujoco

# A ball of 1 kg and 0.1 kg m^2 on an arm of 1 m swings from level for 2 s: 1.1 a'' = -g sin(a), a from the vertical.
MODEL = """
<mujoco>
  <option gravity="0 -9.81 0" timestep="{step}" {option}/>
  <worldbody>
    <body name="ball" pos="1 0 0">
      <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><joint type="hinge" axis="0 0 1"/>
      <inertial pos="0 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>
    </body>
  </worldbody>
  <equality><connect body1="ball" anchor="-1 0 0" {equality}/></equality>
</mujoco>"""
G, EVERY = 9.81, 1e-2


def exact(seconds, h=1e-3):
    """The place [m] and the arm's force along itself [N] every 0.01 s, by Runge and Kutta's method of fourth order."""
    a, w, found = pi / 2, 0.0, []
    for step in range(round(seconds / h) + 1):
        if step % 10 == 0:
            found.append((sin(a), -cos(a), G * cos(a) + w * w))
        k1, j1 = w, -G / 1.1 * sin(a)
        k2, j2 = w + h / 2 * j1, -G / 1.1 * sin(a + h / 2 * k1)
        k3, j3 = w + h / 2 * j2, -G / 1.1 * sin(a + h / 2 * k2)
        k4, j4 = w + h * j3, -G / 1.1 * sin(a + h * k3)
        a, w = a + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), w + h / 6 * (j1 + 2 * j2 + 2 * j3 + j4)
    return found


def run(step, stiff):
    """The largest errors over 2 s: place [m], gap [m]; energy of that of the fall, force of the largest."""
    option, equality = 'integrator="RK4"', f'solref="{stiff * step} 1" solimp="0.9999 0.9999 0.001 0.5 2"'
    words = {"option": option, "equality": equality} if stiff else {"option": "", "equality": ""}
    model = mujoco.MjModel.from_xml_string(MODEL.format(step=step, **words))
    data = mujoco.MjData(model)

    truth, worst = exact(2.0), [0.0] * 4
    for x, y, force in truth[1:]:
        for _ in range(round(EVERY / step)):
            mujoco.mj_step(model, data)
        now_x, now_y = 1 + float(data.qpos[0]), float(data.qpos[1])
        mujoco.mj_forward(model, data)
        pull = data.qfrc_constraint
        energy = float(data.qvel[:2] @ data.qvel[:2] + 0.1 * data.qvel[2] ** 2) / 2 + G * now_y
        errors = (
            ((now_x - x) ** 2 + (now_y - y) ** 2) ** 0.5,
            ((now_x - cos(data.qpos[2])) ** 2 + (now_y - sin(data.qpos[2])) ** 2) ** 0.5,
            abs(energy) / G,
            abs(-now_x * pull[0] - now_y * pull[1] - force) / max(each for *_, each in truth),
        )
        worst = [max(pair) for pair in zip(worst, errors, strict=True)]
    return worst


print(f"MuJoCo {mujoco.__version__}")
print(f"{'':24}{'step [s]':>9}{'place [m]':>11}{'gap [m]':>10}{'energy':>10}{'force':>10}")
for label, stiff in (("as shipped", 0), ("RK4, solref of 2 steps", 2)):
    for step in (1e-3, 1e-4):
        errors = run(step, stiff)
        print(f"{label:24}{step:9.0e}{errors[0]:11.1e}" + "".join(f"{each:10.1e}" for each in errors[1:]))

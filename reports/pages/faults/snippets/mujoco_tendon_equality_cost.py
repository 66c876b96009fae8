from math import cos, pi, sin

import mujoco

# A weight of 1 kg on a string of 1 m swings from level for 2 s: a'' = -g sin(a), a from the vertical.
MODEL = """
<mujoco>
  <option gravity="0 -9.81 0" timestep="{step}" {option}/>
  <worldbody>
    <site name="middle"/>
    <body pos="1 0 0">
      <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><geom size="0.1" mass="1"/>
      <site name="point"/>
    </body>
  </worldbody>
  <tendon><spatial name="string"><site site="middle"/><site site="point"/></spatial></tendon>
  <equality><tendon tendon1="string" {equality}/></equality>
</mujoco>"""
G, EVERY = 9.81, 1e-2


def exact(seconds, h=1e-3):
    """The place [m] and the string's force [N] every 0.01 s, by Runge and Kutta's method of fourth order."""
    a, w, found = pi / 2, 0.0, []
    for step in range(round(seconds / h) + 1):
        if step % 10 == 0:
            found.append((sin(a), -cos(a), G * cos(a) + w * w))
        k1, j1 = w, -G * sin(a)
        k2, j2 = w + h / 2 * j1, -G * sin(a + h / 2 * k1)
        k3, j3 = w + h / 2 * j2, -G * sin(a + h / 2 * k2)
        k4, j4 = w + h * j3, -G * sin(a + h * k3)
        a, w = a + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), w + h / 6 * (j1 + 2 * j2 + 2 * j3 + j4)
    return found


def run(step, stiff, term):
    """The largest errors over 2 s: place [m], gap [m]; energy of that of the fall, force of the largest."""
    option, equality = 'integrator="RK4"', f'solref="{stiff * step} 1" solimp="0.9999 0.9999 0.001 0.5 2"'
    words = {"option": option, "equality": equality} if stiff else {"option": "", "equality": ""}
    model = mujoco.MjModel.from_xml_string(MODEL.format(step=step, **words))
    data = mujoco.MjData(model)

    def with_term(model, data):
        # The second derivative of |r| at a steady velocity, (v^2 - (dr/dt)^2) / |r|, which the engine leaves out.
        data.efc_aref[0] -= (data.qvel @ data.qvel - data.ten_velocity[0] ** 2) / data.ten_length[0]

    mujoco.set_mjcb_control(with_term if term else None)
    truth, worst = exact(2.0), [0.0] * 4
    for x, y, force in truth[1:]:
        for _ in range(round(EVERY / step)):
            mujoco.mj_step(model, data)
        now_x, now_y = 1 + float(data.qpos[0]), float(data.qpos[1])
        mujoco.mj_forward(model, data)
        energy = float(data.qvel @ data.qvel) / 2 + G * now_y
        errors = (
            ((now_x - x) ** 2 + (now_y - y) ** 2) ** 0.5,
            abs((now_x**2 + now_y**2) ** 0.5 - 1),
            abs(energy) / G,
            abs(-data.efc_force[0] - force) / max(each for *_, each in truth),
        )
        worst = [max(pair) for pair in zip(worst, errors, strict=True)]
    mujoco.set_mjcb_control(None)
    return worst


print(f"MuJoCo {mujoco.__version__}")
print(f"{'':24}{'step [s]':>9}{'place [m]':>11}{'gap [m]':>10}{'energy':>10}{'force':>10}")
for label, stiff, term in (
    ("as shipped", 0, False),
    ("RK4, solref of 2 steps", 2, False),
    ("RK4, solref of 5 steps", 5, False),
    ("the same, with the term", 5, True),
):
    for step in (1e-3, 1e-4):
        errors = run(step, stiff, term)
        print(f"{label:24}{step:9.0e}{errors[0]:11.1e}" + "".join(f"{each:10.1e}" for each in errors[1:]))

import mujoco

# A bead of 1 kg swings on the wire y = x^2 from x = 1 m for 2 s: (1 + 4 x^2) x'' = -4 x x'^2 - 2 g x.
MODEL = """
<mujoco>
  <option gravity="0 -9.81 0" timestep="{step}" {option}/>
  <worldbody>
    <body>
      <joint name="x" type="slide" axis="1 0 0"/><joint name="y" type="slide" axis="0 1 0"/><geom size="0.1" mass="1"/>
    </body>
  </worldbody>
  <equality><joint joint1="y" joint2="x" polycoef="0 0 1 0 0" {equality}/></equality>
  <keyframe><key qpos="1 1"/></keyframe>
</mujoco>"""
G, EVERY = 9.81, 1e-2


def exact(seconds, h=1e-3):
    """x [m] and the wire's upward force [N] every 0.01 s, by Runge and Kutta's method of fourth order."""

    def rate(x, v):
        return -(4 * x * v * v + 2 * G * x) / (1 + 4 * x * x)

    x, v, found = 1.0, 0.0, []
    for step in range(round(seconds / h) + 1):
        if step % 10 == 0:
            found.append((x, 2 * v * v + 2 * x * rate(x, v) + G))
        k1, j1 = v, rate(x, v)
        k2, j2 = v + h / 2 * j1, rate(x + h / 2 * k1, v + h / 2 * j1)
        k3, j3 = v + h / 2 * j2, rate(x + h / 2 * k2, v + h / 2 * j2)
        k4, j4 = v + h * j3, rate(x + h * k3, v + h * j3)
        x, v = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), v + h / 6 * (j1 + 2 * j2 + 2 * j3 + j4)
    return found


def run(step, stiff, term):
    """The largest errors over 2 s: place [m], gap [m]; energy of that of the fall, force of the largest."""
    option, equality = 'integrator="RK4"', f'solref="{stiff * step} 1" solimp="0.9999 0.9999 0.001 0.5 2"'
    words = {"option": option, "equality": equality} if stiff else {"option": "", "equality": ""}
    model = mujoco.MjModel.from_xml_string(MODEL.format(step=step, **words))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)

    def with_term(model, data):
        data.efc_aref[0] += 2 * data.qvel[0] ** 2  # p''(x) x'^2, which the engine leaves out

    mujoco.set_mjcb_control(with_term if term else None)
    truth, worst = exact(2.0), [0.0] * 4
    for x, force in truth[1:]:
        for _ in range(round(EVERY / step)):
            mujoco.mj_step(model, data)
        now_x, now_y = (float(value) for value in data.qpos)
        mujoco.mj_forward(model, data)
        energy = float(data.qvel @ data.qvel) / 2 + G * (now_y - 1)
        errors = (
            abs(now_x - x),
            abs(now_y - now_x**2),
            abs(energy) / G,
            abs(data.efc_force[0] - force) / max(each for _, each in truth),
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

"""Andrews' mechanism in MuJoCo, as the method *tuned* does it."""

import mujoco

duration = 0.05  # s
steps = 300  # 300: below 0.01; 3000: below 1e-4
dt = duration / steps  # s
solref = f"{5 * dt} 1"  # the loops' springs: critically damped, with a time constant of five steps


def body(name, place, pivot, mass, inertia, inside=""):
    """A body that stands parallel to the world at the start: its centre [m] in its parent, its hinge from there."""
    x, y = place
    return f"""
    <body name="{name}" pos="{x} {y} 0">
      <inertial pos="0 0 0" mass="{mass}" diaginertia="{inertia} {inertia} {inertia}"/>
      <joint name="{name}" axis="0 0 1" pos="{pivot[0]} {pivot[1]} 0"/>{inside}
    </body>"""


k2 = body(
    "K2",
    (-0.005409681957963834, 0.0003342770014233451),
    (0.011478107475384518, -0.0007092593203631858),
    0.00365,
    4.41e-7,
)
k4 = body(
    "K4", (0.023013888325545254, -0.004560665609952361), (-0.003774264055680976, 0.00439078931833374), 0.00706, 5.667e-7
)
k6 = body(
    "K6",
    (0.030719134265008115, -0.00012155637453945163),
    (-0.0030898659706253, -0.004896613961052246),
    0.00706,
    5.667e-7,
)
end_of_spring = '<site name="D" pos="0.008269792781500834 0.004872681741201319 0"/>'
bodies = [
    body(
        "K1",
        (0.0009182485980307614, -5.674074562905483e-05),
        (-0.0009182485980307614, 5.674074562905483e-05),
        0.04325,
        2.194e-6,
        k2,
    ),
    body(
        "K3",
        (-0.018742186670315453, 0.02048510678907394),
        (-0.017607813329684547, 0.012244893210926061),
        0.02373,
        5.255e-6,
        end_of_spring,
    ),
    body(
        "K5",
        (-0.053236828155704144, 0.016631847966616306),
        (-0.016103171844295862, -0.018901847966616307),
        0.0705,
        1.169e-5,
        k4,
    ),
    body(
        "K7",
        (-0.059262402801791715, -0.010600698332712844),
        (-0.010077597198208282, 0.008330698332712844),
        0.05498,
        1.912e-5,
        k6,
    ),
]
# The end P of K2, where three loops meet, from its centre of mass.
loops = [
    f'<connect body1="K2" body2="{name}" anchor="-0.016468588986421263 0.0010176329379123971 0" '
    f'solref="{solref}" solimp=".9999 .9999 .001 .5 1"/>'
    for name in ("K3", "K4", "K6")
]
model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{dt}" gravity="0 0 0" integrator="RK4" tolerance="1e-15" jacobian="dense">
    <flag contact="disable" island="disable"/>
  </option>
  <worldbody>
    <site name="C" pos="0.014 0.072 0"/>{"".join(bodies)}
  </worldbody>
  <equality>{"".join(loops)}</equality>
  <tendon>
    <spatial stiffness="4530" springlength="0.07785 0.07785"><site site="C"/><site site="D"/></spatial>
  </tendon>
  <actuator><motor joint="K1"/></actuator>
</mujoco>""")
data = mujoco.MjData(model)
data.ctrl[0] = 0.033  # N m
mujoco.mj_step(model, data, nstep=steps)
mujoco.mj_forward(model, data)  # places of the bodies at the end, not in the last stage of RK4
end = (*data.body("K1").xpos[:2], -0.0617138900142765 + data.joint("K1").qpos[0])
print("K1: x = {:.10f} m, y = {:.10f} m, angle = {:.10f} rad".format(*end))
# Exact: K1: x = -0.0006845463 m, y = 0.0006146514 m, angle = 33.8258677670 rad

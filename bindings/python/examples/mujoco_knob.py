"""A knob simulated in MuJoCo hits a contact that gains energy, with and without the energy guard in the loop.

A hand throws a knob into a stiff spring and lets go. The spring's torque is calculated at 1 kHz from the encoder's angle and acts one tick late, as
over a USB link, so each bounce gives the knob energy. The guard bounds the torque between spring and motor. It knows the knob's damping and encoder, but
not the springs.

    pip install touchstone-haptics mujoco
    python mujoco_knob.py
"""

import math

import mujoco
import touchstone

RATE_HZ = 1000
INERTIA_KG_M2, DAMPING_N_M_S_PER_RAD = 1e-4, 4e-4
FORCE_LIMIT_N_M, STIFFNESS_N_M_PER_RAD, SURFACE_RAD = 0.5, 30.0, 0.5
COUNT_RAD = 2 * math.pi / 40_000
SPEED_RAD_PER_S = 20.0
CAPACITY_J = 0.02

KNOB = f"""
<mujoco>
  <option timestep="{1e-4}" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody>
    <body>
      <inertial pos="0 0 0" mass="0.1" diaginertia="{INERTIA_KG_M2} {INERTIA_KG_M2} {INERTIA_KG_M2}"/>
      <joint name="knob" type="hinge" axis="0 0 1" damping="{DAMPING_N_M_S_PER_RAD}"/>
    </body>
  </worldbody>
  <actuator><motor joint="knob" ctrllimited="true" ctrlrange="-{FORCE_LIMIT_N_M} {FORCE_LIMIT_N_M}"/></actuator>
</mujoco>
"""


def contact(angle_rad):
    """Torque of the contact along the angle, N·m: springs on both sides."""
    depth = math.copysign(max(0.0, abs(angle_rad) - SURFACE_RAD), angle_rad)
    return max(-FORCE_LIMIT_N_M, min(FORCE_LIMIT_N_M, -STIFFNESS_N_M_PER_RAD * depth))


def throw(guarded, seconds=5.0):
    """Throws the knob. Returns its kinetic energy at the throw, and the largest between the springs after the first bounce, J."""
    model = mujoco.MjModel.from_xml_string(KNOB)
    knob = mujoco.MjData(model)
    knob.qvel[0] = SPEED_RAD_PER_S
    per_tick = round(1 / (RATE_HZ * model.opt.timestep))
    guard = touchstone.Guard(
        rate_hz=RATE_HZ,
        force_limit_n_m=FORCE_LIMIT_N_M,
        count_rad=COUNT_RAD,
        damping_n_m_s_per_rad=DAMPING_N_M_S_PER_RAD,
        # MuJoCo applies the guard's torque from the moment at which the angle is read.
        delay_s=0.0,
        capacity_j=CAPACITY_J,
        overspeed_rad_per_s=120.0,
    )
    energy = lambda: 0.5 * INERTIA_KG_M2 * knob.qvel[0] ** 2
    thrown, largest, reached, late, last = energy(), 0.0, False, 0.0, 0.0
    for _ in range(round(seconds * RATE_HZ)):
        angle = round(knob.qpos[0] / COUNT_RAD) * COUNT_RAD
        wanted, late = late, contact(angle)
        # The guard counts a torque that resists a motion as positive.
        knob.ctrl[0] = -guard.tick(angle - last, -wanted) if guarded else wanted
        last = angle
        for _ in range(per_tick):
            mujoco.mj_step(model, knob)
        reached = reached or abs(angle) > SURFACE_RAD
        if reached and abs(angle) < SURFACE_RAD:
            largest = max(largest, energy())
    return thrown, largest


if __name__ == "__main__":
    thrown, free = throw(guarded=False)
    _, bounded = throw(guarded=True)
    print(f"thrown with {1e3 * thrown:.1f} mJ; afterwards at most {1e3 * free:.1f} mJ without the guard, {1e3 * bounded:.1f} mJ with it")

"""Compares MuJoCo, Drake and Touchstone: error and computing time for a hinge with dry friction that is pressed into a wall.

    compare.py RIVALS [TICKS [ROUNDS]]    RIVALS: the program of `cargo build --release -p touchstone-lab --example rivals`

Needs the Python packages mujoco and drake; a package that is not installed is left out with a note. README.md in this folder says what
is compared and what is not.
"""

import json
import statistics
import subprocess
import sys
import time

import numpy

SUBSTEPS = (1, 4, 16)
# Speed in rad/s at which the smoothed friction reaches tanh(1) of its level, for a physics engine without dry friction.
SMOOTHING_RAD_PER_S = 1e-2


def problem(program, name, ticks):
    text = subprocess.run([program, "problem", name, str(ticks)], check=True, capture_output=True, text=True).stdout
    found = json.loads(text)
    found["torque"] = numpy.array(found["torque"])
    found["angle"] = numpy.array(found["angle"])
    return found


def mujoco_model(given, integrator, substeps, wall):
    import mujoco

    # The wall is a joint limit of MuJoCo with the wall's stiffness and critical damping. Only its time is compared, because it is another model.
    inertia, stiffness = given["inertia"], given["stiffness"]
    limit = ('limited="true" range="-10 0.5" '
             f'solreflimit="{-stiffness / inertia} {-2 * (stiffness / inertia) ** 0.5}"') if wall else ""
    xml = f"""
    <mujoco>
      <compiler angle="radian"/>
      <option timestep="{given['period'] / substeps}" integrator="{integrator}" gravity="0 0 0"/>
      <worldbody><body>
        <joint name="hinge" type="hinge" axis="0 0 1" damping="{given['damping']}" frictionloss="{given['friction']}" {limit}/>
        <inertial pos="0 0 0" mass="0.1" diaginertia="{given['inertia']} {given['inertia']} {given['inertia']}"/>
      </body></worldbody>
      <actuator><motor joint="hinge"/></actuator>
    </mujoco>"""
    return mujoco.MjModel.from_xml_string(xml)


def cost_of_a_call_s(given):
    """Time in s that a call of mj_step from Python costs in addition to the step. Compares a thousand calls with one call for a thousand steps."""
    import mujoco

    model = mujoco_model(given, "Euler", 1, False)
    data = mujoco.MjData(model)

    def least(calls, steps):
        times = []
        for _ in range(20):
            begun = time.thread_time()
            for _ in range(calls):
                data.ctrl[0] = 0.0
                mujoco.mj_step(model, data, steps)
            times.append(time.thread_time() - begun)
        return min(times)

    return max(0.0, (least(1000, 1) - least(1, 1000)) / 999)


def mujoco_rows(given):
    import mujoco

    call_s = cost_of_a_call_s(given)
    print(f"(a call of mj_step from Python costs {1e9 * call_s:.0f} ns, which is taken off each tick)")

    def run(integrator, substeps, wall=False):
        model = mujoco_model(given, integrator, substeps, wall)
        data = mujoco.MjData(model)
        data.qpos[0] = given["start"]
        torques = [0.02] * len(given["torque"]) if wall else given["torque"].tolist()

        def march(seen):
            for torque in torques:
                data.ctrl[0] = torque
                mujoco.mj_step(model, data, substeps)
                if seen is not None:
                    seen.append(float(data.qpos[0]))

        begun = time.thread_time()
        march(None)
        took = time.thread_time() - begun - call_s * len(torques)
        mujoco.mj_resetData(model, data)
        data.qpos[0] = given["start"]
        angles = []
        march(angles)
        return took, numpy.array(angles)

    for integrator in ("Euler", "implicitfast", "RK4"):
        for substeps in SUBSTEPS:
            yield f"MuJoCo {integrator}, {substeps} a tick", lambda i=integrator, s=substeps: run(i, s)
    yield "MuJoCo implicitfast, 1 a tick, its own wall (time only)", lambda: (run("implicitfast", 1, True)[0], None)


def drake_rows(given):
    from pydrake.all import (
        DiagramBuilder, LogVectorOutput, PiecewisePolynomial, ResetIntegratorFromFlags, Simulator, SymbolicVectorSystem,
        TrajectorySource, Variable, ZeroOrderHold,
    )
    from pydrake.symbolic import tanh

    def run(scheme, step, accuracy):
        x, v, u = Variable("x"), Variable("v"), Variable("u")
        friction = given["friction"] * tanh(v / SMOOTHING_RAD_PER_S)
        acceleration = (u - given["damping"] * v - friction) / given["inertia"]
        ticks = len(given["torque"])

        def built(logged):
            builder = DiagramBuilder()
            plant = builder.AddSystem(SymbolicVectorSystem(state=[x, v], input=[u], dynamics=[v, acceleration], output=[x]))
            times = given["period"] * numpy.arange(ticks + 1)
            values = numpy.append(given["torque"], given["torque"][-1])[None, :]
            # Shifted by half a tick, so that rounding of a tick's start never gives the value of the tick before.
            source = builder.AddSystem(TrajectorySource(PiecewisePolynomial.ZeroOrderHold(times - 0.5 * given["period"], values)))
            hold = builder.AddSystem(ZeroOrderHold(given["period"], 1))
            builder.Connect(source.get_output_port(), hold.get_input_port())
            builder.Connect(hold.get_output_port(), plant.get_input_port())
            log = LogVectorOutput(plant.get_output_port(), builder, given["period"]) if logged else None
            diagram = builder.Build()
            simulator = Simulator(diagram)
            if accuracy:
                ResetIntegratorFromFlags(simulator, scheme, given["period"])
                simulator.get_mutable_integrator().set_target_accuracy(accuracy)
            else:
                # This integrator has no error estimate, so its steps are fixed.
                ResetIntegratorFromFlags(simulator, scheme, step)
            context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
            context.SetContinuousState([given["start"], 0.0])
            simulator.Initialize()
            return simulator, log

        simulator, _ = built(False)
        begun = time.thread_time()
        simulator.AdvanceTo(given["period"] * ticks)
        took = time.thread_time() - begun
        simulator, log = built(True)
        simulator.AdvanceTo(given["period"] * ticks)
        data = log.FindLog(simulator.get_context()).data()[0]
        return took, data[1:ticks + 1]

    period = given["period"]
    for scheme, step, accuracy, words in (
        ("semi_explicit_euler", period / 4, None, "semi-explicit Euler, 4 a tick"),
        ("semi_explicit_euler", period / 16, None, "semi-explicit Euler, 16 a tick"),
        ("runge_kutta3", period, 1e-4, "RK3, accuracy 1e-4"),
        ("runge_kutta3", period, 1e-8, "RK3, accuracy 1e-8"),
    ):
        yield f"Drake {words}, smoothed friction", lambda a=scheme, b=step, c=accuracy: run(a, b, c)


def main():
    program = sys.argv[1]
    ticks = int(sys.argv[2]) if len(sys.argv) > 2 else 10_000
    rounds = int(sys.argv[3]) if len(sys.argv) > 3 else 5
    for name in ("moving", "stuck"):
        given = problem(program, name, ticks)
        print(f"\n{name}: {ticks} ticks, {given['events']} stops and starts, at rest in {100 * given['stuck_share']:.0f} % of the ticks, "
              f"reference's own floor {given['reference_floor']:.1e} rad")
        rows = []
        for engine, make in (("mujoco", mujoco_rows), ("drake", drake_rows)):
            try:
                rows += [(words, run, [], []) for words, run in make(given)]
            except ImportError as missing:
                print(f"{engine} is left out: {missing}")
        ours = ([], [])
        # The engines run in turns, so that a disturbance by other programs does not hit one engine alone.
        for _ in range(rounds):
            # Elapsed time, in pieces so short that other programs do not disturb all of them.
            for _ in range(10):
                out = subprocess.run([program, "time", name, str(4 * ticks)], check=True, capture_output=True, text=True).stdout
                for times, word in zip(ours, out.split()):
                    times.append(float(word))
            for _, run, times, angles in rows:
                took, found = run()
                times.append(1e9 * took / ticks)
                angles[:] = [found]
        # The smallest times count, because other programs can only make a time longer.
        whole, alone = min(ours[0]), min(ours[1])
        print(f"{'':<58}{'error, rad':>12}{'ns a tick: least, median':>26}{'over loop, plant':>18}")
        for words, times, error in (
            ("Touchstone: plant, encoder, law, press", ours[0], given["touchstone_error"]),
            ("Touchstone: plant alone", ours[1], given["touchstone_error"]),
        ):
            print(f"{words:<58}{error:>12.1e}{min(times):>14.1f}{statistics.median(times):>12.1f}{min(times) / whole:>11.1f}{min(times) / alone:>7.1f}")
        for words, _, times, angles in rows:
            error = "–" if angles[0] is None else f"{numpy.max(numpy.abs(angles[0] - given['angle'])):.1e}"
            median = statistics.median(times)
            print(f"{words:<58}{error:>12}{min(times):>14.1f}{median:>12.1f}{min(times) / whole:>11.1f}{min(times) / alone:>7.1f}")


if __name__ == "__main__":
    main()

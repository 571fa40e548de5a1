"""Runs law and plant of `touchstone export-fmu` in turn with FMPy, and prints a table.

python couple.py LAW.fmu PLANT.fmu [SECONDS] > run.csv
"""

import shutil
import sys

from fmpy import extract, read_model_description
from fmpy.fmi3 import FMU3Slave


class Part:
    """One FMU, initialised."""

    def __init__(self, path):
        self.described = read_model_description(path)
        self.numbers = {it.name: it.valueReference for it in self.described.modelVariables}
        self.folder = extract(path)
        identifier = self.described.coSimulation.modelIdentifier
        token = self.described.guid
        self.fmu = FMU3Slave(guid=token, unzipDirectory=self.folder, modelIdentifier=identifier, instanceName=identifier)
        self.fmu.instantiate()
        self.fmu.enterInitializationMode(startTime=0.0)
        self.fmu.exitInitializationMode()

    def get(self, name):
        """Value of a number."""
        return self.fmu.getFloat64([self.numbers[name]])[0]

    def set(self, name, value):
        """Sets an input."""
        self.fmu.setFloat64([self.numbers[name]], [value])

    def close(self):
        """Ends the instance and removes its files."""
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


def run(law, plant, seconds=None):
    """Rows of time_s, angle_rad, torque_n_m, energy_account_j: the law first, so that its torque acts in the same period."""
    step = plant.described.coSimulation.fixedInternalStepSize
    step = float(step)
    last = float(plant.described.defaultExperiment.stopTime) if seconds is None else seconds
    measured = [name for name in ("angle_rad", "angle_at_change_rad") if name in law.numbers]
    for tick in range(round(last / step)):
        time = tick * step
        for name in measured:
            law.set(name, plant.get(name))
        law.fmu.doStep(time, step)
        torque = law.get("torque_n_m")
        account = law.get("energy_account_j") if "energy_account_j" in law.numbers else 0.0
        yield time, plant.get("angle_rad"), torque, account
        plant.set("torque_n_m", torque)
        plant.fmu.doStep(time, step)


if __name__ == "__main__":
    both = Part(sys.argv[1]), Part(sys.argv[2])
    print("time_s,angle_rad,torque_n_m,energy_account_j")
    for row in run(*both, *map(float, sys.argv[3:])):
        print(*row, sep=",")
    for part in both:
        part.close()

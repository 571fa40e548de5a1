"""Checks FMUs by FMPy: against FMI's schema and rules, and by a simulation with FMPy's own steps. Ends with 9 without FMPy."""

import sys

try:
    import fmpy
    from fmpy.validation import validate_fmu
except ImportError:
    print("no fmpy")
    sys.exit(9)

for path in sys.argv[1:]:
    problems = validate_fmu(path)
    assert not problems, problems
    described = fmpy.read_model_description(path)
    # FMPy's steps have several control periods in a long run.
    done = fmpy.simulate_fmu(path, stop_time=2 * float(described.defaultExperiment.stopTime))
    assert len(done) > 100 and done.dtype.names[0] == "time", done.dtype
    print(path.rsplit("/", 1)[-1], fmpy.supported_platforms(path), len(done), done.dtype.names)

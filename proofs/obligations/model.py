"""The functions that the obligations are about, in Python integers, against vectors from the code.

`cargo run -p touchstone-proofs --example vectors` prints one case a line: name, inputs, outputs.
"""
import math
import subprocess


def step(energy, force, moved, inward, full):
    work = force * moved
    if inward:
        return min(energy + work, full), force
    if work <= energy:
        return energy - work, force
    quotient = energy // moved
    return energy - quotient * moved, quotient


def affordable(energy, force, largest):
    moved = min(energy // force, largest) if force else 0
    return moved, energy - force * moved


def agrees():
    done = subprocess.run(
        ["cargo", "run", "--quiet", "--profile", "every", "-p", "touchstone-proofs", "--example", "vectors"],
        capture_output=True, text=True, check=True)
    cases = wrong = 0
    for line in done.stdout.splitlines():
        name, bits, *numbers = line.split()
        bits = int(bits)
        n = list(map(int, numbers))
        full, largest = (1 << (2 * bits - 1)) - 1, (1 << (bits - 1)) - 1
        if name == "step":
            expected = step(n[0], n[1], n[2], bool(n[3]), full)
            got = tuple(n[4:])
        elif name == "affordable":
            expected, got = affordable(n[0], n[1], largest), tuple(n[2:])
        elif name == "root":
            r = math.isqrt(n[0])
            expected, got = (r, r * r), tuple(n[1:])
        elif name == "scale":
            expected, got = (min(n[0] * n[1] >> (bits * 3 // 4), largest),), tuple(n[2:])
        else:
            expected, got = None, ()
        cases += 1
        if expected != got:
            wrong += 1
            if wrong < 5:
                print("differs:", line, "expected", expected)
    print(f"{cases - wrong} of {cases} vectors of the code agree with the model")
    return cases > 100_000 and wrong == 0

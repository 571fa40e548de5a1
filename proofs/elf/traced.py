"""A second reading: the guard's specification of `spec.py` beside the ticks of the Rust code, as `proofs/examples/trace.rs` prints them.

    traced.py TRACE       the end is 0 if they are the same, bit for bit; 1 else

It needs no board's program, so that it runs wherever the integer obligations do.
"""
import sys

import spec
from whole import Counts

#: Least number of ticks, and of switched-off forces, in a trace.
LEAST = 1000, 10
#: First words of the trace's lines that do not concern the guard; these lines are skipped. Any other unknown word counts as a
#: difference.
OTHERS = {"enhanced", "fba", "law", "made", "mass", "refused", "root_32", "root_64", "root_high_32", "root_high_64", "settings", "tdpa"}


def same_as_rust(lines):
    """Ticks and ends of the guard: how many of each are the specification's, and the first that is not."""
    of, k, m, ticks, ends = Counts(), None, None, 0, 0
    for line in lines:
        word, *numbers = line.split()
        if word == "guard":
            k = spec.Guard(*map(int, numbers))
            m = spec.GuardMemory(account=k.capacity)
        elif word == "tick":
            moved, before_change, wanted, told, account, force, older, fine, kept = map(int, numbers)
            m, found = spec.guard_tick(of, k, m, moved, before_change, wanted)
            if (m.account, m.force, m.older, int(found)) != (account, force, older, fine):
                return ticks, ends, line
            m = spec.commanded(of, m, told)
            if m.force != kept:
                return ticks, ends, line
            ticks += 1
        elif word == "off":
            m = spec.switched_off(of, k, m)
            if (m.account, m.force, m.older) != tuple(map(int, numbers)):
                return ticks, ends, line
            ends += 1
        elif word not in OTHERS:
            return ticks, ends, line
    return ticks, ends, None


def is_read(path):
    """Whether a trace is the specification's, which is said."""
    with open(path) as lines:
        ticks, ends, other = same_as_rust(lines)
    if other is not None:
        print(f"WRONG: proofs/elf/spec.py has another tick than the Rust code after {ticks} that are the same: {other.strip()}")
        return False
    if ticks < LEAST[0] or ends < LEAST[1]:
        print(f"{path} has {ticks} ticks and {ends} ends of the guard; {LEAST[0]} and {LEAST[1]} are wanted")
        return False
    print(f"{ticks} ticks and {ends} ends of the guard's Rust code are those of proofs/elf/spec.py, bit for bit")
    return True


if __name__ == "__main__":
    sys.exit(0 if is_read(sys.argv[1]) else 1)

"""Ticks of a board's program are their specification, for all inputs: `cargo xtask prove --elf`.

    check.py PROGRAM FUNCTIONS TRACE       both readings, then the proofs
    check.py … --mutants                   wrong changes of the program's bytes, each of which must be refuted
    check.py … --readings                  both readings alone, within a minute
    check.py … --only X                    one tick

FUNCTIONS is what `xtask-inspect functions PROGRAM` prints.

The end is 0 if all that was asked is proved, or refuted; 1 else; 2 if nothing is of that name, or not a function of its own in this program.
"""
import sys
import time

import beside
import verdict
import wrong
from machine import Decoder
from program import NoFunction, Program
from ticks import TICKS
from traced import is_read

#: Number of inputs of each tick that run both in Unicorn and in the checker's own machine.
BESIDE = 1000
#: Longest time that a tick's proof may take, in seconds.
DEADLINE_S = 900


def main(words):
    path, functions, trace, *options = words
    only = options[options.index("--only") + 1] if "--only" in options else ""
    program = Program(path, functions)
    kinds = [kind for kind in TICKS if only in kind.name]
    if not kinds:
        # If no tick has this name, nothing is checked, which must not count as a success.
        print(f"no tick has `{only}` in its name; there are {', '.join(kind.name for kind in TICKS)}", file=sys.stderr)
        return 2
    ticks = []
    for kind in kinds:
        try:
            ticks.append(kind(program))
        except NoFunction as why:
            print(f"{kind.name}: `{kind.what}` is no function of its own in this program, so nothing is said of it: {why}", file=sys.stderr)
            return 2
    if "--mutants" in options:
        return 0 if all([refutes(tick, path, functions) for tick in ticks]) else 1
    good = is_read(trace)
    board = beside.Board(program)
    for tick in ticks:
        good &= reads(tick, program, board) and ("--readings" in options or proves(tick, program, board))
    return 0 if good else 1


def reads(tick, program, board):
    decoder, begun = Decoder(program), time.monotonic()
    count, other = beside.same_as_unicorn(tick, decoder, board, BESIDE, verdict.kept)
    if other:
        print(f"{tick.name}: WRONG: {other}")
        return False
    print(f"{tick.name}: {count} inputs give in Unicorn the bits that they give here ({time.monotonic() - begun:.0f} s)", flush=True)
    return True


def proves(tick, program, board):
    decoder = Decoder(program)
    found = verdict.check(tick, decoder, deadline_s=DEADLINE_S)
    at = f"{tick.what} at {tick.at:#x}, {tick.length} bytes"
    work = f"{found.paths} paths, {found.cases} cases, {found.instructions} instructions at most, {found.questions} questions, {found.seconds:.0f} s"
    if found.proved:
        print(f"{tick.name}: PROVED for all inputs: {at}; {work}")
    elif found.counterexample:
        one = beside.Concrete(tick, decoder, board, found.counterexample)
        print(f"{tick.name}: REFUTED: {at}: {found.counterexample}: {one.wrong(verdict.kept)}")
    else:
        print(f"{tick.name}: NO ANSWER: {at}: {found.why}; {work}")
    print(f"{tick.name}: assumed: {tick.assumes}", flush=True)
    return found.proved


def refutes(tick, path, functions):
    """Each change by itself; a proof of one is as bad as no answer."""
    good, asked = True, 0
    for at, text, kind, code in wrong.changes(tick, Decoder(tick.program)):
        begun, asked = time.monotonic(), asked + 1
        program = Program(path, functions)
        program.patched(at, code)
        changed, decoder = type(tick)(program), Decoder(program)
        found = verdict.check(changed, decoder, deadline_s=DEADLINE_S)
        said = "NOT REFUTED: " + (found.why or "proved")
        if found.counterexample:
            one = beside.Concrete(changed, decoder, beside.Board(program), found.counterexample)
            names = [name for name, _, _ in one.wrong(verdict.kept)]
            said = f"refuted, wrong in Unicorn too: {names[0]}" if names and not one.differences() else "NOT REFUTED: the counterexample is none"
        good &= said.startswith("refuted")
        print(f"{tick.name}: {at:#x} {text}: {kind}: {said} ({time.monotonic() - begun:.0f} s)", flush=True)
    print(f"{tick.name}: {asked} wrong changes asked")
    return good and asked > 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

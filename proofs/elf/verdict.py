"""One tick for all inputs: every path of the machine code, on each every case of the specification, in each that all is equal."""
import time

import z3

import samples
import words as w
from flags import Unknown
from machine import SP, Machine, runs
from paths import Oracle, Path, Undecided
from whole import Counts, NotAWord

#: If a counterexample has wrong products, the solver is asked again with the true products of its factors, at most this many
#: times.
REFINED = 60
#: Number of sample inputs; they show without the solver which conditions are sometimes true and sometimes false.
SAMPLES = 400
#: Number of known inputs that are tried on each path before the solver is asked.
TRIED = 24


class Verdict:
    """What was found."""

    def __init__(self):
        self.paths = self.cases = self.refined = self.questions = 0
        self.instructions = 0
        self.seconds = 0.0
        self.counterexample = None
        self.why = ""

    @property
    def proved(self):
        return not self.why and self.counterexample is None


def check(tick, decoder, timeout_ms=60_000, deadline_s=600):
    """All paths, to the first counterexample."""
    found, begun = Verdict(), time.monotonic()
    path = Path(timeout_ms)
    for values in samples.drawn(tick, SAMPLES, seed=1):
        path.pool.add({name: (value, 32) for name, value in values.items()})
    inputs = {}

    def any_word(name, width):
        inputs[name] = z3.BitVec(name, width)
        return inputs[name]

    try:
        machine = Machine(decoder, path)
        tick.begin(machine, any_word)
        machine.regs[15] = tick.at
        for assumption in tick.assumed(Counts(path)):
            path.know(w.truth(assumption))
        path.products.assumed = len(path.products.rows)
        tick.known(Counts(path))
        if not path.check(True):
            found.why = "what is assumed contradicts itself"
        saved = list(machine.regs)
        for end in runs(machine):
            found.paths += 1
            found.instructions = max(found.instructions, end.count)
            found.counterexample = tried(tick, path, inputs, end, saved)
            if found.counterexample:
                return found
            oracle = Oracle(path)
            of = Counts(path, oracle.decide)
            for claims in oracle.cases(lambda: [*tick.claims(of, end), *kept(end, saved)]):
                found.cases += 1
                found.counterexample = refuted(tick, decoder, path, inputs, claims, found)
                if found.counterexample or found.why:
                    return found
                if time.monotonic() - begun > deadline_s:
                    found.why = f"no answer for all paths in {deadline_s} s"
                    return found
    except (Undecided, NotAWord, Unknown) as error:
        found.why = f"{type(error).__name__}: {error}"
    finally:
        found.questions = path.asked
        found.seconds = time.monotonic() - begun
    return found


def kept(machine, saved):
    """What every function leaves as it was: registers 4 to 11, the stack pointer."""
    for i in (*range(4, 12), SP):
        yield f"register {i}", machine.regs[i], saved[i]


def tried(tick, path, inputs, end, saved):
    """Inputs of this path on which what the code leaves is not what the specification says: a few that are known, before all that are not."""
    def number(x):
        return x if isinstance(x, int) else model.eval(x, model_completion=True).as_long()
    for model in path.pool.models[:TRIED]:
        values = {name: number(x) for name, x in inputs.items()}
        other = type(tick)(tick.program)
        other.begin(samples.Bare(), samples.Given(values=values))
        if not samples.satisfies(other, Counts()):
            continue
        seen = Seen([number(x) for x in end.regs], {at: number(x) for at, x in end.memory.items()})
        claims = [*other.claims(Counts(), seen), *kept(seen, [number(x) for x in saved])]
        if any(code != value for _, code, value in claims):
            return values
    return None


def is_wrong(tick, decoder, values):
    """Whether the code, run on inputs that are known, leaves something else than the specification says."""
    other = type(tick)(tick.program)
    machine = Machine(decoder, Path())
    machine.regs[:13] = [0] * 13
    other.begin(machine, samples.Given(values=values))
    machine.regs[15] = tick.at
    if not samples.satisfies(other, Counts()):
        return False
    saved = list(machine.regs)
    end = next(runs(machine))
    return any(code != value for _, code, value in [*other.claims(Counts(), end), *kept(end, saved)])


class Seen:
    """Registers and memory after a function."""

    def __init__(self, regs, memory):
        self.regs, self.memory = regs, memory


def refuted(tick, decoder, path, inputs, claims, found):
    """Inputs for which a claim is wrong; their products are products. `None`: there are none."""
    wrong = [w.not_(w.eq(code, value, width(code, value))) for _, code, value in claims]
    wrong = w.any_(*wrong)
    if wrong is False:
        return None
    count = len(path.known)
    path.all.push()
    try:
        for _ in range(REFINED):
            if not path.check(wrong):
                return None
            value = lambda x: path.model.eval(w.term(x), model_completion=True).as_long()
            lies = [(a, b, product) for a, b, product in path.products.rows if value(product) != value(a) * value(b)]
            if not lies:
                return {name: value(x) for name, x in inputs.items()}
            # The inputs may be a counterexample even with the true products.
            values = {name: value(x) for name, x in inputs.items()}
            if is_wrong(tick, decoder, values):
                return values
            found.refined += 1
            for a, b, product in lies:
                # Tells the solver the true products with each of the two factors.
                for x, y in ((a, b), (b, a)):
                    path.know(z3.Implies(y == value(y), product == z3.ZeroExt(32, x) * value(y)))
        found.why = f"{REFINED} counterexamples, of each of which a product is none"
        return None
    finally:
        path.all.pop()
        del path.known[count:]


def width(*values):
    return next((value.size() for value in values if not isinstance(value, int)), 64)

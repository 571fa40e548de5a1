"""What is assumed on a path, and what follows from it, asked of z3."""
import time
from contextlib import contextmanager

import bitwuzla
import z3

import words as w
from bounds import Bounds
from products import Products


class Undecided(Exception):
    """The solver gave no answer in the time that it has."""


class Pool:
    """Inputs that satisfy what is assumed, with their true products: a condition that differs among them follows from nothing, and one
    that holds of one is possible, without a question."""

    #: Largest number of inputs on which a condition is evaluated.
    LOOKED_AT = 48

    def __init__(self):
        self.models = []
        self.late = []

    def found(self, model):
        """One that a solver has found, of which every product is one."""
        self.models.insert(0, model)
        self.late.append(model)

    def add(self, values):
        model = z3.Model()
        for name, (value, width) in values.items():
            model.update_value(z3.BitVec(name, width), z3.BitVecVal(value, width))
        self.models.append(model)

    @staticmethod
    def number(model, x):
        return model.eval(x, model_completion=True).as_long()

    def multiplied(self, a, b, product):
        for model in self.models:
            value = self.number(model, a) * self.number(model, b)
            model.update_value(product, z3.BitVecVal(value, product.size()))

    def signed(self, short, product, negative):
        for model in self.models:
            value = self.number(model, product)
            if z3.is_true(model.eval(negative, model_completion=True)):
                value = -value
            model.update_value(short, z3.BitVecVal(value, short.size()))

    def longest(self, x):
        """Bits of the largest that a word is among them."""
        return max((self.number(model, x) for model in self.models), default=0).bit_length()

    def answers(self, condition):
        """Which of `True` and `False` it is among them."""
        found = set()
        for model in self.models[:self.LOOKED_AT]:
            found.add(z3.is_true(model.eval(condition, model_completion=True)))
            if len(found) == 2:
                break
        return found

    def where(self, condition):
        return [model for model in self.models if z3.is_true(model.eval(condition, model_completion=True))]


def in_bitwuzla(formulas, limit_ms):
    """The other solver's answer, and its model as z3's: on sums of the same in another order it is the quicker by far."""
    solver = z3.Solver()
    solver.add(*formulas)
    options = bitwuzla.Options()
    options.set(bitwuzla.Option.PRODUCE_MODELS, True)
    options.set(bitwuzla.Option.TIME_LIMIT_PER, limit_ms)
    parser = bitwuzla.Parser(bitwuzla.TermManager(), options)
    parser.parse(f"(set-logic QF_BV)\n{solver.to_smt2()}".replace("(check-sat)", ""), True, False)
    found = parser.bitwuzla().check_sat()
    if found == bitwuzla.Result.UNSAT:
        return z3.unsat, None
    if found != bitwuzla.Result.SAT:
        return z3.unknown, None
    model = z3.Model()
    for unknown in parser.get_declared_funs():
        name, sort = unknown.symbol().strip("|"), unknown.sort()
        value = int(parser.bitwuzla().get_value(unknown).value(10))
        width = sort.bv_size()
        model.update_value(z3.BitVec(name, width), z3.BitVecVal(value, width))
    return z3.sat, model


class Path:
    """Assumptions, one within the other; facts of products; questions.

    z3 is asked first, which keeps what it has learnt from one question to the next, and Bitwuzla where it has no quick answer.
    """

    QUICK_MS = 400
    #: Time limit in ms for a question that would only narrow a number's bounds. Later questions lack an answer that did not come
    #: in time. So the limit is several times what a single run needs: with 1 to 3 s such a run gets its answers, but two runs at
    #: the same time on a slow machine got none.
    SOON_MS = 10_000

    def __init__(self, timeout_ms=60_000):
        self.timeout_ms = timeout_ms
        self.all = z3.SolverFor("QF_BV")
        self.pool = Pool()
        self.products = Products(self)
        self.bounds = Bounds(self)
        self.names = 0
        self.lockstep = False
        self.asked = 0
        self.asked_s = 0.0
        self.answers = {}
        self.known = []

    def fresh(self, name, width):
        self.names += 1
        return z3.BitVec(f"{name}!{self.names}", width)

    def know(self, *facts):
        self.all.add(*facts)
        self.known.extend(facts)

    def check(self, question, most_ms=None):
        """Whether there is anything for which it holds; then `model` is one."""
        begun = time.monotonic()
        question = w.truth(question)
        self.asked += 1
        try:
            self.all.set("timeout", self.QUICK_MS)
            found = self.all.check(question)
            if found == z3.sat:
                self.model = self.all.model()
            elif found == z3.unknown:
                found, self.model = in_bitwuzla([*self.known, question], most_ms or self.timeout_ms)
        finally:
            self.asked_s += time.monotonic() - begun
        if found == z3.unknown:
            raise Undecided(f"a question without an answer in {most_ms or self.timeout_ms} ms")
        if found == z3.sat:
            number = lambda x: Pool.number(self.model, x)
            if all(number(a) * number(b) == number(product) for a, b, product in self.products.rows):
                self.pool.found(self.model)
        return found == z3.sat

    def possible(self, condition):
        if isinstance(condition, bool):
            return condition
        return True in self.pool.answers(condition) or self.check(condition)

    def holds(self, condition, soon_ms=None):
        """Follows from what is assumed; with a time, whether that is seen so soon."""
        if isinstance(condition, bool):
            return condition
        key = condition.get_id()
        if key not in self.answers:
            if False in self.pool.answers(condition):
                return False
            try:
                found = not self.check(w.not_(condition), soon_ms)
            except Undecided:
                if soon_ms is None:
                    raise
                return False
            self.answers[key] = found, condition
            if found:
                # The solver gets the condition as a fact, so that later questions need not derive it again.
                self.know(condition)
        return self.answers[key][0]

    def settled(self, condition):
        """`True` or `False` where that follows, else the condition."""
        if not isinstance(condition, bool) and len(self.pool.answers(condition)) == 2:
            return condition
        if self.holds(condition):
            return True
        return False if self.holds(w.not_(condition)) else condition

    def values(self, x, most=64):
        """All that a word can be here."""
        found = []
        while self.check(w.all_(*(w.not_(w.eq(x, value)) for value in found))):
            found.append(self.model.eval(w.term(x), model_completion=True).as_long())
            if len(found) > most:
                raise Undecided("too many places to go on at")
        return found

    @contextmanager
    def assuming(self, condition):
        """Whether it is possible; assumed, with all that is asked and found meanwhile, to the end of the block."""
        if condition is True:
            yield True
            return
        if not self.possible(condition):
            yield False
            return
        rows, answers, count = list(self.products.rows), dict(self.answers), len(self.known)
        signs = list(self.products.signs)
        bounds, self.bounds.found = self.bounds.found, {}
        models, late = self.pool.models, self.pool.late
        self.pool.late = []
        self.pool.models = self.pool.where(w.truth(condition))
        self.all.push()
        self.know(w.truth(condition))
        # With one more assumption, every condition that followed still follows. A condition that did not follow may follow now,
        # so its answer is dropped.
        self.answers = {key: answer for key, answer in self.answers.items() if answer[0]}
        try:
            yield True
        finally:
            self.products.signs, self.bounds.found = signs, bounds
            self.products.rows, self.answers = rows, answers
            self.pool.models, self.pool.late = self.pool.late + models, late + self.pool.late
            self.all.pop()
            del self.known[count:]


class Empty(Exception):
    """A case that there is not: another choice of it says the opposite of what follows."""


class Oracle:
    """Cases of a specification: each `if` of it that is not settled is gone both ways, by running it again.

    A way is kept with the number of its `if`. What is settled rests on what was found in time, so a later run may have an `if` settled
    that an earlier had open: then the way that does not follow has no case. One that is open and was settled is no answer.
    """

    def __init__(self, path):
        self.path = path

    def cases(self, f):
        """`f()` in each case, within the case's assumptions. `f` asks `decide`."""
        todo = [[]]
        while todo:
            self.ways, self.at, self.count, self.more = todo.pop(), 0, 0, []
            self.depth = []
            try:
                found = f()
                if self.at < len(self.ways):
                    raise Undecided("a choice of the specification that did not come again")
                yield found
            except Empty:
                pass
            finally:
                for block in reversed(self.depth):
                    block.__exit__(None, None, None)
            todo.extend(self.more)

    def decide(self, condition):
        number, self.count = self.count, self.count + 1
        told = self.at < len(self.ways) and self.ways[self.at][0] == number
        if not isinstance(condition, bool):
            condition = self.path.settled(condition)
        if isinstance(condition, bool):
            if told and self.ways[self.at][1] != condition:
                raise Empty
            self.at += told
            return condition
        if self.at == len(self.ways):
            self.more.append([*self.ways, (number, False)])
            self.ways = [*self.ways, (number, True)]
        elif not told:
            raise Undecided("a choice of the specification that was settled before")
        way = self.ways[self.at][1]
        self.at += 1
        block = self.path.assuming(condition if way else w.not_(condition))
        block.__enter__()
        self.depth.append(block)
        return way

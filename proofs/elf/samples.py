"""Inputs of a tick that satisfy what is assumed: numbers of every length, edges, and small differences, most of which are thrown away."""
import random

import words as w
from whole import Counts

#: Ends of the number formats and of the allowed ranges, and the neighbours of these ends.
EDGES = [0, 1, 2, 3, 0xffffffff, 0xfffffffe, 1 << 24, (1 << 24) - 1, 1 << 29, (1 << 29) - 1, (1 << 29) + 1, (1 << 31) - 1, 1 << 31,
         (1 << 31) + 1, 1 << 12, 0xff000000, 0xe0000001]


def any_word(chance):
    """A word of any length."""
    kind = chance.random()
    if kind < 0.25:
        return chance.choice(EDGES)
    value = chance.getrandbits(32) >> chance.randrange(32)
    return -value & w.MASK if kind > 0.75 else value


class Given:
    """Words by their names, drawn where they are not given."""

    def __init__(self, chance=None, values=None):
        self.chance, self.values = chance, dict(values or {})

    def __call__(self, name, width):
        if name not in self.values:
            self.values[name] = any_word(self.chance)
        return self.values[name]


def satisfies(tick, of):
    return all(bool(condition) for condition in tick.assumed(of))


def drawn(tick, count, seed, most_tries=400_000):
    """So many inputs, or what there is of them."""
    chance, found = random.Random(seed), []
    for _ in range(most_tries):
        given = Given(chance)
        machine = Bare()
        tick.begin(machine, given)
        tick.drawn(chance, given)
        tick.begin(machine, given)
        if satisfies(tick, Counts()):
            found.append(given.values)
            if len(found) == count:
                break
    return found


class Bare:
    """As much of a machine as a tick is begun on."""

    def __init__(self):
        self.regs, self.memory = [0] * 16, {}

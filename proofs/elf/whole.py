"""Whole numbers of a specification: Python's where they are known, else bit-vectors so wide, by their bounds, that nothing wraps.

Each has the bounds between which it lies. The few functions that a specification needs take both kinds.
"""
import z3

import words as w

DOUBLE, WIDEST = 64, 96


class Whole:
    """A number that is not known, within `low..=high`, as a signed bit-vector that holds these."""

    def __init__(self, term, low, high):
        self.term, self.low, self.high = at_width(term, wide(low, high)), low, high

    def __add__(self, other):
        return made(lambda a, b: a + b, self, other, self.low + low(other), self.high + high(other))

    def __sub__(self, other):
        return made(lambda a, b: a - b, self, other, self.low - high(other), self.high - low(other))

    def __rsub__(self, other):
        return made(lambda a, b: b - a, self, other, low(other) - self.high, high(other) - self.low)

    __radd__ = __add__

    def __neg__(self):
        return 0 - self

    def __rshift__(self, n):
        return shrunk(self.term >> min(n, self.term.size() - 1), self.low >> n, self.high >> n)

    def __lt__(self, other):
        return order(self, other)

    def __gt__(self, other):
        return order(other, self)

    def __le__(self, other):
        return w.not_(order(other, self))

    def __ge__(self, other):
        return w.not_(order(self, other))


def low(x):
    return x if isinstance(x, int) else x.low


def high(x):
    return x if isinstance(x, int) else x.high


def needed(low, high):
    """Bits of a signed word that holds both."""
    return max(n.bit_length() if n >= 0 else (~n).bit_length() for n in (low, high)) + 1


def wide(low, high):
    """Bits of a term for such a number: the machine's double word where that holds it, so that sums of the same are written alike."""
    bits = needed(low, high)
    assert bits <= WIDEST, "wider than the checker's numbers"
    return DOUBLE if bits <= DOUBLE else WIDEST


def at_width(term, width):
    """A signed term with more bits, or with fewer that hold it."""
    if term.size() < width:
        return w._normal_term(z3.SignExt(width - term.size(), term))
    return w._normal_term(z3.Extract(width - 1, 0, term)) if term.size() > width else term


def bits_of(x, width):
    return z3.BitVecVal(x, width) if isinstance(x, int) else at_width(x.term, width)


def shrunk(term, low, high):
    term = w._normal_term(term)
    if low == high:
        return low
    return w.to_signed(term.as_long(), term.size()) if z3.is_bv_value(term) else Whole(term, low, high)


def made(f, a, b, low_, high_):
    width = max(wide(low_, high_), wide(low(a), high(a)), wide(low(b), high(b)))
    return shrunk(f(bits_of(a, width), bits_of(b, width)), low_, high_)


def together(f, a, b):
    width = max(wide(low(x), high(x)) for x in (a, b))
    return w._normal(f(bits_of(a, width), bits_of(b, width)))


def order(a, b):
    if high(a) < low(b):
        return True
    if low(a) >= high(b):
        return False
    if isinstance(b, int) and b == 0:
        return w.bit(a.term, a.term.size() - 1)
    return together(lambda a, b: a < b, a, b)


def equal(a, b):
    return a == b if isinstance(a, int) and isinstance(b, int) else together(lambda a, b: a == b, a, b)


def signed(x, width=32):
    """A machine's word as a number."""
    return w.to_signed(x, width) if isinstance(x, int) else shrunk(x, -(1 << width - 1), (1 << width - 1) - 1)


def unsigned(x, width=32):
    """A machine's word as a number that has no sign."""
    return x if isinstance(x, int) else shrunk(z3.ZeroExt(DOUBLE - width, x), 0, (1 << width) - 1)


def word(x, width=32):
    """A number's lowest bits."""
    if isinstance(x, int):
        return x & ((1 << width) - 1)
    return w._normal(at_width(x.term, width))


class Counts:
    """What a specification counts with: choices by `decide`, products by a path's or Python's own."""

    def __init__(self, path=None, decide=bool):
        self.path, self.decide = path, decide

    def settled(self, c):
        return c if isinstance(c, bool) else self.path.settled(c)

    def either(self, c, a, b):
        c = self.settled(c)
        if isinstance(c, bool):
            return a if c else b
        return made(lambda a, b: z3.If(c, a, b), a, b, min(low(a), low(b)), max(high(a), high(b)))

    def least(self, a, b):
        return self.tight(self.either(order(a, b), a, b), min(low(a), low(b)), min(high(a), high(b)))

    def most(self, a, b):
        return self.tight(self.either(order(a, b), b, a), max(low(a), low(b)), max(high(a), high(b)))

    def within(self, x, lowest, highest):
        return self.most(self.least(x, highest), lowest)

    def narrowed(self, x, bits):
        """A number that is seen to be a signed word of so many bits, as one."""
        if isinstance(x, int) or needed(x.low, x.high) <= bits:
            return x
        if not self.path.holds(self.fits(x, bits)):
            raise NotAWord(f"a number that is not known to have {bits} bits")
        return Whole(x.term, max(-(1 << bits - 1), x.low), min((1 << bits - 1) - 1, x.high))

    def seen(self, x):
        """A number with as few bits as the assumptions give it."""
        if isinstance(x, int):
            return x
        for bits in (8, 26, 30, 31, 54, 63):
            within = self.fits(x, bits)
            if bits < needed(x.low, x.high) and self.path.holds(within, self.path.SOON_MS):
                x = Whole(x.term, max(-(1 << bits - 1), x.low), min((1 << bits - 1) - 1, x.high))
                return self.tight(x, 0, x.high) if x.low < 0 and self.path.holds(x >= 0, self.path.SOON_MS) else x
        return x

    def size(self, x):
        found = self.either(order(x, 0), -x, x)
        return self.tight(found, 0, max(abs(low(x)), abs(high(x))))

    def fits(self, x, bits=32):
        """Whether it is a signed word."""
        return w.all_(order(-(1 << bits - 1) - 1, x), order(x, 1 << bits - 1))

    def times(self, a, b):
        """The product of two words; that they are words is a claim, as under the other checker."""
        if isinstance(a, int) and isinstance(b, int):
            return a * b
        a, b = self.narrowed(a, 32), self.narrowed(b, 32)
        self.path.lockstep = True
        product = self.path.products.signed(word(a), word(b))
        self.path.lockstep = False
        # The bounds of the factors give the bounds of the product.
        ends = [x * y for x in (low(a), high(a)) for y in (low(b), high(b))]
        most = 1 << self.path.products.length
        return product if isinstance(product, int) else shrunk(product, max(min(ends), -most), min(max(ends), most))

    def tight(self, x, low_, high_):
        """A number of which narrower bounds are known."""
        return x if isinstance(x, int) else Whole(x.term, max(low_, x.low), min(high_, x.high))


class NotAWord(Exception):
    """What would be a wrong product."""

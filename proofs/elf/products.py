"""Products of which facts are known: one answer for one question, as `proofs/src/multiplied.rs` under the other checker.

Whether machine code does as its specification does not depend on what a product is: both multiply the same numbers and then add, shift
and compare. So the product of two magnitudes is any number that has these facts, all of them true of the product; the first two are
in `obligations/check.py`, over the integers, the others are shifts:

    a <= c, b <= d  implies  a b <= c d
    a < 2^n  implies  a b <= (b << n) - b
    0 b = 0, 1 b = b, 2^16 b = b << 16, 2^24 b = b << 24, 2^29 b = b << 29, (2^31 - 1) b = (b << 31) - b, 2^31 b = b << 31

and everything else that multiplies is made of that: the signed product has the signs' sign, the unsigned one differs from it by the
words' upper halves. Where both factors are known the product is what it is.
"""
import z3

import words as w

FACTORS = (1, 1 << 16, 1 << 24, 1 << 29, (1 << 31) - 1, 1 << 31)


def of_factor(factor, b):
    """`factor b`, without a multiplication."""
    b = z3.ZeroExt(32, w.term(b))
    if factor == (1 << 31) - 1:
        return (b << 31) - b
    return b << factor.bit_length() - 1


def length(product):
    """Bits below its leading zeros, which are written as such."""
    if z3.is_app_of(product, z3.Z3_OP_CONCAT) and z3.is_bv_value(product.arg(0)) and product.arg(0).as_long() == 0:
        return 64 - product.arg(0).size()
    return 64


class Products:
    """Those asked for so far on a path."""

    def __init__(self, path):
        self.path = path
        self.rows = []
        #: Number of first rows that come from the tick's assumptions; `None` while these are being made. Each later product gets
        #: facts that compare it with these rows.
        self.assumed = None
        #: Signed products: the product of the magnitudes, whether it was negated, and the signed number.
        self.signs = []

    def magnitude(self, a, b, expected=None):
        """Of two words, neither above 2^31. `expected`: whose rows may answer, if they are the same question."""
        if w.known(a, b):
            return a * b
        for factor, other in ((a, b), (b, a)):
            if isinstance(factor, int) and factor & (factor - 1) == 0:
                return w._normal(of_factor(factor, other)) if factor else 0
        found = self.answered(a, b)
        if found is not None:
            return found
        return self.asked(a, b)

    def answered(self, a, b):
        """By a row that is written alike, or is the same on this path."""
        for c, d, product in self.rows:
            if w.same(a, c) and w.same(b, d) or w.same(a, d) and w.same(b, c):
                return product
        if self.path.lockstep:
            for c, d, product in self.rows:
                for e, f in ((c, d), (d, c)):
                    if self.path.holds(w.eq(a, e)) and self.path.holds(w.eq(b, f)):
                        return product
        return None

    def bits(self, a):
        """How many a magnitude has at most: the most that is known of one, where that is seen to hold of all."""
        if isinstance(a, int):
            return a.bit_length()
        least = self.path.pool.longest(a)
        low, high = self.path.bounds.of(w.zero_extended(a, 32))
        at_most = min(high.bit_length(), 32) if low >= 0 else 32
        for bits in (least, least + 1, 31):
            if least <= bits < at_most and self.path.holds(w.below(a, 1 << bits), self.path.SOON_MS):
                return bits
        return at_most

    def asked(self, a, b):
        """A new row, with what is known of it."""
        bits = [self.bits(a), self.bits(b)]
        if 0 in bits:
            return 0
        short = self.path.fresh("product", min(sum(bits), 63))
        product = z3.simplify(z3.ZeroExt(64 - short.size(), short))
        a, b = w.term(a), w.term(b)
        facts = []
        for x, y, length in ((a, b, bits[0]), (b, a, bits[1])):
            facts.append(z3.Implies(x == 0, product == 0))
            # If a factor is below 2^n, the product is at most 2^n - 1 times the other factor.
            longest = z3.ZeroExt(32, y)
            facts.append(z3.ULE(product, (longest << length) - longest))
            for factor in FACTORS:
                if factor.bit_length() <= length:
                    most = of_factor(factor, y)
                    facts.append(z3.Implies(z3.ULE(x, factor), z3.ULE(product, most)))
                    facts.append(z3.Implies(z3.UGE(x, factor), z3.UGE(product, most)))
        soon = lambda condition: self.path.holds(w._normal(condition), self.path.SOON_MS)
        for c, d, other in self.rows[:self.assumed]:
            for e, f in ((c, d), (d, c)):
                if soon(z3.ULE(a, e)) and soon(z3.ULE(b, f)):
                    facts.append(z3.ULE(product, other))
                    continue
                facts.append(z3.Implies(z3.And(z3.ULE(a, e), z3.ULE(b, f)), z3.ULE(product, other)))
                facts.append(z3.Implies(z3.And(z3.ULE(e, a), z3.ULE(f, b)), z3.ULE(other, product)))
        self.path.know(*facts)
        self.rows.append((a, b, product))
        self.path.pool.multiplied(a, b, short)
        return product

    def size(self, a):
        """Sign and magnitude of a signed word."""
        negative = w.less(a, 0)
        if not isinstance(negative, bool):
            negative = self.path.settled(negative)
        return negative, w.choose(negative, w.neg(a), a)

    def signed(self, a, b):
        """64 bits."""
        (below, a), (under, b) = self.size(a), self.size(b)
        product, negative = self.magnitude(a, b), w.differ(below, under)
        self.length = 63 if isinstance(product, int) else length(product)
        if isinstance(product, int):
            return w.choose(negative, w.neg(product, 64), product, 64)
        return self.with_sign(product, negative)

    def with_sign(self, product, negative):
        """A number of its own for a product that may be negative, so that sums of these are sums of the same: 64 bits."""
        zero, negative = product == 0, w.truth(negative)
        for other, before, signed in self.signs:
            if other.eq(product):
                if self.path.holds(w._normal(z3.Or(zero, before == negative))):
                    return signed
                if self.path.holds(w._normal(z3.Or(zero, before != negative))):
                    return w.neg(signed, 64)
        for sign, signed in ((z3.Not(negative), product), (negative, w.neg(product, 64))):
            if self.path.holds(w._normal(z3.Or(zero, sign))):
                self.signs.append((product, z3.BoolVal(False), product))
                return signed
        bits = length(product) + 1
        short = self.path.fresh("signed", min(bits, 64))
        signed = z3.SignExt(64 - short.size(), short) if short.size() < 64 else short
        signed = z3.simplify(signed)
        size = z3.Extract(short.size() - 1, 0, product) if short.size() < 64 else product
        self.path.know(short == z3.If(negative, -size, size))
        self.path.pool.signed(short, product, negative)
        self.signs.append((product, negative, signed))
        return signed

    def unsigned(self, a, b):
        """64 bits: a word with its highest bit set is its signed reading and 2^32."""
        product = self.signed(a, b)
        for x, y in ((a, b), (b, a)):
            negative = w.less(x, 0)
            if not isinstance(negative, bool):
                negative = self.path.settled(negative)
            more = w.choose(negative, w.join(y, 0), 0, 64)
            product = w.add(product, more, 64)
        return product

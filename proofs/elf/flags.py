"""Sums, differences, shifts and saturation of words, with the flags that they set, from the pseudocode of the ARMv7-M reference manual."""
import z3
from capstone import arm as c

import words as w


class Unknown(Exception):
    """What these semantics do not have."""


class Flags:
    """N, Z, C, V of the last instruction that set them, asked for one by one.

    `pair`: the numbers whose difference or sum the flags are of, of which an SBC or ADC makes one with twice the bits; an order of these is
    then asked for as an order, not as `N != V`.
    """

    def __init__(self, n=None, z=None, c=None, v=None, pair=None):
        self.n, self.z, self.c, self.v, self.pair = n, z, c, v, pair

    @staticmethod
    def of_result(r, carry, overflow):
        return Flags(w.bit(r, 31), w.eq(r, 0), carry, overflow)

    def get(self, name):
        value = getattr(self, name)
        if value is None:
            raise Unknown(f"flag {name} is not known here")
        return value() if callable(value) else value

    def holds(self, condition):
        """A condition of the manual's table."""
        base, opposite = condition & 0xe, condition & 1
        subtracted = self.pair and self.pair[0] == "-" and self.pair[1:]
        if base == 0:
            found = self.get("z")
        elif base == 2:
            found = self.get("c")
        elif base == 4:
            found = self.get("n")
        elif base == 6:
            found = self.get("v")
        elif base == 8:
            found = w.all_(self.get("c"), w.not_(self.get("z")))
        elif base in (10, 12):
            if subtracted:
                found = w.not_(w.less(*subtracted))
            else:
                found = w.not_(w.differ(self.get("n"), self.get("v")))
            if base == 12:
                found = w.all_(w.not_(self.get("z")), found)
        else:
            return True
        return w.not_(found) if opposite else found

    @staticmethod
    def merged(c, new, old):
        """Those of an instruction that ran under a condition."""
        def either(name):
            a, b = getattr(new, name), getattr(old, name)
            if a is b or b is None or a is None:
                return a if a is b else None
            return lambda: w.choose(c, new.get(name), old.get(name), 1)
        return Flags(*(either(name) for name in "nzcv"))


def added(a, b, carry=0, before=None):
    """Sum of two words and a carry, and its flags; `before`: the flags that the carry is from."""
    if before is not None and before.pair and before.pair[0] == "+":
        _, low_a, low_b, width = before.pair
        x, y = w.join(a, low_a, width), w.join(b, low_b, width)
        total = w.add(x, y, width + 32)
        r = w.part(total, width + 31, width)
        return r, sum_flags(r, total, x, y, width + 32, a, b)
    if before is not None:
        carry = w.choose(before.get("c"), 1, 0)
    if carry == 0 and isinstance(carry, int):
        r = w.add(a, b)
        return r, sum_flags(r, r, a, b, 32, a, b)
    wide = w.add(w.add(w.zero_extended(a, 1), w.zero_extended(b, 1), 33), w.zero_extended(carry, 1), 33)
    r = w.part(wide, 31, 0)
    return r, Flags.of_result(r, lambda: w.bit(wide, 32), lambda: overflow(a, b, r))


def sum_flags(r, total, x, y, width, a, b):
    flags = Flags.of_result(r, lambda: w.below(total, x, width), lambda: overflow(a, b, r))
    flags.pair = ("+", x, y, width)
    return flags


def overflow(a, b, r):
    """Of a sum."""
    return w.all_(w.not_(w.differ(w.bit(a, 31), w.bit(b, 31))), w.differ(w.bit(r, 31), w.bit(a, 31)))


def subtracted(a, b, before=None):
    """Difference of two words, less a borrow, and its flags."""
    if before is None:
        x, y, width, r = a, b, 32, w.sub(a, b)
    elif before.pair and before.pair[0] == "-":
        _, low_a, low_b, low = before.pair
        x, y, width = w.join(a, low_a, low), w.join(b, low_b, low), low + 32
        r = w.part(w.sub(x, y, width), width - 1, low)
    else:
        return added(a, w.inv(b), w.choose(before.get("c"), 1, 0))
    flags = Flags.of_result(r, lambda: w.not_(w.below(x, y, width)), lambda: overflow(a, w.inv(b), r))
    flags.pair = ("-", x, y, width)
    return r, flags


SHIFTS = {c.ARM_SFT_LSL: "lsl", c.ARM_SFT_LSR: "lsr", c.ARM_SFT_ASR: "asr", c.ARM_SFT_ROR: "ror"}


def shifted(kind, a, n, carry):
    """A word shifted by a number that is known, and the carry."""
    if n == 0:
        return a, carry
    if kind == "lsl":
        return w.lsl(a, n), lambda: w.bit(a, 32 - n) if n <= 32 else False
    if kind == "lsr":
        return w.lsr(a, n), lambda: w.bit(a, n - 1) if n <= 32 else False
    if kind == "asr":
        return w.asr(a, n), lambda: w.bit(a, min(n, 32) - 1)
    return w.ror(a, n), lambda: w.bit(a, (n - 1) % 32)


def shifted_by(kind, a, n):
    """The same by the lowest byte of a register."""
    n = w.part(n, 7, 0)
    if isinstance(n, int):
        return shifted(kind, a, n, None)[0]
    if kind == "ror":
        raise Unknown("a rotation by a register")
    amount, a = z3.ZeroExt(24, n), w.term(a)
    # For shifts by the word's width or more, the solver's results are those of the machine.
    return w._normal({"lsl": a << amount, "lsr": z3.LShR(a, amount), "asr": a >> amount}[kind])


def saturated(path, x, width, bits=32, signed=True):
    """A number of `width` bits within `bits`."""
    lowest, highest = (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)
    mask = (1 << width) - 1
    for end, beyond in ((lowest & mask, w.less(x, lowest & mask, width)), (highest, w.less(highest, x, width))):
        x = w.choose(beyond if isinstance(beyond, bool) else path.settled(beyond), end, x, width)
    return w.part(x, 31, 0)

"""Words of a machine: Python's integers where they are known, z3's bit-vectors where not.

Every function takes either and gives an integer where it can, so that the same semantics run on values and on unknowns. Conditions are
`bool` or z3's. Bit-vectors are kept in z3's normal form, so that what is written alike is found to be the same without a question.
"""
import z3

WORD = 32
MASK = (1 << WORD) - 1


def known(*values):
    return all(isinstance(value, (int, bool)) for value in values)


def term(x, width=WORD):
    return z3.BitVecVal(x, width) if isinstance(x, int) else x


def truth(c):
    return z3.BoolVal(c) if isinstance(c, bool) else c


# For each upper part that `part` has extracted: the whole from which it comes, so that `join` can put the two parts together
# again.
_HALVES = {}


def _normal_term(x):
    """The normal form of what is a term; the parts of a sum in one order."""
    x = z3.simplify(x)
    if z3.is_app_of(x, z3.Z3_OP_BADD):
        parts = sorted(x.children(), key=lambda part: part.get_id())
        terms = (z3.Ast * len(parts))(*(part.as_ast() for part in parts))
        return z3.BitVecRef(z3.Z3_mk_app(x.ctx.ref(), x.decl().ast, len(parts), terms), x.ctx)
    return x


def _normal(x):
    x = _normal_term(x)
    if z3.is_bv_value(x):
        return x.as_long()
    if z3.is_true(x):
        return True
    if z3.is_false(x):
        return False
    return x


def both(f, whole, *values, width=WORD):
    """`whole` of integers, `f` of bit-vectors."""
    if known(*values):
        return whole(*values) & ((1 << width) - 1)
    return _normal(f(*(term(value, width) for value in values)))


def add(a, b, width=WORD):
    return both(lambda a, b: a + b, lambda a, b: a + b, a, b, width=width)


def sub(a, b, width=WORD):
    return both(lambda a, b: a - b, lambda a, b: a - b, a, b, width=width)


def neg(a, width=WORD):
    return sub(0, a, width)


def and_(a, b, width=WORD):
    return both(lambda a, b: a & b, lambda a, b: a & b, a, b, width=width)


def or_(a, b, width=WORD):
    return both(lambda a, b: a | b, lambda a, b: a | b, a, b, width=width)


def xor(a, b, width=WORD):
    return both(lambda a, b: a ^ b, lambda a, b: a ^ b, a, b, width=width)


def inv(a, width=WORD):
    return xor(a, (1 << width) - 1, width)


def lsl(a, n, width=WORD):
    return 0 if n >= width else both(lambda a: a << n, lambda a: a << n, a, width=width)


def lsr(a, n, width=WORD):
    return 0 if n >= width else both(lambda a: z3.LShR(a, n), lambda a: a >> n, a, width=width)


def asr(a, n, width=WORD):
    n = min(n, width - 1)
    return both(lambda a: a >> n, lambda a: to_signed(a, width) >> n, a, width=width)


def ror(a, n):
    n %= WORD
    return a if n == 0 else or_(lsr(a, n), lsl(a, WORD - n))


def to_signed(a, width=WORD):
    return a - (1 << width) if a >> (width - 1) else a


def part(x, high, low):
    """Bits `high` to `low`."""
    if isinstance(x, int):
        return (x >> low) & ((1 << (high - low + 1)) - 1)
    found = _normal(z3.Extract(high, low, x))
    if not isinstance(found, int) and low > 0 and high == x.size() - 1:
        _HALVES[found.get_id()] = (found, low, x)
    return found


def join(high, low, low_width=WORD, high_width=WORD):
    """Two words as one."""
    if known(high, low):
        return high << low_width | low
    # Two halves that are choices by the same condition are joined to one choice of the whole.
    if all(not isinstance(x, int) and z3.is_app_of(x, z3.Z3_OP_ITE) for x in (high, low)) and high.arg(0).eq(low.arg(0)):
        halves = [(_whole(high.arg(i)), _whole(low.arg(i))) for i in (1, 2)]
        first, second = (join(h, l, low_width, high_width) for h, l in halves)
        return choose(high.arg(0), first, second, low_width + high_width)
    if not isinstance(high, int):
        _, at, whole = _HALVES.get(high.get_id(), (None, None, None))
        if at == low_width and same(part(whole, at - 1, 0), low):
            return whole
    return _normal(z3.Concat(term(high, high_width), term(low, low_width)))


def _whole(x):
    return x.as_long() if z3.is_bv_value(x) else x


def same(a, b):
    """Written alike."""
    if known(a, b):
        return a == b
    return not isinstance(a, (int, bool)) and not isinstance(b, (int, bool)) and a.eq(b)


def zero_extended(x, by, width=WORD):
    return x if isinstance(x, int) else _normal(z3.ZeroExt(by, x))


def sign_extended(x, by, width=WORD):
    if isinstance(x, int):
        return to_signed(x, width) & ((1 << (width + by)) - 1)
    return _normal(z3.SignExt(by, x))


def compared(f, whole, a, b, width):
    if known(a, b):
        return whole(a, b)
    return _normal(f(term(a, width), term(b, width)))


def eq(a, b, width=WORD):
    return compared(lambda a, b: a == b, lambda a, b: a == b, a, b, width)


def below(a, b, width=WORD):
    """Unsigned."""
    return compared(z3.ULT, lambda a, b: a < b, a, b, width)


def less(a, b, width=WORD):
    """Signed."""
    if isinstance(b, int) and b == 0:
        return bit(a, width - 1)
    signed = lambda a, b: to_signed(a, width) < to_signed(b, width)
    return compared(lambda a, b: a < b, signed, a, b, width)


def bit(x, n):
    return eq(part(x, n, n), 1, 1)


def not_(c):
    return (not c) if isinstance(c, bool) else _normal(z3.Not(c))


def all_(*conditions):
    if any(c is False for c in conditions):
        return False
    rest = [c for c in conditions if c is not True]
    return True if not rest else rest[0] if len(rest) == 1 else _normal(z3.And(*rest))


def any_(*conditions):
    return not_(all_(*(not_(c) for c in conditions)))


def differ(c, d):
    if known(c, d):
        return c != d
    return _normal(z3.Xor(truth(c), truth(d)))


def choose(c, a, b, width=WORD):
    if isinstance(c, bool):
        return a if c else b
    if same(a, b):
        return a
    if isinstance(a, bool) or isinstance(b, bool) or z3.is_bool(a) or z3.is_bool(b):
        return _normal(z3.If(c, truth(a), truth(b)))
    return _normal(z3.If(c, term(a, width), term(b, width)))

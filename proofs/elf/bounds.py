"""Between which numbers a machine's double word lies, seen from how it is made: sums of what is short are short.

What comes out is told to the solver, which then need not look into the sum for it.
"""
import z3

import words as w


class Bounds:
    def __init__(self, path):
        self.path, self.found = path, {}

    def of(self, x, width=64):
        """As a signed number."""
        if isinstance(x, int):
            return (w.to_signed(x, width),) * 2
        key = x.get_id()
        if key not in self.found:
            self.found[key] = *self.seen(x), x
        return self.found[key][:2]

    def seen(self, x):
        size = x.size()
        full = -(1 << size - 1), (1 << size - 1) - 1
        kind, parts = x.decl().kind(), x.children()
        if z3.is_bv_value(x):
            return (w.to_signed(x.as_long(), size),) * 2
        if kind == z3.Z3_OP_BADD:
            found = [self.of(part) for part in parts]
            found = sum(low for low, _ in found), sum(high for _, high in found)
        elif kind == z3.Z3_OP_BMUL and len(parts) == 2 and z3.is_bv_value(parts[0]):
            factor = w.to_signed(parts[0].as_long(), size)
            found = sorted(factor * end for end in self.of(parts[1]))
        elif kind == z3.Z3_OP_ITE:
            found = [self.of(part) for part in parts[1:]]
            found = min(low for low, _ in found), max(high for _, high in found)
        elif kind == z3.Z3_OP_CONCAT and z3.is_bv_value(parts[0]) and parts[0].as_long() == 0:
            found = 0, (1 << size - parts[0].size()) - 1
        elif kind == z3.Z3_OP_CONCAT and self.is_sign_extended(parts):
            found = self.of(parts[-1])
        elif size == 64:
            found = self.asked(x, full)
        else:
            found = full
        return tuple(found) if full[0] <= found[0] and found[1] <= full[1] else full

    @staticmethod
    def is_sign_extended(parts):
        last = parts[-1]
        top = z3.simplify(z3.Extract(last.size() - 1, last.size() - 1, last))
        return all(part.eq(top) for part in parts[:-1])

    def asked(self, x, full):
        """Of what is not made of anything: by a question."""
        low, high = full
        if self.path.holds(w.not_(w.less(x, 0, 64)), self.path.SOON_MS):
            low = 0
        for bits in (54, 62):
            if self.path.holds(w.all_(w.less(x, 1 << bits, 64), w.not_(w.less(x, -(1 << bits) & (1 << 64) - 1, 64))), self.path.SOON_MS):
                return max(low, -(1 << bits)), min(high, 1 << bits)
        return low, high

    def told(self, x):
        """Says of a sum where it lies."""
        if isinstance(x, int):
            return
        low, high = self.of(x)
        if (low, high) != (-(1 << 63), (1 << 63) - 1):
            self.path.know(x <= high, x >= low)

"""What Thumb-2 instructions do, from the pseudocode of the ARMv7-M reference manual; capstone only says which instruction bytes are.

An instruction, an operand or a use of the flags that is not written down here is an error, never skipped.
"""
from capstone import arm as c

import words as w
from flags import SHIFTS, Flags, Unknown, added, saturated, shifted, shifted_by, subtracted


class Steps:
    """Instructions by name: each gets the machine and its operands."""

    def __init__(self, machine):
        self.m = machine

    # Operands.

    def register(self, op):
        return self.m.register(op.reg)

    def value(self, insn, op, carry=None):
        """A register, shifted or not, or a number; and the shifter's carry."""
        if op.type == c.ARM_OP_IMM:
            number = op.imm & w.MASK
            # The shifter's carry of a rotated constant is the constant's highest bit. An 8-bit constant leaves the carry as it
            # is. Arithmetic instructions do not use this carry.
            rotated = number > 0xff and not self.is_splat(number)
            return number, (number >> 31 == 1) if rotated else carry
        if op.type != c.ARM_OP_REG:
            raise Unknown(f"operand of {insn.mnemonic} {insn.op_str}")
        a = self.register(op)
        if op.shift.type == c.ARM_SFT_INVALID:
            return a, carry
        if op.shift.type == c.ARM_SFT_RRX:
            return w.or_(w.lsr(a, 1), w.choose(self.m.flags.get("c"), 1 << 31, 0)), lambda: w.bit(a, 0)
        if op.shift.type not in SHIFTS:
            raise Unknown(f"shift of {insn.mnemonic} {insn.op_str}")
        return shifted(SHIFTS[op.shift.type], a, op.shift.value, carry)

    @staticmethod
    def is_splat(number):
        low, next_ = number & 0xff, number >> 8 & 0xff
        return number in (low * 0x00010001, next_ * 0x01000100, low * 0x01010101)

    def three(self, insn):
        """Destination, first and second operand; with two operands the first is the destination."""
        ops = insn.operands
        return (ops[0], ops[0], ops[1]) if len(ops) == 2 else tuple(ops[:3])

    # Data processing.

    def arithmetic(self, insn, f):
        d, n, m = self.three(insn)
        r, flags = f(self.register(n), self.value(insn, m)[0])
        self.m.set_register(d.reg, r)
        self.m.set_flags(insn, flags)

    def add(self, insn):
        self.arithmetic(insn, added)

    def addw(self, insn):
        self.add(insn)

    def sub(self, insn):
        self.arithmetic(insn, subtracted)

    def subw(self, insn):
        self.sub(insn)

    def adc(self, insn):
        before = self.m.flags
        self.arithmetic(insn, lambda a, b: added(a, b, before=before))
        self.told()

    def sbc(self, insn):
        before = self.m.flags
        self.arithmetic(insn, lambda a, b: subtracted(a, b, before))
        self.told()

    def told(self):
        """Where the double word lies that two instructions have made."""
        pair = self.m.flags.pair
        if pair and pair[3] == 64:
            self.m.path.bounds.told((w.add if pair[0] == "+" else w.sub)(pair[1], pair[2], 64))

    def rsb(self, insn):
        self.arithmetic(insn, lambda a, b: subtracted(b, a))

    def neg(self, insn):
        d, n = insn.operands
        r, flags = subtracted(0, self.register(n))
        self.m.set_register(d.reg, r)
        self.m.set_flags(insn, flags)

    def cmp(self, insn):
        a, b = insn.operands
        self.m.flags = subtracted(self.register(a), self.value(insn, b)[0])[1]

    def cmn(self, insn):
        a, b = insn.operands
        self.m.flags = added(self.register(a), self.value(insn, b)[0])[1]

    def logical_flags(self, r, carry):
        v = self.m.flags.v
        return Flags(w.bit(r, 31), w.eq(r, 0), carry, v)

    def logic(self, insn, f):
        d, n, m = self.three(insn)
        b, carry = self.value(insn, m, self.m.flags.c)
        r = f(self.register(n), b)
        self.m.set_register(d.reg, r)
        self.m.set_flags(insn, self.logical_flags(r, carry))

    def and_(self, insn):
        self.logic(insn, w.and_)

    def orr(self, insn):
        self.logic(insn, w.or_)

    def orn(self, insn):
        self.logic(insn, lambda a, b: w.or_(a, w.inv(b)))

    def eor(self, insn):
        self.logic(insn, w.xor)

    def bic(self, insn):
        d, n, m = self.three(insn)
        if m.type == c.ARM_OP_REG and m.reg == n.reg and m.shift.type == c.ARM_SFT_ASR and m.shift.value >= 31 and not insn.update_flags:
            # `a AND NOT (a ASR 31)` is max(a, 0) for a signed number `a`.
            a = self.register(n)
            self.m.set_register(d.reg, w.choose(w.less(a, 0), 0, a))
            return
        self.logic(insn, lambda a, b: w.and_(a, w.inv(b)))

    def tested(self, insn, f):
        a, b = insn.operands
        b, carry = self.value(insn, b, self.m.flags.c)
        self.m.flags = self.logical_flags(f(self.register(a), b), carry)

    def tst(self, insn):
        self.tested(insn, w.and_)

    def teq(self, insn):
        self.tested(insn, w.xor)

    def moved(self, insn, f):
        d, m = insn.operands
        b, carry = self.value(insn, m, self.m.flags.c)
        r = f(b)
        self.m.set_register(d.reg, r)
        self.m.set_flags(insn, self.logical_flags(r, carry))

    def mov(self, insn):
        self.moved(insn, lambda b: b)

    def mvn(self, insn):
        self.moved(insn, w.inv)

    def movw(self, insn):
        self.m.set_register(insn.operands[0].reg, insn.operands[1].imm & 0xffff)

    def movt(self, insn):
        d, m = insn.operands
        self.m.set_register(d.reg, w.join(m.imm & 0xffff, w.part(self.register(d), 15, 0), 16, 16))

    def shift(self, insn, kind):
        d, n, m = self.three(insn)
        a = self.register(n)
        if m.type == c.ARM_OP_IMM:
            r, carry = shifted(kind, a, m.imm, self.m.flags.c)
        else:
            # The carry of this shift is not modelled; an instruction that uses the carry later is an error.
            r, carry = shifted_by(kind, a, self.register(m)), None
        self.m.set_register(d.reg, r)
        self.m.set_flags(insn, self.logical_flags(r, carry))

    def lsl(self, insn):
        self.shift(insn, "lsl")

    def lsr(self, insn):
        self.shift(insn, "lsr")

    def asr(self, insn):
        self.shift(insn, "asr")

    # Products.

    def mul(self, insn):
        d, n, m = self.three(insn)
        r = w.part(self.m.products.signed(self.register(n), self.register(m)), 31, 0)
        self.m.set_register(d.reg, r)
        self.m.set_flags(insn, Flags(w.bit(r, 31), w.eq(r, 0), self.m.flags.c, self.m.flags.v))

    def mla(self, insn):
        d, n, m, a = insn.operands
        r = w.part(self.m.products.signed(self.register(n), self.register(m)), 31, 0)
        self.m.set_register(d.reg, w.add(self.register(a), r))

    def mls(self, insn):
        d, n, m, a = insn.operands
        r = w.part(self.m.products.signed(self.register(n), self.register(m)), 31, 0)
        self.m.set_register(d.reg, w.sub(self.register(a), r))

    def long(self, insn, f, accumulates):
        low, high, n, m = insn.operands
        r = f(self.register(n), self.register(m))
        if accumulates:
            r = w.add(w.join(self.register(high), self.register(low)), r, 64)
            self.m.path.bounds.told(r)
        self.m.set_register(low.reg, w.part(r, 31, 0))
        self.m.set_register(high.reg, w.part(r, 63, 32))

    def smull(self, insn):
        self.long(insn, self.m.products.signed, False)

    def smlal(self, insn):
        self.long(insn, self.m.products.signed, True)

    def umull(self, insn):
        self.long(insn, self.m.products.unsigned, False)

    def umlal(self, insn):
        self.long(insn, self.m.products.unsigned, True)

    # Bits and saturation.

    def clz(self, insn):
        d, m = insn.operands
        a = self.register(m)
        r = 32
        for i in range(32):
            r = w.choose(w.bit(a, i), 31 - i, r)
        self.m.set_register(d.reg, r)

    def ubfx(self, insn):
        d, n, low, width = insn.operands
        r = w.part(self.register(n), low.imm + width.imm - 1, low.imm)
        self.m.set_register(d.reg, w.zero_extended(r, 32 - width.imm) if width.imm < 32 else r)

    def sbfx(self, insn):
        d, n, low, width = insn.operands
        r = w.part(self.register(n), low.imm + width.imm - 1, low.imm)
        self.m.set_register(d.reg, w.sign_extended(r, 32 - width.imm, width.imm) if width.imm < 32 else r)

    def extended(self, insn, f, width):
        d, m = insn.operands
        r = w.part(self.value(insn, m)[0], width - 1, 0)
        self.m.set_register(d.reg, f(r, 32 - width, width))

    def uxtb(self, insn):
        self.extended(insn, w.zero_extended, 8)

    def uxth(self, insn):
        self.extended(insn, w.zero_extended, 16)

    def sxtb(self, insn):
        self.extended(insn, w.sign_extended, 8)

    def sxth(self, insn):
        self.extended(insn, w.sign_extended, 16)

    def saturating(self, insn, f):
        # The operands of QADD and QSUB are in the order Rd, Rm, Rn.
        d, m, n = self.three(insn)
        a, b = (w.sign_extended(self.register(x), 1) for x in (m, n))
        self.m.set_register(d.reg, saturated(self.m.path, f(a, b, 33), 33))

    def qadd(self, insn):
        self.saturating(insn, w.add)

    def qsub(self, insn):
        self.saturating(insn, w.sub)

    def saturate(self, insn, signed):
        d, bits, n = insn.operands
        a = self.value(insn, n)[0]
        self.m.set_register(d.reg, saturated(self.m.path, a, 32, bits.imm, signed))

    def ssat(self, insn):
        self.saturate(insn, True)

    def usat(self, insn):
        self.saturate(insn, False)

    def pkhbt(self, insn):
        d, n, m = self.three(insn)
        b = self.value(insn, m)[0]
        self.m.set_register(d.reg, w.join(w.part(b, 31, 16), w.part(self.register(n), 15, 0), 16, 16))

    # Memory.

    def place(self, insn, op):
        """Where a memory operand is, and what is written back to its base after it."""
        if op.type != c.ARM_OP_MEM:
            raise Unknown(f"operand of {insn.mnemonic} {insn.op_str}")
        base = self.m.register(op.mem.base)
        if op.mem.base == c.ARM_REG_PC:
            base &= ~3
        if op.mem.index:
            index = self.m.register(op.mem.index)
            if op.shift.type != c.ARM_SFT_INVALID:
                index = shifted(SHIFTS[op.shift.type], index, op.shift.value, None)[0]
            return w.add(base, index), None
        after = insn.operands[-1] if insn.operands[-1].type == c.ARM_OP_IMM else None
        if after is not None:
            at, back = base, w.add(base, after.imm & w.MASK if not after.subtracted else -after.imm & w.MASK)
        else:
            at = w.add(base, op.mem.disp & w.MASK)
            back = at
        return at, (op.mem.base, back) if insn.writeback else None

    def transferred(self, insn, count, f):
        ops = insn.operands
        memory = next(op for op in ops if op.type == c.ARM_OP_MEM)
        at, back = self.place(insn, memory)
        for i, op in enumerate(ops[:count]):
            f(op.reg, w.add(at, 4 * i))
        if back:
            self.m.set_register(*back)

    def ldr(self, insn):
        self.transferred(insn, 1, lambda reg, at: self.m.set_register(reg, self.m.load(at)))

    def str(self, insn):
        self.transferred(insn, 1, lambda reg, at: self.m.store(at, self.m.register(reg)))

    def ldrd(self, insn):
        # Both words are read before a register changes, because one of the registers may be the base.
        values = []
        self.transferred(insn, 2, lambda reg, at: values.append((reg, self.m.load(at))))
        for reg, value in values:
            self.m.set_register(reg, value)

    def strd(self, insn):
        self.transferred(insn, 2, lambda reg, at: self.m.store(at, self.m.register(reg)))

    def ldrb(self, insn):
        self.transferred(insn, 1, lambda reg, at: self.m.set_register(reg, self.m.load_part(at, 8)))

    def strb(self, insn):
        self.transferred(insn, 1, lambda reg, at: self.m.store_part(at, self.m.register(reg), 8))

    def ldrh(self, insn):
        self.transferred(insn, 1, lambda reg, at: self.m.set_register(reg, self.m.load_part(at, 16)))

    def strh(self, insn):
        self.transferred(insn, 1, lambda reg, at: self.m.store_part(at, self.m.register(reg), 16))

    def many(self, insn, base, regs, start, end, f):
        for i, op in enumerate(regs):
            f(op.reg, w.add(start, 4 * i))
        if end is not None:
            self.m.set_register(base, end)

    def push(self, insn):
        regs = insn.operands
        start = w.sub(self.m.register(c.ARM_REG_SP), 4 * len(regs))
        self.many(insn, c.ARM_REG_SP, regs, start, start, lambda reg, at: self.m.store(at, self.m.register(reg)))

    def pop(self, insn):
        self.loaded(insn, c.ARM_REG_SP, insn.operands, True)

    def loaded(self, insn, base, regs, back):
        start = self.m.register(base)
        values = [(op.reg, self.m.load(w.add(start, 4 * i))) for i, op in enumerate(regs)]
        if back:
            self.m.set_register(base, w.add(start, 4 * len(regs)))
        for reg, value in values:
            self.m.set_register(reg, value)

    def ldm(self, insn):
        self.loaded(insn, insn.operands[0].reg, insn.operands[1:], insn.writeback)

    def stm(self, insn):
        base, regs = insn.operands[0].reg, insn.operands[1:]
        start = self.m.register(base)
        end = w.add(start, 4 * len(regs)) if insn.writeback else None
        self.many(insn, base, regs, start, end, lambda reg, at: self.m.store(at, self.m.register(reg)))

    # Branches.

    def b(self, insn):
        self.m.go(insn.operands[0].imm)

    def bl(self, insn):
        self.m.set_register(c.ARM_REG_LR, self.m.next | 1)
        self.m.go(insn.operands[0].imm)

    def bx(self, insn):
        self.m.set_register(c.ARM_REG_PC, self.register(insn.operands[0]))

    def cbz(self, insn):
        self.m.go_if(w.eq(self.register(insn.operands[0]), 0), insn.operands[1].imm)

    def cbnz(self, insn):
        self.m.go_if(w.not_(w.eq(self.register(insn.operands[0]), 0)), insn.operands[1].imm)

    def tbb(self, insn):
        table = insn.operands[0].mem
        base = self.m.next if table.base == c.ARM_REG_PC else self.m.register(table.base)
        offset = self.m.load_part(w.add(base, self.m.register(table.index)), 8)
        self.m.set_register(c.ARM_REG_PC, w.or_(w.add(self.m.next, w.lsl(offset, 1)), 1))

    def nop(self, insn):
        pass

"""A Cortex-M that runs on unknown words: registers, flags, memory, and a path for each way that a function can go.

Addresses are known: the structures that a tick is given, the stack, the program. A load of a word that nothing has stored, an access that is
not aligned or at an unknown address, and a store to the program are errors.
"""
from capstone import CS_ARCH_ARM, CS_MODE_MCLASS, CS_MODE_THUMB, Cs
from capstone import arm as c

import flags
import thumb
import words as w
from flags import Unknown

#: Return address of the function under test. A path that arrives at this address has ended.
END = 0x3000_0100
STACK = 0x2001_f000
#: Largest number of instructions on one path. A longer path is an error, because it may be a loop whose end the checker does not
#: know.
LONGEST = 20_000

GENERAL = {getattr(c, f"ARM_REG_R{i}"): i for i in range(13)} | {
    c.ARM_REG_SP: 13, c.ARM_REG_LR: 14, c.ARM_REG_PC: 15}
PC, SP, LR = 15, 13, 14


class Decoder:
    """Instruction bytes as capstone reads them, once for each place."""

    def __init__(self, program):
        self.program = program
        self.capstone = Cs(CS_ARCH_ARM, CS_MODE_THUMB | CS_MODE_MCLASS)
        self.capstone.detail = True
        self.at = {}

    def __getitem__(self, address):
        if address not in self.at:
            code = self.program.code(address)
            insn = next(self.capstone.disasm(code, address, 1), None)
            if insn is None:
                raise Unknown(f"bytes {code.hex()} at {address:#x}")
            name = insn.insn_name()
            name = {"and": "and_", "hint": "nop"}.get(name, name) if not insn.mnemonic.startswith("nop") else "nop"
            if not hasattr(thumb.Steps, name) and not name.startswith("it"):
                raise Unknown(f"{insn.mnemonic} {insn.op_str} at {address:#x}")
            self.at[address] = insn, name
        return self.at[address]


class Machine:
    """One state of it. `hooks`: what is done in the place of a function at an address."""

    def __init__(self, decoder, path, hooks=None):
        self.decoder, self.path, self.hooks = decoder, path, hooks or {}
        self.products = path.products
        self.regs = [path.fresh(f"r{i}", 32) if i < 13 else 0 for i in range(16)]
        self.regs[SP], self.regs[LR] = STACK, END | 1
        self.flags = flags.Flags()
        self.memory = {}
        self.it = []
        self.steps = thumb.Steps(self)
        self.count = 0
        self.pending = None

    def copy(self):
        other = object.__new__(Machine)
        other.__dict__.update(self.__dict__)
        other.regs, other.memory, other.it = list(self.regs), dict(self.memory), list(self.it)
        other.steps = thumb.Steps(other)
        return other

    # Access to registers, flags and memory for the instructions.

    def register(self, reg):
        if reg not in GENERAL:
            raise Unknown(f"register {reg}")
        number = GENERAL[reg]
        return self.here + 4 if number == PC else self.regs[number]

    def set_register(self, reg, value):
        if reg not in GENERAL:
            raise Unknown(f"register {reg}")
        number = GENERAL[reg]
        if number == PC:
            self.pending = value
        else:
            self.regs[number] = value

    def set_flags(self, insn, flags):
        """Within an IT block the short instructions leave the flags alone."""
        if insn.update_flags and not (self.in_it and insn.size == 2):
            self.flags = flags

    def go(self, target):
        self.pending = target | 1

    def go_if(self, condition, target):
        self.pending = (condition, target)

    def address(self, at, size):
        if not isinstance(at, int):
            raise Unknown(f"an unknown address at {self.here:#x}: {at}")
        if at % size:
            raise Unknown(f"an access to {at:#x} that is not aligned, at {self.here:#x}")
        return at

    def load(self, at):
        at = self.address(at, 4)
        if at in self.memory:
            return self.memory[at]
        fixed = self.decoder.program.word(at)
        if fixed is None:
            raise Unknown(f"a load of {at:#x} at {self.here:#x}, where nothing has been stored")
        return fixed

    def store(self, at, value):
        at = self.address(at, 4)
        if self.decoder.program.word(at) is not None:
            raise Unknown(f"a store to the program at {self.here:#x}")
        if at not in self.memory and not STACK - 0x1000 <= at < STACK:
            raise Unknown(f"a store to {at:#x} at {self.here:#x}, outside of what the tick is given")
        self.memory[at] = value

    def load_part(self, at, bits):
        at = self.address(at, bits // 8)
        low = at % 4 * 8
        return w.zero_extended(w.part(self.load(at & ~3), low + bits - 1, low), 32 - bits, bits)

    def store_part(self, at, value, bits):
        at = self.address(at, bits // 8)
        low = at % 4 * 8
        mask = ((1 << bits) - 1) << low
        kept = w.and_(self.load(at & ~3), w.MASK ^ mask)
        self.store(at & ~3, w.or_(kept, w.and_(w.lsl(value, low), mask)))

    # Execution of instructions.

    def execute(self, insn, name):
        """One instruction that is to be done, whatever its condition."""
        self.pending = None
        getattr(self.steps, name)(insn)

    def step(self):
        """One instruction; where it may go on, as conditions and machines: one for each."""
        self.here = self.regs[PC]
        if self.here in self.hooks:
            self.hooks[self.here](self)
            return self.arrive(self.regs[LR])
        insn, name = self.decoder[self.here]
        self.next = self.here + insn.size
        self.count += 1
        if self.count > LONGEST:
            raise Unknown(f"a path of more than {LONGEST} instructions")
        self.in_it = bool(self.it)
        if name.startswith("it"):
            self.begin_it(insn)
            self.regs[PC] = self.next
            return [(True, self)]
        condition = self.it.pop(0) if self.it else None
        if condition is None:
            condition = insn.cc - 1 if name == "b" and insn.cc not in (0, c.ARM_CC_AL) else 14
        holds = True if condition == 14 else self.flags.holds(condition)
        if not isinstance(holds, bool):
            holds = self.path.settled(holds)
        if holds is True:
            self.execute(insn, name)
            return self.arrived()
        if holds is False:
            self.regs[PC] = self.next
            return [(True, self)]
        if name == "b":
            taken = self.copy()
            taken.execute(insn, name)
            self.regs[PC] = self.next
            return [(holds, taken.arrived()[0][1]), (w.not_(holds), self)]
        before = self.copy()
        self.execute(insn, name)
        if self.pending is not None:
            before.regs[PC] = before.next
            return [(holds, self.arrived()[0][1]), (w.not_(holds), before)]
        self.merge(holds, before)
        return self.arrived()

    def begin_it(self, insn):
        """Conditions of the instructions that follow: the mask's bits up to its lowest one that is set."""
        code = int.from_bytes(insn.bytes, "little")
        first, mask = code >> 4 & 0xf, code & 0xf
        length = 4 - (mask & -mask).bit_length() + 1
        self.it = [first] + [first & 0xe | (mask >> (4 - i) & 1) for i in range(1, length)]

    def merge(self, holds, before):
        """An instruction that is done under a condition."""
        for i in range(15):
            self.regs[i] = w.choose(holds, self.regs[i], before.regs[i])
        for at in self.memory:
            if at not in before.memory:
                raise Unknown(f"a store under a condition to {at:#x}, where nothing has been stored")
            self.memory[at] = w.choose(holds, self.memory[at], before.memory[at])
        if self.flags is not before.flags:
            self.flags = flags.Flags.merged(holds, self.flags, before.flags)

    def arrived(self):
        target = self.pending
        if target is None:
            self.regs[PC] = self.next
            return [(True, self)]
        if isinstance(target, tuple):
            condition, at = target
            if isinstance(condition, bool):
                self.regs[PC] = at if condition else self.next
                return [(True, self)]
            other = self.copy()
            other.regs[PC], self.regs[PC] = at, self.next
            return [(condition, other), (w.not_(condition), self)]
        return self.arrive(target)

    def arrive(self, target):
        """At the address of a branch by register, which has the lowest bit set."""
        if isinstance(target, int):
            if not target & 1:
                raise Unknown(f"a branch to {target:#x}, which is no Thumb code")
            self.regs[PC] = target & ~1
            return [(True, self)]
        if not w.same(w.part(target, 0, 0), 1) and not self.path.holds(w.bit(target, 0)):
            raise Unknown("a branch to what may be no Thumb code")
        ways = []
        for value in self.path.values(target):
            other = self.copy()
            other.regs[PC] = value & ~1
            ways.append((w.eq(target, value), other))
        return ways

    @property
    def done(self):
        return self.regs[PC] == END


def runs(machine):
    """Each way through a function, its path's conditions assumed while it is looked at."""
    path = machine.path
    while not machine.done:
        ways = machine.step()
        if len(ways) == 1 and ways[0][0] is True:
            machine = ways[0][1]
            continue
        for condition, way in ways:
            with path.assuming(condition) as possible:
                if possible:
                    yield from runs(way)
        return
    yield machine

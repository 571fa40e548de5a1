"""A second reading: the instructions' semantics beside Unicorn (QEMU's core).

`same_as_unicorn` runs a tick of the program on inputs that are known, in `machine.py` and in Unicorn: every register that a function leaves,
and every byte of its structures, must be the same.
"""
import random

import unicorn
from unicorn import arm_const as u

import samples
import words as w
from machine import END, PC, Machine, runs
from paths import Path
from whole import Counts

#: Memory for structures and stack, which Unicorn gets in addition to the program's sections.
FREE, FREE_SIZE = 0x2000_0000, 0x4_0000
RETURN = END & ~0xfff


class Board:
    """The program in Unicorn."""

    def __init__(self, program):
        self.machine = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
        pages = {at & ~0xfff for start, data in program.sections for at in range(start, start + len(data) + 0xfff, 0x1000)}
        for page in sorted(pages):
            self.machine.mem_map(page, 0x1000)
        for start, data in program.sections:
            self.machine.mem_write(start, bytes(data))
        self.machine.mem_map(FREE, FREE_SIZE)
        self.machine.mem_map(RETURN, 0x1000)

    def run(self, at, regs, memory):
        """Registers 0 to 13 and the words of `memory` after a function."""
        for address, value in memory.items():
            self.machine.mem_write(address, value.to_bytes(4, "little"))
        for i in range(15):
            self.machine.reg_write(register(i), regs[i])
        self.machine.emu_start(at | 1, END, count=100_000)
        if self.machine.reg_read(u.UC_ARM_REG_PC) != END:
            raise RuntimeError("Unicorn did not come back")
        read = lambda address: int.from_bytes(self.machine.mem_read(address, 4), "little")
        return [self.machine.reg_read(register(i)) for i in range(14)], {address: read(address) for address in memory}


def register(i):
    return {13: u.UC_ARM_REG_SP, 14: u.UC_ARM_REG_LR}.get(i, getattr(u, f"UC_ARM_REG_R{i}", None))


class Concrete:
    """A tick on inputs that are known."""

    def __init__(self, tick, decoder, board, values):
        self.tick = tick
        machine = Machine(decoder, Path())
        machine.regs[:13] = [0x1111_1111 * i & w.MASK for i in range(13)]
        tick.begin(machine, samples.Given(values=values))
        machine.regs[PC] = tick.at
        self.saved, self.began = list(machine.regs), dict(machine.memory)
        self.there = board.run(tick.at, self.saved, self.began)
        self.here = next(runs(machine))

    def differences(self):
        """Where the two machines are not the same; scratch registers count, as both run the same instructions."""
        regs, memory = self.there
        found = [f"register {i}" for i in range(14) if self.here.regs[i] != regs[i]]
        return found + [f"word at {at:#x}" for at in self.began if self.here.memory[at] != memory[at]]

    def wrong(self, kept):
        """Claims of the specification that are not so, of this machine."""
        claims = [*self.tick.claims(Counts(), self.here), *kept(self.here, self.saved)]
        return [(name, code, value) for name, code, value in claims if code != value]


def same_as_unicorn(tick, decoder, board, count, kept):
    """How many inputs, and the first difference; of half of them nothing is assumed."""
    chance = random.Random(7)
    held = samples.drawn(tick, count // 2, seed=8)
    for i in range(count):
        given = held[i] if i < len(held) else any_inputs(tick, chance)
        one = Concrete(tick, decoder, board, given)
        different = one.differences()
        if different:
            return i, f"Unicorn has another {different[0]}: {given}"
        if i < len(held) and one.wrong(kept):
            return i, f"the specification has another {one.wrong(kept)[0]}: {given}"
    return count, None


def any_inputs(tick, chance):
    given = samples.Given(chance)
    tick.begin(samples.Bare(), given)
    # Enumerations and flags hold one of their values: no function gets any other byte as input.
    for placed in (tick.law, tick.state):
        for name, field in placed.fields.items():
            if field.size == 1:
                tick.draw(given, name, chance.randint(0, max(field.words.values(), default=1)))
    return given.values

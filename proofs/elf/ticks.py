"""The ticks that are compared: which function of a board's program, what it is given, what is assumed of that, and what its specification
says that it leaves behind. Assumptions are those of `proofs/src/valid.rs` and `proofs/src/guard.rs`, by the same names.
"""
from dataclasses import is_dataclass

import spec
import words as w
from machine import STACK
from whole import Whole, equal, signed, unsigned, word

FIXED32 = "touchstone_control::number::fixed_point::Fixed32"
#: Half of the format's largest energy.
ENERGY_CAP = 1 << 62
QUARTER = spec.HIGHEST >> 2
#: Upper bound of the guard's capacity and refill; both are below it.
MOST_STORED = (QUARTER + 1) << spec.SIGNAL
SELF, STATE, OUT = 0x2000_1000, 0x2000_2000, 0x2000_3000


class Placed:
    """A structure in a machine's memory, each of its words any, or as they are given."""

    def __init__(self, machine, program, name, base, inputs, die=None):
        self.base = base
        self.die = die or program.structure(name)
        self.fields = program.fields(self.die)
        self.size = -(-self.die.attributes["DW_AT_byte_size"].value // 4) * 4
        self.before = {}
        for at in range(base, base + self.size, 4):
            self.before[at] = machine.memory[at] = inputs(f"m{at:x}", 32)
        self.machine = machine

    def get(self, name, memory=None):
        """A field as a word or two."""
        memory = self.before if memory is None else memory
        field = self.fields[name]
        at = self.base + field.at
        if field.size == 8:
            return w.join(memory[at + 4], memory[at])
        if field.size == 4:
            return memory[at]
        low = at % 4 * 8
        return w.part(memory[at & ~3], low + 8 * field.size - 1, low)

    def number(self, name, memory=None):
        """A field as a signed number."""
        return signed(self.get(name, memory), 8 * self.fields[name].size)

    def set(self, name, value):
        """Makes a field a number that is known."""
        field = self.fields[name]
        at = self.base + field.at
        low = at % 4 * 8
        mask = (1 << 8 * field.size) - 1 << low
        kept = w.and_(self.before[at & ~3], w.MASK ^ mask)
        self.before[at & ~3] = self.machine.memory[at & ~3] = w.or_(kept, value << low)

    def is_word(self, name, label):
        """Whether a choice is that one."""
        field = self.fields[name]
        return w.eq(self.get(name), field.words[label], 8 * field.size)

    def valid_choices(self):
        """Of each choice and each truth value: it is one of those that there are."""
        for name, field in self.fields.items():
            if field.size == 1:
                most = max(field.words.values()) if field.words else 1
                yield w.not_(w.below(most, self.get(name), 8))

    def unchanged(self, memory, but=()):
        """That no byte outside of the named fields is another."""
        free = {self.base + field.at + i for name, field in self.fields.items() if name in but for i in range(field.size)}
        for at, before in self.before.items():
            mask = sum(0xff << 8 * i for i in range(4) if at + i not in free)
            if mask:
                yield f"untouched {at - self.base}", w.and_(memory[at], mask), w.and_(before, mask)


def not_negative(*numbers):
    return [number >= 0 for number in numbers]


class Tick:
    """A function of the program beside its specification."""

    name = pattern = assumes = ""
    kind = state_kind = ""

    def __init__(self, program):
        self.program = program
        self.at, self.length = program.function(self.pattern)

    def placed(self, machine, inputs):
        """What it is given."""
        self.law = Placed(machine, self.program, self.kind, SELF, inputs)
        self.state = Placed(machine, self.program, self.state_kind, STATE, inputs)
        machine.regs[0], machine.regs[1] = SELF, STATE

    def draw(self, given, name, value):
        """Makes a field of the law or of the memory a number, of inputs that are drawn."""
        placed = self.law if name in self.law.fields else self.state
        field = placed.fields[name]
        at = placed.base + field.at
        value &= (1 << 8 * field.size) - 1
        for i in range(0, field.size, 4):
            low = at % 4 * 8
            mask = ((1 << 8 * min(field.size, 4)) - 1) << low
            old = given.values[f"m{(at & ~3) + i:x}"]
            given.values[f"m{(at & ~3) + i:x}"] = old & ~mask & w.MASK | (value >> 8 * i << low) & mask

    def drawn(self, chance, given):
        """Moves inputs that are drawn towards what is assumed of them."""
        for placed in (self.law, self.state):
            for name, field in placed.fields.items():
                if field.size == 1:
                    self.draw(given, name, chance.randint(0, max(field.words.values(), default=1)))

    def argument(self, machine, register, name, inputs):
        machine.regs[register] = inputs(name, 32)
        return signed(machine.regs[register])

    def known(self, of):
        """Makes the numbers as short as what is assumed lets them be."""
        def shorter(x):
            return of.seen(x) if isinstance(x, Whole) else x
        for name, value in vars(self).items():
            if isinstance(value, tuple):
                setattr(self, name, type(value)(*map(shorter, value)))
            elif is_dataclass(value):
                setattr(self, name, type(value)(**{field: shorter(x) for field, x in vars(value).items()}))

    def same_memory(self, memory, expected):
        """Of each field by its name: the code's word and the specification's."""
        for name, value in expected.items():
            width = 8 * self.state.fields[name].size
            yield name, self.state.get(name, memory), word(value, width)
        yield from self.law.unchanged(memory)
        yield from self.state.unchanged(memory, but=expected)


class OfGuard(Tick):
    name = "guard"
    what = "Guard::tick_with_change"
    pattern = r"^<?touchstone_control::guard::Guard<.*::tick_with_change$"
    kind, state_kind = f"Guard<{FIXED32}>", f"GuardState<{FIXED32}>"
    assumes = "coefficients as Guard::new gives them (`valid` of proofs/src/guard.rs), memory in the invariant; any displacements, any wanted force"

    def begin(self, machine, inputs):
        self.placed(machine, inputs)
        self.moved = self.argument(machine, 2, "moved", inputs)
        self.before_change = self.argument(machine, 3, "before_change", inputs)
        machine.memory[STACK] = inputs("wanted", 32)
        self.wanted = signed(machine.memory[STACK])
        self.k = spec.Guard(*(self.law.number(name) for name in spec.Guard._fields))
        self.m = spec.GuardMemory(*(self.state.number(name) for name in ("account", "force", "older")))

    def assumed(self, of):
        k, m = self.k, self.m
        yield from not_negative(k.capacity, k.refill, k.damping, k.per_reach, k.late, k.stray, k.overrun)
        for x in (k.furthest, k.count, k.slack, k.in_flight):
            yield from (x >= 0, x <= QUARTER)
        yield from (k.capacity < MOST_STORED, k.refill < MOST_STORED, k.late <= 1 << spec.SIGNAL)
        largest = of.times(k.per_reach, k.capacity >> spec.SIGNAL) >> spec.GAIN
        yield largest <= QUARTER
        yield of.times(k.damping, k.furthest) >> spec.GAIN <= QUARTER
        yield of.times(k.stray, largest + largest) >> spec.SIGNAL <= QUARTER
        yield of.times(largest, k.in_flight) <= k.capacity
        # The invariant of the guard's memory.
        yield m.account <= k.capacity
        for force in (m.force, m.older):
            yield from (force <= largest, force >= -largest)
        still = w.all_(equal(m.force, 0), equal(m.older, 0), m.account > -ENERGY_CAP)
        yield w.any_(m.account >= 0, still)

    def drawn(self, chance, given):
        for name in spec.Guard._fields:
            bits = 53 if name in ("capacity", "refill") else 25 if name == "late" else 29
            self.draw(given, name, chance.getrandbits(bits) >> chance.randrange(bits))
        k = lambda name: self.law.number(name)
        self.law.before = {at: given.values[f"m{at:x}"] for at in self.law.before}
        largest = k("per_reach") * (k("capacity") >> 24) >> 12
        if chance.random() < 0.8:
            self.draw(given, "account", k("capacity") - (chance.getrandbits(53) >> chance.randrange(53)))
            for name in ("force", "older"):
                self.draw(given, name, chance.choice((chance.randint(-largest, largest), 0, largest, -largest)))
        else:
            self.draw(given, "account", -(chance.getrandbits(62) >> chance.randrange(62)))
            self.draw(given, "force", 0)
            self.draw(given, "older", 0)
        for name in ("moved", "before_change"):
            if chance.random() < 0.8:
                given.values[name] = chance.randint(-k("furthest"), k("furthest")) & w.MASK

    def claims(self, of, machine):
        after, fine = spec.guard_tick(of, self.k, self.m, self.moved, self.before_change, self.wanted)
        yield "overspeed", w.part(machine.regs[0], 0, 0), 0 if fine else 1
        if fine:
            yield "force shown", machine.regs[1], word(after.force)
        yield from self.same_memory(machine.memory, {"account": after.account, "force": after.force, "older": after.older})


class OfSfa(Tick):
    name = "sfa"
    what = "Sfa::tick"
    pattern = r"^<touchstone_control::law::sfa::Sfa<.* as touchstone_control::law::Law(<.*>)?>::tick$"
    kind, state_kind = f"Sfa<{FIXED32}>", f"SfaState<{FIXED32}>"
    assumes = "gains, ratios not negative, a limit above 0 (`validate`), memory in the invariant; any sample"

    def begin(self, machine, inputs):
        self.placed(machine, inputs)
        self.e = self.argument(machine, 2, "e", inputs)
        self.moved = self.argument(machine, 3, "moved", inputs)
        law, state = self.law, self.state
        update = {label: law.is_word("update", label) for label in ("TurnInward", "Inward")}
        numbers = {name: law.number(name) for name in ("desired", "soft", "gain", "compliance", "limit")}
        self.k = spec.Sfa(update=update, keep_force=law.is_word("first_contact", "KeepForce"), **numbers)
        self.free = state.is_word("contact", "Free")
        self.m = spec.SfaMemory(w.not_(self.free), state.is_word("contact", "Augmenting"),
                                *(state.number(name) for name in ("last", "before_last", "offset", "force")))

    def assumed(self, of):
        k, m = self.k, self.m
        yield from self.law.valid_choices()
        yield from self.state.valid_choices()
        yield from not_negative(k.desired, k.soft, k.gain, k.compliance)
        yield k.limit > 0
        yield from (m.force >= 0, m.force <= k.limit)
        yield w.any_(m.augmenting, equal(m.offset, 0))
        yield w.any_(m.inside, equal(m.force, 0))

    def drawn(self, chance, given):
        super().drawn(chance, given)
        for name in ("desired", "soft", "gain", "compliance", "limit"):
            self.draw(given, name, chance.getrandbits(31) >> chance.randrange(31))
        self.draw(given, "force", chance.choice((0, chance.getrandbits(31) >> chance.randrange(31))))
        if chance.random() < 0.5:
            self.draw(given, "offset", 0)

    def claims(self, of, machine):
        after, force = spec.sfa_tick(of, self.k, self.m, self.e, self.moved)
        words = self.state.fields["contact"].words
        contact = words["Augmenting" if after.augmenting else "First" if after.inside else "Free"]
        yield "force shown", machine.regs[0], word(force)
        yield from self.same_memory(machine.memory, {
            "contact": contact, "last": after.last, "before_last": after.before_last, "offset": after.offset, "force": after.force})


class OfMotor(Tick):
    name = "motor"
    what = "ThreePhase::command"
    pattern = r"^<touchstone_drive::command::ThreePhase as touchstone_drive::command::Drive>::command$"
    kind, state_kind = "ThreePhase", "Rotor"
    assumes = "a current limit that is not negative (`MotorSettings`); any torque constants, torque, angle, derating and map"

    def begin(self, machine, inputs):
        self.placed(machine, inputs)
        self.out = Placed(machine, self.program, "Driven", OUT, inputs)
        self.command = Placed(machine, self.program, "CurrentCommand", OUT + self.out.fields["command"].at, inputs)
        machine.regs[0], machine.regs[1], machine.regs[3] = OUT, SELF, STATE
        self.torque = self.argument(machine, 2, "torque", inputs)
        self.k = spec.Motor(*(self.law.number(name) for name in spec.Motor._fields))
        self.map_ = self.state.number("map")
        self.derating = unsigned(self.state.get("derating"))
        self.against = w.eq(self.state.get("against"), 1, 8)

    def assumed(self, of):
        yield from self.state.valid_choices()
        yield self.k.limit >= 0

    def drawn(self, chance, given):
        super().drawn(chance, given)
        self.draw(given, "limit", chance.getrandbits(31) >> chance.randrange(31))
        # Edges: deratings around 0 and 1 (65536), and map currents around the current limit.
        whole = 1 << 16
        if chance.random() < 0.6:
            self.draw(given, "derating", chance.choice((0, whole - 1, whole, whole + 1, w.MASK)))
        if chance.random() < 0.5:
            limit = given.values[f"m{SELF + self.law.fields['limit'].at:x}"]
            self.draw(given, "map", chance.choice((limit, -limit, limit + 1, -limit - 1, limit >> 1, spec.LOWEST, 0)))

    def claims(self, of, machine):
        found = spec.motor_command(of, self.k, self.torque, self.derating, self.against, self.map_)
        memory, rotor = machine.memory, self.state
        bit = lambda condition, place: w.choose(of.settled(condition), 1 << place, 0, 8)
        yield "torque left", self.out.get("torque", memory), word(found.torque)
        yield "limits", self.out.get("limits", memory), w.or_(bit(found.derated, 0), bit(found.limited, 1), 8)
        expected = {"mode": self.command.fields["mode"].words["Drive"], "current.d": 0, "current.q": word(found.q)}
        expected |= {name: rotor.get(name) for name in ("tick", "angle", "advance")}
        for name, value in expected.items():
            yield name, self.command.get(name, memory), value
        # A claim beside the specification: the current is within the part of the limit that the temperature leaves.
        yield "within the limit", w.choose(of.settled(found.q <= found.left), 1, 0, 1), 1
        yield "within the limit, the other way", w.choose(of.settled(found.q >= -found.left), 1, 0, 1), 1
        yield from self.law.unchanged(memory)
        yield from self.state.unchanged(memory)


TICKS = [OfGuard, OfSfa, OfMotor]

"""The specification ticks of `proofs/src/spec/`, line by line: read each beside its file there.

`of` says how to count (`whole.Counts`): `of.decide` of a condition is an `if` there, `of.least`, `of.most`, `of.size` and `of.within` are `min`,
`max`, `abs` and `clamp`, `of.times` is `times`. On Python's integers these are the functions that `beside.py` compares with the Rust code.
"""
from collections import namedtuple
from dataclasses import dataclass, replace

from whole import equal

GAIN, SIGNAL = 12, 24
HIGHEST, LOWEST = (1 << 31) - 1, -(1 << 31)

# Arithmetic that all of them use: `rounding.rs`.


def cut(of, dividend, digits):
    size = of.size(dividend) >> digits
    return of.either(dividend < 0, -size, size)


def signal(of, x):
    return of.within(x, LOWEST, HIGHEST)


def spring(of, stiffness, position):
    return of.within(cut(of, of.times(stiffness, position), GAIN), -HIGHEST, HIGHEST)


# `sfa.rs`: the spring.

Spring = namedtuple("Spring", "desired damping limit")


def spring_tick(of, k, e, moved):
    if of.decide(e <= 0):
        return 0
    tension = of.times(k.desired, e) + of.times(k.damping, of.least(moved, e))
    return of.within(cut(of, tension, GAIN), 0, of.least(HIGHEST, k.limit))


# `sfa.rs`: successive force augmentation.

Sfa = namedtuple("Sfa", "desired soft gain compliance update keep_force limit")


@dataclass(frozen=True)
class SfaMemory:
    inside: object = False
    augmenting: object = False
    last: object = 0
    before_last: object = 0
    offset: object = 0
    force: object = 0


def sfa_step(of, k, m, moved):
    if of.decide(k.update["TurnInward"]):
        due = of.decide(moved > 0) and of.decide(m.last <= m.before_last)
    elif of.decide(k.update["Inward"]):
        due = of.decide(moved > 0)
    else:
        due = True
    if not due:
        return 0
    step = of.within(cut(of, of.times(k.gain, moved), SIGNAL), -HIGHEST, HIGHEST)
    wanted = of.least(spring(of, k.desired, m.last), k.limit)
    if of.decide(m.last > 0) and of.decide(m.force < wanted):
        return step
    if of.decide(m.last > 0) and of.decide(equal(m.force, wanted)):
        return 0
    return -step


def sfa_tick(of, k, m, e, moved):
    turned = of.decide(m.inside) and not of.decide(m.augmenting) and of.decide(moved < 0)
    if turned and of.decide(k.keep_force):
        force = of.within(spring(of, k.desired, e), 0, k.limit)
        held = of.within(cut(of, of.times(k.compliance, force), SIGNAL), -HIGHEST, HIGHEST)
        offset = signal(of, held - e)
    elif of.decide(m.augmenting):
        offset = signal(of, m.offset + sfa_step(of, k, m, moved))
    else:
        offset = 0
    inside = of.decide(m.inside) or of.decide(e > 0)
    augmenting = of.decide(m.augmenting) or turned
    if augmenting:
        force = spring(of, k.soft, signal(of, e + offset))
    elif inside:
        force = spring(of, k.desired, e)
    else:
        force = 0
    force = of.least(force, k.limit)
    last, before_last = e, m.last
    if of.decide(force <= 0):
        return SfaMemory(last=last, before_last=before_last), 0
    return SfaMemory(inside, augmenting, last, before_last, offset, force), force


# `guard.rs`.

Guard = namedtuple("Guard", "capacity refill damping furthest count late stray slack per_reach in_flight overrun")


@dataclass(frozen=True)
class GuardMemory:
    account: object = 0
    force: object = 0
    older: object = 0


def guard_within(of, x, limit):
    return of.most(of.least(x, limit), -limit)


def damped(of, k, distance):
    surely = of.most(distance - k.count, 0)
    return of.times(of.times(k.damping, surely) >> GAIN, surely)


def reserve(of, k, force):
    return of.times(of.size(force), k.in_flight)


def largest_force(of, k, free):
    return of.times(k.per_reach, free >> SIGNAL) >> GAIN


def booked(of, k, m, moved, before_change):
    change = m.force - m.older
    under_older = before_change + (
        (of.times(k.late, moved - before_change) + of.times(k.stray, change)) >> SIGNAL)
    return (m.account + k.refill + of.times(m.force, moved)
            - of.times(change, under_older)
            - of.times(of.size(change), k.slack)
            + damped(of, k, of.size(moved)))


def lost(of, k, m):
    size = of.most(of.size(m.force), of.size(m.older))
    over = of.least(of.times(k.overrun, size) >> SIGNAL, HIGHEST)
    return of.times(size, of.least(over + 1, HIGHEST))


def guard_tick(of, k, m, moved, before_change, wanted):
    still = GuardMemory()
    if of.decide(of.size(moved) > k.furthest) or of.decide(of.size(before_change) > k.furthest):
        return replace(still, account=m.account - lost(of, k, m)), False
    if of.decide(m.account < 0):
        account = m.account + k.refill + damped(of, k, of.size(moved))
        return replace(still, account=of.least(account, k.capacity)), True
    held = reserve(of, k, m.force)
    account = booked(of, k, m, moved, before_change)
    free = of.most(of.least(account, k.capacity) - held, 0)
    return GuardMemory(free + held, guard_within(of, wanted, largest_force(of, k, free)), m.force), True


def commanded(of, m, told):
    return replace(m, force=guard_within(of, told, of.size(m.force)))


def switched_off(of, k, m):
    account = m.account - reserve(of, k, m.older) if m.force == 0 else of.least(m.account, 0)
    return GuardMemory(account)


# `drive/src/command.rs`: converts a torque into the current command of a motor on the board's three-phase bridge.

Motor = namedtuple("Motor", "amps_per_nm nm_per_amp limit")
Command = namedtuple("Command", "q limited derated torque left")


def scaled(of, a, b, digits):
    return signal(of, of.times(a, b) >> digits)


def negated(of, x):
    return signal(of, -x)


def motor_command(of, k, torque, derating, against, map_):
    along = scaled(of, torque, k.amps_per_nm, 24)
    left = scaled(of, k.limit, of.least(derating, 1 << 16), 16)
    added = of.most(of.least(map_, left), negated(of, left))
    least, most = signal(of, negated(of, left) - added), signal(of, left - added)
    given = of.most(of.least(along, most), least)
    current = signal(of, given + added)
    q = of.either(against, negated(of, current), current)
    derated = derating < 1 << 16
    if of.decide(equal(given, along)):
        return Command(q, False, derated, torque, left)
    bound = scaled(of, of.either(given < 0, negated(of, least), most), k.nm_per_amp, 16)
    return Command(q, True, derated, of.most(of.least(torque, bound), negated(of, bound)), left)

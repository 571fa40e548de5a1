//! Guards, hands and laws for whoever compares the guard with its specification: any settings, hostile motions, any wanted force.

use super::guard::{Guard as Specified, Memory};
use fixed::types::I8F24;
use touchstone_control::{
    ChangeOfForce, Fixed32, Guard, GuardSettings, GuardState, GuardedDevice, Si,
};

/// Seeded numbers.
pub struct Random(pub u64);
impl Random {
    /// Any 64 bits.
    pub fn any(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.0 ^ self.0 >> 31
    }
    /// Below a bound.
    pub fn below(&mut self, bound: u64) -> u64 {
        (self.any() >> 8) % bound
    }
    /// Of any size up to so many bits, either sign.
    pub fn signed(&mut self, bits: u64) -> i64 {
        let size = (self.any() >> 1 >> (63 - bits) >> self.below(bits)).cast_signed();
        if self.any() & 4096 == 0 { size } else { -size }
    }
    /// Of `-size..=size`.
    pub fn within(&mut self, size: i64) -> i64 {
        (self.any() >> 20).cast_signed() % (2 * size + 1) - size
    }
    /// A setting of at most 2^bits, of any size.
    pub fn setting(&mut self, bits: u64) -> Si {
        Si::from_bits((self.any() >> (31 - bits) >> self.below(12) >> 1).cast_signed())
    }
}

/// Any settings with any device; not all are accepted.
pub fn any_settings(random: &mut Random) -> (GuardSettings, GuardedDevice) {
    let rate_hz = [5, 20, 100, 500, 1000, 2000, 4000, 10_000][random.below(8) as usize];
    let tick = Si::ONE / Si::from_num(rate_hz);
    let share = |random: &mut Random| {
        let eighths = Si::from_num(random.below(9)) / 8;
        if random.below(2) == 0 {
            eighths
        } else {
            Si::from_bits(random.below(1 << 32).cast_signed())
        }
    };
    let delay = tick * share(random);
    let settings = GuardSettings {
        on: true,
        capacity: random.setting(4),
        refill: random.setting(0),
        share_of_damping: Si::from_bits(random.below((1 << 32) + 1).cast_signed()),
        overspeed: random.setting(7),
        delay: if random.below(3) == 0 {
            Si::ZERO
        } else {
            delay
        },
        lag: if random.below(2) == 0 {
            Si::ZERO
        } else {
            (tick - delay) * share(random)
        },
        change: if random.below(4) == 0 {
            ChangeOfForce::Measured
        } else {
            ChangeOfForce::Estimated
        },
        damping: random.setting(0),
    };
    let device = GuardedDevice {
        rate_hz,
        force_limit: random.setting(6),
        count: Si::from_bits(random.below(429_496_730).cast_signed() >> random.below(20)),
    };
    (settings, device)
}

/// A guard's coefficients as the specification has them.
#[must_use]
pub fn specified(law: &Guard<Fixed32>) -> Specified {
    let signal = |x: I8F24| i128::from(x.to_bits());
    Specified {
        capacity: i128::from(law.capacity.0.to_bits()),
        refill: i128::from(law.refill.0.to_bits()),
        damping: i128::from(law.damping.0.to_bits()),
        furthest: signal(law.furthest.0),
        count: signal(law.count.0),
        late: signal(law.late.0),
        stray: signal(law.stray.0),
        slack: signal(law.slack.0),
        per_reach: i128::from(law.per_reach.0.to_bits()),
        in_flight: signal(law.in_flight.0),
        overrun: signal(law.overrun.0),
    }
}

/// Its memory.
#[must_use]
pub fn memory(state: &GuardState<Fixed32>) -> Memory {
    Memory {
        account: i128::from(state.account.0.to_bits()),
        force: i128::from(state.force.0.to_bits()),
        older: i128::from(state.older.0.to_bits()),
    }
}

/// The signal of so many quanta, at most the end of the format.
#[must_use]
pub fn bits(x: i64) -> I8F24 {
    I8F24::from_bits(x.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32)
}

/// How a hand moves at a tick: one of several habits.
pub fn moved(random: &mut Random, habit: u64, tick: u64, state: &Memory, furthest: i64) -> i64 {
    let speed = furthest >> (habit / 8 % 12);
    match habit % 8 {
        0 => random.signed(31),
        1 => random.within(speed + 1),
        // Out where the force is high, in where it is low.
        2 => {
            if state.force.abs() > state.older.abs() {
                -speed
            } else {
                speed
            }
        }
        // With the force, against it.
        3 => -(state.force.signum() as i64) * speed,
        4 => state.force.signum() as i64 * speed,
        5 => {
            if (tick / (1 + habit / 96)).is_multiple_of(2) {
                speed
            } else {
                -speed
            }
        }
        6 => 0,
        _ => {
            if tick.is_multiple_of(97) {
                furthest + random.within(3)
            } else {
                random.within(speed + 1)
            }
        }
    }
}

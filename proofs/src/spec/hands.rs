//! Random settings, hands and laws for tests that compare the code with its specification: any settings, hostile motions, any force
//! requested by the law.

use super::guard::Memory;
use fixed::types::I8F24;
use touchstone_control::{
    ChangeOfForce, FilterSettings, FirstContact, GuardSettings, GuardedDevice, IdealStep, LawKind,
    ObserverForm, OffsetUpdate, Regulate, Settings, Si,
};

/// Generator of seeded random numbers.
pub struct Random(pub u64);
impl Random {
    /// The next 64 random bits.
    pub fn any(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.0 ^ self.0 >> 31
    }
    /// A random number from 0 up to, not including, a bound.
    pub fn below(&mut self, bound: u64) -> u64 {
        (self.any() >> 8) % bound
    }
    /// A random number of up to this many bits, of either sign.
    pub fn signed(&mut self, bits: u64) -> i64 {
        let size = (self.any() >> 1 >> (63 - bits) >> self.below(bits)).cast_signed();
        if self.any() & 4096 == 0 { size } else { -size }
    }
    /// A random number from `-size` to `size`.
    pub fn within(&mut self, size: i64) -> i64 {
        (self.any() >> 20).cast_signed() % (2 * size + 1) - size
    }
    /// A random setting of at most `2^bits`, with a random order of magnitude.
    pub fn setting(&mut self, bits: u64) -> Si {
        Si::from_bits((self.any() >> (31 - bits) >> self.below(12) >> 1).cast_signed())
    }
}

/// Random settings of a guard and a device. Not all of them are accepted.
pub fn any_settings(random: &mut Random) -> (GuardSettings, GuardedDevice) {
    let usual = [5, 20, 100, 500, 1000, 2000, 4000, 10_000][random.below(8) as usize];
    // At unusual rates, rounding to digits of a tick has more effect.
    let most = 100_000 >> random.below(12);
    let other = 1 + random.below(most) as u32;
    let rate_hz = [usual, other][random.below(2) as usize];
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
        overspeed: if random.below(2) == 0 {
            random.setting(7)
        } else {
            random.setting(10).min(Si::const_from_int(1000))
        },
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

/// The position or force of this many steps of its format, limited to the range of the format.
#[must_use]
pub fn bits(x: i64) -> I8F24 {
    I8F24::from_bits(x.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32)
}

/// Displacement of a simulated hand in a tick. The number `habit` selects one of several patterns of motion, some of them hostile.
pub fn moved(random: &mut Random, habit: u64, tick: u64, state: &Memory, furthest: i64) -> i64 {
    let speed = furthest >> (habit / 8 % 12);
    match habit % 8 {
        0 => random.signed(31),
        1 => random.within(speed + 1),
        // Moves out while the force is large, and in while it is small.
        2 => {
            if state.force.abs() > state.older.abs() {
                -speed
            } else {
                speed
            }
        }
        // Moves with the force; in the next pattern against it.
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

/// A random setting: 0, the default, a multiple of it, or a number of any size.
fn near(random: &mut Random, default: &str) -> Si {
    let default = Si::from_str(default).expect("a number");
    match random.below(4) {
        0 => Si::ZERO,
        1 => default,
        2 => Si::from_bits((random.any() >> 16 >> random.below(40)).cast_signed()),
        _ => default * Si::from_num(random.below(64)) / 8,
    }
}

/// Random settings of a law. Not all of them are accepted.
pub fn any_law(random: &mut Random, law: LawKind) -> Settings {
    let one_of_two = |random: &mut Random| random.below(2) == 0;
    Settings {
        law,
        rate_hz: [100, 1000, 1000, 4000][random.below(4) as usize],
        k_desired: near(random, "5"),
        k_soft: near(random, "4.9"),
        device_damping: near(random, "0.0005"),
        virtual_damping: near(random, "0.0076"),
        observer: if one_of_two(random) {
            ObserverForm::Exact
        } else {
            ObserverForm::Thesis
        },
        count_device_damping: one_of_two(random),
        regulate: [Regulate::Hip, Regulate::Mass, Regulate::MassCompensated]
            [random.below(3) as usize],
        offset_update: [
            OffsetUpdate::EveryTick,
            OffsetUpdate::Inward,
            OffsetUpdate::TurnInward,
        ][random.below(3) as usize],
        ideal_step: if one_of_two(random) {
            IdealStep::Force
        } else {
            IdealStep::Position
        },
        first_contact: if one_of_two(random) {
            FirstContact::KeepForce
        } else {
            FirstContact::ZeroOffset
        },
        step_of_ideal: near(random, "0.21"),
        limit_of_force: near(random, "0.41"),
        limit_of_penetration: near(random, "0.4"),
        energy_credit: near(random, "0.02"),
        force_limit: near(random, "0.5"),
        filter: FilterSettings {
            mass: near(random, "0.00000068"),
            stiffness: near(random, "29.6"),
            damping: near(random, "0.00655"),
            ground_damping: near(random, "0.00356"),
        },
        ..Settings::default()
    }
}

/// A simulated hand that gives penetration and displacement of each next tick: a press and its release, trembling at the surface,
/// and jumps. Sometimes the displacement does not match the penetration, as can happen with an estimator.
pub struct Hand {
    habit: u64,
    at: i64,
}
impl Hand {
    /// A hand just outside the wall, with a random pattern of motion.
    pub fn any(random: &mut Random) -> Self {
        Self {
            habit: random.any() >> 20,
            at: -1000,
        }
    }

    /// Penetration and displacement of the next tick, which may depend on the last force.
    pub fn moves(&mut self, random: &mut Random, tick: u64, force: i128) -> (I8F24, I8F24) {
        let before = self.at;
        let speed = 1_i64 << (self.habit / 8 % 22);
        let step = match self.habit % 8 {
            0 => random.within(speed),
            1 => {
                if tick % 200 < 60 {
                    speed
                } else if tick % 200 < 120 {
                    -speed / 3
                } else {
                    random.within(speed / 4 + 1)
                }
            }
            2 => {
                if force > 1 << 20 {
                    -speed
                } else {
                    speed
                }
            }
            3 => {
                if tick % 4 < 2 {
                    speed
                } else {
                    -speed
                }
            }
            4 => random.signed(31) - self.at,
            5 => {
                if tick % 100 < 50 {
                    speed
                } else {
                    -speed - 1
                }
            }
            6 => random.within(3),
            _ => {
                if self.at > speed * 20 {
                    -speed * 7
                } else {
                    random.within(speed) + speed / 8
                }
            }
        };
        self.at = (self.at + step).clamp(-(1 << 31), (1 << 31) - 1);
        let moved = if random.below(16) == 0 {
            random.signed(31)
        } else {
            self.at - before
        };
        (bits(self.at), bits(moved))
    }
}

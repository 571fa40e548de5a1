//! Tests that the guard as a stage of the controller equals its specification, which knows the true position. Subjects are the
//! displacement that the stage measures, the end of positions, and the mirrored axis.

use touchstone_control::{Fixed32, Force, Guard, Guarded, Position};
use touchstone_proofs::spec::guard as spec;
use touchstone_proofs::spec::hands::{Random, any_settings, bits};
use touchstone_proofs::specified::at32::{guard as specified, of_guard as memory};

type N = Fixed32;
const HIGHEST: i64 = i32::MAX as i64;

fn quanta(x: Position<N>) -> i64 {
    i64::from(x.0.to_bits())
}

/// Specification of the stage: the guard's specification, and the device's true position in steps of the position format.
struct Stage {
    guard: spec::Guard,
    memory: spec::Memory,
    last: Option<i64>,
    tripped: bool,
}

impl Stage {
    fn tick(&mut self, e: i64, at_change: Option<i64>, wanted: i64) -> i128 {
        let last = self.last.replace(e).unwrap_or(e);
        let furthest = self.guard.furthest as i64;
        let edge = (HIGHEST - furthest).max(-HIGHEST - 1) - furthest;
        let edge = edge.max(-HIGHEST - 1);
        let since = |x: i64| i128::from((x - last).clamp(-HIGHEST - 1, HIGHEST));
        // The negative of the lowest number does not fit the format.
        let other = (-edge).min(HIGHEST);
        self.tripped |= wanted != 0 && (e >= edge || e <= other);
        let before_change = at_change.map_or(0, since);
        let (next, fine) =
            self.guard
                .tick(&self.memory, since(e), before_change, i128::from(wanted));
        self.memory = next;
        self.tripped |= !fine;
        if self.tripped {
            self.memory.force = 0;
        }
        self.memory.force
    }
}

#[test]
fn every_tick_of_the_stage_is_its_specification() {
    let mut random = Random(3);
    let (mut ends, mut overspeeds, mut forces, mut changes) = ([0_u32; 2], 0_u32, 0_u32, 0_u32);
    for _ in 0..20_000 {
        let (settings, device) = any_settings(&mut random);
        let Ok(guard) = Guard::<N>::new(&settings, &device) else {
            continue;
        };
        let mut stage = Guarded::new(guard);
        assert!(!stage.tripped && !stage.limited && stage.last.is_none());
        let mut expected = Stage {
            guard: specified(&guard),
            memory: memory(&guard.full()),
            last: None,
            tripped: false,
        };
        let furthest = quanta(guard.furthest);
        // In the middle of the range, or close to where forces end, on either side.
        let edge = HIGHEST - 2 * furthest;
        let mut at = match random.below(3) {
            0 => random.signed(31),
            1 => edge - random.within(3) - 3,
            _ => -edge + random.within(3) + 3,
        };
        for _ in 0..30 {
            let most = if random.below(16) == 0 { 3 } else { 0 };
            at = (at + random.within((furthest + 1) << most) / 4).clamp(-HIGHEST - 1, HIGHEST);
            let at_change = match random.below(2) {
                0 => None,
                _ => Some((at + random.within(furthest / 4)).clamp(-HIGHEST - 1, HIGHEST)),
            };
            let wanted = i64::from(bits(random.signed(31)).to_bits());
            let was = expected.tripped;
            let last = expected.last;
            let force = expected.tick(at, at_change, wanted);
            let told = stage.tick(
                Position(bits(at)),
                at_change.map(|x| Position(bits(x))),
                Force(bits(wanted)),
            );
            assert_eq!(
                (i128::from(told.0.to_bits()), stage.tripped),
                (force, expected.tripped),
                "{settings:?} {device:?} {last:?} {at} {at_change:?} {wanted}"
            );
            assert_eq!(memory(&stage.state), expected.memory);
            assert_eq!(stage.limited, told != Force(bits(wanted)));
            assert_eq!(stage.last, Some(Position(bits(at))));
            if expected.tripped && !was {
                let beyond = at >= edge || at <= -edge;
                ends[usize::from(at < 0)] += u32::from(beyond);
                overspeeds += u32::from(!beyond);
            }
            forces += u32::from(force != 0);
            changes += u32::from(force != 0 && at_change.is_some());
        }
    }
    println!("ended at either end: {ends:?}, {overspeeds} overspeeds, {forces} forces");
    assert!(ends.iter().all(|count| *count > 100) && overspeeds > 100 && changes > 1000);
}

#[test]
fn from_the_other_end_of_the_axis_it_is_the_same() {
    let mut random = Random(4);
    let mut turned = 0_u32;
    for _ in 0..5_000 {
        let (settings, device) = any_settings(&mut random);
        let Ok(guard) = Guard::<N>::new(&settings, &device) else {
            continue;
        };
        let (mut stage, mut seen) = (Guarded::new(guard), Guarded::new(guard));
        let furthest = quanta(guard.furthest);
        for _ in 0..30 {
            let some = |random: &mut Random| bits(random.within(furthest / 8));
            let (moved, before_change) = (some(&mut random), some(&mut random));
            let wanted = bits(random.signed(31).max(-HIGHEST));
            let told =
                stage.moved_mirrored(Position(moved), Position(before_change), Force(wanted));
            let other = seen.moved(Position(-moved), Position(-before_change), Force(-wanted));
            assert_eq!(told, -other);
            let spec::Memory {
                account,
                force,
                older,
            } = memory(&seen.state);
            let mirrored = spec::Memory {
                account,
                force: -force,
                older: -older,
            };
            assert_eq!(memory(&stage.state), mirrored, "{settings:?} {device:?}");
            turned += u32::from(force != 0 && older != 0 && force != older);
        }
    }
    assert!(turned > 1000, "{turned}");
}

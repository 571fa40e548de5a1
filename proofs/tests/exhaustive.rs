//! Tests the unsigned arithmetic (`magnitude`) and the signed functions built on it, at 8 bits on all inputs, against plain
//! arithmetic in wider integers.

use touchstone_control::magnitude::{affordable, passivity_step, quotient, root, scale};
use touchstone_control::{Fixed8, Number};

const FULL: u32 = (1 << 15) - 1;

#[test]
fn every_passivity_step() {
    let mut clamped = 0_u64;
    for force in 0..=128_u8 {
        for moved in 0..=128_u8 {
            let work = u32::from(force) * u32::from(moved);
            for energy in 0..=FULL {
                let inward = passivity_step::<u8>(energy as u16, force, moved, true);
                assert!(
                    u32::from(inward.energy) == (energy + work).min(FULL) && inward.force == force
                );
                let outward = passivity_step::<u8>(energy as u16, force, moved, false);
                let paid = u32::from(outward.force) * u32::from(moved);
                // The energy falls by exactly the work of the reduced force, which is the largest that the energy covers.
                assert!(u32::from(outward.energy) + paid == energy);
                if work <= energy {
                    assert!(outward.force == force);
                } else {
                    clamped += 1;
                    assert!(outward.force < force && u32::from(outward.energy) < u32::from(moved));
                }
            }
        }
    }
    assert!(clamped > 1_000_000);
}

#[test]
fn every_signed_step_is_the_heart_s() {
    type Signal = <Fixed8 as Number>::Signal;
    type Energy = <Fixed8 as Number>::Energy;
    for energy in (0..=i16::MAX).step_by(7).chain([1, 2, i16::MAX]) {
        for force in 0..=i8::MAX {
            for moved in i8::MIN..=i8::MAX {
                let (after, shown) = Fixed8::passivity_step(
                    Energy::from_bits(energy),
                    Signal::from_bits(force),
                    Signal::from_bits(moved),
                );
                let work = i32::from(shown.to_bits()) * i32::from(moved);
                let sum = i32::from(energy) + work;
                assert!(i32::from(after.to_bits()) == sum.min(FULL as i32) && sum >= 0);
                assert!(shown.to_bits() >= 0 && shown.to_bits() <= force);
            }
        }
    }
}

#[test]
fn every_retreat() {
    for force in 0..=128_u8 {
        for energy in 0..=FULL {
            let retreat = affordable::<u8>(energy as u16, force);
            let cost = u32::from(force) * u32::from(retreat.moved);
            assert!(cost + u32::from(retreat.rest) == energy);
            assert!(
                retreat.moved == 127 || force == 0 || u32::from(retreat.rest) < u32::from(force)
            );
            // P1 of the enhanced law, for every smaller force.
            for smaller in 0..=force {
                let saved = u32::from(force - smaller) * u32::from(retreat.moved);
                let work = u32::from(smaller) * u32::from(retreat.moved);
                assert!(u32::from(retreat.rest) + saved + work == energy);
            }
        }
    }
}

#[test]
fn every_root_scale_and_quotient() {
    for radicand in 0..=u16::MAX {
        let found = root::<u8>(radicand);
        assert!(u16::from(found.root) == radicand.isqrt());
        assert!(u32::from(found.square) == u32::from(found.root).pow(2));
    }
    for gain in 0..=255_u8 {
        for x in 0..=255_u8 {
            for bits in 0..16 {
                let exact = (u32::from(gain) * u32::from(x)) >> bits;
                assert!(u32::from(scale::<u8>(gain, x, bits)) == exact.min(127));
            }
        }
    }
    for wide in 0..=u16::MAX {
        for divisor in 0..=255_u8 {
            let exact = wide.checked_div(u16::from(divisor)).unwrap_or(0);
            assert!(u16::from(quotient::<u8>(wide, divisor)) == exact.min(127));
        }
    }
}

/// Checks for all 8-bit arguments the facts by which `proofs/src/divided.rs` replaces divisions.
#[test]
fn every_division_is_a_floor_with_its_sign() {
    type Signal = <Fixed8 as Number>::Signal;
    type Energy = <Fixed8 as Number>::Energy;
    let floor = |a: u16, b: u16| a.checked_div(b).unwrap_or(0).min(127);
    for p in i16::MIN..=i16::MAX {
        for k in 0..=u8::MAX {
            let size = floor(p.unsigned_abs(), u16::from(k)) as i8;
            let expected = if p < 0 { -size } else { size };
            assert!(Fixed8::divide_by(p, &k) == Signal::from_bits(expected));
        }
        let energy = p.max(0).unsigned_abs();
        for f in i8::MIN..=i8::MAX {
            let (moved, rest) = Fixed8::affordable(Energy::from_bits(p), Signal::from_bits(f));
            let size = u16::from(f.unsigned_abs());
            let out = floor(energy, size);
            assert!(moved == Signal::from_bits(out as i8));
            assert!(rest == Energy::from_bits((energy - out * size) as i16));
        }
    }
}

//! Prints control periods (ticks) computed by the shipped code. The specification extracted from Coq (`proofs/coq/`) must reproduce
//! them. For the guard and the laws TDPA, FBA and enhanced it prints the coefficients, and for each tick the inputs, the memory and
//! the output. It also prints the guard's coefficients for settings, invalid ones included, and integer roots.
//!
//! `cargo run --release -p touchstone-proofs --example trace -- TICKS`.

use std::io::{BufWriter, Result, Write};
use touchstone_control::law::{Law as _, Sample};
use touchstone_control::magnitude;
use touchstone_control::space::root;
use touchstone_control::{
    AnyLaw, ChangeOfForce, Fixed32, Force, Guard, GuardSettings, GuardedDevice, LawKind,
    ObserverForm, Position, Settings, Si,
};
use touchstone_proofs::spec::enhanced;
use touchstone_proofs::spec::hands::{Hand, Random, any_law, any_settings, bits, moved};
use touchstone_proofs::specified::at32::{
    enhanced as specified_enhanced, guard as specified, of_enhanced, of_guard as memory,
};

fn main() -> Result<()> {
    let ticks = std::env::args().nth(1).and_then(|text| text.parse().ok());
    let ticks: u64 = ticks.unwrap_or(20_000);
    let mut out = BufWriter::new(std::io::stdout().lock());
    guards(&mut out, ticks)?;
    settings_alone(&mut out, ticks / 14)?;
    roots(&mut out, ticks / 60)?;
    for kind in [LawKind::Tdpa, LawKind::Fba] {
        laws(&mut out, kind, ticks / 4)?;
    }
    enhanced_laws(&mut out, 2 * ticks)?;
    out.flush()
}

/// Prints integer square roots of numbers of every length, and of squares and their neighbours, where the root changes.
fn roots(out: &mut impl Write, draws: u64) -> Result<()> {
    let mut random = Random(9);
    for _ in 0..draws {
        let any = (random.any() as u32) >> random.below(32);
        let square = u64::from(any) * u64::from(any);
        let anything = random.any() >> random.below(64);
        for n in [
            anything,
            square,
            square.wrapping_sub(1),
            square + 2 * u64::from(any),
        ] {
            let by_digits = magnitude::root::<u32>(n).root;
            writeln!(out, "root_64 {n} {by_digits} {}", root::root_64(n))?;
            let half = (n >> 32) as u32 >> random.below(32);
            writeln!(out, "root_32 {half} {}", root::root_32(half))?;
            // After the shift one of the four highest bits is set.
            let high = n.max(1) << (n.max(1).leading_zeros() & !3);
            writeln!(out, "root_high_64 {high} {}", root::root_high_64(high))?;
            let half = (high >> 32) as u32;
            writeln!(out, "root_high_32 {half} {}", root::root_high_32(half))?;
        }
    }
    Ok(())
}

/// Prints ticks of the laws TDPA or FBA (time-domain passivity, force bounding) over contacts of every type.
fn laws(out: &mut impl Write, kind: LawKind, wanted_ticks: u64) -> Result<()> {
    let mut random = Random(5);
    let mut ticks = 0;
    while ticks < wanted_ticks {
        let Ok(mut law) = AnyLaw::<Fixed32>::new(&any_law(&mut random, kind)) else {
            continue;
        };
        match &law {
            AnyLaw::Tdpa(it, _) => {
                let exact = u8::from(it.observer == ObserverForm::Exact);
                let [k, c] = [it.desired, it.device_damping].map(|k| k.0.to_bits());
                writeln!(out, "tdpa {k} {exact} {c} {}", it.limit.0.to_bits())?;
            }
            AnyLaw::Fba(it, _) => {
                let [k, c] = [it.desired, it.device_damping].map(|k| k.0.to_bits());
                writeln!(out, "fba {k} {c} {}", it.limit.0.to_bits())?;
            }
            _ => {}
        }
        let mut hand = Hand::any(&mut random);
        let mut force = 0;
        for tick in 0..200 {
            ticks += 1;
            let (e, moved) = hand.moves(&mut random, tick, force);
            let sample = Sample {
                e: Position(e),
                moved: Position(moved),
            };
            let (shown, energy) = match &mut law {
                AnyLaw::Tdpa(it, state) => (it.tick(state, sample), state.energy),
                AnyLaw::Fba(it, state) => (it.tick(state, sample), state.energy),
                _ => continue,
            };
            force = i128::from(shown.0.to_bits());
            writeln!(
                out,
                "law {} {} {force} {}",
                e.to_bits(),
                moved.to_bits(),
                energy.0.to_bits()
            )?;
        }
    }
    Ok(())
}

/// Prints ticks of the enhanced law over contacts of every type, each with the law's whole memory.
fn enhanced_laws(out: &mut impl Write, wanted_ticks: u64) -> Result<()> {
    let mut random = Random(6);
    let mut ticks = 0;
    while ticks < wanted_ticks {
        // The theorems are about the wall without the parallel damper, which adds to the force and changes no memory.
        let settings = Settings {
            virtual_damping: Si::ZERO,
            ..any_law(&mut random, LawKind::EnhancedSfa)
        };
        // With a desired stiffness up to `k_v`, the enhanced law is a plain spring.
        let Ok(AnyLaw::Enhanced(law, mut state)) = AnyLaw::<Fixed32>::new(&settings) else {
            continue;
        };
        // The code's divisors are calculated from the settings, rounded towards zero to a gain's digits.
        let series = i128::from((settings.filter.stiffness + settings.k_soft).to_bits() >> 20);
        let it = specified_enhanced(&law, series);
        write!(out, "enhanced")?;
        for value in [
            it.desired,
            it.target,
            it.soft,
            it.compliance,
            it.of_ideal,
            it.of_force,
            it.of_penetration,
            i128::from(it.at_hip),
            i128::from(it.every_tick),
            i128::from(it.exact),
            i128::from(it.keep_force),
            it.inertia,
            it.coupling,
            it.damping,
            it.total,
            it.series,
            it.credit,
            it.limit,
        ] {
            write!(out, " {value}")?;
        }
        writeln!(out)?;
        let mut hand = Hand::any(&mut random);
        let mut force = 0;
        for tick in 0..500 {
            ticks += 1;
            let (e, moved) = hand.moves(&mut random, tick, force);
            let sample = Sample {
                e: Position(e),
                moved: Position(moved),
            };
            force = i128::from(law.tick(&mut state, sample).0.to_bits());
            let m = of_enhanced(&state);
            let contact = match m.contact {
                enhanced::Contact::Free => 0,
                enhanced::Contact::First => 1,
                enhanced::Contact::Augmenting => 2,
            };
            write!(
                out,
                "mass {} {} {force} {contact}",
                e.to_bits(),
                moved.to_bits()
            )?;
            for value in [
                m.last,
                m.force,
                m.energy,
                m.mass,
                m.mass_moved,
                m.offset,
                m.at_mass,
            ] {
                write!(out, " {value}")?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}

fn coefficients(out: &mut impl Write, law: &Guard<Fixed32>) -> Result<()> {
    let g = specified(law);
    for value in [
        g.capacity,
        g.refill,
        g.damping,
        g.furthest,
        g.count,
        g.late,
        g.stray,
        g.slack,
        g.per_reach,
        g.in_flight,
        g.overrun,
    ] {
        write!(out, " {value}")?;
    }
    writeln!(out)
}

/// Prints settings of the guard, and the coefficients that follow from them, or that the settings are refused.
fn guard_of(
    out: &mut impl Write,
    settings: &GuardSettings,
    device: &GuardedDevice,
) -> Result<Option<Guard<Fixed32>>> {
    write!(out, "settings")?;
    for value in [
        settings.capacity,
        settings.refill,
        settings.share_of_damping,
        settings.damping,
        settings.overspeed,
        settings.delay,
        settings.lag,
    ] {
        write!(out, " {}", value.to_bits())?;
    }
    let measured = u8::from(settings.change == ChangeOfForce::Measured);
    let [limit, count] = [device.force_limit, device.count].map(Si::to_bits);
    writeln!(out, " {measured} {} {limit} {count}", device.rate_hz)?;
    let law = Guard::new(settings, device).ok();
    match &law {
        Some(law) => {
            write!(out, "made")?;
            coefficients(out, law)?;
        }
        None => writeln!(out, "refused")?,
    }
    Ok(law)
}

/// Prints settings around each end of the accepted ranges, with the guard's coefficients, but without ticks.
fn settings_alone(out: &mut impl Write, draws: u64) -> Result<()> {
    let mut random = Random(8);
    for _ in 0..draws {
        let (mut settings, mut device) = any_settings(&mut random);
        for _ in 0..random.below(4) {
            strays(&mut random, &mut settings, &mut device);
        }
        guard_of(out, &settings, &device)?;
    }
    Ok(())
}

/// Moves one setting of the guard to an end of its range, a little beyond it, or to a size that does not fit the format.
fn strays(random: &mut Random, settings: &mut GuardSettings, device: &mut GuardedDevice) {
    let whole = Si::const_from_int;
    let end = |random: &mut Random, most: Si| {
        let end = [Si::ZERO, most][random.below(2) as usize];
        end.saturating_add(Si::from_bits(random.within(2)))
    };
    let tick = whole(1).saturating_div(Si::saturating_from_num(device.rate_hz.max(1)));
    match random.below(15) {
        0 => settings.capacity = end(random, whole(16)),
        1 => settings.refill = end(random, whole(1)),
        2 => settings.share_of_damping = end(random, whole(1)),
        3 => settings.damping = end(random, whole(1000)),
        4 => settings.damping = random.setting(10),
        5 => settings.overspeed = end(random, whole(1000)),
        6 => settings.overspeed = Si::lit("0.001") + Si::from_bits(random.within(2)),
        7 => settings.delay = end(random, tick),
        8 => settings.lag = end(random, tick.saturating_sub(settings.delay)),
        9 => device.force_limit = end(random, whole(1000)),
        10 => device.force_limit = end(random, whole(128)),
        11 => device.count = end(random, Si::lit("0.1")),
        // 12: a largest displacement of a quarter of the format, 32 rad. 13: nearly as much, with a delay of a whole tick, so that
        // the older force acts over the whole displacement.
        12 => settings.overspeed = whole(32).saturating_mul(Si::from_num(device.rate_hz.min(1000))),
        13 => {
            device.rate_hz = 1 + random.below(30) as u32;
            let rate = Si::from_num(device.rate_hz);
            device.count = Si::lit("0.0999");
            let way = Si::lit("31.8") + Si::from_bits(random.below(1 << 29).cast_signed());
            settings.overspeed = way.saturating_mul(rate);
            settings.delay = whole(1).saturating_div(rate);
            settings.lag = Si::ZERO;
        }
        _ => {
            let any = random.any() as u32;
            device.rate_hz = [0, 1, 2, 3, 100_000, 100_001, 1 << 31, (1 << 31) - 1, any]
                [random.below(9) as usize];
        }
    }
}

fn guards(out: &mut impl Write, wanted_ticks: u64) -> Result<()> {
    let mut random = Random(3);
    let mut ticks = 0;
    while ticks < wanted_ticks {
        let (settings, device) = any_settings(&mut random);
        let Some(law) = guard_of(out, &settings, &device)? else {
            continue;
        };
        write!(out, "guard")?;
        coefficients(out, &law)?;
        let mut state = law.full();
        let habit = random.any() >> 16;
        for tick in 0..200 {
            ticks += 1;
            let furthest = i64::from(law.furthest.0.to_bits());
            let moved = bits(moved(&mut random, habit, tick, &memory(&state), furthest));
            let wanted = bits(random.signed(31));
            let before_change = if settings.change == ChangeOfForce::Measured {
                bits(random.signed(31 - habit % 12))
            } else {
                bits(0)
            };
            // Sometimes the force is switched off after this tick: if `ends` is 0, after a tick that commanded no force; if it is
            // 1, under a force.
            let ends = random.below(60);
            let told = bits(if ends == 0 { 0 } else { random.signed(31) });
            let answer = law.tick_with_change(
                &mut state,
                Position(moved),
                Position(before_change),
                Force(wanted),
            );
            let (after, fine) = (memory(&state), answer.is_ok());
            law.commanded(&mut state, Force(told));
            let force = memory(&state).force;
            writeln!(
                out,
                "tick {} {} {} {} {} {} {} {} {force}",
                moved.to_bits(),
                before_change.to_bits(),
                wanted.to_bits(),
                told.to_bits(),
                after.account,
                after.force,
                after.older,
                u8::from(fine),
            )?;
            if ends < 2 {
                law.switched_off(&mut state);
                let off = memory(&state);
                writeln!(out, "off {} {} {}", off.account, off.force, off.older)?;
            }
        }
    }
    Ok(())
}

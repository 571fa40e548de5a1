//! Properties of the drive's arithmetic between a force and the power stage: the torque that fades in, its current, the current's
//! voltage, compare values of the PWM timer, angles, and the mailbox of commands.

use crate::source::Source;
use crate::{assume, cover, property, replaced_property, such};
#[cfg(kani)]
use core::sync::atomic::Ordering::Relaxed;
use fixed::types::I8F24;
use fixed::types::I16F16;
use touchstone_control::Force;
use touchstone_drive::Angle;
use touchstone_drive::Si;
use touchstone_drive::angle::ElectricalScale;
use touchstone_drive::command::{Drive as _, DriveCommand, Rotor, ThreePhase};
use touchstone_drive::current::{CurrentCommand, CurrentMode};
use touchstone_drive::device::torque_of;
use touchstone_drive::modulation::Modulator;
use touchstone_drive::pi::{Pi, PiGains};
use touchstone_drive::transform::{AlphaBeta, Dq};
use touchstone_drive::units::{product, share_of};
use touchstone_protocol::{DeviceSettings, Limit};

fn any_value<S: Source>(s: &mut S) -> I16F16 {
    I16F16::from_bits(s.i32())
}

property! {
    /// P4 (limits): for every requested voltage and every bus voltage, each compare value of the PWM timer leaves enough time to
    /// sample the shunts; no overflow, no panic.
    equation "top - longest <= duty <= longest"
    over "timer, voltage vector, bus voltage"
    by minisat fn p4_duties32(s) {
        let timer = Modulator { top: s.u16(), longest: s.u16() };
        assume!(s, timer.longest <= timer.top && timer.top - timer.longest <= timer.longest, "the boards' constants: a test");
        let vector = AlphaBeta { alpha: any_value(s), beta: any_value(s) };
        let bus = any_value(s);
        let duties = timer.duties(vector, bus);
        for duty in duties {
            assert_reached!(duty >= timer.top - timer.longest && duty <= timer.longest);
        }
        assert!(bus > I16F16::ONE || duties == timer.zero());
        cover!(s, duties[0] == timer.longest && duties[1] < duties[0] && bus > 5, "at the limit");
        cover!(s, bus < 0, "no bus");
    }
}
/// The product of a force and a fraction in units of 2^-31, rounded down.
fn part_of(force: i32, share: u32) -> i64 {
    (i64::from(force) * i64::from(share)).div_euclid(1 << 31)
}
/// Whether a result is 0 or has the sign of the product of `a` and `b`.
fn has_sign(found: i32, a: i32, b: i32) -> bool {
    found == 0 || a != 0 && b != 0 && (found < 0) == ((a < 0) != (b < 0))
}
/// Whether `part` lies between 0 and `whole`.
fn is_part(part: i64, whole: i64) -> bool {
    part >= whole.min(0) && part <= whole.max(0)
}

property! {
    /// P3 (arithmetic): the drive's fixed-point product is the exact product, rounded down and limited to a word.
    equation "p = floor(x y 2^-k), not beyond the format, k = 16, 24, 31"
    over "two words"
    by kissat fn p3_product32(s) {
        let (x, y) = (s.i32(), s.i32());
        let digits = match s.u8() % 3 {
            0 => 16,
            1 => 24,
            _ => 31,
        };
        // A product of two words does not wrap.
        let exact = i64::from(x).wrapping_mul(i64::from(y));
        let found = product(x, y, digits);
        // The definition of rounding down, as in obligations/check.py. At an end of the format the exact product may lie beyond it.
        let back = i64::from(found) << digits;
        assert!(found == i32::MIN || back <= exact);
        assert!(found == i32::MAX || exact - back < 1 << digits);
        cover!(s, x < 0 && found == i32::MAX, "the end");
    }
}
property! {
    /// P3 (arithmetic): a fraction of the difference between two words is rounded to the nearest. The current controller's
    /// integrator uses it.
    equation "p = floor(x s 2^-16 + 1/2), s < 2^16"
    over "two words, share"
    by kissat fn p3_part_of_way32(s) {
        let way = such!(s, s.i64(), |way| way.unsigned_abs() < 1 << 32, "type of words");
        let share = s.u16();
        let part = share_of(way, share);
        // A product of 33 and 16 bits does not wrap.
        let exact = way.wrapping_mul(i64::from(share)) + (1 << 15);
        assert!(part << 16 <= exact && exact - (part << 16) < 1 << 16);
        cover!(s, part < 0, "back");
        cover!(s, way > i64::from(u32::MAX) - 2 && part < way, "furthest");
    }
}
property! {
    /// P3 (arithmetic): the rounded products have the facts that the model checker assumes of them: they have the right sign and
    /// lie between 0 and the factor. Two solvers show it over the integers in `obligations/check.py`.
    equation "p = 0 or x y p > 0; p between 0 and x for y < 2^31 from 0 on; of a way the same"
    over "two words; two words, share"
    by sampled fn p3_parts_of_words(s) {
        let (x, y, digits) = (s.i32(), s.i32(), [16, 24, 31][usize::from(s.u8() % 3)]);
        let found = product(x, y, digits);
        assert!(has_sign(found, x, y));
        let share = s.u32() >> 1;
        assert!(is_part(product(x, share.cast_signed(), 31).into(), x.into()));
        let way = such!(s, s.i64(), |way| way.unsigned_abs() < 1 << 32, "type of words");
        assert!(is_part(share_of(way, s.u16()), way));
        cover!(s, found < 0, "negative");
    }
}

/// Replaces [`product`] when the model checker runs: any result that has the facts of [`p3_parts_of_words`].
#[cfg(kani)]
pub fn any_product(a: i32, b: i32, shift: u32) -> i32 {
    let found = kani::any();
    kani::assume(has_sign(found, a, b));
    if shift == 31 {
        kani::assume(b < 0 || is_part(i64::from(found), a.into()));
        for (place, word) in ASKED.iter().zip([a, b, found]) {
            place.store(word, Relaxed);
        }
    }
    found
}
/// Replaces [`part_of`] when the model checker runs: the code's product, if the code has multiplied the same numbers.
#[cfg(kani)]
pub fn same_part(force: i32, share: u32) -> i64 {
    let any: i32 = kani::any();
    let is_same = ASKED[0].load(Relaxed) == force && ASKED[1].load(Relaxed) == share.cast_signed();
    i64::from(if is_same { ASKED[2].load(Relaxed) } else { any })
}
/// Replaces [`share_of`] when the model checker runs: any value that has the facts of [`p3_parts_of_words`].
#[cfg(kani)]
pub fn any_share(way: i64, _: u16) -> i64 {
    let found = kani::any();
    kani::assume(is_part(found, way));
    found
}
#[cfg(kani)]
static ASKED: [core::sync::atomic::AtomicI32; 3] =
    [const { core::sync::atomic::AtomicI32::new(0) }; 3];

replaced_property! {
    [(touchstone_drive::units::product, crate::drive::any_product)
    (crate::drive::part_of, crate::drive::same_part)]
    /// P4 (limits): the torque is the negative of the force. While the torque fades in, it is a fraction of that: never larger than
    /// the force, and never of the force's sign.
    equation "τ = -floor(f s 2^-31), s < 2^31; τ = -f without"
    over "force, share or none; under the checker a part of which p3_parts_of_words holds"
    by cadical fn p4_fade_in32(s) {
        let (force, share) = (s.i32(), s.bool().then_some(s.u32()));
        let torque = i64::from(torque_of(Force(I8F24::from_bits(force)), share).0.to_bits());
        let (whole, highest) = (i64::from(force), i64::from(i32::MAX));
        let part = share.map_or(whole, |share| part_of(force, share >> 1));
        assert!(torque == (-part).min(highest));
        assert!(torque.abs() <= whole.abs() && (torque == 0 || (torque > 0) == (force < 0)));
        cover!(s, torque < 0 && torque > -whole, "fades in");
        cover!(s, torque == highest, "the lowest force");
    }
}
/// Replaces the quotient that gives a motor's coefficient, when the model checker runs: any value.
#[cfg(kani)]
pub fn any_quotient(_: Si, _: Si) -> Si {
    Si::from_bits(kani::any())
}
replaced_property! {
    [(touchstone_drive::units::product, crate::drive::any_product)
    (touchstone_control::quotient::quotient, crate::drive::any_quotient)]
    /// P4 (limits): for every requested torque, the motor's current is along the q-axis alone and turns the motor in the right
    /// direction. It is within the current limit as reduced by temperature. The torque that the drive reports is not larger than
    /// the requested one, and equal to it if the current was not cut.
    equation "|i_q| <= i_max min(θ, 1), ±i_q τ >= 0, i_d = 0; |τ'| <= |τ|, τ' τ >= 0"
    over "torque, share of the current that the temperature leaves, direction of the encoder, current limit; torque constants whose inverse fits, under the checker whatever a product is"
    by kissat fn p4_current32(s) {
        let mut motor = DeviceSettings::default().motor;
        // The ranges of settings keep both from being negative.
        let (limit, constant) = (s.u32() >> 1, s.u64() >> 1);
        motor.current_limit_a = Si::from_bits(i64::from(limit) << 16);
        motor.torque_constant_n_m_per_a = Si::from_bits(constant.cast_signed());
        let Ok(drive) = ThreePhase::new(&motor) else {
            return;
        };
        let torque = Force(I8F24::from_bits(s.i32()));
        let (tick, angle, advance) = (s.u32(), Angle(s.u16()), s.i32());
        let rotor = Rotor { tick, angle, advance, derating: s.u32(), against: s.bool(), ..Rotor::default() };
        let driven = drive.command(torque, &rotor);
        let DriveCommand::Current(command) = driven.command else {
            unreachable!("a motor on this board's bridge has a current");
        };
        let left = i64::from(limit).wrapping_mul(rotor.derating.min(1 << 16).into()) >> 16;
        let q = i64::from(command.current.q.to_bits());
        assert!(command.current.d == 0 && q.abs() <= left);
        assert!(command.mode == CurrentMode::Drive && command.tick == tick);
        assert!(command.angle == angle && command.advance == advance);
        let (asked, shown) = (i64::from(torque.0.to_bits()), i64::from(driven.torque.0.to_bits()));
        assert!(shown.abs() <= asked.abs() && (shown == 0 || (shown > 0) == (asked > 0)));
        assert!(q == 0 || ((q > 0) != rotor.against) == (asked > 0));
        assert!(driven.limits.has(Limit::Current) || shown == asked);
        assert!(driven.limits.has(Limit::Temperature) == (rotor.derating < 1 << 16));
        cover!(s, shown != asked && shown > 0, "cut");
        cover!(s, shown == asked && shown < 0 && rotor.against, "not cut");
    }
}
replaced_property! {
    [(touchstone_drive::units::product, crate::drive::any_product)
    (touchstone_drive::units::share_of, crate::drive::any_share)]
    /// P4 (limits): a current controller's voltage is within its limit, for every error and every memory. The integrator's absolute
    /// value is at most the limit or its former absolute value.
    equation "|v| <= v_max, |s'| <= max(|s|, v_max)"
    over "gains, error, limit from 0 on, memory; under the checker any product, and a share of which p3_parts_of_words holds"
    by cadical fn p4_current_loop32(s) {
        let gains = PiGains { proportional: any_value(s), share: s.u16() };
        let (error, limit, before) = (any_value(s), I16F16::from_bits((s.u32() >> 1).cast_signed()), any_value(s));
        let size = |v: I16F16| i64::from(v.to_bits()).abs();
        let mut pi = Pi::of(before);
        let (given, limited) = pi.tick(&gains, error, limit);
        assert!(size(given) <= size(limit) && size(pi.integral()) <= size(limit).max(size(before)));
        let moved = pi.integral() != before;
        cover!(s, limited & moved, "at the limit");
        cover!(s, !limited & (given < 0), "within it");
    }
}
property! {
    /// P9 (angles): angles wrap. Adding an angle and subtracting again gives the distance, the short way round, for any start
    /// angle.
    equation "(a + b) - a = b"
    over "pair of angles"
    fn p9_angle16(s) {
        let (from, by) = (Angle(s.u16()), Angle(s.u16()));
        let to = from.plus(by);
        assert!(to.since(from) == by.0.cast_signed());
        assert!(to.since(by) == from.0.cast_signed());
        cover!(s, to.0 < from.0 && by.0 > 0, "over the end of the turn");
        cover!(s, to.since(from) == i16::MIN, "half a turn");
    }
}
property! {
    /// P3 (arithmetic): sine and cosine stay within ±1, and no index leaves the table of sines.
    equation "|sin a| <= 1, |cos a| <= 1"
    over "angle"
    fn p3_sine16(s) {
        let angle = Angle(s.u16());
        assert!(angle.sin().unsigned_abs() <= 1 << 15 && angle.cos().unsigned_abs() <= 1 << 15);
        cover!(s, angle.sin() == -32_767, "lowest");
        cover!(s, angle.sin() == 0 && angle.0 > 0, "half a turn");
    }
}
property! {
    /// P3 (arithmetic): the conversion from encoder counts to the motor's electrical angle does not panic for any motor and
    /// encoder, and count 0 is angle 0.
    equation "angle(0) = 0"
    over "pole pairs, counts of a turn, count"
    by kissat fn p3_electrical_angle64(s) {
        let scale = ElectricalScale::new(s.u8(), s.u32());
        assert!(scale.angle(0) == Angle(0));
        let angle = scale.angle(s.i64());
        cover!(s, angle.0 > 0, "turned");
    }
}
property! {
    /// P10 (fault machine): a drive command is decoded as it was sent, through the words that the control and the current interrupt
    /// share.
    equation "decode(encode(c)) = c"
    over "command"
    fn p10_command_arrives32(s) {
        let command = CurrentCommand {
            tick: s.u32(),
            mode: match s.u8() % 3 {
                0 => CurrentMode::Off,
                1 => CurrentMode::Offsets,
                _ => CurrentMode::Drive,
            },
            angle: Angle(s.u16()),
            advance: s.i32(),
            current: Dq { d: any_value(s), q: any_value(s) },
        };
        assert!(CurrentCommand::from_words(&command.to_words()) == command);
        cover!(s, command.mode == CurrentMode::Drive && command.advance < 0, "on");
    }
}
property! {
    /// P10 (fault machine): whatever bits are in the mailbox of commands, the bridge is on for one pattern of the mode only, and
    /// off for unknown ones.
    equation "mode /= 2  =>  not Drive"
    over "five words"
    fn p10_unknown_is_off32(s) {
        let words = [s.u32(), s.u32(), s.u32(), s.u32(), s.u32()];
        let mode = CurrentCommand::from_words(&words).mode;
        assert!((mode == CurrentMode::Drive) == (words[1] >> 16 == 2));
        assert!(mode == CurrentMode::Off || words[1] >> 16 == 1 || words[1] >> 16 == 2);
        cover!(s, mode == CurrentMode::Drive, "on");
        cover!(s, mode == CurrentMode::Off && words[1] >> 16 == u32::from(u16::MAX), "unknown");
    }
}

#[cfg(all(test, not(kani)))]
mod tests {
    use touchstone_drive::hardware::{B_G431B_ESC1, IHM08M1, IHM16M1, SIMPLEFOC_MINI};

    /// Checks that the boards' PWM timers are as the property `p4_duties32` assumes; a zero voltage is within their range as well.
    #[test]
    fn p4_the_boards_are_as_assumed() {
        for board in [IHM08M1, B_G431B_ESC1, IHM16M1, SIMPLEFOC_MINI] {
            let timer = board.modulator();
            assert!(timer.longest <= timer.top && timer.top - timer.longest <= timer.longest);
            assert!(timer.longest < timer.top);
        }
    }
}

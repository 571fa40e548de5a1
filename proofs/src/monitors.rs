//! Properties of the supervisor's checks that remember earlier control periods: the share of bad encoder readings, the stuck
//! encoder, the motor's voltages, and the motion of the shaft.
//!
//! Each property begins with any memory that the check can have, and takes one control period or a stated number of them. What
//! one period preserves holds for any number of periods.
//!
//! `p10_share_borne16` and the two properties of the motor's voltages are tested on samples only: the model checker was stopped
//! before it had an answer.

use crate::source::Source;
use crate::{assume, cover, property, replaced_property};
#[cfg(kani)]
use core::sync::atomic::{AtomicI32, AtomicUsize, Ordering::Relaxed};
use fixed::types::I16F16;
use touchstone_drive::CurrentReport;
use touchstone_drive::supervisor::model::{Model, ModelConfig};
use touchstone_drive::supervisor::motion::{Motion, MotionConfig};
use touchstone_drive::supervisor::share::Share;
use touchstone_drive::supervisor::stuck::{Stuck, StuckConfig};
use touchstone_drive::transform::Dq;
use touchstone_drive::units::product;
use touchstone_protocol::FaultCode;

/// The sum of bad readings that raises the fault.
const FAULT: u16 = 1_000;
/// What a bad reading adds to its sum; as many good readings make up for it.
const BAD: u16 = 50;

fn any_value<S: Source>(s: &mut S) -> I16F16 {
    I16F16::from_bits(s.i32())
}

/// A sum of bad readings up to `most`.
fn any_sum<S: Source>(s: &mut S, most: u16) -> u16 {
    let any = s.u16();
    if any > most { most } else { any }
}

fn any_report<S: Source>(s: &mut S) -> CurrentReport {
    CurrentReport {
        current: Dq {
            d: any_value(s),
            q: any_value(s),
        },
        voltage: Dq {
            d: any_value(s),
            q: any_value(s),
        },
        ..CurrentReport::default()
    }
}

property! {
    /// P10 (fault machine): a bad reading adds 50 to its sum, a good one takes 1 from it, and a reading that was not due leaves
    /// it. A sum stays within 0 and 1,000, and raises the fault if and only if it is 1,000. The fault's value says which sum.
    equation "S' - S = 50 or S' = 1000 (bad), S' - S = -1 or S' = 0 (good); fault <=> S' = 1000"
    over "two sums from 0 to 1,000, readings"
    by cadical fn p10_share16(s) {
        let before = [any_sum(s, FAULT), any_sum(s, FAULT)];
        let (first, second) = (s.bool(), s.bool().then_some(s.bool()));
        let mut share = Share::from_bad_sums(before);
        let found = share.update(first, second);
        let after = share.bad_sums();
        for ((before, after), bad) in before.into_iter().zip(after).zip([Some(first), second]) {
            // Differences of numbers up to 1,000 do not wrap.
            let step = i32::from(after) - i32::from(before);
            assert_reached!(after <= FAULT);
            assert_reached!(bad != Some(true) || step == i32::from(BAD) || after == FAULT);
            assert_reached!(bad != Some(false) || step == -1 || after == 0 && before == 0);
            assert_reached!(bad.is_some() || step == 0);
        }
        let number = if after[0] == FAULT { 1 } else { 2 };
        let is_fault = after.contains(&FAULT);
        assert!(found == is_fault.then_some((FaultCode::EncoderUnsteady, number)));
        cover!(s, is_fault & (number == 2) & (second == Some(true)), "second readings");
        cover!(s, !is_fault & first & (before[0] == 949), "just not");
    }
}
property! {
    /// P10 (fault machine): an encoder with at most one bad reading in each 51 never raises the fault. A sum that begins at
    /// most at 949 is no fault within 51 readings. It ends at most where it began, or at 50. So this holds over any number of
    /// readings. It follows from `p10_share16` by induction.
    equation "one bad in 51, S <= 949  =>  no fault, S(51) <= max(S, 50)"
    over "two sums from 0 to 949, place of the bad reading of each kind"
    by sampled fn p10_share_borne16(s) {
        let before = [any_sum(s, FAULT - BAD - 1), any_sum(s, FAULT - BAD - 1)];
        let places = [s.u8(), s.u8()];
        let mut share = Share::from_bad_sums(before);
        let mut tick = 0;
        while tick <= BAD {
            let is_bad = |place: u8| u16::from(place) == tick;
            let found = share.update(is_bad(places[0]), Some(is_bad(places[1])));
            assert_reached!(found.is_none());
            tick += 1;
        }
        let after = share.bad_sums();
        assert!(after[0] <= before[0].max(BAD) && after[1] <= before[1].max(BAD));
        cover!(s, after[0] == before[0] && before[0] == 949, "made up for");
        cover!(s, after[1] == BAD && before[1] < BAD, "at the end");
    }
}
property! {
    /// P10 (fault machine): twenty bad readings in a row raise the fault, whatever was before. Without earlier bad readings the
    /// fault comes with the twentieth, not earlier.
    equation "20 bad in a row  =>  fault; S = 0: with the 20th"
    over "two sums from 0 to 1,000, which of the readings are bad, the other readings"
    by cadical fn p10_share_found16(s) {
        let before = [any_sum(s, FAULT), any_sum(s, FAULT)];
        let is_second = s.bool();
        let mut share = Share::from_bad_sums(before);
        let mut at_first = None;
        let mut last = None;
        let mut tick = 0_u8;
        while tick < 20 {
            let other = s.bool();
            let (first, second) = if is_second { (other, true) } else { (true, other) };
            last = share.update(first, Some(second));
            at_first = at_first.or(last.map(|_| tick));
            tick += 1;
        }
        assert!(last.is_some() && at_first.is_some());
        assert!(before != [0, 0] || at_first == Some(19));
        cover!(s, at_first == Some(0), "at once");
        cover!(s, at_first == Some(19) && is_second && before[1] == 0, "not earlier");
    }
}

/// Marks that the products from now on are asked for a second time. Without the model checker it does nothing.
#[cfg(not(kani))]
fn again() {}
/// Marks that the products from now on are asked for a second time, in the same order.
#[cfg(kani)]
fn again() {
    AGAIN.store(AT.load(Relaxed), Relaxed);
    AT.store(0, Relaxed);
}
/// Largest number of products that a check asks for in a control period.
#[cfg(kani)]
const ROWS: usize = 5;
/// Row of the next product.
#[cfg(kani)]
static AT: AtomicUsize = AtomicUsize::new(0);
/// Number of products of the first calculation; 0 until the second one begins.
#[cfg(kani)]
static AGAIN: AtomicUsize = AtomicUsize::new(0);
/// The two factors and the product of each row.
#[cfg(kani)]
static ASKED: [[AtomicI32; 3]; ROWS] = [const { [const { AtomicI32::new(0) }; 3] }; ROWS];
/// Replaces [`product`] when the model checker runs: any value, and the same one when it is asked for again with the same factors.
#[cfg(kani)]
pub fn remembered_product(a: i32, b: i32, _: u32) -> i32 {
    let (at, any): (usize, i32) = (AT.load(Relaxed), kani::any());
    AT.store(at + 1, Relaxed);
    if at >= ROWS {
        return any;
    }
    let row = &ASKED[at];
    if AGAIN.load(Relaxed) == 0 {
        for (place, word) in row.iter().zip([a, b, any]) {
            place.store(word, Relaxed);
        }
        return any;
    }
    let is_same = row[0].load(Relaxed) == a && row[1].load(Relaxed) == b;
    if is_same { row[2].load(Relaxed) } else { any }
}

replaced_property! {
    [(touchstone_drive::units::product, crate::monitors::remembered_product)]
    /// P10 (fault machine): a control period makes the encoder suspect if and only if it did not count, and the voltage beyond `R
    /// i` is more than the allowance for dead time, slow motion and a warm winding. So a motor whose voltage is within that
    /// allowance is never suspect, and an encoder that counts is not.
    equation "suspect <=> moved = 0 and max |v - R i| > least + R (|i_d| + |i_q|)/2, within the format"
    over "resistance and least voltage from 0 on, memory, displacement, currents, voltages; under the checker whatever a product is, for R from 0 on not negative"
    by cadical fn p10_stuck_suspects32(s) {
        let resistance = I16F16::from_bits((s.u32() >> 1).cast_signed());
        let least = I16F16::from_bits((s.u32() >> 1).cast_signed());
        let config = StuckConfig::from_limits(resistance, least, s.u32());
        let (moved, report) = (s.i64(), any_report(s));
        let mut stuck = Stuck::suspected_for(s.u32());
        let found = stuck.update(&config, moved, &report);
        // An encoder that counts asks for no product.
        if moved != 0 {
            assert_reached!(found.is_none() && !stuck.is_suspected());
            return;
        }
        again();
        let drop = |i: I16F16| i64::from(product(resistance.to_bits(), i.to_bits(), 16));
        let Dq { d, q } = report.current;
        let drops = [drop(d), drop(q)];
        let warm = drop(d.saturating_abs().saturating_add(q.saturating_abs()));
        assume!(s, warm >= 0, "p3_parts_of_words: a product of factors from 0 on");
        let beyond = |v: I16F16, drop: i64| (i64::from(v.to_bits()) - drop).abs();
        let most = beyond(report.voltage.d, drops[0]).max(beyond(report.voltage.q, drops[1]));
        let is_beyond = most.min(i32::MAX.into()) > i64::from(least.to_bits()) + (warm >> 1);
        assert!(stuck.is_suspected() == is_beyond);
        assert!(found.is_none() || is_beyond);
        cover!(s, is_beyond & found.is_none() & (warm > 1 << 16), "suspect");
        cover!(s, !is_beyond & (most > 1 << 16), "a motor at rest with a current");
    }
}
replaced_property! {
    [(touchstone_drive::units::product, crate::monitors::remembered_product)]
    /// P10 (fault machine): whether a period makes the encoder suspect does not depend on earlier ones. Each such period counts
    /// one, every other ends the count, and the fault comes as soon as the count is the configured one. So it comes after exactly
    /// that many suspect periods in a row, never earlier, and the count does not overflow.
    equation "n' = n + 1 (suspect), 0 (not); fault <=> suspect and n' >= N"
    over "coefficients, memory, displacement, currents, voltages; under the checker whatever a product is"
    by cadical fn p10_stuck_counts32(s) {
        let (before, ticks) = (s.u32(), s.u32());
        let config = StuckConfig::from_limits(any_value(s), any_value(s), ticks);
        let (moved, report) = (s.i64(), any_report(s));
        let mut alone = Stuck::new();
        let _ = alone.update(&config, moved, &report);
        again();
        let mut stuck = Stuck::suspected_for(before);
        let found = stuck.update(&config, moved, &report);
        let is_suspect = alone.is_suspected();
        let after = if is_suspect { before.saturating_add(1) } else { 0 };
        assert!(stuck.suspected_ticks() == after);
        let code = found.map(|(code, _)| code);
        assert!(code == (is_suspect && after >= ticks).then_some(FaultCode::EncoderStuck));
        cover!(s, is_suspect & (after == ticks) & (before > 1), "the last of them");
        cover!(s, is_suspect & found.is_none() & (before > 1), "not yet");
        cover!(s, !is_suspect & (moved == 0) & (before > 1), "not in a row");
    }
}

/// Largest time constant of the voltages' filter in control periods, as a power of two: 20 ms at 10 kHz.
const LONGEST_LOG2: u32 = 7;
/// Bound of a filter's sum divided by its time constant: more than any unexplained or allowed voltage of a period, in 2^-16 V.
const LARGEST: i64 = 1 << 34;

/// A filter's memory: on each axis the sum of the unexplained voltage is at most that of the allowed one plus `beyond`.
fn any_sums<S: Source>(s: &mut S, over_log2: u32, beyond: i64) -> [i64; 4] {
    let mut sums = [0; 4];
    for axis in [0, 2] {
        let allowed = (s.u64() >> 1).cast_signed();
        let allowed = allowed.min(LARGEST << over_log2);
        sums[axis] = s.i64().clamp(-allowed - beyond, allowed + beyond);
        sums[axis + 1] = allowed;
    }
    sums
}
/// Whether on each axis the unexplained voltage is at most the allowed one, and the sums are within their bound.
fn is_good(sums: [i64; 4], over_log2: u32) -> bool {
    let [r_d, a_d, r_q, a_q] = sums;
    let most = LARGEST << over_log2;
    r_d.abs() <= a_d && r_q.abs() <= a_q && a_d <= most && a_q <= most
}

property! {
    /// P10 (fault machine): a motor whose unexplained voltage is at most the allowed one in each control period never raises the
    /// alarm. The filter's sums neither overflow nor lose that property, rounding included.
    equation "|r| <= a and |S_r| <= S_a  =>  no alarm, |S_r'| <= S_a' <= 2^34 2^k"
    over "coefficients, memory without alarm, speed, currents, voltages"
    by sampled fn p10_model_good64(s) {
        let over_log2 = u32::from(s.u8() & 7);
        let config = ModelConfig::from_motor(any_value(s), any_value(s), any_value(s), over_log2);
        let (speed, report) = (any_value(s), any_report(s));
        // With an empty memory the sums are the period's own voltages.
        let mut alone = Model::new();
        let _ = alone.update(&config, speed, &report);
        again();
        let before = any_sums(s, over_log2, 0);
        let mut model = Model::from_filter_sums(before);
        let found = model.update(&config, speed, &report);
        let is_within = is_good(alone.filter_sums(), 0);
        assert!(!is_within || found.is_none() && is_good(model.filter_sums(), over_log2));
        cover!(s, is_within && before[0] == -before[1] && before[1] > 1 << 20, "at the allowed voltage");
        cover!(s, !is_within && found.is_some(), "an alarm");
        cover!(s, over_log2 == LONGEST_LOG2 && is_within, "longest time constant");
    }
}
property! {
    /// P10 (fault machine): the alarm comes after a bounded time, whatever was before. While the unexplained voltage exceeds the
    /// allowed one by `e` quanta in each control period, their filtered difference grows by at least `e - 2` a period, up to the
    /// alarm. The 2 is for the rounding of two sums.
    equation "r - a >= e, D < 2^k  =>  D' >= D + e - 2; alarm where D' >= 2^k, D = S_r - S_a"
    over "coefficients, memory without alarm, speed, currents, voltages, axis and direction"
    by sampled fn p10_model_found64(s) {
        let over_log2 = u32::from(s.u8() & 7);
        let config = ModelConfig::from_motor(any_value(s), any_value(s), any_value(s), over_log2);
        let (speed, report) = (any_value(s), any_report(s));
        let mut alone = Model::new();
        let _ = alone.update(&config, speed, &report);
        again();
        let before = any_sums(s, over_log2, (1 << over_log2) - 1);
        let mut model = Model::from_filter_sums(before);
        let found = model.update(&config, speed, &report);
        let (axis, is_negative) = (if s.bool() { 2 } else { 0 }, s.bool());
        let less = |sums: [i64; 4]| if is_negative { -sums[axis] - sums[axis + 1] } else { sums[axis] - sums[axis + 1] };
        let (excess, grown) = (less(alone.filter_sums()), less(model.filter_sums()) - less(before));
        assert!(excess < 1 || grown >= excess - 2);
        assert!(less(model.filter_sums()) < 1 << over_log2 || found.is_some());
        cover!(s, excess > 1 << 16 && found.is_none() && less(before) < 0, "not yet");
        cover!(s, excess > 1 << 16 && found.is_some() && before[axis] != 0, "the alarm");
    }
}

/// The coefficients that settings can give for the shaft's motion.
fn any_motion_config<S: Source>(s: &mut S) -> (MotionConfig, [i32; 2], I16F16, u32) {
    let swing = (s.u32() >> 1).cast_signed().max(1);
    let run = (s.u32() >> 1).cast_signed().max(swing);
    let opposing = I16F16::from_bits((s.u32() >> 1).cast_signed().max(1));
    let rate_hz = s.u32();
    let config = MotionConfig::from_least(swing, run, opposing, rate_hz);
    (config, [swing, run], opposing, rate_hz)
}

property! {
    /// P10 (fault machine): the fault of an oscillation needs eight reversals in a row, each with at least the least speed and at
    /// most 40 ms after the one before. A slower reversal ends the count; a motion without a reversal leaves it.
    equation "n' = n + 1 (fast reversal), 0 (slow), n (none); fault <=> reversal and n' >= 8"
    over "coefficients, memory, speed, current"
    by cadical fn p10_swings32(s) {
        let (config, [swing, _], _, rate_hz) = any_motion_config(s);
        let direction = [-1, 0, 1][usize::from(s.u8() % 3)];
        let (swings, since, began, run) = (s.u8(), s.u32(), s.i32(), s.u32());
        let mut motion = Motion::from_swings_and_run(direction, swings, since, began, run);
        let (counts, report) = (s.i32(), any_report(s));
        let found = motion.update(&config, counts, &report, s.bool());
        let is_reversal = counts.saturating_abs() >= swing && counts.signum() != i32::from(direction);
        // Periods from the last reversal to this one.
        let is_fast = direction != 0 && since.saturating_add(1) <= rate_hz / 25;
        let after = match (is_reversal, is_fast) {
            (true, true) => swings.saturating_add(1),
            (true, false) => 0,
            (false, _) => swings,
        };
        assert!(motion.swings_and_run().0 == after);
        let is_oscillation = found.is_some_and(|(code, _)| code == FaultCode::Oscillation);
        assert!(is_oscillation == (is_reversal && after >= 8));
        cover!(s, is_oscillation & (swings == 7), "the eighth");
        cover!(s, is_reversal & is_fast & !is_oscillation & (swings == 6), "the seventh");
        cover!(s, is_reversal & !is_fast & (swings == 7), "too slow");
    }
}
property! {
    /// P10 (fault machine): a runaway is counted only while the shaft has at least the least speed, is not slower than when
    /// the runaway began, and a current of at least the least one brakes it. Each such period counts one, every other ends the
    /// count or begins it anew. The fault comes as soon as the count is more than 10 ms, and not earlier.
    equation "n' = n + 1 (runs on), 1 (begins), 0 (does not); fault Runaway <=> runs on and n' > rate/100, without an oscillation"
    over "coefficients, memory, speed, current"
    by cadical fn p10_runaway32(s) {
        let (config, [_, least], opposing, rate_hz) = any_motion_config(s);
        let direction = [-1, 0, 1][usize::from(s.u8() % 3)];
        let (swings, since, began, run) = (s.u8(), s.u32(), s.i32(), s.u32());
        let mut motion = Motion::from_swings_and_run(direction, swings, since, began, run);
        let (counts, report, against) = (s.i32(), any_report(s), s.bool());
        let found = motion.update(&config, counts, &report, against);
        // A current drives the shaft in its own direction, or against it if the angle falls when the count rises.
        let drives_up = (report.current.q >= 0) != against;
        let brakes = drives_up != (counts >= 0);
        let speed = counts.saturating_abs();
        let is_run = speed >= least && brakes && report.current.q.saturating_abs() >= opposing;
        let runs_on = is_run && run != 0 && speed >= began;
        let after = if runs_on { run.saturating_add(1) } else { u32::from(is_run) };
        assert!(motion.swings_and_run().1 == after);
        let is_due = runs_on && after > rate_hz / 100;
        let code = found.map(|(code, _)| code);
        assert!((code == Some(FaultCode::Runaway)) == (is_due && code != Some(FaultCode::Oscillation)));
        cover!(s, is_due && code == Some(FaultCode::Runaway) && against && run > 9, "in time");
        cover!(s, runs_on && code.is_none() && run > 9, "not yet");
        cover!(s, !runs_on && is_run && run > 9, "it slows down");
        cover!(s, !brakes && run > 9 && code.is_none(), "the motor helps");
    }
}

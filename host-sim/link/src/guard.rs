//! Checks the settings of a board's energy guard against the conditions of the guard's energy bound on this board. The program
//! warns if a settings file weakens the guard.

use crate::value;
use touchstone_control::{ChangeOfForce, Fixed32, Guard, Si};
use touchstone_drive::change::law_settings;
use touchstone_drive::wire::hardware;
use touchstone_protocol::settings::fields::field;
use touchstone_protocol::settings::{DriveKind, GuardSettings};
use touchstone_protocol::{Board, DeviceSettings};

/// A changed setting that raises the energy guard's bound, or makes it void.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Weaker {
    /// Path of the setting, such as `law.guard.on`.
    pub path: &'static str,
    /// What is wrong with the new value, in words.
    pub problem: String,
}

/// Lists the settings in `after` that weaken the energy guard's bound. With the board's own current loop the change of force must
/// stay measured; with the same external amplifier, delay plus lag must not fall below that in `before`. The trusted damping must
/// not exceed that in `before`. The encoder's error must not be below that in `before`. Capacity and refilling power must not
/// exceed the shipped ones. A setting with the same value in `before` is not listed, unless the guard was off there.
#[must_use]
pub fn weaker(before: &DeviceSettings, after: &DeviceSettings, board: Board) -> Vec<Weaker> {
    const ON: &str = "law.guard.on";
    let shipped = DeviceSettings::defaults(board).law.guard;
    let (old, new) = (&before.law.guard, &after.law.guard);
    let mut found = Vec::new();
    let mut add = |path: &'static str, is_weaker: bool, why: String| {
        let shown = |settings| field(path).map(|field| value::shown(settings, field));
        // A guard that was off had no bound. When it is switched on, all its settings count as new.
        if is_weaker && (shown(before) != shown(after) || !old.on) {
            found.push(Weaker { path, problem: why });
        }
    };
    if !new.on {
        if old.on {
            let why = "off: the energy that a hand gets out then has no bound".to_owned();
            add(ON, true, why);
        }
        return found;
    }
    let is_own_loop = after.drive.kind == DriveKind::ThreePhase;
    add(
        "law.guard.change",
        is_own_loop && new.change == ChangeOfForce::Estimated,
        "estimated: the guard then uses the delay from the file, but this board's delay is longer, and the board measures it".to_owned(),
    );
    let late = |guard: &GuardSettings| guard.delay_s.saturating_add(guard.lag_s);
    let path = match new.delay_s < old.delay_s {
        true => "law.guard.delay_s",
        false => "law.guard.lag_s",
    };
    add(
        path,
        !is_own_loop && before.drive.kind == after.drive.kind && late(new) < late(old),
        format!(
            "less than the delay in the board's settings, {:.9} s",
            late(old)
        ),
    );
    let path = match new.damping_n_m_s_per_rad > old.damping_n_m_s_per_rad {
        true => "law.guard.damping_n_m_s_per_rad",
        false => "law.guard.share_of_damping",
    };
    add(
        path,
        trusted(new) > trusted(old),
        format!(
            "more damping than in the board's settings: the guard would rely on {:.9} N·m·s/rad instead of {:.9}",
            trusted(new),
            trusted(old)
        ),
    );
    add(
        "law.position_error_rad",
        after.law.position_error_rad < before.law.position_error_rad,
        format!(
            "less than the encoder's error in the board's settings, {:.6} rad",
            before.law.position_error_rad
        ),
    );
    add(
        "law.guard.capacity_j",
        new.capacity_j > shipped.capacity_j,
        format!(
            "more than the {} J that this board ships with",
            shipped.capacity_j
        ),
    );
    add(
        "law.guard.refill_w",
        new.refill_w > shipped.refill_w,
        format!(
            "more than the {} W that this board ships with",
            shipped.refill_w
        ),
    );
    found
}

fn trusted(guard: &GuardSettings) -> Si {
    guard
        .share_of_damping
        .saturating_mul(guard.damping_n_m_s_per_rad)
}

/// Energy that the energy guard of a board lets the motor give to a hand, with the board's present settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Most energy that a hand can get out at once beyond what it put in, J. It is the capacity of the energy guard's account,
    /// plus the encoder's largest error (half a count and `law.position_error_rad`) times the largest force that a full account
    /// allows.
    pub at_once_j: f64,
    /// Power that a hand can get out continuously in addition, W: the power that refills the energy guard's account.
    pub refill_w: f64,
}

/// Computes the bound of the energy guard with a board's settings; `None` if the guard is off or the settings are refused.
#[must_use]
pub fn bound(settings: &DeviceSettings, board: Board) -> Option<Bound> {
    let (law, _) = law_settings(settings, hardware(board)).ok()?;
    let device = law.guarded_device();
    let guard = law
        .guard
        .on
        .then(|| Guard::<Fixed32>::new(&law.guard, &device));
    let guard = guard?.ok()?;
    let capacity_j = guard.capacity.0.to_num::<f64>();
    let largest_n_m = capacity_j * guard.per_reach.0.to_num::<f64>();
    Some(Bound {
        at_once_j: capacity_j + largest_n_m * device.count.to_num::<f64>() / 2.0,
        refill_w: guard.refill.0.to_num::<f64>() * f64::from(device.rate_hz),
    })
}

/// The energy guard's bound as text for people, with the conditions under which it holds.
#[must_use]
pub fn promise(settings: &DeviceSettings, board: Board) -> String {
    let Some(bound) = bound(settings, board) else {
        return "with these settings the energy that a hand gets out has no bound, because law.guard.on = false".into();
    };
    let guard = &settings.law.guard;
    // Rounded up, so that the printed bound is never below the true one.
    let milli = |value: f64| (1e5 * value).ceil() / 100.0;
    let delay = match guard.change {
        ChangeOfForce::Measured => "",
        ChangeOfForce::Estimated => ", the delay is the configured one",
    };
    let error = settings.law.position_error_rad;
    let error = if error > Si::ZERO {
        format!(" and {error} rad")
    } else {
        String::new()
    };
    let joules = kinetic_j(settings);
    let moving = if joules > 0.0 {
        format!(
            ". The knob's own motion at {SHOWN_RAD_PER_S:.0} rad/s has {:.2} mJ, by law.estimator.inertia_kg_m2",
            milli(joules)
        )
    } else {
        String::new()
    };
    format!(
        "with these settings a hand gets out at most {:.2} mJ at once and {:.2} mW in addition, beyond what it put in and the knob's own motion. This holds if the knob alone has {:.3e} N·m·s/rad of damping, the encoder of {} counts a turn errs by at most half a count{error}, and the motor gives the commanded torque{delay} (docs/guard-promise.md){moving}",
        milli(bound.at_once_j),
        milli(bound.refill_w),
        trusted(guard).to_num::<f64>(),
        settings.encoder.counts_per_rev,
    )
}

/// Speed for which the kinetic energy of a knob is printed, rad/s: a brisk turn by hand.
const SHOWN_RAD_PER_S: f64 = 10.0;

/// Kinetic energy of the knob at [`SHOWN_RAD_PER_S`], J, with the inertia that the estimator assumes.
fn kinetic_j(settings: &DeviceSettings) -> f64 {
    let inertia: f64 = settings.law.estimator.inertia_kg_m2.to_num();
    0.5 * inertia * SHOWN_RAD_PER_S * SHOWN_RAD_PER_S
}

/// A sentence on how much an uncertain torque constant raises the bound. Takes the relative error that the constant may have.
#[must_use]
pub fn by_torque_constant(error: f64) -> String {
    format!(
        "the torque constant is uncertain by {:.1} %, so the bound may be {:.3} times as large",
        100.0 * error,
        1.0 + error
    )
}

/// Limits the energy guard's settings, from whichever file they come, to values that are certain on this board. The guard is
/// switched on. With the board's own current loop, the guard uses the position measured when the force changes. The assumed
/// damping becomes at most `sure_damping`; its trusted share, the capacity and the refilling power become at most the shipped
/// ones.
pub fn hold(all: &mut DeviceSettings, board: Board, sure_damping: Si) {
    let shipped = DeviceSettings::defaults(board).law.guard;
    let guard = &mut all.law.guard;
    guard.on = true;
    if all.drive.kind == DriveKind::ThreePhase {
        guard.change = shipped.change;
    }
    guard.damping_n_m_s_per_rad = guard.damping_n_m_s_per_rad.min(sure_damping);
    guard.share_of_damping = guard.share_of_damping.min(shipped.share_of_damping);
    guard.capacity_j = guard.capacity_j.min(shipped.capacity_j);
    guard.refill_w = guard.refill_w.min(shipped.refill_w);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(before: &DeviceSettings, after: &DeviceSettings, board: Board) -> Vec<&'static str> {
        weaker(before, after, board)
            .iter()
            .map(|it| it.path)
            .collect()
    }

    #[test]
    fn each_setting_that_the_bound_rests_on_is_noticed_and_the_other_way_is_not() {
        type Change = fn(&mut DeviceSettings, bool);
        // Each change with a value that weakens the bound, and with one that does not.
        let changes: [(&str, Change); 7] = [
            ("law.guard.on", |all, weak| all.law.guard.on = !weak),
            ("law.guard.change", |all, weak| {
                all.law.guard.change = match weak {
                    true => ChangeOfForce::Estimated,
                    false => ChangeOfForce::Measured,
                };
            }),
            ("law.guard.damping_n_m_s_per_rad", |all, weak| {
                let damping = &mut all.law.guard.damping_n_m_s_per_rad;
                *damping = match weak {
                    true => *damping + Si::DELTA * 8,
                    false => *damping / 2,
                };
            }),
            ("law.guard.share_of_damping", |all, weak| {
                all.law.guard.share_of_damping = Si::lit(if weak { "0.9" } else { "0.7" });
            }),
            ("law.position_error_rad", |all, weak| {
                all.law.position_error_rad = Si::lit(if weak { "0.001" } else { "0.003" });
            }),
            ("law.guard.capacity_j", |all, weak| {
                all.law.guard.capacity_j = Si::lit(if weak { "0.046" } else { "0.044" });
            }),
            ("law.guard.refill_w", |all, weak| {
                all.law.guard.refill_w = Si::lit(if weak { "0.0006" } else { "0.0004" });
            }),
        ];
        for board in Board::ALL {
            let mut before = DeviceSettings::defaults(board);
            before.law.position_error_rad = Si::lit("0.002");
            assert!(paths(&before, &before, board).is_empty(), "{board:?}");
            for (path, change) in changes {
                let mut after = before.clone();
                change(&mut after, false);
                assert!(paths(&before, &after, board).is_empty(), "{board:?} {path}");
                change(&mut after, true);
                if path.ends_with("damping_n_m_s_per_rad") {
                    // `change` has halved the damping above. The weaker value must exceed that in `before`.
                    after.law.guard.damping_n_m_s_per_rad =
                        before.law.guard.damping_n_m_s_per_rad + Si::DELTA * 8;
                }
                assert_eq!(paths(&before, &after, board), [path], "{board:?}");
                // A weakness that is already set is not listed again.
                assert!(paths(&after, &after, board).is_empty(), "{board:?} {path}");
            }
        }
    }

    #[test]
    fn a_guard_that_is_switched_on_is_looked_at_whole() {
        let board = Board::NucleoG474re;
        let mut before = DeviceSettings::defaults(board);
        before.law.guard.on = false;
        before.law.guard.change = ChangeOfForce::Estimated;
        let mut after = before.clone();
        assert!(paths(&before, &after, board).is_empty());
        after.law.guard.on = true;
        assert_eq!(paths(&before, &after, board), ["law.guard.change"]);
        hold(&mut after, board, Si::lit("0.0003"));
        assert!(paths(&before, &after, board).is_empty());
    }

    #[test]
    fn no_less_delay_is_told_to_the_guard_of_somebody_elses_amplifier() {
        let board = Board::NucleoG474re;
        let mut before = DeviceSettings::defaults(board);
        before.drive.kind = DriveKind::Analogue;
        before.law.guard.change = ChangeOfForce::Estimated;
        before.law.guard.delay_s = Si::lit("0.0002");
        let mut after = before.clone();
        after.law.guard.delay_s = Si::lit("0.0001");
        assert_eq!(paths(&before, &after, board), ["law.guard.delay_s"]);
        after.law.guard.lag_s = Si::lit("0.0001");
        assert!(paths(&before, &after, board).is_empty());
    }

    #[test]
    fn what_is_held_is_weaker_than_nothing() {
        for board in Board::ALL {
            let mut told = DeviceSettings::defaults(board);
            let guard = &mut told.law.guard;
            (guard.on, guard.change) = (false, ChangeOfForce::Estimated);
            guard.damping_n_m_s_per_rad = Si::ONE;
            (guard.share_of_damping, guard.capacity_j) = (Si::ONE, Si::ONE);
            guard.refill_w = Si::ONE;
            let mut sure = DeviceSettings::defaults(board);
            sure.law.guard.damping_n_m_s_per_rad = Si::lit("0.000003");
            hold(&mut told, board, Si::lit("0.000003"));
            assert!(weaker(&sure, &told, board).is_empty(), "{board:?}");
            assert_eq!(told, sure, "{board:?}");
        }
    }

    #[test]
    fn the_bound_of_shipped_boards_is_that_of_the_theorem() {
        for board in Board::ALL {
            let mut settings = DeviceSettings::defaults(board);
            let bound = bound(&settings, board).unwrap();
            // `any_accepted_window` of proofs/coq/AcceptedWindow.v: at most 45.145 mJ, and 0.59 mJ in a second.
            assert!(bound.at_once_j <= 0.045_145, "{board:?} {bound:?}");
            assert!(bound.at_once_j > 0.045_13, "{board:?} {bound:?}");
            assert!(bound.refill_w <= 0.000_59 && bound.refill_w > 0.000_49);
            let text = promise(&settings, board);
            assert!(text.contains("at most 45.15 mJ at once"), "{text}");
            // 1e-4 kg·m² at 10 rad/s. The text does not have this energy if the inertia is not known.
            settings.law.estimator.inertia_kg_m2 = Si::lit("0.0001");
            let text = promise(&settings, board);
            assert!(
                text.contains("The knob's own motion at 10 rad/s has 5.01 mJ, by"),
                "{text}"
            );
            settings.law.estimator.inertia_kg_m2 = Si::ZERO;
            assert!(!promise(&settings, board).contains("10 rad/s has"));
            assert!(text.contains("errs by at most half a count, and"), "{text}");
            settings.law.position_error_rad = Si::lit("0.003");
            let text = promise(&settings, board);
            assert!(
                text.contains("by at most half a count and 0.003 rad, and"),
                "{text}"
            );
            assert!(super::bound(&settings, board).unwrap().at_once_j > bound.at_once_j);
            settings.law.guard.on = false;
            assert!(promise(&settings, board).contains("has no bound"));
            assert_eq!(super::bound(&settings, board), None);
        }
    }
}

//! Computes the scorecard's measures of a run on a haptic device, from encoder positions and motor commands.
//!
//! A simulated hand follows the scorecard's actions, [`DeedsInTurn`]. For a person's hand, the run is searched for times at which
//! the hand rested, oscillated or let go ([`super::noticed`]), and measures that are not available are named.

use super::cases::Deed;
use super::direction::DirectionFigures;
use super::in_turn::DeedsInTurn;
use super::measure::{Figures, Limits, Measure};
use super::noticed::{DeviceRun, MovedAt, Noticed, SPEED_S, met};
use super::touched::{TouchedSeries, TouchedTick, dot};
use serde::Serialize;
use touchstone_sim::run::measure::{Release, WorstWindow};

/// A scorecard measure of a run on a device.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DeviceFigure {
    /// Name of the measure for programs, with its unit.
    pub key: &'static str,
    /// Heading of the measure for readers, and the factor from its SI value to the displayed value.
    #[serde(skip)]
    pub heading: (&'static str, f64),
    /// Value of the measure, in SI units; absent if it was not measured or is infinite.
    pub value: Option<f64>,
    /// Limit of the measure; absent for a measure without a limit.
    pub limit: Option<f64>,
    /// Reason why the measure is not available; absent if it was measured.
    pub not_measured: Option<&'static str>,
}

impl DeviceFigure {
    fn of(
        key: &'static str,
        heading: (&'static str, f64),
        limit: Option<f64>,
        found: Result<f64, &'static str>,
    ) -> Self {
        Self {
            key,
            heading,
            value: found.ok().filter(|value| value.is_finite()),
            limit: limit.filter(|limit| limit.is_finite()),
            not_measured: found.err(),
        }
    }

    /// Whether the measure is beyond its limit. An infinite value is beyond every limit.
    #[must_use]
    pub fn is_beyond(&self) -> bool {
        match (self.limit, self.not_measured) {
            (Some(limit), None) => self.value.is_none_or(|value| value > limit),
            _ => false,
        }
    }
}

/// The scorecard of a run on a device.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DeviceCard {
    /// Whether a simulated hand followed the scorecard's actions (otherwise a person moved the device).
    pub commanded: bool,
    /// All measures of the scorecard.
    pub figures: Vec<DeviceFigure>,
    /// Response of the wall at every frequency of the hand.
    pub moved: Vec<MovedAt>,
}

impl DeviceCard {
    /// Returns a measure by its name for programs.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&DeviceFigure> {
        self.figures.iter().find(|figure| figure.key == key)
    }

    /// Returns the measures beyond their limits.
    pub fn beyond(&self) -> impl Iterator<Item = &DeviceFigure> {
        self.figures.iter().filter(|figure| figure.is_beyond())
    }
}

const NO_PRESS: &str = "no press was commanded, so there is no F/k_de";
const NO_RAMP: &str = "no press was commanded, so there is no ramp to settle after";
const NO_LETTING_GO: &str = "when the hand began to let go was not commanded";
const NO_OUTSIDE: &str = "the hand's rest point outside the wall is not known";
const NO_HAND: &str =
    "the device's losses and kinetic energy are not measured; the energy at the wall is below";
const NOT_DEEP: &str = "the hand was never deeper than ten counts";
const NO_REST: &str = "the hand never rested in the wall for a quarter of a second";
const NO_RHYTHM: &str =
    "the hand did not move in one rhythm for three seconds without leaving the wall";
const NO_LEAVING: &str = "the hand did not leave the wall after a quarter of a second in it";
const NO_TOUCH: &str = "no first touch that lasted three ticks was seen with the whole force";
const NO_CONTACT: &str = "the wall was not touched for a quarter of a second";

/// Calculates the scorecard of a run on a device.
#[must_use]
pub fn card(run: &DeviceRun) -> DeviceCard {
    let series = TouchedSeries::of(run.ticks);
    let looked = Noticed::at(run, &series);
    let scored = run.turn.map(|turn| scored(&turn, &series));
    let limits = Limits::new(run.late, f64::INFINITY);
    let commanded = scored.as_ref().map(|scored| &scored.worst.figures);
    let of = |measure: Measure, otherwise: Result<f64, &'static str>| {
        let found = commanded.map_or(otherwise, |figures| Ok(figures.get(measure)));
        let (key, heading) = match measure {
            Measure::PeakPenetrationRatio => ("peak_penetration_ratio", measure.heading()),
            Measure::StiffnessError => ("stiffness_error", measure.heading()),
            Measure::StiffnessErrorHeld => ("stiffness_error_held", measure.heading()),
            Measure::StiffnessErrorRelease => ("stiffness_error_release", measure.heading()),
            Measure::ModulusError => ("modulus_error", measure.heading()),
            Measure::PhaseDeg => ("phase_deg", measure.heading()),
            // A force along the normal, not a torque.
            Measure::RippleRmsNM => ("ripple_rms_n", ("ripple mN", 1e3)),
            Measure::EnergyOutJ => ("energy_out_j", measure.heading()),
        };
        DeviceFigure::of(key, heading, Some(limits.of(measure)), found)
    };
    let beside = |key, heading, found| DeviceFigure::of(key, heading, None, found);
    let settle = match &scored {
        None => Err(NO_RAMP),
        Some(scored) => Ok(scored.worst.settle_s.unwrap_or(f64::INFINITY)),
    };
    let release = scored.as_ref().map(|scored| scored.release);
    let (since_start, window) = wall_energy(run.ticks);
    let figures = vec![
        of(Measure::PeakPenetrationRatio, Err(NO_PRESS)),
        of(Measure::StiffnessError, looked.moment.ok_or(NOT_DEEP)),
        of(Measure::StiffnessErrorHeld, looked.held.ok_or(NO_REST)),
        of(Measure::StiffnessErrorRelease, Err(NO_LETTING_GO)),
        of(Measure::ModulusError, looked.modulus.ok_or(NO_RHYTHM)),
        of(Measure::PhaseDeg, looked.phase.ok_or(NO_RHYTHM)),
        of(Measure::RippleRmsNM, looked.ripple.ok_or(NO_CONTACT)),
        DeviceFigure::of(
            "energy_out_j",
            Measure::EnergyOutJ.heading(),
            None,
            Err(NO_HAND),
        ),
        beside("energy_out_wall_j", ("wall's mJ", 1e3), Ok(since_start)),
        beside(
            "energy_out_wall_worst_window_j",
            ("in a window mJ", 1e3),
            Ok(window),
        ),
        beside("settle_from_ramp_end_s", ("settle s", 1.0), settle),
        beside(
            "release_speed_m_per_s",
            ("release mm/s", 1e3),
            release.map_or(looked.leaving.ok_or(NO_LEAVING), |it| {
                Ok(it.speed_rad_per_s())
            }),
        ),
        beside(
            "release_excursion_m",
            ("outside mm", 1e3),
            release.map_or(Err(NO_OUTSIDE), |it| Ok(it.excursion_rad())),
        ),
        beside(
            "rate_hardness_n_per_m",
            ("hardness N/mm", 1e-3),
            looked.hardness.ok_or(NO_TOUCH),
        ),
        beside(
            "motion_at_rest_counts",
            ("rest counts", 1.0),
            looked.rest_counts.ok_or(NO_REST),
        ),
    ];
    DeviceCard {
        commanded: run.turn.is_some(),
        figures,
        moved: scored.map_or(looked.moved, |scored| scored.moved),
    }
}

/// Most energy that the wall gave out since the start, and most that it gave out in any window of time, J.
fn wall_energy(ticks: &[TouchedTick]) -> (f64, f64) {
    let mut window = WorstWindow::default();
    let (mut absorbed, mut least) = (0.0, 0.0_f64);
    for pair in ticks.windows(2) {
        let [here, next] = pair else { continue };
        let moved = std::array::from_fn(|i| next.position_m[i] - here.position_m[i]);
        absorbed -= dot(here.force_n, moved);
        least = least.min(absorbed);
        window.record(absorbed);
    }
    (-least, window.worst_j())
}

/// Results of a run in which a simulated hand followed the scorecard's actions.
struct Scored {
    worst: DirectionFigures,
    release: Release,
    moved: Vec<MovedAt>,
}

fn scored(turn: &DeedsInTurn, series: &TouchedSeries) -> Scored {
    let approach = &turn.approach;
    let rate_hz = f64::from(approach.rate_hz);
    let intervals = (SPEED_S * rate_hz) as usize;
    let mut worst = DirectionFigures::NONE;
    let mut release = Release::new(approach.release_tick());
    let mut moved = Vec::new();
    for (deed, first) in turn.begun() {
        let mut watch = approach.watch(deed);
        for index in 0..approach.ticks(deed) {
            let at = series.index(first + index);
            let (Some(middle), Some(out)) = (series.middle.get(at), series.out.get(at)) else {
                // The run ended before the action was complete.
                worst.figures = Figures::LOST;
                worst.settle_s = None;
                break;
            };
            watch.take(index, *middle, *out);
            if deed == Deed::Press {
                release.record(
                    index,
                    series.depth[at],
                    series.speed(at, intervals, rate_hz),
                );
            }
        }
        if let (Deed::Move(frequency_hz), Some(response)) = (deed, watch.response()) {
            moved.push(met(response, frequency_hz));
        }
        worst = worst.worst(&watch.finish());
    }
    Scored {
        worst,
        release,
        moved,
    }
}

#[cfg(test)]
mod tests {
    use super::super::direction::Approach;
    use super::*;
    use touchstone_world::plant::FIRM_TRANSLATION;

    const APPROACH: Approach = Approach {
        k_desired_n_per_m: 5000.0,
        push_n: 8.0,
        touch_n: 1.6,
        count_m: 1e-5,
        unsure_m: 5e-6,
        rate_hz: 1000,
    };

    /// Makes the recorded ticks of a flat wall of stiffness `k` that is pressed to the given depths, as a device would record them.
    fn led(ticks: u64, k: f64, depth_m: impl Fn(u64) -> f64) -> Vec<TouchedTick> {
        let tick = |due: u64| {
            let depth_m = depth_m(due);
            TouchedTick {
                due,
                position_m: [0.0, 0.0, -depth_m],
                force_n: [0.0, 0.0, (k * depth_m).max(0.0)],
                depth_m,
                normal: [0.0, 0.0, 1.0],
            }
        };
        (0..ticks).map(tick).collect()
    }

    fn run(ticks: &[TouchedTick], turn: Option<DeedsInTurn>) -> DeviceCard {
        card(&DeviceRun {
            ticks,
            rate_hz: 1000,
            stiffness: APPROACH.stiffness(),
            whole_from: 1000,
            late: false,
            turn,
        })
    }

    #[test]
    fn what_was_commanded_is_judged_as_the_simulator_does_and_a_softer_wall_is_beyond() {
        let turn = DeedsInTurn::new(APPROACH, FIRM_TRANSLATION, 1200);
        let own = 1.0 / FIRM_TRANSLATION.stiffness + 1.0 / FIRM_TRANSLATION.pad_stiffness;
        let of = |k: f64| {
            let depth = |due: u64| match turn.rest_depth_m(due) {
                rest if rest > 0.0 => rest / (1.0 + k * own),
                rest => rest,
            };
            run(&led(turn.ticks(), k, depth), Some(turn))
        };
        let right = of(5000.0);
        assert_eq!(right.beyond().count(), 0, "{right:?}");
        assert!(
            right
                .figures
                .iter()
                .filter(|it| it.not_measured.is_some())
                .count()
                == 1
        );
        assert_eq!(right.moved.len(), 3);
        let soft = of(2500.0);
        let beyond: Vec<_> = soft.beyond().map(|it| it.key).collect();
        for key in [
            "peak_penetration_ratio",
            "stiffness_error_held",
            "modulus_error",
        ] {
            assert!(beyond.contains(&key), "{key}: {beyond:?}");
        }
        // A run that ends in the middle of the programme fails.
        let cut = led(3000, 5000.0, |due| turn.rest_depth_m(due));
        let cut = run(&cut, Some(turn));
        assert!(cut.beyond().count() >= 5);
        let mut figures = cut.figures.iter();
        let settle = figures
            .find(|it| it.key == "settle_from_ramp_end_s")
            .unwrap();
        assert_ne!(settle.value, Some(0.0));
    }

    #[test]
    fn of_a_hand_that_nobody_commands_it_is_said_what_is_not_known() {
        let tau = std::f64::consts::TAU;
        // The hand is outside while the force fades in. Then it goes in, rests for a second, oscillates at 1.5 Hz for four seconds,
        // and goes out.
        let depth = |due: u64| match due as f64 * 1e-3 {
            t if t < 1.5 => -0.002,
            t if t < 1.8 => -0.002 + 0.004 * (t - 1.5) / 0.3,
            t if t < 3.0 => 0.002,
            t if t < 7.0 => 0.002 + 0.001 * (tau * 1.5 * (t - 3.0)).sin(),
            t => (0.002 - 0.02 * (t - 7.0)).max(-0.002),
        };
        let right = run(&led(8000, 5000.0, depth), None);
        assert_eq!(right.beyond().count(), 0, "{right:?}");
        let value = |key: &str| right.get(key).and_then(|it| it.value);
        assert!((value("release_speed_m_per_s").unwrap() - 0.02).abs() < 1e-3);
        assert!(value("stiffness_error_held").unwrap() < 1e-9);
        assert!((value("rate_hardness_n_per_m").unwrap() - 5000.0).abs() < 1.0);
        assert_eq!(right.moved.len(), 1);
        assert!(
            (right.moved[0].frequency_hz - 1.5).abs() < 0.02,
            "{:?}",
            right.moved
        );
        assert_eq!(
            right.get("peak_penetration_ratio").unwrap().not_measured,
            Some(NO_PRESS)
        );
        let soft = run(&led(8000, 4000.0, depth), None);
        let beyond: Vec<_> = soft.beyond().map(|it| it.key).collect();
        assert_eq!(
            beyond,
            ["stiffness_error", "stiffness_error_held", "modulus_error"]
        );
        // If nobody touches the wall, no measure has a value, and each has a reason.
        let none = run(&led(3000, 5000.0, |_| -0.01), None);
        assert!(
            none.figures
                .iter()
                .filter(|it| it.value.is_some())
                .all(|it| it.key.contains("wall"))
        );
    }

    #[test]
    fn what_a_wall_gives_is_counted_over_missed_ticks_too() {
        let mut ticks = led(3000, 5000.0, |due| 1e-3 * (due as f64 * 0.01).sin());
        // The wall pushes with 2 N more on the way out: it gives 2 N over 2 mm in each oscillation.
        for pair in 1..ticks.len() {
            if ticks[pair].depth_m < ticks[pair - 1].depth_m {
                ticks[pair].force_n[2] += 2.0;
            }
        }
        ticks.retain(|tick| tick.due % 7 != 3);
        let (_, window) = wall_energy(&ticks);
        assert!(window > 0.01, "{window}");
    }
}

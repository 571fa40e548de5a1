//! Computes the scorecard's limit for the torque ripple from a reference: a spring-damper with velocity from differences of encoder
//! counts.
//!
//! Damping from differences of counts causes ripple, and damping is needed to hold a wall with delay. The limit is therefore
//! computed from the spring-damper with the least ripple that holds this wall on the nominal device with a whole tick of delay. If
//! none does, the longest delay is used at which a spring-damper holds the wall.
//!
//! A bad spring-damper must not raise the limit, so three rules apply. Encoder noise is left out. If a spring-damper's ripple
//! exceeds that of one count of change per tick, it counts as a limit cycle and does not hold the wall. No law may have a ripple
//! above a tenth of the press.

use super::cases::{Case, Change, Deed, GRIPS, LATE_TICKS, MOVES_WITH, Programme};
use super::measure::{Figures, Limits, Measure};
use super::rivals::Rival;
use super::watch::watch;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::TAU;
use touchstone_sim::error::Result;
use touchstone_sim::scene::Scene;

/// The spring-damper from which the limit of the torque ripple (change of the torque from tick to tick) is computed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Reference {
    /// Virtual damping of the spring-damper, N·m·s/rad.
    pub damping_n_m_s_per_rad: f64,
    /// Longest delay with which the spring-damper holds the wall, in ticks (control periods); absent if no spring-damper holds the
    /// wall.
    pub delay_ticks: Option<f64>,
    /// Ripple of the spring-damper on the nominal device, root mean square, N·m.
    pub ripple_n_m: f64,
    /// Largest allowed ripple of a law on the nominal device, root mean square, N·m.
    pub limit_n_m: f64,
    /// Largest allowed ripple of a law on any device, root mean square, N·m.
    pub most_n_m: f64,
}

/// Delays for which a spring-damper is searched, in ticks (control periods), the longest first.
const DELAYS: [f64; 4] = [1.0, 0.5, 0.1, 0.0];
/// Number of damping ratios `B/(2 sqrt(k_de J))` that are tried: damping `B`, requested stiffness `k_de`, inertia `J`.
const RATIOS: usize = 28;
/// Factor from the reference spring-damper's ripple to the limit, if that spring-damper holds the wall with a whole tick of delay.
const WHERE_DAMPING_SUFFICES: f64 = 1.1;
/// Factor from the reference spring-damper's ripple to the limit, if that spring-damper holds the wall only with less than a tick
/// of delay.
const WHERE_IT_DOES_NOT: f64 = 0.6;
/// Largest allowed ripple as a fraction of the press' torque. A hand notices changes of torque above about 13 % (Jandura and
/// Srinivasan 1994).
const MOST_OF_THE_PRESS: f64 = 0.1;

impl Reference {
    /// Finds the reference spring-damper for a scene's device and wall.
    ///
    /// # Errors
    /// The control law does not accept its settings.
    pub fn of(scene: &Scene) -> Result<Self> {
        let mut scene = scene.clone();
        scene.sensor.noise = None;
        let scene = &scene;
        let programme = Programme::of(scene).shortened();
        let critical = 2.0 * (scene.wall.k_desired_n_m_per_rad * scene.device.inertia_kg_m2).sqrt();
        let dampings: Vec<f64> = (0..RATIOS)
            .map(|i| critical * 0.03 * 60_f64.powf(i as f64 / (RATIOS - 1) as f64))
            .collect();
        let mut reference = None;
        for delay in DELAYS {
            let held: Vec<(f64, f64)> = dampings
                .par_iter()
                .map(|damping| held(scene, &programme, *damping, delay))
                .collect::<Result<Vec<_>>>()?
                .into_iter()
                .zip(&dampings)
                .filter_map(|(ripple, damping)| ripple.map(|ripple| (ripple, *damping)))
                .collect();
            if let Some((_, damping)) = held.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)) {
                reference = Some((damping, delay));
                break;
            }
        }
        // If no damping holds the wall, a damping ratio of 0.6 is assumed.
        let (damping, delay_ticks) = match reference {
            Some((damping, delay)) => (damping, Some(delay)),
            None => (0.6 * critical, None),
        };
        let own_delay = scene.timing.computational_delay_s * f64::from(scene.timing.rate_hz);
        let ripple = figures(scene, &programme, damping, own_delay)?.get(Measure::RippleRmsNM);
        // The ripple of a lost wall has no meaning. Then the torque by which one count per tick changes the damping force is
        // used.
        let count = scene.encoder.as_ref().map_or(0.0, |it| it.step_rad());
        let most = a_count_every_tick(scene, &programme, damping);
        let ripple_n_m = match delay_ticks {
            Some(_) => ripple.min(most),
            None => damping * f64::from(scene.timing.rate_hz) * count,
        };
        let most_n_m = MOST_OF_THE_PRESS * programme.press.push_torque_n_m;
        let share = match delay_ticks {
            Some(ticks) if ticks >= 1.0 => WHERE_DAMPING_SUFFICES,
            _ => WHERE_IT_DOES_NOT,
        };
        Ok(Self {
            damping_n_m_s_per_rad: damping,
            delay_ticks,
            ripple_n_m,
            limit_n_m: (share * ripple_n_m).min(most_n_m),
            most_n_m,
        })
    }

    /// Makes a reference that sets no limit for the torque ripple.
    #[must_use]
    pub fn none() -> Self {
        Self {
            damping_n_m_s_per_rad: 0.0,
            delay_ticks: None,
            ripple_n_m: 0.0,
            limit_n_m: f64::INFINITY,
            most_n_m: f64::INFINITY,
        }
    }

    /// Limits of the measures on a device; the limit of the ripple is proportional to the angle of an encoder count.
    #[must_use]
    pub fn limits(&self, case: &Case) -> Limits {
        let counts = match case.change {
            Change::Counts(share) => share,
            _ => 1.0,
        };
        Limits::new(case.is_late(), (self.limit_n_m / counts).min(self.most_n_m))
    }
}

fn figures(scene: &Scene, programme: &Programme, damping: f64, delay: f64) -> Result<Figures> {
    let case = Case {
        name: "",
        change: Change::Delay(delay),
    };
    let mut scene = Rival::named("spring-damper")?.of(&case.of(scene));
    scene.law.virtual_damping_n_m_s_per_rad = damping;
    let mut worst = Figures::NONE;
    for grip in GRIPS {
        for deed in programme.deeds().filter(|deed| *deed != Deed::Press) {
            let deed_scene = programme.scene(&scene, grip, deed);
            worst = worst.worst(&watch(&deed_scene, deed, false)?.0);
        }
    }
    Ok(worst)
}

/// Ripple in N·m of a spring-damper with this damping; `None` if it does not hold the wall at this delay in ticks. Only the limits
/// for an oscillating hand have to be met, because ripple alone may move a press beyond 5 %.
fn held(scene: &Scene, programme: &Programme, damping: f64, delay: f64) -> Result<Option<f64>> {
    let figures = figures(scene, programme, damping, delay)?;
    let limits = Limits::new(delay >= LATE_TICKS, f64::INFINITY);
    let holds = [Measure::ModulusError, Measure::PhaseDeg]
        .iter()
        .all(|measure| figures.get(*measure) <= limits.of(*measure));
    let ripple = figures.get(Measure::RippleRmsNM);
    Ok((holds && ripple <= a_count_every_tick(scene, programme, damping)).then_some(ripple))
}

/// Ripple in N·m of a spring-damper whose measured position changes by one count back and forth in every tick, plus the ripple that
/// the hand's motion causes.
fn a_count_every_tick(scene: &Scene, programme: &Programme, damping: f64) -> f64 {
    let Some(encoder) = &scene.encoder else {
        return f64::INFINITY;
    };
    let rate_hz = f64::from(scene.timing.rate_hz);
    let per_count = damping * rate_hz + scene.wall.k_desired_n_m_per_rad;
    let fastest_hz = programme.frequencies_hz.iter().copied().fold(0.0, f64::max);
    let moved = MOVES_WITH * programme.press.push_torque_n_m * TAU * fastest_hz / rate_hz;
    per_count * encoder.step_rad() + moved
}

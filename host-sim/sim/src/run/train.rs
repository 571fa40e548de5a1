//! The drive train of a scene (flexible transmission, current lag, friction with bristles, cogging): whether the scene needs one,
//! and how many substeps it takes per tick.

use touchstone_world::plant::train::{
    Current, DriveTrain, Friction, Harmonic, Links, LuGre, Shaft, Sliding, TrainState, Transmission,
};

use super::crossed;
use super::mechanics::{Mechanics, Standing};
use crate::error::Result;
use crate::scene::{Integrator, Scene};

/// A drive train: the effects between motor and knob that the basic plant model of device and hand lacks.
#[derive(Debug, Clone, PartialEq)]
pub struct Train {
    /// Linear part of the drive train: inertias, springs, dampers and the current lag.
    pub links: Links,
    /// Nonlinear part of the drive train, such as friction and cogging.
    pub shaft: Shaft,
    /// Number of substeps per control period.
    pub substeps: u32,
    /// Reasons for this number of substeps, one per line; empty if no effect needs more than the minimum of 1 or 4.
    pub reasons: Vec<String>,
    /// Field of the scene that requires this number of substeps; `None` if there are no reasons.
    pub cause: Option<&'static str>,
}

/// Number of substeps per control period that one effect requires, with field and reason.
struct Wish {
    count: f64,
    path: &'static str,
    reason: String,
}

/// Largest speed of the device for which the substeps resolve cogging, rad/s. A hand turns a knob more slowly.
const FAST_RAD_PER_S: f64 = 10.0;
/// Largest number of substeps per control period that the program chooses by itself; `plant.substeps` can set more.
const MOST: f64 = 4096.0;

impl Train {
    /// Builds the drive train of a scene; `None` if the scene names no effect that needs one.
    #[must_use]
    pub fn of(scene: &Scene) -> Option<Self> {
        let device = &scene.device;
        let harmonics = harmonics(scene);
        let falls = device
            .friction
            .as_ref()
            .is_some_and(|it| it.stribeck_rad_per_s.is_some() && it.static_n_m() > it.kinetic_n_m);
        let has_bristles = device
            .friction
            .as_ref()
            .is_some_and(|it| it.bristle_stiffness_n_m_per_rad.is_some());
        let needed = device.current_loop.is_some()
            || device.transmission.is_some()
            || has_bristles
            || falls
            || !harmonics.is_empty();
        needed.then(|| {
            let links = links(scene);
            let shaft = Shaft {
                friction: friction(scene),
                harmonics,
            };
            let (substeps, reasons, cause) = substeps(scene, &links, &shaft);
            Self {
                links,
                shaft,
                substeps,
                reasons,
                cause,
            }
        })
    }

    /// Builds the mechanics of a run from the drive train. `from` gives the initial positions and velocities.
    ///
    /// # Errors
    /// A plant that cannot be built, named by its field of the scene; an integration method that cannot advance a drive train.
    pub fn mechanics(&self, scene: &Scene, from: Standing) -> Result<Box<dyn Mechanics>> {
        if let Some(plant) = &scene.plant
            && plant.integrator != Integrator::Exact
        {
            return Err(scene.error(
                "plant.integrator",
                "only the exact integrator supports a current loop, a transmission, cogging, imbalance, falling friction or bristles",
                "leave those out, or give plant.integrator = \"exact\"",
            ));
        }
        match self.links.states() {
            2 => self.made::<2, 6>(scene, from),
            3 => self.made::<3, 7>(scene, from),
            4 => self.made::<4, 8>(scene, from),
            5 => self.made::<5, 9>(scene, from),
            6 => self.made::<6, 10>(scene, from),
            _ => self.made::<7, 11>(scene, from),
        }
    }

    fn made<const N: usize, const K: usize>(
        &self,
        scene: &Scene,
        from: Standing,
    ) -> Result<Box<dyn Mechanics>> {
        let device = [from.angle_rad, from.velocity_rad_per_s];
        let hand = match self.links.hand {
            Some(_) => [from.hand_rad, from.hand_velocity_rad_per_s],
            None => device,
        };
        // A delay or jitter divides a tick into parts; each gets substeps in proportion to its length.
        let per_s = f64::from(self.substeps) / scene.timing.period_s();
        let substeps = |interval_s: f64| (interval_s * per_s).ceil().max(1.0) as u32;
        crossed::crossed_apart(
            scene,
            |h| DriveTrain::<N, K>::new(&self.links, &self.shaft, h, substeps(h)),
            TrainState::moving(device, hand),
        )
    }
}

/// Linear part of a scene's device and hand as a drive train, even if the run does not need a drive train.
#[must_use]
pub fn links(scene: &Scene) -> Links {
    let device = &scene.device;
    Links {
        device: touchstone_world::plant::Device {
            friction: None,
            ..crossed::device(scene)
        },
        current: device.current_loop.as_ref().map(|current| Current {
            bandwidth_hz: current.bandwidth_hz,
            back_emf: current.back_emf_n_m_s_per_rad,
        }),
        transmission: device.transmission.as_ref().map(|it| Transmission {
            stiffness: it.spring_n_m_per_rad,
            damping: it.damper_n_m_s_per_rad,
            knob_inertia: it.knob_share * device.inertia_kg_m2,
            gap: it.play_rad,
        }),
        hand: crossed::hand(scene),
    }
}

fn harmonics(scene: &Scene) -> Vec<Harmonic> {
    let cogging = scene.device.cogging.as_ref().map(|it| Harmonic {
        amplitude: it.torque_n_m,
        per_rev: f64::from(it.periods_per_rev),
        phase: it.phase_rad,
    });
    let imbalance = scene.device.imbalance.as_ref().map(|it| Harmonic {
        amplitude: it.torque_n_m,
        per_rev: 1.0,
        phase: it.phase_rad,
    });
    [cogging, imbalance]
        .into_iter()
        .flatten()
        .filter(|harmonic| harmonic.amplitude > 0.0)
        .collect()
}

fn friction(scene: &Scene) -> Friction {
    let Some(friction) = &scene.device.friction else {
        return Friction::None;
    };
    let asymmetry = friction.asymmetry_n_m.unwrap_or(0.0);
    let directions = [asymmetry, -asymmetry].map(|more| Sliding {
        kinetic: friction.kinetic_n_m + more,
        breakaway: friction.static_n_m() + more,
    });
    let stribeck = friction.stribeck_rad_per_s;
    match friction.bristle_stiffness_n_m_per_rad {
        None => Friction::Dry {
            directions,
            stribeck,
        },
        Some(stiffness) => Friction::Bristles(LuGre {
            stiffness,
            damping: friction
                .bristle_damping_n_m_s_per_rad
                .unwrap_or_else(|| libm::sqrt(stiffness * scene.device.inertia_kg_m2)),
            directions,
            stribeck,
        }),
    }
}

/// Number of substeps per control period, the reasons for it, and the field of the scene that requires it.
fn substeps(
    scene: &Scene,
    links: &Links,
    shaft: &Shaft,
) -> (u32, Vec<String>, Option<&'static str>) {
    let gap = links.transmission.filter(|it| it.gap > 0.0);
    if shaft.is_smooth() && gap.is_none() {
        return (1, Vec::new(), None);
    }
    if let Some(plant) = &scene.plant {
        let reason = format!("{} substeps, as plant.substeps says", plant.substeps);
        return (plant.substeps, vec![reason], Some("plant.substeps"));
    }
    let wishes = wishes(scene, links, shaft);
    let wanted = wishes.iter().map(|wish| wish.count).fold(4.0, f64::max);
    let count = wanted.min(MOST).ceil();
    let largest = wishes.into_iter().filter(|wish| wish.count == wanted);
    let (mut reasons, paths): (Vec<_>, Vec<_>) =
        largest.map(|wish| (wish.reason, wish.path)).unzip();
    if wanted > MOST {
        reasons.push(format!(
            "{wanted:.0} substeps are needed, but only {MOST} are used: raise plant.substeps"
        ));
    }
    (count as u32, reasons, paths.first().copied())
}

fn wishes(scene: &Scene, links: &Links, shaft: &Shaft) -> Vec<Wish> {
    let period = scene.timing.period_s();
    let knob = links.transmission.map_or(0.0, |it| it.knob_inertia);
    let motor = links.device.inertia - knob;
    let mut wishes: Vec<Wish> = Vec::new();
    let mut wish = |count, path, reason| {
        wishes.push(Wish {
            count,
            path,
            reason,
        });
    };
    match shaft.friction {
        Friction::None => {}
        Friction::Dry { .. } => wish(
            32.0,
            "device.friction.kinetic_n_m",
            "friction beside it is set-valued at the end of each: 32".to_owned(),
        ),
        Friction::Bristles(lugre) => {
            let rate = libm::sqrt(lugre.stiffness / motor);
            wish(
                10.0 * rate * period,
                "device.friction.bristle_stiffness_n_m_per_rad",
                format!("bristles of friction at {rate:.0} 1/s, a tenth of a radian each"),
            );
        }
    }
    for harmonic in &shaft.harmonics {
        let (what, torque, periods) = if harmonic.per_rev == 1.0 {
            let torque = "device.imbalance.torque_n_m";
            ("one period a turn", torque, torque)
        } else {
            (
                "device.cogging",
                "device.cogging.torque_n_m",
                "device.cogging.periods_per_rev",
            )
        };
        let own = libm::sqrt(harmonic.amplitude * harmonic.per_rev / motor);
        wish(
            20.0 * own * period,
            torque,
            format!("{what}: an oscillation at {own:.0} 1/s, a twentieth of a radian each"),
        );
        let passing = harmonic.per_rev * FAST_RAD_PER_S;
        wish(
            5.0 * passing * period,
            periods,
            format!("{what}: passed at {FAST_RAD_PER_S} rad/s, a fifth of a radian each"),
        );
    }
    if let Some(transmission) = links.transmission.filter(|it| it.gap > 0.0) {
        let rate = libm::sqrt(transmission.stiffness * (1.0 / motor + 1.0 / knob));
        wish(
            20.0 * rate * period,
            "device.transmission.spring_n_m_per_rad",
            format!(
                "device.transmission: contact across the play at {rate:.0} 1/s, a twentieth of a radian each"
            ),
        );
    }
    wishes
}

//! The list of all effects (friction, noise, delay, …) that a scene can name. Each entry gives the effect's place in the control
//! loop, its typical magnitude and the source of that magnitude.
//!
//! The list serves the cost measurement, the tests that an absent effect costs nothing, `touchstone plan` and the table of
//! `docs/effects.md`.

mod all;
mod place;
mod touch;

pub use all::{EFFECTS, by_name, exclude_each_other};
pub use place::Place;

use crate::scene::{
    Cogging, CurrentLoop, CurrentSensor, Encoder, Friction, Grip, HandReflex, HandTremor,
    Imbalance, PeriodicError, Scene, SensorNoise, Transmission,
};

/// One effect of the simulation, such as friction or sensor noise.
#[derive(Debug, Clone, Copy)]
pub struct Effect {
    /// Name of the effect in lists and commands.
    pub name: &'static str,
    /// Place of the effect in the loop.
    pub place: Place,
    /// Field or table of the scene file that adds the effect.
    pub field: &'static str,
    /// Typical magnitude of the effect, with its unit.
    pub typical: &'static str,
    /// Source of the typical magnitude: a publication, a data sheet or an estimate.
    pub source: &'static str,
    /// Whether the effect belongs to the hand.
    pub of_hand: bool,
    /// Returns whether a given scene has the effect.
    pub is_named: fn(&Scene) -> bool,
    /// Adds the effect to a scene, at its typical magnitude.
    pub add: fn(&mut Scene),
    /// Removes the effect from a scene, and also all effects that need it.
    pub remove: fn(&mut Scene),
    /// Sets the amplitude of the effect to zero, so that the effect changes nothing; `None` for an effect without an amplitude.
    pub silence: Option<fn(&mut Scene)>,
}

fn friction(scene: &mut Scene) -> &mut Friction {
    scene.device.friction.get_or_insert_default()
}

fn of_friction<T>(scene: &Scene, what: impl Fn(&Friction) -> Option<T>) -> bool {
    scene.device.friction.as_ref().and_then(what).is_some()
}

fn held(scene: &mut Scene) {
    if scene.operator.hand().is_none() {
        scene.operator.grip = Grip::Medium;
    }
}

fn back_emf(scene: &Scene) -> Option<f64> {
    let current = scene.device.current_loop.as_ref()?;
    Some(current.back_emf_n_m_s_per_rad)
}

/// A flexible transmission for the device of a scene, with its first resonance at 150 Hz.
fn transmission(scene: &Scene) -> Transmission {
    let given = Transmission::default();
    let share = given.knob_share;
    let reduced = scene.device.inertia_kg_m2 * share * (1.0 - share);
    let rate = std::f64::consts::TAU * 150.0;
    Transmission {
        spring_n_m_per_rad: reduced * rate * rate,
        // A twentieth of the critical damping.
        damper_n_m_s_per_rad: 0.1 * reduced * rate,
        ..given
    }
}

/// Entries for effects of sensor, timing, device and hand.
const WORLD: &[Effect] = &[
    Effect {
        name: "encoder",
        place: Place::Sensor,
        field: "encoder",
        typical: "40,000 counts a turn",
        source: "optical disc of 10,000 lines at four edges a line; a 14-bit magnetic sensor has 16,384",
        of_hand: false,
        is_named: |scene| scene.encoder.is_some(),
        add: |scene| scene.encoder = Some(Encoder::default()),
        remove: |scene| scene.encoder = None,
        silence: None,
    },
    Effect {
        name: "sensor-noise",
        place: Place::Angle,
        field: "sensor.noise",
        typical: "5.2e-4 rad rms (0.03°), white",
        source: "AS5046 data sheet rev. 1.0 p. 30: transition noise 0.03° rms in slow mode, 0.06° in fast",
        of_hand: false,
        is_named: |scene| scene.sensor.noise.is_some(),
        add: |scene| scene.sensor.noise = Some(SensorNoise::default()),
        remove: |scene| scene.sensor.noise = None,
        silence: Some(|scene| scene.sensor.noise = Some(SensorNoise { rms_rad: 0.0 })),
    },
    Effect {
        name: "sensor-periodic",
        place: Place::Angle,
        field: "sensor.periodic",
        typical: "8.7e-3 rad (0.5°), once a turn",
        source: "AS5050 data sheet rev. 1.12 p. 17: better than 0.5° with a centred magnet, 1.41° specified",
        of_hand: false,
        is_named: |scene| scene.sensor.periodic.is_some(),
        add: |scene| scene.sensor.periodic = Some(PeriodicError::default()),
        remove: |scene| scene.sensor.periodic = None,
        silence: Some(|scene| {
            scene.sensor.periodic = Some(PeriodicError {
                amplitude_rad: 0.0,
                ..PeriodicError::default()
            });
        }),
    },
    Effect {
        name: "delay",
        place: Place::Crossing,
        field: "timing.computational_delay_s",
        typical: "one period",
        source: "a law that reads in one tick and acts in the next",
        of_hand: false,
        is_named: |scene| scene.timing.computational_delay_s > 0.0,
        add: |scene| scene.timing.computational_delay_s = scene.timing.period_s().min(1.0),
        remove: |scene| scene.timing.computational_delay_s = 0.0,
        silence: Some(|scene| scene.timing.computational_delay_s = 0.0),
    },
    Effect {
        name: "jitter",
        place: Place::Crossing,
        field: "timing.jitter_s",
        typical: "a tenth of the period",
        source: "estimate; Kirkpatrick and Sze, HAPTICS 2004 (abstract): up to 52 % of the period on a loaded desktop",
        of_hand: false,
        is_named: |scene| scene.timing.jitter_s.is_some(),
        add: |scene| scene.timing.jitter_s = Some(0.1 * scene.timing.period_s()),
        remove: |scene| scene.timing.jitter_s = None,
        silence: Some(|scene| scene.timing.jitter_s = Some(0.0)),
    },
    Effect {
        name: "latency-spread",
        place: Place::Crossing,
        field: "timing.latency_spread_s",
        typical: "0 to 1 ms",
        source: "a full-speed USB device is polled once in a frame of 1 ms; spreads differ by device: Wimmer, Schmid and Bockes, CHI 2019",
        of_hand: false,
        is_named: |scene| scene.timing.latency_spread_s.is_some(),
        add: |scene| scene.timing.latency_spread_s = Some(1e-3),
        remove: |scene| scene.timing.latency_spread_s = None,
        silence: Some(|scene| scene.timing.latency_spread_s = Some(0.0)),
    },
    Effect {
        name: "lost-ticks",
        place: Place::Law,
        field: "timing.lost_share",
        typical: "1 % of the ticks",
        source: "estimate",
        of_hand: false,
        is_named: |scene| scene.timing.lost_share.is_some(),
        add: |scene| scene.timing.lost_share = Some(0.01),
        remove: |scene| scene.timing.lost_share = None,
        silence: Some(|scene| scene.timing.lost_share = Some(0.0)),
    },
    Effect {
        name: "torque-limit",
        place: Place::Torque,
        field: "device.torque_limit_n_m",
        typical: "0.5 N·m",
        source: "the thesis' knob as shipped: 2 A at 0.25 N·m/A",
        of_hand: false,
        is_named: |scene| scene.device.torque_limit_n_m.is_some(),
        add: |scene| scene.device.torque_limit_n_m = Some(0.5),
        remove: |scene| scene.device.torque_limit_n_m = None,
        silence: None,
    },
    Effect {
        name: "amplifier-steps",
        place: Place::Torque,
        field: "device.amplifier_step_n_m",
        typical: "2.4e-4 N·m",
        source: "12 bits from -0.5 to 0.5 N·m",
        of_hand: false,
        is_named: |scene| scene.device.amplifier_step_n_m.is_some(),
        add: |scene| scene.device.amplifier_step_n_m = Some(2.4e-4),
        remove: |scene| scene.device.amplifier_step_n_m = None,
        silence: None,
    },
    Effect {
        name: "current-sensor",
        place: Place::Torque,
        field: "device.current_sensor",
        typical: "8.7e-4 N·m rms and a step of as much",
        source: "X-NUCLEO-IHM08M1: 15.5 mA a code (drive/src/hardware/ihm08m1.rs) times 0.25 N·m/A, over the root of the 20 runs of a loop in a tick; noise of a code is an estimate",
        of_hand: false,
        is_named: |scene| scene.device.current_sensor.is_some(),
        add: |scene| scene.device.current_sensor = Some(CurrentSensor::default()),
        remove: |scene| scene.device.current_sensor = None,
        silence: Some(|scene| {
            scene.device.current_sensor = Some(CurrentSensor {
                noise_rms_n_m: 0.0,
                step_n_m: 0.0,
            });
        }),
    },
    Effect {
        name: "current-loop",
        place: Place::State,
        field: "device.current_loop",
        typical: "600 Hz",
        source: "the firmware's default (motor.current_bandwidth_hz)",
        of_hand: false,
        is_named: |scene| back_emf(scene) == Some(0.0),
        add: |scene| scene.device.current_loop = Some(CurrentLoop::default()),
        remove: |scene| scene.device.current_loop = None,
        silence: None,
    },
    Effect {
        name: "windings",
        place: Place::State,
        field: "device.current_loop.back_emf_n_m_s_per_rad",
        typical: "318 Hz and 0.0069 N·m·s/rad",
        source: "a gimbal motor of 6 Ω, 3 mH, 0.25 N·m/A at a voltage: `k_t²/(1.5 R)` (host-sim/world/src/motor/windings.rs)",
        of_hand: false,
        is_named: |scene| back_emf(scene).is_some_and(|it| it > 0.0),
        add: |scene| {
            scene.device.current_loop = Some(CurrentLoop {
                bandwidth_hz: 318.0,
                back_emf_n_m_s_per_rad: 0.0069,
            });
        },
        remove: |scene| scene.device.current_loop = None,
        silence: None,
    },
    Effect {
        name: "friction",
        place: Place::Exact,
        field: "device.friction",
        typical: "1e-3 N·m",
        source: "estimate: small direct-drive motors have 0.5 to 3 mN·m, and no maker publishes it",
        of_hand: false,
        is_named: |scene| scene.device.friction.is_some(),
        add: |scene| scene.device.friction = Some(Friction::default()),
        remove: |scene| scene.device.friction = None,
        silence: None,
    },
    Effect {
        name: "friction-asymmetry",
        place: Place::Exact,
        field: "device.friction.asymmetry_n_m",
        typical: "a fifth of the kinetic friction",
        source: "estimate",
        of_hand: false,
        is_named: |scene| of_friction(scene, |it| it.asymmetry_n_m),
        add: |scene| {
            let friction = friction(scene);
            friction.asymmetry_n_m = Some(0.2 * friction.kinetic_n_m);
        },
        remove: |scene| {
            if let Some(friction) = &mut scene.device.friction {
                friction.asymmetry_n_m = None;
            }
        },
        silence: None,
    },
    Effect {
        name: "stribeck",
        place: Place::Shaft,
        field: "device.friction.stribeck_rad_per_s",
        typical: "0.1 rad/s, from 1.5 times the kinetic friction",
        source: "ratio of the example of Canudas de Wit et al., IEEE TAC 40(3) 419, 1995 (as recalled); the velocity is an estimate",
        of_hand: false,
        is_named: |scene| of_friction(scene, |it| it.stribeck_rad_per_s),
        add: |scene| {
            let friction = friction(scene);
            friction.static_n_m = Some(friction.static_n_m().max(1.5 * friction.kinetic_n_m));
            friction.stribeck_rad_per_s = Some(0.1);
        },
        remove: |scene| {
            if let Some(friction) = &mut scene.device.friction {
                friction.stribeck_rad_per_s = None;
            }
        },
        silence: None,
    },
    Effect {
        name: "lugre",
        place: Place::Shaft,
        field: "device.friction.bristle_stiffness_n_m_per_rad",
        typical: "10 N·m/rad, damped by the root of stiffness times inertia",
        source: "damping as in the example of Canudas de Wit et al. (as recalled); the stiffness is an estimate: 1e-4 rad before it slides",
        of_hand: false,
        is_named: |scene| of_friction(scene, |it| it.bristle_stiffness_n_m_per_rad),
        add: |scene| {
            let friction = friction(scene);
            friction.bristle_stiffness_n_m_per_rad = Some(10.0);
            // The bristle model divides by the kinetic friction, which must therefore be above 0.
            friction.kinetic_n_m = friction.kinetic_n_m.max(1e-6);
            friction.static_n_m = Some(friction.static_n_m().max(friction.kinetic_n_m));
        },
        remove: |scene| {
            if let Some(friction) = &mut scene.device.friction {
                friction.bristle_stiffness_n_m_per_rad = None;
                friction.bristle_damping_n_m_s_per_rad = None;
            }
        },
        silence: None,
    },
    Effect {
        name: "cogging",
        place: Place::Shaft,
        field: "device.cogging",
        typical: "1e-3 N·m, 84 periods a turn",
        source: "estimate for gimbal motors that are not sold as free of it; 84 is the least common multiple of 12 slots and 14 poles",
        of_hand: false,
        is_named: |scene| scene.device.cogging.is_some(),
        add: |scene| scene.device.cogging = Some(Cogging::default()),
        remove: |scene| scene.device.cogging = None,
        silence: Some(|scene| {
            scene.device.cogging = Some(Cogging {
                torque_n_m: 0.0,
                ..Cogging::default()
            });
        }),
    },
    Effect {
        name: "imbalance",
        place: Place::Shaft,
        field: "device.imbalance",
        typical: "1e-3 N·m",
        source: "10 g at 10 mm",
        of_hand: false,
        is_named: |scene| scene.device.imbalance.is_some(),
        add: |scene| scene.device.imbalance = Some(Imbalance::default()),
        remove: |scene| scene.device.imbalance = None,
        silence: Some(|scene| {
            scene.device.imbalance = Some(Imbalance {
                torque_n_m: 0.0,
                ..Imbalance::default()
            });
        }),
    },
    Effect {
        name: "transmission",
        place: Place::State,
        field: "device.transmission",
        typical: "a first mode at 150 Hz, a twentieth of critical damping, 0.3 of the inertia at the knob",
        source: "estimate: capstan drives have 60 to 300 Hz",
        of_hand: false,
        is_named: |scene| scene.device.transmission.is_some(),
        add: |scene| scene.device.transmission = Some(transmission(scene)),
        remove: |scene| scene.device.transmission = None,
        silence: None,
    },
    Effect {
        name: "play",
        place: Place::Shaft,
        field: "device.transmission.play_rad",
        typical: "1.7e-3 rad (0.1°)",
        source: "estimate",
        of_hand: false,
        is_named: |scene| {
            let transmission = scene.device.transmission.as_ref();
            transmission.is_some_and(|it| it.play_rad > 0.0)
        },
        add: |scene| {
            let given = transmission(scene);
            scene.device.transmission.get_or_insert(given).play_rad = 1.7e-3;
        },
        remove: |scene| {
            if let Some(transmission) = &mut scene.device.transmission {
                transmission.play_rad = 0.0;
            }
        },
        silence: None,
    },
    Effect {
        name: "hand",
        place: Place::Exact,
        field: "operator.grip",
        typical: "the grip medium",
        source: "host-sim/world/src/plant/hand.rs: chosen, not measured",
        of_hand: true,
        is_named: |scene| scene.operator.hand().is_some(),
        add: held,
        remove: |scene| {
            scene.operator = crate::scene::Operator::default();
        },
        silence: None,
    },
    Effect {
        name: "tremor",
        place: Place::Hand,
        field: "operator.tremor",
        typical: "9 Hz, 0.02 rad of the rest point",
        source: "6 to 12 Hz: Lakie et al., J Physiol 593(19) 4411, 2015; the amplitude is an estimate",
        of_hand: true,
        is_named: |scene| scene.operator.tremor.is_some(),
        add: |scene| {
            held(scene);
            scene.operator.tremor = Some(HandTremor::default());
        },
        remove: |scene| scene.operator.tremor = None,
        silence: Some(|scene| {
            held(scene);
            scene.operator.tremor = Some(HandTremor {
                amplitude_rad: 0.0,
                ..HandTremor::default()
            });
        }),
    },
    Effect {
        name: "reflex",
        place: Place::Hand,
        field: "operator.reflex",
        typical: "the hand's own stiffness once more, after 50 ms",
        source: "half of a disturbance is corrected: J Physiol 316, 47, 1981; long-latency responses from 40 to 50 ms: Acta Neurol Scand 79(5) 384, 1989",
        of_hand: true,
        is_named: |scene| scene.operator.reflex.is_some(),
        add: |scene| {
            held(scene);
            let own = scene.operator.hand().map(|hand| hand.stiffness_n_m_per_rad);
            scene.operator.reflex = Some(HandReflex {
                muscle_stiffness_n_m_per_rad: own.unwrap_or_default(),
                ..HandReflex::default()
            });
        },
        remove: |scene| scene.operator.reflex = None,
        silence: Some(|scene| {
            held(scene);
            scene.operator.reflex = Some(HandReflex {
                muscle_stiffness_n_m_per_rad: 0.0,
                ..HandReflex::default()
            });
        }),
    },
];

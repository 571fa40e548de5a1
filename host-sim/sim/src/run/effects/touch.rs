//! Entries of the list of effects for further walls, detents and end stops, and for the velocity estimates of the control law
//! `spring-damper`.

use super::{Effect, Place};
use crate::scene::{
    AddedInertia, CentreSpring, Clicks, DetentRing, DryFriction, Endstops, Environment,
    FurtherWall, Scene, TorqueProfile, ViscousFriction,
};
use touchstone_control::{LawKind, StatesKind, VelocityKind};

fn environment(scene: &mut Scene) -> &mut Environment {
    scene.environment.get_or_insert_default()
}

fn of_environment(scene: &Scene, has: impl Fn(&Environment) -> bool) -> bool {
    scene.environment.as_ref().is_some_and(has)
}

/// Removes a part of a scene's environment, such as its detents. Removes the whole environment if nothing is left in it.
fn rid(scene: &mut Scene, take: impl Fn(&mut Environment)) {
    if let Some(environment) = &mut scene.environment {
        take(environment);
        if *environment == Environment::default() {
            scene.environment = None;
        }
    }
}

fn has_velocity(scene: &Scene, from: VelocityKind) -> bool {
    scene.law.kind == LawKind::SpringDamper && scene.law.velocity.from == from
}

fn damped(scene: &mut Scene, from: VelocityKind) {
    if scene.law.kind != LawKind::SpringDamper {
        scene.law.kind = LawKind::SpringDamper;
        scene.law.states = StatesKind::Measured;
        // Half the damping of the thesis' device, 4e-4 N·m·s/rad. With the default of 0 the velocity would have no effect.
        scene.law.virtual_damping_n_m_s_per_rad = 2e-4;
    }
    scene.law.velocity.from = from;
}

fn as_told(scene: &mut Scene) {
    scene.law.velocity.from = VelocityKind::Told;
}

/// Makes the list's entry for a velocity estimate, which has no magnitude.
const fn velocity(
    name: &'static str,
    typical: &'static str,
    source: &'static str,
    is_named: fn(&Scene) -> bool,
    add: fn(&mut Scene),
) -> Effect {
    Effect {
        name,
        place: Place::Velocity,
        field: "law.velocity.from",
        typical,
        source,
        of_hand: false,
        is_named,
        add,
        remove: as_told,
        silence: None,
    }
}

/// Entries for walls, detents and velocity estimates in the list of effects.
pub const ROWS: [Effect; 9] = [
    Effect {
        name: "second-wall",
        place: Place::Environment,
        field: "environment.wall2",
        typical: "as stiff as the first, solid below a radian before it",
        source: "a knob that turns by some 60° between two ends",
        of_hand: false,
        is_named: |scene| of_environment(scene, |it| it.wall2.is_some()),
        add: |scene| {
            let at_rad = scene.wall.surface_rad - 1.0;
            environment(scene).wall2 = Some(FurtherWall {
                at_rad,
                ..FurtherWall::default()
            });
        },
        remove: |scene| rid(scene, |it| it.wall2 = None),
        silence: None,
    },
    Effect {
        name: "endstops",
        place: Place::Environment,
        field: "environment.endstops",
        typical: "2.6 rad from the wall on either side (300° of travel)",
        source: "the travel of a common potentiometer",
        of_hand: false,
        is_named: |scene| of_environment(scene, |it| it.endstops.is_some()),
        add: |scene| {
            let middle = scene.wall.surface_rad;
            environment(scene).endstops = Some(Endstops {
                lower_rad: middle - 2.6,
                upper_rad: middle + 2.6,
                ..Endstops::default()
            });
        },
        remove: |scene| rid(scene, |it| it.endstops = None),
        silence: None,
    },
    Effect {
        name: "detents",
        place: Place::Environment,
        field: "environment.detents",
        typical: "24 a turn, 0.02 N·m",
        source: "small mechanical encoders have 12 to 30 detents of 5 to 20 mN·m (as recalled)",
        of_hand: false,
        is_named: |scene| of_environment(scene, |it| it.detents.is_some()),
        add: |scene| environment(scene).detents = Some(DetentRing::default()),
        remove: |scene| rid(scene, |it| it.detents = None),
        silence: Some(|scene| {
            environment(scene).detents = Some(DetentRing {
                strength_n_m: 0.0,
                ..DetentRing::default()
            });
        }),
    },
    Effect {
        name: "profile",
        place: Place::Environment,
        field: "environment.profile",
        typical: "6 magnetic detents a turn, 0.02 N·m",
        source: "as strong as the detents above; the shape is this project's",
        of_hand: false,
        is_named: |scene| {
            of_environment(scene, |it| it.profile.is_some() || it.detent_list.is_some())
        },
        add: |scene| {
            let start_rad = scene.wall.surface_rad;
            environment(scene).profile = Some(TorqueProfile {
                start_rad,
                ..TorqueProfile::default()
            });
        },
        remove: |scene| rid(scene, |it| (it.profile, it.detent_list) = (None, None)),
        silence: Some(|scene| {
            environment(scene).profile = Some(TorqueProfile {
                strength_n_m: 0.0,
                ..TorqueProfile::default()
            });
        }),
    },
    Effect {
        name: "feel",
        place: Place::Environment,
        field: "environment.spring",
        typical: "a spring of 0.03 N·m/rad, damping of 0.0005 N·m·s/rad, friction of 5 mN·m and 24 clicks a turn of 20 mN·m",
        source: "a tenth to the whole of the detents' torque above, at some rad/s; the values are this project's",
        of_hand: false,
        is_named: |scene| {
            of_environment(scene, |it| {
                it.spring.is_some()
                    || it.damper.is_some()
                    || it.dry_friction.is_some()
                    || it.click.is_some()
                    || it.inertia.is_some()
            })
        },
        add: |scene| {
            let centre_rad = scene.wall.surface_rad;
            let environment = environment(scene);
            environment.spring = Some(CentreSpring {
                centre_rad,
                ..CentreSpring::default()
            });
            environment.damper = Some(ViscousFriction::default());
            environment.dry_friction = Some(DryFriction::default());
            environment.click = Some(Clicks::default());
        },
        remove: |scene| {
            rid(scene, |it| {
                (it.spring, it.damper, it.dry_friction) = (None, None, None);
                (it.click, it.inertia) = (None, None);
            });
        },
        silence: Some(|scene| {
            let environment = environment(scene);
            environment.spring = Some(CentreSpring {
                strength_n_m: 0.0,
                ..CentreSpring::default()
            });
            environment.damper = Some(ViscousFriction {
                damping_n_m_s_per_rad: 0.0,
                ..ViscousFriction::default()
            });
            environment.dry_friction = Some(DryFriction {
                strength_n_m: 0.0,
                ..DryFriction::default()
            });
            environment.click = Some(Clicks {
                strength_n_m: 0.0,
                ..Clicks::default()
            });
            environment.inertia = Some(AddedInertia {
                inertia_kg_m2: 0.0,
                ..AddedInertia::default()
            });
        }),
    },
    velocity(
        "velocity-filtered",
        "30 Hz, of first order",
        "what drivers of haptic devices do; the cut-off is an estimate",
        |scene| has_velocity(scene, VelocityKind::Filtered),
        |scene| damped(scene, VelocityKind::Filtered),
    ),
    velocity(
        "velocity-foaw",
        "up to 15 ticks",
        "Janabi-Sharifi, Hayward and Chen, IEEE TCST 8(6) 1003, 2000, with the line through both ends",
        |scene| has_velocity(scene, VelocityKind::Foaw),
        |scene| damped(scene, VelocityKind::Foaw),
    ),
    velocity(
        "velocity-kalman",
        "30 Hz, constant velocity",
        "Kalata, IEEE TAES 20(2) 174, 1984; the bandwidth is an estimate",
        |scene| has_velocity(scene, VelocityKind::Kalman),
        |scene| damped(scene, VelocityKind::Kalman),
    ),
    velocity(
        "velocity-kalman-acceleration",
        "30 Hz, constant acceleration",
        "as the one before",
        |scene| has_velocity(scene, VelocityKind::KalmanAcceleration),
        |scene| damped(scene, VelocityKind::KalmanAcceleration),
    ),
];

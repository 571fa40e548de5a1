//! Tests that a scene printed as TOML reads back unchanged, and that the scene's types agree with the list of fields.

use std::collections::BTreeSet;

use super::draft::Draft;
use super::schema::{FIELDS, Kind};
use super::*;
use touchstone_control::{FirstContact, LawKind};

/// Scenes, one per hand motion, that together give every field, many of them with a value other than the default.
fn full_scenes() -> Vec<Scene> {
    let motions = [
        MotionSpec::None,
        MotionSpec::RampAndHold(RampAndHold {
            hold_s: 1.25,
            ..RampAndHold::default()
        }),
        MotionSpec::Tap(Tap {
            velocity_rad_per_s: 1.0 / 3.0,
            ..Tap::default()
        }),
        MotionSpec::PressWiggleRelease(PressWiggleRelease {
            wiggle_frequency_hz: 3.5,
            ..PressWiggleRelease::default()
        }),
        MotionSpec::TouchAndPress(TouchAndPress {
            touch_s: 1.75,
            ..TouchAndPress::default()
        }),
        MotionSpec::Turn(Turn {
            angle_rad: -2.5,
            ..Turn::default()
        }),
        // Any existing file will do, because its content is not read here.
        MotionSpec::Recorded(Recorded {
            scale: -2.0,
            offset_rad: 0.1,
            ..Recorded::new(env!("CARGO_MANIFEST_PATH").into())
        }),
    ];
    let with = |motion| Scene {
        name: "all \"of\" it".into(),
        description: "two lines".into(),
        device: DeviceSpec {
            inertia_kg_m2: 1.0 / 3.0,
            initial_angle_rad: Some(-0.1),
            torque_limit_n_m: Some(1e-12),
            amplifier_step_n_m: Some(1e300),
            friction: Some(Friction {
                kinetic_n_m: 0.01,
                static_n_m: Some(0.1),
                asymmetry_n_m: Some(1e-3),
                stribeck_rad_per_s: Some(0.2),
                bristle_stiffness_n_m_per_rad: Some(7.0),
                bristle_damping_n_m_s_per_rad: Some(0.0),
            }),
            cogging: Some(Cogging {
                periods_per_rev: 42,
                ..Cogging::default()
            }),
            imbalance: Some(Imbalance::default()),
            current_sensor: Some(CurrentSensor::default()),
            current_loop: Some(CurrentLoop::default()),
            transmission: Some(Transmission {
                play_rad: 1.0 / 7.0,
                ..Transmission::default()
            }),
            ..DeviceSpec::default()
        },
        encoder: Some(Encoder {
            counts_per_rev: 16_384.0,
        }),
        seed: Some(4_294_967_295),
        sensor: SensorErrors {
            noise: Some(SensorNoise { rms_rad: 0.0 }),
            periodic: Some(PeriodicError {
                periods_per_rev: 3,
                ..PeriodicError::default()
            }),
        },
        plant: Some(Plant {
            integrator: Integrator::RungeKutta4,
            substeps: 7,
        }),
        timing: Timing {
            rate_hz: 12_345,
            computational_delay_s: 1.7e-3,
            jitter_s: Some(8e-5),
            latency_spread_s: Some(1e-3),
            lost_share: Some(0.0),
            // The longest of the motions needs 3.7 s.
            duration_s: 4.25,
        },
        environment: Some(Environment {
            wall2: Some(FurtherWall {
                stiffness_n_m_per_rad: Some(1.0 / 3.0),
                ..FurtherWall::default()
            }),
            wall3: Some(FurtherWall {
                stiffness_n_m_per_rad: Some(2.5),
                ..FurtherWall::default()
            }),
            wall4: Some(FurtherWall {
                stiffness_n_m_per_rad: Some(0.0),
                ..FurtherWall::default()
            }),
            endstops: Some(Endstops {
                stiffness_n_m_per_rad: Some(7.0),
                ..Endstops::default()
            }),
            detents: Some(DetentRing {
                per_rev: 17,
                ..DetentRing::default()
            }),
            profile: Some(TorqueProfile {
                shape: vec![0.25, -1.0, 1.0],
                ..TorqueProfile::default()
            }),
            detent_list: Some(DetentList {
                positions_rad: vec![-1.0, 0.25, 1.5],
                strengths_n_m: vec![0.01, 0.02, 0.015],
                widths_rad: vec![0.5],
            }),
            spring: Some(CentreSpring {
                centre_rad: 1.0 / 3.0,
                ..CentreSpring::default()
            }),
            damper: Some(ViscousFriction {
                bandwidth_hz: 70.5,
                ..ViscousFriction::default()
            }),
            dry_friction: Some(DryFriction {
                stretch_rad: 0.03,
                ..DryFriction::default()
            }),
            click: Some(Clicks {
                per_rev: 0,
                ..Clicks::default()
            }),
            inertia: Some(AddedInertia {
                bandwidth_hz: 7.25,
                ..AddedInertia::default()
            }),
            ..Environment::default()
        }),
        law: Law {
            kind: LawKind::SfaContinuous,
            first_contact: Some(FirstContact::KeepForce),
            filter: FilterSettings {
                mass_kg_m2: 2e-5,
                ..FilterSettings::default()
            },
            ..Law::default()
        },
        operator: Operator {
            grip: Grip::Custom,
            hand: Some(Hand {
                inertia_kg_m2: 1e-5,
                ..Hand::default()
            }),
            tremor: Some(HandTremor {
                frequency_hz: 8.5,
                ..HandTremor::default()
            }),
            reflex: Some(HandReflex::default()),
            motion,
        },
        ..Scene::default()
    };
    motions.into_iter().map(with).collect()
}

#[test]
fn every_printed_scene_reads_back_as_itself() {
    let shipped = names().into_iter().map(|name| Scene::load(name).unwrap());
    for scene in shipped.chain(full_scenes()).chain([Scene {
        name: "bare".into(),
        ..Scene::default()
    }]) {
        let text = scene.to_toml();
        let again = parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!(again, scene, "\n{text}");
    }
}

#[test]
fn printing_names_every_field_or_says_what_its_absence_means() {
    let text = Scene::load("press-hold").unwrap().to_toml();
    for field in FIELDS.iter().filter(|field| field.suits("ramp-and-hold")) {
        let listed =
            text.contains(field.name()) || text.contains(&format!("# [{}] absent", field.table()));
        assert!(listed, "{} is missing from\n{text}", field.path);
    }
    for line in [
        "# [encoder] absent: exact position",
        "# torque_limit_n_m absent: no limit",
        "inertia_kg_m2 = 0.0001                       # the device's moment of inertia in kg·m²",
        "rate_hz = 1000                               # the control rate in Hz",
    ] {
        assert!(
            text.lines().any(|printed| printed == line),
            "{line} is missing from\n{text}"
        );
    }
}

#[test]
fn types_and_schema_name_the_same_fields() {
    let mut typed = BTreeSet::new();
    for scene in full_scenes() {
        let draft = Draft::from_scene(&scene);
        let motion = scene.operator.motion.name();
        let fields: BTreeSet<&str> = FIELDS
            .iter()
            .filter(|field| field.suits(motion))
            .map(|field| field.path)
            .collect();
        assert_eq!(
            draft
                .fields
                .keys()
                .map(String::as_str)
                .collect::<BTreeSet<_>>(),
            fields,
            "motion {motion}"
        );
        typed.extend(draft.fields.into_keys());
    }
    assert_eq!(typed.len(), FIELDS.len());
}

#[test]
fn every_number_ends_in_its_unit() {
    let without = FIELDS.iter().filter(|field| {
        matches!(field.kind, Kind::Number(_) | Kind::Whole(..)) && field.stem().is_none()
    });
    let names: Vec<&str> = without.map(|field| field.name()).collect();
    assert_eq!(
        names,
        [
            "seed",
            "periods_per_rev",
            "knob_share",
            "counts_per_rev",
            "periods_per_rev",
            "substeps",
            "lost_share",
            "per_rev",
            "per_rev",
            "per_rev",
            "step_of_ideal_per_ms",
            "limit_of_force_per_ms",
            "limit_of_penetration_per_ms",
            "share_of_damping",
            "share_of_momentum",
            "vibration_share_of_speed",
            "scale"
        ]
    );
    assert!(
        FIELDS
            .iter()
            .all(|field| field.unit.is_empty() || !field.unit_shown().is_empty())
    );
}

#[test]
fn every_word_of_a_choice_is_understood() {
    let scenes = full_scenes();
    for field in FIELDS {
        let Kind::Choice(words) = field.kind else {
            continue;
        };
        // A grip or motion needs further fields, so other tests cover it.
        for word in words
            .iter()
            .filter(|_| !field.path.starts_with("operator."))
        {
            let scene = scenes[0]
                .with_overrides(&[format!("{}={word}", field.path)])
                .unwrap_or_else(|error| panic!("{error}"));
            let value = Draft::from_scene(&scene).fields[field.path].clone();
            assert_eq!(value.as_str(), Some(*word));
        }
    }
    let motions: Vec<&str> = scenes
        .iter()
        .map(|scene| scene.operator.motion.name())
        .collect();
    assert_eq!(
        Kind::Choice(&motions.leak()[..]),
        schema::at(schema::MOTION_KIND).unwrap().kind
    );
    let grips = [
        Grip::None,
        Grip::Light,
        Grip::Medium,
        Grip::Firm,
        Grip::Custom,
    ]
    .map(Grip::name);
    assert_eq!(
        Kind::Choice(&Vec::from(grips).leak()[..]),
        schema::at("operator.grip").unwrap().kind
    );
}

#[test]
fn a_bare_scene_has_the_defaults_and_no_effects() {
    let scene = parse("").unwrap();
    assert_eq!(
        scene,
        Scene {
            name: "s".into(),
            ..Scene::default()
        }
    );
    assert_eq!(
        (
            &scene.encoder,
            &scene.device.friction,
            scene.operator.hand()
        ),
        (&None, &None, None)
    );
    assert_eq!(scene.hold_window_s(), None);
    assert_eq!(
        (scene.timing.ticks(), scene.timing.period_s()),
        (3000, 1e-3)
    );
    // A table without fields switches the effect on with its defaults.
    assert_eq!(
        parse("[encoder]").unwrap().encoder,
        Some(Encoder {
            counts_per_rev: 40_000.0
        })
    );
    // A hand without a grip has the grip `custom`; values that it leaves out are those of the medium grip.
    let operator = parse("[operator.hand]\ninertia_kg_m2 = 1e-5")
        .unwrap()
        .operator;
    assert_eq!(operator.grip, Grip::Custom);
    assert_eq!(
        operator.hand(),
        Some(Hand {
            inertia_kg_m2: 1e-5,
            ..Grip::Medium.hand().unwrap()
        })
    );
}

#[test]
fn the_medium_grip_is_the_published_one_at_15_mm() {
    let hand = Grip::Medium.hand().unwrap();
    let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
    assert!(
        close(hand.pad_stiffness_n_m_per_rad, 0.1575)
            && close(hand.pad_damping_n_m_s_per_rad, 1e-4)
    );
    assert!(close(hand.inertia_kg_m2, 6.75e-5) && close(hand.damping_n_m_s_per_rad, 6.75e-4));
    assert!(close(hand.stiffness_n_m_per_rad, 0.0225));
}

#[test]
fn the_first_contact_rule_is_the_laws_own_unless_given() {
    let rule = |kind| {
        Law {
            kind,
            ..Law::default()
        }
        .first_contact()
    };
    assert_eq!(rule(LawKind::Sfa), FirstContact::KeepForce);
    assert_eq!(rule(LawKind::EnhancedSfa), FirstContact::ZeroOffset);
    let given = Law {
        kind: LawKind::Sfa,
        first_contact: Some(FirstContact::ZeroOffset),
        ..Law::default()
    };
    assert_eq!(given.first_contact(), FirstContact::ZeroOffset);
}

#[test]
fn shipped_scenes_are_what_their_names_say() {
    let scene = |name| Scene::load(name).unwrap();
    assert!(
        names()
            .into_iter()
            .all(|name| scene(name).name == name && !scene(name).description.is_empty())
    );
    let knob = scene("thesis-knob");
    assert_eq!(
        (
            knob.device.torque_limit_n_m,
            knob.wall.k_desired_n_m_per_rad
        ),
        (Some(0.5), 5.0)
    );
    assert_eq!(
        (knob.encoder.map(|e| e.counts_per_rev), knob.operator.grip),
        (Some(40_000.0), Grip::Medium)
    );
    assert_eq!(scene("free-release").operator, Operator::default());
    assert!(scene("free-release").device.initial_angle_rad > Some(0.5));
    assert!(
        scene("low-stiffness").wall.k_desired_n_m_per_rad
            < scene("low-stiffness").law.k_soft_n_m_per_rad
    );
    for name in ["tap", "press-wiggle-release"] {
        assert_eq!(scene(name).operator.motion.name(), name);
    }
    assert_eq!(
        scene("press-hold").operator.motion,
        MotionSpec::RampAndHold(RampAndHold::default())
    );
    assert_eq!(
        scene("press-hold").hold_window_s(),
        Some((0.1 + 0.5 + 0.75, 0.1 + 0.5 + 1.5))
    );
}

/// Tests that a control setting written as decimal text becomes the same bits in a scene and on a device.
#[test]
fn a_setting_means_the_same_in_a_scene_and_on_a_device() {
    use touchstone_control::{Field, PositionSettings, Settings};
    use touchstone_protocol::DeviceSettings;
    use touchstone_protocol::settings::{Decimal, VALUE_MAX, fields};

    // The position settings differ, because the scene has no encoder and the device has one. All other settings must agree.
    let told = |scene: &Scene| Settings {
        position: PositionSettings::default(),
        ..scene.settings().unwrap()
    };
    assert_eq!(told(&Scene::default()), Settings::default());
    let mut seen = vec![Settings::default()];
    for path in Field::ALL.iter().map(|field| field.path()) {
        let mut buffer = [0; VALUE_MAX];
        let (text, bytes) = match fields::field(path).expect(path).kind {
            // Not the default, within both ranges, and exact in decimals and in binary.
            fields::Kind::Number { .. } => {
                let value = match path {
                    "law.impact.vibration_hz" => Decimal::lit("2"),
                    _ => Decimal::lit("0.046875"),
                };
                (value.to_string(), postcard::to_slice(&value, &mut buffer))
            }
            fields::Kind::Whole { .. } => {
                ("2000".into(), postcard::to_slice(&2000_u32, &mut buffer))
            }
            fields::Kind::Choice(words) => {
                let scene = Draft::from_scene(&Scene::default())
                    .fields
                    .get(path)
                    .cloned();
                let other = words
                    .iter()
                    .position(|word| scene.as_ref().and_then(|it| it.as_str()) != Some(word));
                let number = other.expect("two words") as u32;
                (
                    words[number as usize].to_owned(),
                    postcard::to_slice(&number, &mut buffer),
                )
            }
            fields::Kind::Flag => {
                let is_on = Draft::from_scene(&Scene::default()).fields.get(path)
                    == Some(&toml::Value::Boolean(true));
                (
                    (!is_on).to_string(),
                    postcard::to_slice(&!is_on, &mut buffer),
                )
            }
        };
        let scene = Scene::default()
            .with_overrides(&[format!("{path}={text}")])
            .unwrap_or_else(|error| panic!("{error}"));
        let mut device = DeviceSettings::default();
        device.set(path, bytes.unwrap()).expect(path);
        let settings = told(&scene);
        let on_device = Settings {
            position: PositionSettings::default(),
            ..device.law()
        };
        assert_eq!(settings, on_device, "{path}");
        assert!(
            !seen.contains(&settings),
            "{path} changes nothing, or what another changes"
        );
        seen.push(settings);
        // The printed scene has the same value.
        assert_eq!(told(&parse(&scene.to_toml()).unwrap()), settings);
    }
}

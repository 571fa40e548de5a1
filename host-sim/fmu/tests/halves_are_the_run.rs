//! Tests that both halves of a scene, stepped in turn through their variables, give the same bits as the run of the scene.

use touchstone_control::ChangeOfForce;
use touchstone_fmu::Half;
use touchstone_fmu::model::Model;
use touchstone_fmu::variables::Name;
use touchstone_sim::run::{Recorder, Tick, watch};
use touchstone_sim::scene::{self, MotionSpec, Scene};

/// All ticks of a run.
struct All(Vec<Tick>);

impl Recorder for All {
    fn record(&mut self, tick: &Tick) {
        self.0.push(*tick);
    }
}

fn get(model: &Model, name: Name) -> f64 {
    model.number(name as u32).expect("a number")
}

fn set(model: &mut Model, name: Name, value: f64) {
    model.set(name as u32, value).expect("an input");
}

/// Law and plant of one scene.
struct Pair {
    law: Model,
    plant: Model,
    period_s: f64,
    has_change: bool,
}

impl Pair {
    fn new(scene: &Scene) -> Self {
        let half = |half| Model::of(scene.clone(), half).expect("a half");
        Self {
            law: half(Half::Law),
            plant: half(Half::Plant),
            period_s: scene.timing.period_s(),
            has_change: scene.law.guard.on && scene.law.guard.change == ChangeOfForce::Measured,
        }
    }

    /// Passes the plant's angles to the law.
    fn measure(&mut self) {
        set(
            &mut self.law,
            Name::MeasuredAngle,
            get(&self.plant, Name::Angle),
        );
        if self.has_change {
            set(
                &mut self.law,
                Name::MeasuredChange,
                get(&self.plant, Name::Change),
            );
        }
    }

    fn command(&mut self) {
        set(&mut self.plant, Name::Command, get(&self.law, Name::Torque));
    }

    fn step(&mut self, index: u64, half: Half) {
        let time_s = index as f64 * self.period_s;
        let model = match half {
            Half::Law => &mut self.law,
            Half::Plant => &mut self.plant,
        };
        let ticks = model.ticks_of(time_s, self.period_s).expect("a step");
        assert_eq!(ticks, 1);
        model.step(ticks).expect("a step");
    }
}

fn same(one: f64, other: f64) -> bool {
    one.to_bits() == other.to_bits() || one.is_nan() && other.is_nan()
}

/// Steps in every tick first the law, then the plant, and compares their values with the run of the scene. Returns the number of
/// ticks.
fn compare(name: &str, scene: &Scene) -> u64 {
    let ticks = watch(scene, All(Vec::new())).expect("a run").0;
    let mut pair = Pair::new(scene);
    let mut absorbed_j = 0.0;
    for tick in &ticks {
        let at = (name, tick.index);
        assert!(
            same(get(&pair.plant, Name::Angle), tick.angle_rad),
            "{at:?}"
        );
        assert!(
            same(get(&pair.plant, Name::Velocity), tick.velocity_rad_per_s),
            "{at:?}"
        );
        if scene.operator.hand().is_some() {
            assert!(same(get(&pair.plant, Name::Hand), tick.hand_rad), "{at:?}");
        }
        pair.measure();
        pair.step(tick.index, Half::Law);
        assert!(
            same(get(&pair.law, Name::Penetration), tick.told_rad),
            "{at:?}"
        );
        if let Some(guard) = tick.inside.guard {
            assert!(
                same(get(&pair.law, Name::Account), guard.account_j),
                "{at:?}"
            );
            let truth = |name| pair.law.truth(name as u32).expect("a truth value");
            assert_eq!(
                (truth(Name::Limited), truth(Name::Tripped)),
                (guard.limited, guard.tripped),
                "{at:?}"
            );
        }
        pair.command();
        pair.step(tick.index, Half::Plant);
        absorbed_j += tick.absorbed_j;
        assert!(same(get(&pair.plant, Name::Absorbed), absorbed_j), "{at:?}");
    }
    ticks.len() as u64
}

#[test]
fn both_halves_of_every_shipped_scene_give_the_bits_of_its_run() {
    let mut ticks = 0;
    for name in [scene::names(), scene::feels()].concat() {
        let scene = Scene::load(name).expect("a shipped scene");
        ticks += compare(name, &scene);
    }
    assert!(ticks > 100_000, "{ticks}");
}

/// Runs the main scene for a hundred thousand ticks, also with effects that keep states of their own.
#[test]
fn a_long_run_with_delay_noise_and_a_second_reading_has_the_same_bits() {
    let scene = Scene::load("press-wiggle-release").expect("a scene");
    let rate_hz = f64::from(scene.timing.rate_hz);
    let long = format!("timing.duration_s={}", 100_001.0 / rate_hz);
    let late = [
        "timing.computational_delay_s=1e-4",
        "timing.jitter_s=2e-5",
        "law.guard.delay_s=1.3e-4",
        "law.guard.change=measured",
        "sensor.noise.rms_rad=1e-4",
        "operator.tremor.amplitude_rad=0.002",
    ];
    for sets in [&[][..], &late[..]] {
        let mut sets: Vec<String> = sets.iter().map(ToString::to_string).collect();
        sets.push(long.clone());
        let scene = scene.with_overrides(&sets).expect("a scene");
        assert!(compare("long", &scene) > 100_000);
    }
}

/// Stepped side by side, both halves get the other half's values of the previous step. The run of the scene with one more period
/// of delay gives the same bits.
#[test]
fn side_by_side_is_one_period_of_delay_more() {
    let scene = Scene::load("thesis-knob").expect("a scene");
    let delay = format!("timing.computational_delay_s={:?}", scene.timing.period_s());
    let late = scene.with_overrides(&[delay]).expect("a scene");
    let ticks = watch(&late, All(Vec::new())).expect("a run").0;
    let mut pair = Pair::new(&scene);
    for tick in &ticks {
        assert!(
            same(get(&pair.plant, Name::Angle), tick.angle_rad),
            "{}",
            tick.index
        );
        pair.measure();
        pair.command();
        pair.step(tick.index, Half::Law);
        pair.step(tick.index, Half::Plant);
    }
}

/// Checks that the input `hand_offset_rad` can replace the scene's motion: with the rest points of a tap, the knob enters the wall.
#[test]
fn the_hand_can_be_moved_from_outside() {
    let tap = Scene::load("tap").expect("a scene");
    let ticks = watch(&tap, All(Vec::new())).expect("a run").0;
    let mut still = tap.clone();
    still.device.initial_angle_rad = Some(0.0);
    still.operator.motion = MotionSpec::None;
    let mut pair = Pair::new(&still);
    let mut furthest: f64 = 0.0;
    for tick in &ticks {
        pair.measure();
        pair.step(tick.index, Half::Law);
        pair.command();
        set(&mut pair.plant, Name::HandOffset, tick.rest_rad);
        pair.step(tick.index, Half::Plant);
        furthest = furthest.max(get(&pair.plant, Name::Angle) - still.wall.surface_rad);
    }
    assert!(furthest > 1e-4, "{furthest}");
}

#[test]
fn wrong_calls_are_refused_in_one_line() {
    let scene = Scene::load("thesis-knob").expect("a scene");
    let mut pair = Pair::new(&scene);
    let period_s = scene.timing.period_s();
    pair.step(0, Half::Law);
    let law = &mut pair.law;
    let wrong = [
        law.ticks_of(0.0, period_s).map(drop),
        law.ticks_of(period_s, 0.5 * period_s).map(drop),
        law.ticks_of(period_s, 0.0).map(drop),
        law.ticks_of(period_s, -period_s).map(drop),
        law.ticks_of(period_s, f64::NAN).map(drop),
        law.ticks_of(period_s, 1e300).map(drop),
        law.ticks_of(f64::INFINITY, period_s).map(drop),
        law.set(Name::Torque as u32, 1.0),
        law.set(Name::MeasuredAngle as u32, f64::NAN),
        law.set(Name::Command as u32, 1.0),
        law.set(99, 1.0),
        law.number(Name::Limited as u32).map(drop),
        law.truth(Name::Torque as u32).map(drop),
        law.start_at(f64::NAN),
    ];
    for (index, wrong) in wrong.into_iter().enumerate() {
        let said = wrong.expect_err(&index.to_string()).to_string();
        assert!(
            said.contains(": ") && said.contains("; ") && !said.contains('\n'),
            "{said}"
        );
    }
    assert_eq!(law.ticks_of(period_s, 4.0 * period_s), Ok(4));
    set(&mut pair.plant, Name::Command, f64::MAX);
    assert!(pair.plant.step(1000).is_err());
    pair.plant.reset().expect("as new");
    assert_eq!(pair.plant.step(1000), Ok(()));
    // A clock that adds up the steps.
    let mut time_s = 0.0;
    law.reset().expect("as new");
    for _ in 0..100_000 {
        let ticks = law.ticks_of(time_s, period_s).expect("a step");
        law.step(ticks).expect("a step");
        time_s += period_s;
    }
}

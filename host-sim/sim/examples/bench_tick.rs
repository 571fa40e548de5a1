//! Measures the computing time per control period (tick), and the cost of more accurate number formats: `cargo run --release
//! --example bench_tick`.
//!
//! The first part times whole ticks of the simulation without logging. The second part times the control law alone in each number
//! format, on encoder counts from a simulation of the thesis' knob, and prints the largest force difference to f64. Times are
//! minimum and median of several repeats, in wall-clock time of one core. The repeats alternate between the measured cases, so that
//! a disturbance of the machine affects all cases alike.

use std::hint::black_box;
use std::time::Instant;
use touchstone_control::{CountScale, Fixed16, Fixed32, LawKind, Reported, Si};
use touchstone_sim::error::Result;
use touchstone_sim::run::wall::{Controlled, Wall};
use touchstone_sim::run::{self, Recorder, Tick};
use touchstone_sim::scene::Scene;

const REPEATS: usize = 100;

/// Setting that makes the hold last 20 s of simulated time. The device is then in contact for nearly the whole simulation. The
/// computation takes only a millisecond or two, so that some repeats run undisturbed.
const HOLD_S: &str = "operator.motion.hold_s=20";
const DURATION_S: &str = "timing.duration_s=23";

/// Records the number of ticks with a force, and the measured position at each tick, from which encoder counts are computed.
#[derive(Default)]
struct Contact {
    ticks: u64,
    told_rad: Vec<f64>,
    step_rad: f64,
    surface_rad: f64,
}

impl Recorder for Contact {
    fn record(&mut self, tick: &Tick) {
        self.ticks += u64::from(tick.force_n_m != 0.0);
        self.told_rad.push(tick.told_rad);
    }
}

impl Contact {
    fn of(scene: &Scene) -> Result<Self> {
        let encoder = scene.encoder.as_ref();
        let start = Contact {
            step_rad: encoder.map_or(1.0, |encoder| encoder.step_rad()),
            surface_rad: scene.wall.surface_rad,
            ..Contact::default()
        };
        run::watch(scene, start)
    }

    fn percent(&self) -> f64 {
        100.0 * self.ticks as f64 / self.told_rad.len() as f64
    }

    fn counts(&self) -> Vec<i64> {
        let count = |told: &f64| ((told + self.surface_rad) / self.step_rad).round() as i64;
        self.told_rad.iter().map(count).collect()
    }
}

/// Minimum and median of the times, ns per tick.
fn statistics(mut times: Vec<f64>) -> (f64, f64) {
    times.sort_by(f64::total_cmp);
    (times[0], times[times.len() / 2])
}

fn timed(ticks: usize, work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64() * 1e9 / ticks as f64
}

fn whole_ticks() -> Result<()> {
    let press = Scene::load("thesis-knob")?.with_overrides(&[HOLD_S, DURATION_S])?;
    let steady = Scene::load("press-wiggle-release")?
        .with_overrides(&["operator.motion.wiggle_s=20", "timing.duration_s=23"])?;
    let without = |scene: &Scene| {
        let mut scene = scene.clone();
        scene.device.friction = None;
        scene
    };
    let sprung = |scene: &Scene| {
        let mut scene = scene.clone();
        scene.law.kind = LawKind::Spring;
        scene.wall.k_desired_n_m_per_rad = 0.5;
        scene
    };
    let rows = [
        ("hold, friction, enhanced", press.clone()),
        ("hold, no friction, enhanced", without(&press)),
        ("wiggle, friction, enhanced", steady.clone()),
        ("wiggle, no friction, enhanced", without(&steady)),
        ("wiggle, friction, spring", sprung(&steady)),
        ("wiggle, no friction, spring", sprung(&without(&steady))),
    ];
    let mut times = vec![Vec::new(); rows.len()];
    let mut contact = Vec::new();
    for (_, scene) in &rows {
        contact.push(Contact::of(scene)?);
    }
    for _ in 0..REPEATS {
        for (row, (_, scene)) in rows.iter().enumerate() {
            let ticks = contact[row].told_rad.len();
            let mut failed = None;
            times[row].push(timed(ticks, || failed = run::simulate(scene, None).err()));
            failed.map_or(Ok(()), Err)?;
        }
    }
    println!("plant, encoder (40,000 counts), law (fixed32), torque limit; logging off");
    println!(
        "{:<32}{:>10}{:>10}{:>14}",
        "", "min ns", "median", "contact, %"
    );
    for (((name, _), times), contact) in rows.iter().zip(times).zip(&contact) {
        let (min, median) = statistics(times);
        println!(
            "{name:<32}{min:>10.1}{median:>10.1}{:>14.1}",
            contact.percent()
        );
    }
    Ok(())
}

/// A control law in one number format: takes encoder counts, one per tick, and returns the forces.
type Law = Box<dyn FnMut(&[i64]) -> Vec<f64>>;

fn law<N: Reported + 'static>(scene: &Scene) -> Law {
    let scene = scene.clone();
    Box::new(move |counts| {
        let encoder = scene.encoder.as_ref().expect("a scene with an encoder");
        let surface = Si::from_num(scene.wall.surface_rad);
        let scale = CountScale::new(encoder.counts_per_rev as u32, surface).expect("counts");
        let settings = scene.settings().expect("a scene that has run");
        let mut wall = Controlled::<N>::new(&settings, scale).expect("a scene that fits");
        counts.iter().map(|&count| wall.at_count(count)).collect()
    })
}

fn number_formats() -> Result<()> {
    let scene = Scene::load("thesis-knob")?.with_overrides(&[HOLD_S, DURATION_S])?;
    let contact = Contact::of(&scene)?;
    let counts = contact.counts();
    let mut rows: [(&str, Law); 4] = [
        ("fixed32", law::<Fixed32>(&scene)),
        ("fixed16", law::<Fixed16>(&scene)),
        ("f32", law::<f32>(&scene)),
        ("f64", law::<f64>(&scene)),
    ];
    let reference = rows[3].1(&counts);
    let mut times = vec![Vec::new(); rows.len()];
    let mut errors = vec![0.0_f64; rows.len()];
    for _ in 0..REPEATS {
        for (row, (_, law)) in rows.iter_mut().enumerate() {
            let mut forces = Vec::new();
            times[row].push(timed(counts.len(), || forces = black_box(law(&counts))));
            errors[row] = forces
                .iter()
                .zip(&reference)
                .map(|(force, reference)| (force - reference).abs())
                .fold(0.0, f64::max);
        }
    }
    println!();
    println!(
        "what accuracy costs: enhanced law at 5 N·m/rad, count to force, {:.1} % in contact",
        contact.percent()
    );
    println!(
        "{:<32}{:>10}{:>10}{:>22}",
        "", "min ns", "median", "largest error, N·m"
    );
    for (((name, _), times), error) in rows.iter().zip(times).zip(errors) {
        let (min, median) = statistics(times);
        println!("{name:<32}{min:>10.1}{median:>10.1}{error:>22.1e}");
    }
    Ok(())
}

fn main() -> std::process::ExitCode {
    match whole_ticks().and_then(|()| number_formats()) {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            std::process::ExitCode::from(2)
        }
    }
}

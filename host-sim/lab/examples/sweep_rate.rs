//! Compares the speed of a parameter sweep on one core with that of single runs of the same scenes: `cargo run --release -p
//! touchstone-lab --example sweep_rate -- [CELLS per axis, default 40] [REPEATS, default 5]`.
//!
//! Each scene lasts 2 s at 1 kHz. Three measurements alternate, so that a disturbance of the machine affects all of them:
//!
//! - every cell by `touchstone_lab::sweep`, from an empty folder to rows in a file
//! - every cell as a single run of a scene that is ready in memory
//! - long runs of the scene in the middle of the map, held in the wall, whose preparation takes negligible time
//!
//! On Linux the times are processor time of this program, elsewhere clock time.

use std::error::Error;
use std::time::Instant;
use touchstone_lab::sweep::store::{Shard, Store};
use touchstone_lab::sweep::{Sweep, use_threads};
use touchstone_report::ProgramVersion;
use touchstone_sim::run;
use touchstone_sim::scene::{MotionSpec, Scene};

/// Processor time of all threads of this program in seconds. Where the system does not report it, the clock time since `begun`.
fn busy_s(begun: Instant) -> f64 {
    let of_threads = || {
        let mut total = 0;
        for thread in std::fs::read_dir("/proc/self/task").ok()? {
            let text = std::fs::read_to_string(thread.ok()?.path().join("schedstat")).ok()?;
            total += text.split_whitespace().next()?.parse::<u64>().ok()?;
        }
        Some(total as f64 * 1e-9)
    };
    of_threads().unwrap_or_else(|| begun.elapsed().as_secs_f64())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let cells: u32 = words.next().map_or(Ok(40), |word| word.parse())?;
    let repeats: u32 = words.next().map_or(Ok(5), |word| word.parse())?;
    use_threads(1)?;
    let begun = Instant::now();
    let scene = Scene::load("thesis-knob")?.with_overrides(&[
        "operator.motion.kind=ramp-and-hold",
        "operator.motion.hold_s=1",
        "timing.duration_s=2",
    ])?;
    for law in ["enhanced-sfa", "spring"] {
        let base = scene.with_overrides(&[format!("law.kind={law}")])?;
        let x = format!("wall.k_desired_n_m_per_rad=0.5..10:{cells}");
        let y = format!("device.inertia_kg_m2=5e-5..5e-4:{cells}:log");
        let sweep = Sweep::new(
            &base,
            [&x, &y],
            &[],
            ProgramVersion::default(),
            "sweep_rate",
        )?;
        let mut scenes = sweep.grid.scenes();
        let ready: Vec<Scene> = (0..sweep.grid.cells())
            .map(|cell| scenes.of_cell(cell))
            .collect::<Result<_, _>>()?;
        let mut long = ready[ready.len() / 2].clone();
        long.timing.duration_s = 2.0 * f64::from(cells);
        if let MotionSpec::RampAndHold(press) = &mut long.operator.motion {
            press.hold_s = long.timing.duration_s - 1.0;
        }
        let folder = std::env::temp_dir().join(format!("touchstone-rate-{}", std::process::id()));
        let (mut shares, mut rates) = (Vec::new(), Vec::new());
        for _ in 0..repeats {
            let _ = std::fs::remove_dir_all(&folder);
            let before = busy_s(begun);
            let mut store = Store::open(&folder, &sweep, true)?;
            sweep.fill(&mut store, Shard::WHOLE, |_| ())?;
            let swept = busy_s(begun) - before;
            let before = busy_s(begun);
            for scene in &ready {
                std::hint::black_box(run::run(scene, false)?);
            }
            let single = busy_s(begun) - before;
            let before = busy_s(begun);
            for _ in 0..cells {
                std::hint::black_box(run::run(&long, false)?);
            }
            let of_long = busy_s(begun) - before;
            shares.push([single / swept, of_long / swept]);
            rates.push(2e-3 * f64::from(cells * cells) / swept);
        }
        std::fs::remove_dir_all(&folder)?;
        let ends = |of: &dyn Fn(&[f64; 2]) -> f64| {
            let mut all: Vec<f64> = shares.iter().map(of).collect();
            all.sort_by(f64::total_cmp);
            (all[0], all[all.len() / 2], all[all.len() - 1])
        };
        let (least, median, most) = ends(&|share| share[0]);
        println!(
            "{law}: {cells} x {cells} cells; of the single runs' rate {least:.3}, {median:.3}, {most:.3} (least, median, most of {repeats})"
        );
        let (least, median, most) = ends(&|share| share[1]);
        println!("  of one long run's rate {least:.3}, {median:.3}, {most:.3}");
        rates.sort_by(f64::total_cmp);
        println!(
            "  {:.2} million ticks a second and core",
            rates[rates.len() / 2]
        );
    }
    Ok(())
}

//! Runs so many ticks of a named configuration and nothing else: `tick_cost NAME TICKS`, `tick_cost --list`.
//!
//! For counting instructions: two runs of different length under callgrind differ by what the ticks between them cost, exactly.
//! The names ending in `-by-hand` are the minimal loops of [`by_hand`], written without plan and chain; the others are what
//! the plan makes of a scene.

mod by_hand;
mod scenes;

use scenes::{CONFIGURATIONS, Pressed, scene};
use std::hint::black_box;
use std::process::ExitCode;
use touchstone_sim::run::chain::{Amplifier, Crossing, Sensor};
use touchstone_sim::run::plan::{self, Prepared, Visitor};
use touchstone_sim::run::wall::Wall;
use touchstone_sim::run::{self};
use touchstone_sim::scene::Motion;
use touchstone_world::plant::Motion as _;

/// So many ticks of whatever the plan has prepared.
struct Ticks {
    ticks: u64,
    period_s: f64,
}

impl Visitor for Ticks {
    type Output = f64;

    fn visit<C: Crossing, S: Sensor, A: Amplifier>(
        self,
        prepared: Prepared<C, S, A>,
        wall: &mut dyn Wall,
        motion: &Motion,
    ) -> f64 {
        let pressed = Prepared {
            crossing: prepared.crossing,
            state: prepared.state,
            sensor: prepared.sensor,
            amplifier: Pressed::new(prepared.amplifier),
        };
        run::follow(pressed, wall, motion, self.ticks, self.period_s, &mut ()).position()
    }
}

fn planned(name: &str, ticks: u64) -> Option<f64> {
    let scene = scene(name)?;
    let mut wall = run::wall(&scene).ok()?;
    let visitor = Ticks {
        ticks,
        period_s: scene.timing.period_s(),
    };
    plan::prepare(&scene, wall.as_mut(), visitor).ok()
}

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let done = match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["--list"] => {
            for (name, _) in CONFIGURATIONS {
                println!("{name}");
            }
            return ExitCode::SUCCESS;
        }
        [name, ticks] => ticks.parse().ok().and_then(|ticks| match name {
            "bare-by-hand" => by_hand::bare(ticks),
            "held-by-hand" => by_hand::held_with_encoder(ticks),
            _ => planned(name, ticks),
        }),
        _ => None,
    };
    match done {
        Some(end) => {
            // Bits, so that two loops can be compared.
            println!("{:016x}", black_box(end).to_bits());
            ExitCode::SUCCESS
        }
        None => {
            eprintln!("give a name from --list and a number of ticks");
            ExitCode::from(2)
        }
    }
}

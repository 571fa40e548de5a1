//! `touchstone scorecard --family`: tests a wall with fixed settings on a set of simulated devices that differ in inertia, damping,
//! delay, encoder and grip.

use super::expect::NOT_MET;
use super::number;
use super::out::{self, say};
use super::progress;
use std::process::ExitCode;
use touchstone_lab::scorecard::family::{Around, Devices, Family, corners, judge, sample};
use touchstone_lab::scorecard::family_page::text;
use touchstone_sim::error::Result;
use touchstone_sim::scene::Scene;

/// Options of the test on a set of varied devices.
#[derive(Debug, Clone, clap::Args)]
#[group(id = "family-options")]
#[command(next_help_heading = "Variants of the device, all with the same settings")]
pub struct Options {
    /// Touches and presses 216 device variants: three simulated grips (light, medium, firm), two encoders, half, once and double
    /// inertia and damping, and four delays up to a control period. Exit code 3 if more variants are lost than --most-lost.
    #[arg(long, conflicts_with_all = ["tuned", "out", "programme"])]
    family: bool,
    /// Also judges this many random device variants between those, on separate lines, with hands between the grips and a little
    /// beyond, drawn by --seed.
    #[arg(long, value_name = "N", requires = "family", default_value_t = 0)]
    members: usize,
    /// For a scene with measured inertia and damping: judges 81 variants within 10 % of both, with delays up to half a control
    /// period. Their touches are compared with those of an ideal damped wall.
    #[arg(long, requires = "family", conflicts_with = "members")]
    measured: bool,
    /// Stiffnesses of the wall, N·m/rad; default: the scene's.
    #[arg(long, value_name = "K", requires = "family", num_args = 1.., value_parser = number::up_to(1e6, "N·m/rad"))]
    walls: Vec<f64>,
    /// Control rates, Hz, each combined with every noise; default: the scene's.
    #[arg(long, value_name = "HZ", requires = "family", num_args = 1.., value_parser = clap::value_parser!(u32).range(1..=100_000))]
    rates: Vec<u32>,
    /// Noise of the position sensor, degrees rms; default: the scene's.
    #[arg(long, value_name = "DEG", requires = "family", num_args = 1.., value_parser = number::within(0.0, 10.0, "degrees"))]
    noise: Vec<f64>,
    /// Number of device variants on which each wall may be lost (a press or touch too deep, or its stiffness far off), in each line:
    /// combinations and random variants are counted apart. Does not count variants on which no tuned law can hold the wall.
    #[arg(long, value_name = "N", requires = "family", default_value_t = 0)]
    most_lost: usize,
    /// Largest allowed depth of press and touch, as a multiple of F/k_de (force over stiffness of the wall).
    #[arg(long, value_name = "RATIO", requires = "family", value_parser = number::up_to(5.0, "times F/k_de"))]
    deepest: Option<f64>,
}

impl Options {
    /// Whether the user requested the test on a set of varied devices.
    pub fn is_asked(&self) -> bool {
        self.family
    }

    /// Tests each control law with each stiffness on all device variants, and prints the results.
    pub fn main(&self, scene: &Scene, laws: &[(String, Scene)], seed: u64) -> Result<ExitCode> {
        let mut sets = vec![match self.measured {
            true => Devices::Measured,
            false => Devices::Corners,
        }];
        if self.members > 0 {
            sets.push(Devices::Random);
        }
        let around = sets.into_iter().map(|devices| Around {
            devices,
            rates_hz: self.rates.clone(),
            noise_deg: self.noise.clone(),
        });
        let around: Vec<Around> = around.collect();
        let mut walls = self.walls.clone();
        if walls.is_empty() {
            walls.push(scene.wall.k_desired_n_m_per_rad);
        }
        let mut families: Vec<Family> = Vec::new();
        for (law, scene) in laws {
            for k_desired in &walls {
                let mut wall = scene.clone();
                wall.wall.k_desired_n_m_per_rad = *k_desired;
                for around in &around {
                    let members = match around.devices {
                        Devices::Random => sample(&wall, around, self.members, seed),
                        Devices::Corners | Devices::Measured => corners(&wall, around),
                    };
                    let bar = progress::bar(members.len() as u64, "touching the family");
                    families.push(judge(law, &wall, around, &members, || bar.inc(1))?);
                    bar.finish_and_clear();
                }
            }
        }
        out::result(
            || serde_json::json!({ "scene": scene.name, "seed": seed, "families": families }),
            || {
                say!("{}", text(&families).trim_end());
                Ok(())
            },
        )?;
        Ok(self.conclude(&families))
    }

    /// Prints every wall that does not meet the demands, and returns the exit code.
    fn conclude(&self, families: &[Family]) -> ExitCode {
        let mut code = ExitCode::SUCCESS;
        for family in families {
            let lost = family.lost - family.lost_beyond_map;
            let mut fails = Vec::new();
            if lost > self.most_lost {
                fails.push(format!(
                    "{lost} are lost, at most {} are allowed",
                    self.most_lost
                ));
            }
            match (self.deepest, family.deepest()) {
                (Some(most), Some(deepest)) if deepest > most => fails.push(format!(
                    "the deepest is {deepest:.3}, at most {most} is allowed"
                )),
                (Some(most), None) => {
                    fails.push(format!("all are lost, so no depth is at most {most}"))
                }
                _ => {}
            }
            if !fails.is_empty() {
                eprintln!(
                    "error: {} at {} N·m/rad, {}: of {} variants {}; tune the law, or relax --most-lost and --deepest",
                    family.law,
                    family.k_desired,
                    family.devices.name(),
                    family.members,
                    fails.join(", and ")
                );
                code = ExitCode::from(NOT_MET);
            }
        }
        code
    }
}

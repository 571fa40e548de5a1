//! Scorecard of `touchstone device run`: the measures that a simulated run has (depth, stiffness, energy), computed for a run on a
//! device.

use super::account::Account;
use crate::report_options::program;
use clap::ValueEnum;
use std::path::{Path, PathBuf};
use touchstone_control::space::Direction;
use touchstone_device::haptic::DataSheet;
use touchstone_device::servo::{ServoLimits, ServoTick};
use touchstone_device::{Obstacle, WallSettings};
use touchstone_lab::identify::lever::PRESS_SHARE;
use touchstone_lab::scorecard::cases::LATE_TICKS;
use touchstone_lab::scorecard::direction::Approach;
use touchstone_lab::scorecard::in_turn::DeedsInTurn;
use touchstone_lab::scorecard::noticed::DeviceRun;
use touchstone_lab::scorecard::on_device::{DeviceCard, card};
use touchstone_lab::scorecard::on_device_page;
use touchstone_lab::scorecard::press::DesiredStiffness;
use touchstone_lab::scorecard::touched::TouchedTick;
use touchstone_lab::thesis::space::Object;
use touchstone_report::pages;
use touchstone_sim::error::{Error, Result};
use touchstone_world::plant::{FIRM_TRANSLATION, Hand, LIGHT_TRANSLATION, MEDIUM_TRANSLATION};

/// Motion of a simulated hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum HandProgramme {
    /// Probes the object, holds, slides along it and lets go, again and again.
    #[default]
    Explore,
    /// Touches, presses, holds and lets go; then moves to and fro in the wall at 1, 2 and 4 Hz; and ends.
    Scorecard,
}

/// The grip of a simulated hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum PressedGrip {
    /// Mass 0.1 kg, stiffness 30 N/m.
    Light,
    /// Mass 0.3 kg, stiffness 100 N/m.
    Medium,
    /// Mass 0.8 kg, stiffness 300 N/m.
    #[default]
    Firm,
}

impl PressedGrip {
    fn hand(self) -> Hand {
        match self {
            Self::Light => LIGHT_TRANSLATION,
            Self::Medium => MEDIUM_TRANSLATION,
            Self::Firm => FIRM_TRANSLATION,
        }
    }
}

/// Options of the scorecard.
#[derive(Debug, Clone, clap::Args)]
pub struct ScoreOptions {
    /// Writes the run's scorecard, as page and results.json, to this folder; needs --seconds, or --programme scorecard.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replaces files that another command left in the folder, and an existing file of --csv.
    #[arg(long)]
    pub force: bool,
    /// Motion of a simulated hand.
    #[arg(long, value_enum, default_value_t)]
    pub programme: HandProgramme,
    /// Grip of the simulated hand, with --programme scorecard.
    #[arg(long, value_enum, default_value_t)]
    pub grip: PressedGrip,
}

impl ScoreOptions {
    /// Refuses options that contradict each other or the device.
    pub fn check(&self, simulated: bool, seconds: Option<f64>, csv: bool) -> Result<()> {
        let recorded = if self.out.is_some() { "--out" } else { "--csv" };
        let wrong = |option: &str, problem: &str, fix: &str| {
            Err(Error::Option {
                option: option.into(),
                problem: problem.into(),
                fix: fix.into(),
            })
        };
        match self.programme {
            HandProgramme::Scorecard if !simulated => wrong(
                "--programme",
                "a person at a device does not follow a programme",
                "leave it out, or give --device simulated",
            ),
            HandProgramme::Scorecard if seconds.is_some() => wrong(
                "--seconds",
                "the scorecard's programme has its own length",
                "leave it out",
            ),
            HandProgramme::Explore if self.grip != PressedGrip::default() => wrong(
                "--grip",
                "is for the scorecard's programme",
                "add --programme scorecard",
            ),
            HandProgramme::Explore if (self.out.is_some() || csv) && seconds.is_none() => wrong(
                recorded,
                "records every control period, so it needs a duration",
                "add --seconds",
            ),
            _ => Ok(()),
        }
    }
}

/// Force with which a hand touches the wall before it presses, as a fraction of the largest force.
const TOUCH_SHARE: f64 = 2.0 / 15.0;
/// Time at which the hand's programme begins, after the force has faded in, s.
const BEGIN_S: f64 = 1.2;

/// Configured stiffness of the wall, and the resolution of the depth along the direction `normal`.
fn stiffness(sheet: &DataSheet, settings: &WallSettings, normal: [f64; 3]) -> DesiredStiffness {
    let across: f64 = normal.iter().map(|n| n.abs()).sum();
    DesiredStiffness {
        k_desired: settings.law.k_desired.to_num(),
        count: sheet.count_m,
        unsure: 0.5 * sheet.count_m * across,
    }
}

/// The scorecard's sequence of hand motions at an object.
pub fn turn(
    sheet: &DataSheet,
    settings: &WallSettings,
    force_n: f64,
    object: Object,
    grip: PressedGrip,
) -> DeedsInTurn {
    let known = stiffness(sheet, settings, object.normal());
    let rate_hz = settings.law.rate_hz;
    let approach = Approach {
        k_desired_n_per_m: known.k_desired,
        push_n: PRESS_SHARE * force_n,
        touch_n: TOUCH_SHARE * force_n,
        count_m: known.count,
        unsure_m: known.unsure,
        rate_hz,
    };
    let first = (BEGIN_S * f64::from(rate_hz)).ceil() as u64;
    DeedsInTurn::new(approach, grip.hand(), first)
}

/// The finished run that the scorecard judges.
pub struct PlayedOnDevice<'a> {
    pub sheet: &'a DataSheet,
    pub settings: &'a WallSettings,
    pub limits: &'a ServoLimits,
    pub turn: Option<DeedsInTurn>,
}

impl PlayedOnDevice<'_> {
    /// Computes the scorecard from all control periods (ticks) of the run.
    pub fn card(&self, ticks: &[ServoTick], obstacle: &Obstacle<'_>) -> DeviceCard {
        let mut side = Direction::default();
        let touched: Vec<TouchedTick> = ticks
            .iter()
            .map(|tick| {
                let (depth_m, normal) = obstacle.beneath(tick.position_m, &mut side);
                TouchedTick {
                    due: tick.due,
                    position_m: tick.position_m,
                    force_n: tick.force_n,
                    depth_m,
                    normal,
                }
            })
            .collect();
        let rate_hz = self.settings.law.rate_hz;
        // The depth is least certain along a direction with equal angles to all three axes. Without a programme the surface's
        // normal may vary, so this direction is assumed.
        let least_sure = [1.0 / 3.0_f64.sqrt(); 3];
        let stiffness = self.turn.map_or_else(
            || stiffness(self.sheet, self.settings, least_sure),
            |turn| turn.approach.stiffness(),
        );
        card(&DeviceRun {
            ticks: &touched,
            rate_hz,
            stiffness,
            whole_from: (self.limits.ramp_s * f64::from(rate_hz)).ceil() as u64,
            late: self.sheet.delay_s * f64::from(rate_hz) >= LATE_TICKS,
            turn: self.turn,
        })
    }
}

/// Writes the report page and the results file.
pub fn write(
    account: &Account,
    card: &DeviceCard,
    command: &str,
    folder: &Path,
    force: bool,
) -> Result<()> {
    let value = account.value();
    let title = format!("A wall on {}", account.sheet.name);
    let sections = [on_device_page::section(card), account.section()];
    let page = pages::Page {
        title: &title,
        intro: "What a hand felt of a virtual wall on a haptic device.",
        command,
        program: program(),
        sections: &sections,
        results: ("run", &value),
        files: &[],
        force,
    };
    let written = pages::write(&page, folder)?;
    crate::out::note!("page  {}", written.page.display());
    Ok(())
}

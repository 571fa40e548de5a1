//! `touchstone device identify`: measures mass, damping and friction of each axis by small motions.

use super::choice::{HapticKind, SimulatedHand, WhichDevice};
use super::device_wall::control_rate_hz;
use super::ended::ended;
use crate::out::{self, say, tell};
use crate::whole::{Named, Overwrite};
use crate::{interrupt, number};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::Ordering;
use touchstone_device::haptic::HapticDevice;
use touchstone_device::servo::{
    DevicePace, Pace, RealTime, ServoLimits, SimulatedPace, play, real_time,
};
use touchstone_device::{MovedAbout, SmallMotions, Survey};
use touchstone_lab::identify::axis::{self, AxisMechanics};
use touchstone_lab::identify::lever;
use touchstone_sim::error::{Error, Result};

/// Options of `device identify`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    #[command(flatten)]
    which: WhichDevice,
    /// Time for which each axis is moved about, s.
    #[arg(long, value_name = "S", default_value_t = 6.0, allow_negative_numbers = true, value_parser = number::within(2.0, 600.0, "of seconds"))]
    axis_s: f64,
    /// Largest pushing force, N.
    #[arg(long, value_name = "N", default_value_t = 1.5, allow_negative_numbers = true, value_parser = number::within(0.1, 5.0, "of newtons"))]
    push_n: f64,
    /// Control rate, Hz; default: the device's fastest rate, or the device's own if it sets the rate itself.
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, value_parser = number::within(500_u32, 10_000, "of Hz"))]
    rate_hz: Option<u32>,
    /// Writes the result to this file, which `--twin` simulates.
    #[arg(long, value_name = "FILE.toml")]
    out: Option<PathBuf>,
    /// Writes the axis with the least damping as a scene of one axis, for `touchstone tune`.
    #[arg(long, value_name = "FILE.toml")]
    scene: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
    /// Stiffness of the wall in the scene that --scene writes, N/mm.
    #[arg(long, value_name = "N_PER_MM", default_value_t = 5.0, allow_negative_numbers = true, value_parser = number::up_to(50.0, "of N/mm"))]
    k_desired: f64,
    /// Runs a simulated device faster than real time.
    #[arg(long)]
    fast: bool,
}

/// Distance from the start at which the motion is aborted, m.
const FURTHEST_M: f64 = 0.03;
/// Force allowed in addition to the pushing force, N. It lets the spring hold the device in place.
const HOLD_N: f64 = 3.0;

/// Moves the device, identifies it, prints the result.
pub fn main(options: &Options) -> Result<ExitCode> {
    let kind = options.which.model();
    if options.fast && !kind.is_some_and(HapticKind::is_simulated) {
        return Err(Error::Option {
            option: "--fast".into(),
            problem: "a real device runs in real time only".into(),
            fix: "give --device simulated, or leave it out".into(),
        });
    }
    let named = |path, option| Named {
        path,
        option,
        replaces: options.overwrite.force,
    };
    let out = options.out.as_deref().map(|path| named(path, "--out"));
    let scene = options.scene.as_deref().map(|path| named(path, "--scene"));
    for place in out.iter().chain(&scene) {
        place.check()?;
    }
    let stop = interrupt::noted()?;
    let simulated_hz = options
        .rate_hz
        .unwrap_or(kind.map_or(4000, HapticKind::own_rate_hz));
    let mut device = options.which.open(SimulatedHand::Nobody(simulated_hz))?;
    let sheet = device.sheet().clone();
    let rate_hz = control_rate_hz(options.rate_hz, &sheet)?;
    let mut law = MovedAbout::new(SmallMotions {
        rate_hz,
        axis_s: options.axis_s,
        push_n: options.push_n,
        furthest_m: FURTHEST_M,
    });
    let limits = ServoLimits {
        force_n: (options.push_n + HOLD_N).min(sheet.force_n),
        ..ServoLimits::of(&sheet)
    };
    let mut pace: Box<dyn Pace> = match (options.fast, sheet.sets_the_pace) {
        (true, _) => Box::new(SimulatedPace),
        (false, true) => Box::new(DevicePace::new(rate_hz)),
        (false, false) => Box::new(RealTime::new(rate_hz)),
    };
    tell!("device    {}", sheet.name);
    tell!(
        "motors    on for {:.0} s, up to {:.1} N and some millimetres; do not hold the device",
        law.ticks() as f64 / f64::from(rate_hz),
        limits.force_n
    );
    let _ = (!options.fast).then(real_time);
    let ticks = law.ticks();
    let (mut least, mut most) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let report = play(
        &mut device,
        &mut law,
        &limits,
        rate_hz,
        &mut *pace,
        |tick| {
            for i in 0..3 {
                least[i] = least[i].min(tick.position_m[i]);
                most[i] = most[i].max(tick.position_m[i]);
            }
            tick.number + 1 < ticks && !stop.load(Ordering::Relaxed)
        },
    );
    ended(&report.ending, &report.release, &sheet.name)?;
    if stop.load(Ordering::Relaxed) {
        return Ok(ExitCode::from(interrupt::INTERRUPTED as u8));
    }
    // At a missed tick the device keeps its last force for longer than recorded. The results state the number of missed ticks.
    let missed = report.missed_ticks;
    let mut found = Vec::new();
    for (name, record) in ["x", "y", "z"].into_iter().zip(&law.axes) {
        let axis = axis::mechanics(&record.position_m, &record.force_n, rate_hz, sheet.count_m);
        found.push((
            name,
            axis.map_err(|why| {
                Error::device(
                    &sheet.name,
                    format!("axis {name}: {why}"),
                    "raise --push-n or --axis-s, and do not hold the device",
                )
            })?,
        ));
    }
    let survey = Survey::measured(
        &sheet.name,
        std::array::from_fn(|i| {
            let axis = &found[i].1;
            [
                axis.mass_kg.value,
                axis.damping_n_s_per_m.value.max(0.0),
                axis.friction_n.value.max(0.0),
            ]
        }),
        least,
        most,
    );
    if let Some(place) = out {
        let text = survey
            .to_toml()
            .map_err(|error| place.error(&std::io::Error::other(error)))?;
        place.write(text)?;
    }
    let mut of_lever = None;
    if let Some(place) = scene {
        let (axis, mechanics) = found
            .iter()
            .min_by(|a, b| {
                let damping = |m: &AxisMechanics| m.damping_n_s_per_m.value;
                damping(&a.1).total_cmp(&damping(&b.1))
            })
            .map(|(name, axis)| (*name, *axis))
            .unwrap_or(found[0]);
        let lever = lever::Lever::of(mechanics.mass_kg.value);
        let text = lever.scene(&lever::AxisOfDevice {
            name: format!("{} of {}", axis, sheet.name),
            mass_kg: mechanics.mass_kg.value,
            damping_n_s_per_m: mechanics.damping_n_s_per_m.value.max(0.0),
            friction_n: mechanics.friction_n.value.max(0.0),
            force_n: sheet.force_n,
            count_m: sheet.count_m,
            delay_s: sheet.delay_s,
            rate_hz,
            k_desired_n_per_m: 1e3 * options.k_desired,
        });
        place.write(text)?;
        of_lever = Some(lever.length_m);
    }
    told(options, &found, missed, of_lever)?;
    Ok(ExitCode::SUCCESS)
}

fn told(
    options: &Options,
    found: &[(&str, AxisMechanics)],
    missed: u64,
    lever_m: Option<f64>,
) -> Result<()> {
    let value = |axis: &AxisMechanics| {
        serde_json::json!({
            "mass_kg": axis.mass_kg.value,
            "mass_uncertainty_kg": axis.mass_kg.uncertainty,
            "damping_n_s_per_m": axis.damping_n_s_per_m.value,
            "damping_uncertainty_n_s_per_m": axis.damping_n_s_per_m.uncertainty,
            "friction_n": axis.friction_n.value,
            "friction_uncertainty_n": axis.friction_n.uncertainty,
            "offset_n": axis.offset_n.value,
            "unexplained_share": axis.unexplained,
        })
    };
    out::result(
        || {
            serde_json::json!({
                "axes": found.iter().map(|(_, axis)| value(axis)).collect::<Vec<_>>(),
                "missed_ticks": missed,
                "lever_m": lever_m,
            })
        },
        || {
            for (name, axis) in found {
                let (mass, damping, friction) =
                    (axis.mass_kg, axis.damping_n_s_per_m, axis.friction_n);
                say!(
                    "axis {name}    {:.4} ± {:.4} kg, {:.3} ± {:.3} N·s/m, friction {:.3} ± {:.3} N, always there {:.3} N; {:.1} % unexplained",
                    mass.value,
                    mass.uncertainty,
                    damping.value,
                    damping.uncertainty,
                    friction.value,
                    friction.uncertainty,
                    axis.offset_n.value,
                    100.0 * axis.unexplained
                );
            }
            if missed > 0 {
                tell!(
                    "missed    {missed} control periods, whose forces acted for an unknown longer time"
                );
            }
            if let Some(file) = &options.out {
                tell!(
                    "file      {}; simulate it: touchstone device run plane --twin {0}",
                    file.display()
                );
            }
            if let (Some(file), Some(lever_m)) = (&options.scene, lever_m) {
                tell!(
                    "scene     {}, as a knob on a lever of {:.2} mm; tune it: touchstone tune {0} --out FILE, then touchstone device run plane --settings FILE --lever-mm {1:.4}",
                    file.display(),
                    1e3 * lever_m
                );
            }
            Ok(())
        },
    )
}

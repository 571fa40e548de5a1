//! `touchstone device eccentricity`: measures the error of the angle that the encoder's off-centre magnet causes. Reports its
//! effect on torque and wall, and whether to mount the magnet again. Also used by `touchstone setup`.

use super::cogging::at_rest;
use super::spin;
use crate::interrupt;
use crate::out::{self, note, say, tell};
use clap::Subcommand;
use serde_json::{Value, json};
use touchstone_device::Client;
use touchstone_lab::identify::eccentricity::cost::{ELECTRICAL_MOST_DEG, STIFFNESS_MOST};
use touchstone_lab::identify::eccentricity::{Eccentricity, Harmonic, ORDERS, Reseat, Witness};
use touchstone_protocol::DeviceSettings;
use touchstone_sim::error::Result;

/// The actions on the angle error of the encoder.
#[derive(Debug, Clone, Copy, Subcommand)]
pub enum EccentricityAction {
    /// Measures the error of the encoder's angle: HANDS OFF, THE SHAFT TURNS, THEN SPINS BOTH WAYS, for half a minute. Nothing is
    /// stored; the device is left stopped.
    Measure,
}

/// Measures the angle error that the encoder's off-centre magnet causes, and prints it.
pub fn main(client: &mut Client, action: EccentricityAction) -> Result<()> {
    let EccentricityAction::Measure = action;
    let settings = client.settings()?;
    at_rest(client)?;
    let stop = interrupt::noted()?;
    tell!("HANDS OFF: THE SHAFT TURNS, THEN SPINS BOTH WAYS, for half a minute");
    let found = spin::encoder(client, &settings, &stop)?;
    let pole_pairs = settings.motor.pole_pairs.into();
    out::result(
        || as_json(&found, pole_pairs),
        || {
            let constant = settings.motor.torque_constant_n_m_per_a.to_num();
            for line in lines(&found, pole_pairs, field_n_m_per_rad(&settings, constant)) {
                say!("{line}");
            }
            if let Some(warning) = warning(&found, pole_pairs) {
                note!("{warning}");
            }
            Ok(())
        },
    )
}

/// Name of each component of the encoder's error, by its number of periods per turn.
pub const NAMES: [&str; ORDERS] = [
    "encoder's error once a turn",
    "encoder's error twice a turn",
];

/// Amplitude, uncertainty and phase of one component (once or twice per turn) of the encoder's error, as text.
pub fn shown(found: &Eccentricity, index: usize) -> [String; 3] {
    let it = &found.harmonics[index];
    let open = format!("{:.3}°", it.uncertainty_rad.to_degrees());
    if !found.stands_out(index) {
        let below = it.amplitude_rad.max(it.uncertainty_rad);
        let none = format!("none above {:.3}°", below.to_degrees());
        return [none, open, String::new()];
    }
    let by = match found.witness[index] {
        Witness::Field => "",
        Witness::Coast => ", by the coasts",
    };
    let amplitude = format!("{:.3}°", it.amplitude_rad.to_degrees());
    let phase = format!(", phase {:+.0}°{by}", it.phase_rad.to_degrees());
    [amplitude, open, phase]
}

/// Effect of the encoder's error on the motor's torque and on a wall, as text.
pub fn costs(found: &Eccentricity, pole_pairs: f64) -> String {
    let cost = found.cost(pole_pairs);
    format!(
        "at the worst angle: {:.2} % less torque, a wall {:.2}° from its place, its stiffness wrong by {:.1} %",
        100.0 * cost.torque_lost,
        cost.place_rad.to_degrees(),
        100.0 * cost.stiffness_off
    )
}

/// Stiffness with which the motor's field holds the shaft in a calibration, N·m/rad.
pub fn field_n_m_per_rad(settings: &DeviceSettings, torque_constant_n_m_per_a: f64) -> f64 {
    let current_a: f64 = settings.calibration.current_a.to_num();
    f64::from(settings.motor.pole_pairs) * torque_constant_n_m_per_a * current_a
}

/// Text on the limits of a measurement in which the motor's field holds the shaft and the shaft never coasts.
fn by_field_alone(field_n_m_per_rad: f64) -> String {
    format!(
        "a torque that varies once or twice a turn, such as that of an unbalanced knob: it shifts the result by {:.3}° for each mN·m (the knob does not coast long enough to tell)",
        (1e-3 / field_n_m_per_rad).to_degrees()
    )
}

/// The measured error as lines of text. `field_n_m_per_rad`: stiffness with which the motor's field held the shaft, N·m/rad.
pub fn lines(found: &Eccentricity, pole_pairs: f64, field_n_m_per_rad: f64) -> Vec<String> {
    let mut lines: Vec<String> = (0..ORDERS)
        .map(|index| {
            let [value, open, phase] = shown(found, index);
            format!("{:<41} {value} ± {open}{phase}", NAMES[index])
        })
        .collect();
    lines.push(format!("{:<41} {}", "effect", costs(found, pole_pairs)));
    lines.push(format!(
        "{:<41} law.position_error_rad = {:.5}, plus the encoder's other errors by its data sheet",
        "setting for the energy guard",
        found.position_error_rad()
    ));
    if found.apart_rad.is_none() {
        lines.push(format!(
            "{:<41} {}",
            "cannot be separated from it",
            by_field_alone(field_n_m_per_rad)
        ));
    }
    lines
}

/// Warning that the encoder's magnet should be mounted again, with the reason; `None` if the error is small enough.
pub fn warning(found: &Eccentricity, pole_pairs: f64) -> Option<String> {
    let cost = found.cost(pole_pairs);
    let why = match cost.reseat()? {
        Reseat::Electrical => format!(
            "the motor's field is {:.0} electrical degrees off at the worst angle; above {ELECTRICAL_MOST_DEG:.0}, the check of a stored alignment may reject a correct one",
            cost.electrical_deg
        ),
        Reseat::Stiffness => format!(
            "a wall's stiffness is {:.0} % off at the worst angle; the scorecard's limit is {:.0} %",
            100.0 * cost.stiffness_off,
            100.0 * STIFFNESS_MOST
        ),
    };
    Some(format!(
        "warning: mount the encoder's magnet again, centred and not tilted: {why}"
    ))
}

/// The measured error of the encoder's angle as JSON, for programs and for a setup that is continued later.
pub fn as_json(found: &Eccentricity, pole_pairs: f64) -> Value {
    let cost = found.cost(pole_pairs);
    let harmonics = (0..ORDERS).map(|index| {
        let it = &found.harmonics[index];
        json!({
            "order": index + 1,
            "amplitude_rad": it.amplitude_rad,
            "phase_rad": it.phase_rad,
            "uncertainty_rad": it.uncertainty_rad,
            "witness": word(found.witness[index]),
            "field_and_coasts_apart_rad": found.apart_rad.map(|apart| apart[index]),
        })
    });
    json!({
        "harmonics": harmonics.collect::<Vec<_>>(),
        "residual_rms_rad": found.residual_rms_rad,
        "count_rad": found.count_rad,
        "wall_off_rad": cost.place_rad,
        "position_error_rad": found.position_error_rad(),
        "field_off_electrical_deg": cost.electrical_deg,
        "torque_lost_share": cost.torque_lost,
        "stiffness_off_share": cost.stiffness_off,
        "reseat_magnet": cost.reseat().map(|why| match why {
            Reseat::Electrical => "electrical",
            Reseat::Stiffness => "stiffness",
        }),
    })
}

const fn word(witness: Witness) -> &'static str {
    match witness {
        Witness::Field => "field",
        Witness::Coast => "coasts",
    }
}

/// Reads the JSON that [`as_json`] wrote.
pub fn from_json(all: &Value) -> Option<Eccentricity> {
    let number = |of: &Value, name: &str| of.get(name)?.as_f64();
    let entries = all.get("harmonics")?.as_array()?;
    let [first, second] = entries.as_slice() else {
        return None;
    };
    let harmonic = |of: &Value| {
        Some(Harmonic {
            amplitude_rad: number(of, "amplitude_rad")?,
            phase_rad: number(of, "phase_rad")?,
            uncertainty_rad: number(of, "uncertainty_rad")?,
        })
    };
    let witness = |of: &Value| match of.get("witness").and_then(Value::as_str) {
        Some(it) if it == word(Witness::Coast) => Witness::Coast,
        _ => Witness::Field,
    };
    let apart = |of: &Value| number(of, "field_and_coasts_apart_rad");
    Some(Eccentricity {
        harmonics: [harmonic(first)?, harmonic(second)?],
        witness: [witness(first), witness(second)],
        apart_rad: apart(first).zip(apart(second)).map(|(a, b)| [a, b]),
        residual_rms_rad: number(all, "residual_rms_rad")?,
        count_rad: number(all, "count_rad")?,
    })
}

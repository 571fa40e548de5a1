//! Reads the tuned law's settings from their file, and corrects the energy guard's settings if they assume a better device than
//! the board.

use super::kept::io;
use super::{knob_scene, named, refuse_invalid};
use crate::config::toml_file;
use crate::out::note;
use std::path::Path;
use touchstone_control::Si;
use touchstone_device::Client;
use touchstone_lab::identify::motor::MeasuredMotor;
use touchstone_link::guard;
use touchstone_link::value;
use touchstone_protocol::DeviceSettings;
use touchstone_sim::error::Result;

/// Complete device settings with the values of the measured motor, the encoder's measured error and the tuned control law.
pub(super) fn with_knob(
    settings: DeviceSettings,
    motor: &MeasuredMotor,
    position_error_rad: f64,
    law_file: &Path,
    client: &Client,
) -> Result<DeviceSettings> {
    let law = touchstone_sim::input::text(law_file, touchstone_sim::input::MOST_OF_SETTINGS)
        .map_err(|error| io(law_file, &error))?;
    let (told, lines) = toml_file::read(&law, law_file, &settings)?;
    // Only the tables `timing`, `wall` and `law` are used. Settings of encoder or drive in the file could describe a better
    // device than this board.
    let is_of_law = |path: &str| {
        let table = path.split('.').next();
        matches!(table, Some("timing" | "wall" | "law"))
    };
    for path in lines.keys().filter(|path| !is_of_law(path)) {
        if value::shown(&told, named(path)?) != value::shown(&settings, named(path)?) {
            note!("note: ignored in the law's file: {path}; give it with --settings");
        }
    }
    let mut all = settings;
    (all.timing, all.wall, all.law) = (told.timing, told.wall, told.law);
    let of = |value: f64| Si::saturating_from_num(value);
    let board = client.identity().board;
    let mut sure = DeviceSettings::defaults(board);
    sure.law.guard.damping_n_m_s_per_rad = of(knob_scene::sure_damping(motor));
    sure.law.position_error_rad = of(position_error_rad);
    let weaker = guard::weaker(&sure, &all, board);
    for it in weaker.iter().filter(|it| lines.contains_key(it.path)) {
        note!(
            "note: ignored for the energy guard: {}: {}",
            it.path,
            it.problem
        );
    }
    guard::hold(&mut all, board, sure.law.guard.damping_n_m_s_per_rad);
    let error = &mut all.law.position_error_rad;
    *error = sure.law.position_error_rad.max(*error);
    all.motor.resistance_ohm = of(motor.resistance_ohm.value);
    all.motor.inductance_h = of(motor.inductance_h.value);
    all.motor.torque_constant_n_m_per_a = of(motor.torque_constant_n_m_per_a.value);
    let most = all.motor.torque_constant_n_m_per_a * all.motor.current_limit_a;
    all.law.force_limit_n_m = all.law.force_limit_n_m.min(most);
    refuse_invalid(&all, client)?;
    Ok(all)
}

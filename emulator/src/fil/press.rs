//! A simulated hand presses the emulated device's wall, as in the thesis' experiment. The device's forces are compared with the
//! control law computed on the host.

use touchstone_control::{Controller, CountScale, Fixed32, Position, Si};
use touchstone_drive::change::law_settings;
use touchstone_drive::wire::hardware;
use touchstone_protocol::{Board, DeviceCommand, DeviceSettings, Phase, Request, Telemetry};
use touchstone_world::plant::MEDIUM;

use crate::bench::{Bench, MS};

/// Result of a hand's press on the wall.
#[derive(Debug, Clone)]
pub struct Press {
    /// Configured stiffness of the wall, N·m/rad.
    pub k_desired: Si,
    /// Number of control periods in which device and host were compared.
    pub compared: usize,
    /// Number of control periods in which the device gave a force.
    pub in_contact: usize,
    /// Largest force of the wall, N·m.
    pub max_force: f64,
    /// Rendered stiffness, N·m/rad: mean force over mean penetration in 0.1 s near the end of the hold.
    pub shown: f64,
    /// Difference between the largest and the smallest encoder count in the same 0.1 s near the end of the hold.
    pub moves: i32,
}

/// Configures the wall's stiffness, calibrates, arms, presses for two seconds, and compares the forces with the control law.
///
/// # Errors
/// The first step that fails, or the first control period in which device and host differ.
pub fn press(bench: &mut Bench, k_desired: Si) -> Result<Press, String> {
    bench.release();
    let phase = bench.status()?.phase;
    if phase != Phase::Boot && phase != Phase::Stopped {
        bench.demand(Request::Command(DeviceCommand::Stop))?;
    }
    bench.configure(|settings| settings.wall.k_desired_n_m_per_rad = k_desired)?;
    bench.calibrate()?;
    let from = bench.link.telemetry.len();
    bench.demand(Request::Command(DeviceCommand::Arm))?;
    bench.wait_for(Phase::Armed, 100 * MS)?;
    bench.run(250 * MS)?;
    let torque = bench.machine.chip().board.press_n_m;
    bench.press(&MEDIUM, torque, 0.6, 0.8)?;
    bench.run(2_200 * MS)?;
    let status = bench.status()?;
    if status.phase != Phase::Armed {
        return Err(format!("{} with {:?}", status.phase.name(), status.fault));
    }
    let settings = bench.settings()?;
    let gaps = bench.link.gaps(from);
    if gaps > 0 {
        return Err(format!("{gaps} records of telemetry are missing"));
    }
    let records = &bench.link.telemetry[from..];
    let armed: Vec<&Telemetry> = records
        .iter()
        .filter(|record| record.phase == Phase::Armed)
        .collect();
    let compared = compare(
        &settings,
        board_named(bench.machine.chip().board.name)?,
        &armed,
    )?;
    // The hand starts a quarter of a second after arming, presses for 0.6 s and holds for 0.8 s.
    let hold = armed.get(1_500..1_600).unwrap_or_default();
    let mean = |of: fn(&Telemetry) -> f64| {
        hold.iter().map(|record| of(record)).sum::<f64>() / hold.len().max(1) as f64
    };
    let force = mean(|record| record.force_n_m.to_num());
    let counts = hold.iter().map(|record| record.count);
    Ok(Press {
        k_desired,
        compared,
        in_contact: armed.iter().filter(|record| record.force_n_m != 0).count(),
        max_force: armed
            .iter()
            .map(|record| record.force_n_m.to_num())
            .fold(0.0, f64::max),
        shown: force / mean(|record| record.penetration_rad.to_num()),
        moves: counts.clone().max().unwrap_or(0) - counts.min().unwrap_or(0),
    })
}

/// The board whose firmware program has this name.
pub fn board_named(name: &str) -> Result<Board, String> {
    let board = Board::ALL.into_iter().find(|board| board.name() == name);
    board.ok_or_else(|| format!("no board is called {name}"))
}

/// Computes the control law on the host from the device's encoder counts. Penetration, force and offset must equal the device's,
/// bit for bit. Returns the number of compared control periods.
pub fn compare(
    settings: &DeviceSettings,
    board: Board,
    armed: &[&Telemetry],
) -> Result<usize, String> {
    let (law, change) = law_settings(settings, hardware(board))
        .map_err(|error| format!("the settings are refused here: {error}"))?;
    let mut law = Controller::<Fixed32>::new(&law)
        .map_err(|error| format!("the law is refused here: {error:?}"))?;
    let scale = CountScale::new(settings.encoder.counts_per_rev, settings.wall.surface_rad)
        .ok_or("the encoder's counts are refused here")?;
    for record in armed {
        let penetration = scale.penetration::<Fixed32>(i64::from(record.count));
        let at_change = penetration - Position(record.since_change_rad);
        let force = law.tick_with_change(penetration, change.map(|_| at_change));
        let here = (
            penetration.0.to_bits(),
            force.0.to_bits(),
            law.view().offset.0.to_bits(),
        );
        let there = (
            record.penetration_rad.to_bits(),
            record.force_n_m.to_bits(),
            record.offset_rad.to_bits(),
        );
        if here != there {
            return Err(format!(
                "tick {}: penetration, force, offset are {there:?} there and {here:?} here",
                record.tick
            ));
        }
    }
    match armed.len() {
        0 => Err("nothing to compare".into()),
        count => Ok(count),
    }
}

//! Tests of the current loop: limits, trips, late periods and missed control periods.

use super::*;
use crate::Device;
use crate::hardware::IHM08M1;
use touchstone_protocol::DeviceSettings;

#[test]
fn the_sides_stay_in_the_circle() {
    let v = |x: f64| Volts::from_num(x);
    assert!((other_side(v(13.0), v(5.0)) - v(12.0)).abs() < v(0.002));
    assert_eq!(other_side(v(5.0), v(-5.0)), Volts::ZERO);
    assert_eq!(other_side(v(5.0), v(6.0)), Volts::ZERO);
    assert!(other_side(Volts::MAX, Volts::MIN) == Volts::ZERO);
}

const RESTS: Offsets = Offsets {
    a: 2_128 << Offsets::BITS,
    b: 2_100 << Offsets::BITS,
    spread: 4,
};

/// A loop on the reference board whose sensors' offsets are known.
fn measured() -> CurrentLoop {
    let settings = DeviceSettings::default();
    let device = Device::new(&settings, &IHM08M1).unwrap();
    let mut current = CurrentLoop::new(device.current_config());
    current.report.offsets = Some(RESTS);
    current
}

/// A sample with these currents in the phases A and B.
fn sample(current: &CurrentLoop, [a, b]: [f64; 2], command: CurrentCommand) -> CurrentSample {
    let per_code = f64::from(current.config.amps_per_code) / 2_f64.powi(28);
    let code = |amps: f64, offset: u16| {
        (f64::from(offset >> Offsets::BITS) + amps / per_code).round() as u16
    };
    CurrentSample {
        phase_a: code(a, RESTS.a),
        phase_b: code(b, RESTS.b),
        bus: 2_000,
        temperature: 1_300,
        hardware_break: false,
        late: false,
        command,
    }
}

/// The first command after power-up: drives this current on the q axis.
fn drives(q: Amps) -> CurrentCommand {
    CurrentCommand {
        mode: CurrentMode::Drive,
        tick: 1,
        current: Dq { d: Amps::ZERO, q },
        ..CurrentCommand::OFF
    }
}

#[test]
fn a_current_beyond_the_limit_is_driven_as_the_limit_in_both_directions() {
    // A limit so small that the voltage stays below its own.
    let limit = measured().config.limit / 64;
    let bridge = |q: Amps| {
        let mut current = measured();
        current.config.limit = limit;
        let sample = sample(&current, [0.0, 0.0], drives(q));
        current.tick(&sample).bridge
    };
    for sign in [1, -1] {
        assert_eq!(bridge(limit * 3 * sign), bridge(limit * sign));
        assert_ne!(bridge(limit * sign), bridge(limit * sign / 2));
    }
}

/// Opposite currents in two phases, each below the trip current, form a vector that is longer than it.
#[test]
fn a_current_that_two_phases_share_trips_by_its_vector() {
    for (share, trips) in [(0.8, 0), (0.95, 1)] {
        let mut current = measured();
        let amps = share * current.config.trip.to_num::<f64>();
        let sample = sample(&current, [amps, -amps], drives(Amps::ZERO));
        let bridge = current.tick(&sample).bridge;
        assert_eq!(current.report.trips, trips, "{share}");
        assert_eq!(bridge == BridgeCommand::Off, trips == 1, "{share}");
    }
}

#[test]
fn a_break_stays_tripped_until_it_ends_and_a_new_command_is_off() {
    let mut current = measured();
    let mut sample = sample(&current, [0.0, 0.0], drives(Amps::ZERO));
    let mut trips = |current: &mut CurrentLoop, is_broken: bool, mode: CurrentMode| {
        sample.hardware_break = is_broken;
        sample.command.mode = mode;
        sample.command.tick += 1;
        let bridge = current.tick(&sample).bridge;
        (bridge == BridgeCommand::Off, current.report.trips)
    };
    use CurrentMode::{Drive, Off};
    assert_eq!(trips(&mut current, false, Drive), (false, 0));
    assert_eq!(trips(&mut current, true, Drive), (true, 1));
    // Neither an off command during the break nor new coefficients clear it.
    assert_eq!(trips(&mut current, true, Off), (true, 1));
    let config = current.config;
    current.reconfigure(config);
    assert_eq!(current.report.offsets, None);
    current.report.offsets = Some(RESTS);
    assert_eq!(trips(&mut current, false, Drive), (true, 1));
    assert_eq!(trips(&mut current, false, Off), (true, 1));
    assert_eq!(trips(&mut current, false, Drive), (false, 1));
}

#[test]
fn without_a_second_reading_none_is_requested() {
    let mut current = measured();
    current.config.read_at = 0;
    let sample = sample(&current, [0.0, 0.0], CurrentCommand::OFF);
    for _ in 0..100 {
        assert!(!current.tick(&sample).reads_change);
    }
}

/// A trip empties the controllers at once, and so does every period at rest: the first voltages after it are those of a new loop.
#[test]
fn the_controllers_begin_anew_after_a_trip_and_after_a_rest() {
    let q = measured().config.limit / 8;
    let driven = || {
        let mut current = measured();
        let mut sample = sample(&current, [0.0, 0.0], drives(q));
        let first = current.tick(&sample).bridge;
        for _ in 0..3 {
            sample.command.tick += 1;
            assert_ne!(current.tick(&sample).bridge, BridgeCommand::Off);
        }
        assert_ne!(current.q, Pi::default());
        (current, sample, first)
    };
    let (mut current, mut sample, _) = driven();
    sample.hardware_break = true;
    assert_eq!(current.tick(&sample).bridge, BridgeCommand::Off);
    assert_eq!((current.d, current.q), Default::default());

    let (mut current, mut sample, first) = driven();
    for mode in [CurrentMode::Off, CurrentMode::Drive] {
        sample.command.mode = mode;
        sample.command.tick += 1;
        let bridge = current.tick(&sample).bridge;
        assert_eq!(bridge == first, mode == CurrentMode::Drive);
    }
}

/// A row of late periods ends with the driving: late periods before a rest do not count after it.
#[test]
fn late_periods_count_only_in_a_row() {
    use CurrentMode::{Drive, Off};
    // The mode of each period, and whether its compare values came late. In the second row the bridge rests in between.
    for (row, trips) in [
        (&[(Drive, true), (Drive, true), (Drive, true)][..], 1),
        (
            &[(Drive, true), (Drive, true), (Off, true), (Drive, true)],
            0,
        ),
        (
            &[(Drive, true), (Drive, true), (Drive, false), (Drive, true)],
            0,
        ),
    ] {
        let mut current = measured();
        let mut sample = sample(&current, [0.0, 0.0], drives(Amps::ZERO));
        for (mode, late) in row {
            sample.command.mode = *mode;
            sample.late = *late;
            current.tick(&sample);
            sample.command.tick += 1;
        }
        assert_eq!(current.report.trips, trips, "{row:?}");
    }
}

/// A control period counts as missed when the next one begins without its command, each once; a command in the period's last
/// moment is in time.
#[test]
fn a_missed_control_period_counts_once() {
    let mut current = measured();
    let periods = current.config.periods_per_tick;
    let mut sample = sample(&current, [0.0, 0.0], CurrentCommand::OFF);
    // For each control period the PWM period in which its command comes, from 1 to `periods`; `None`: it never comes.
    let mut missed = 0;
    for comes_in in [
        Some(1),
        Some(1),
        Some(periods),
        None,
        None,
        Some(2),
        None,
        Some(1),
    ] {
        for period in 1..=periods {
            sample.command.tick += u32::from(comes_in == Some(period));
            let output = current.tick(&sample);
            assert_eq!(output.pend_control, period == periods);
            missed += u16::from(output.pend_control && comes_in.is_none());
            assert_eq!(current.report.missed, missed, "{comes_in:?}, {period}");
        }
    }
    assert_eq!(missed, 3);
}

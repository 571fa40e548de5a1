//! Tests of the encoder reading that a board takes while the commanded force changes: the effect of a failed reading, and motor
//! drives that take none.

use touchstone_control::{ChangeOfForce, Si};
use touchstone_drive::change::law_settings;
use touchstone_drive::encoder::Frames;
use touchstone_drive::hardware::IHM08M1;
use touchstone_drive::wire::checked;
use touchstone_drive::{DriveCommand, EncoderReading};
use touchstone_protocol::settings::DriveKind;
use touchstone_protocol::{Board, DeviceSettings, Limit, State};
use touchstone_tests::knob::{Knob, Tamper};
use touchstone_world::motor::{GIMBAL, as5047p_frame};

const BOARD: Board = Board::NucleoG474re;

/// Replaces the encoder readings taken at changes of force, in the control ticks from `from` up to `until`.
#[derive(Default)]
struct Spoilt {
    from: u32,
    until: u32,
    /// The reading that replaces the true one; `None` for a missing reading.
    reading: Option<EncoderReading>,
}

impl Tamper for Spoilt {
    fn change(&mut self, tick: u32, reading: EncoderReading) -> Option<EncoderReading> {
        if (self.from..self.until).contains(&tick) {
            self.reading
        } else {
            Some(reading)
        }
    }
}

/// A simulated knob with its motor on, which a hand presses against the wall.
fn leaning() -> Knob<Spoilt> {
    let mut settings = DeviceSettings::defaults(BOARD);
    settings.wall.surface_rad = Si::lit("0.2");
    let mut knob = Knob::new(&settings, GIMBAL, 0.0, Spoilt::default()).armed();
    for _ in 0..600 {
        knob.rest_rad = 3.0;
        knob.tick();
    }
    assert!(knob.record.force.0 > 0.02, "in the wall: {:?}", knob.record);
    knob
}

#[test]
fn a_tick_that_was_not_told_where_its_force_changed_shows_none() {
    // Three bad readings: a missing one, one that fails its check, and one that is half a turn off.
    let far = Frames::alone(as5047p_frame(8_192));
    for reading in [
        None,
        Some(EncoderReading::Silent),
        Some(EncoderReading::As5047p(far)),
    ] {
        for ticks in 1..=3 {
            let mut knob = leaning();
            let next = knob.record.tick + 1;
            knob.tamper = Spoilt {
                from: next,
                until: next + ticks,
                reading,
            };
            // The reading is needed only in a tick that follows a tick with a force. A bad reading removes the force, so only every
            // second bad reading has an effect.
            for tick in 0..2 * ticks {
                let record = knob.tick();
                let is_off = tick % 2 == 0 && tick < ticks;
                assert_eq!(
                    record.limits.has(Limit::Encoder),
                    is_off,
                    "{tick} of {ticks}"
                );
                let drive = knob.output.unwrap().drive;
                assert_eq!(drive == DriveCommand::Off, is_off, "{tick} of {ticks}");
                assert_eq!(record.state, State::Armed);
            }
            assert_eq!(knob.fault(), None);
            assert!(knob.record.law_ran && knob.record.force.0 > 0.02);
        }
    }
}

#[test]
fn a_board_that_cannot_measure_says_so() {
    let change = |change: fn(&mut DeviceSettings)| {
        let mut settings = DeviceSettings::defaults(BOARD);
        change(&mut settings);
        checked(&settings, BOARD).map_err(|error| error.to_string())
    };
    assert_eq!(change(|_| ()), Ok(()));
    for refused in [
        |settings: &mut DeviceSettings| settings.timing.rate_hz = 2_000,
        |settings: &mut DeviceSettings| {
            settings.motor.current_bandwidth_hz = Si::lit("300");
        },
        |settings: &mut DeviceSettings| settings.drive.kind = DriveKind::Analogue,
    ] {
        let said = change(refused).unwrap_err();
        assert!(
            said.starts_with("law.guard.change: the board's current loop has to be done"),
            "{said}"
        );
    }
    for accepted in [
        |settings: &mut DeviceSettings| {
            settings.timing.rate_hz = 2_000;
            settings.law.guard.change = ChangeOfForce::Estimated;
        },
        |settings: &mut DeviceSettings| {
            settings.timing.rate_hz = 2_000;
            settings.motor.current_bandwidth_hz = Si::lit("1200");
        },
        |settings: &mut DeviceSettings| {
            settings.drive.kind = DriveKind::Analogue;
            settings.law.guard.on = false;
        },
    ] {
        assert_eq!(change(accepted), Ok(()));
    }
}

#[test]
fn the_law_is_told_the_boards_own_delay_where_it_measures() {
    let mut settings = DeviceSettings::defaults(BOARD);
    let (law, change) = law_settings(&settings, &IHM08M1).unwrap();
    let change = change.unwrap();
    assert_eq!(
        (law.guard.delay, law.guard.lag),
        (change.delay_s, change.lag_s)
    );
    assert!(law.guard.delay > Si::lit("0.0002") && law.guard.lag < Si::lit("0.00003"));
    settings.law.guard.change = ChangeOfForce::Estimated;
    assert_eq!(
        law_settings(&settings, &IHM08M1).unwrap(),
        (settings.law(), None)
    );
}

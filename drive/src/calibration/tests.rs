use super::*;
use crate::current::Offsets;
use crate::hardware::IHM08M1;
use touchstone_protocol::DeviceSettings;

/// Runs a calibration and returns the control periods until its field turns. `rotor` gives the rotor's position in counts in each
/// period.
fn ticks_until_the_field_turns(rotor: impl Fn(u32) -> i64) -> u32 {
    let config = CalibrationConfig::new(&DeviceSettings::default(), &IHM08M1);
    let code = IHM08M1.offset_code << 4;
    let report = CurrentReport {
        offsets: Some(Offsets {
            a: code,
            b: code,
            spread: 0,
        }),
        current: Dq {
            d: config.current,
            q: Amps::ZERO,
        },
        ..CurrentReport::default()
    };
    let mut calibration = Calibration::new(config);
    for tick in 0..20_000 {
        match calibration.tick(tick, rotor(tick), &report) {
            Progress::Running(_) if calibration.field == 0 => {}
            Progress::Running(_) => return tick,
            ended => panic!("{ended:?}"),
        }
    }
    panic!("it never turns")
}

#[test]
fn the_field_waits_for_a_rotor_that_swings_and_not_for_ever() {
    let at_rest = ticks_until_the_field_turns(|_| 700);
    // At 1 kHz: half a second in which the current rises, and half a second in which the rotor settles.
    assert!((1_000..1_010).contains(&at_rest), "{at_rest}");
    // A motion of one count is no swing.
    assert_eq!(
        ticks_until_the_field_turns(|tick| 700 + i64::from(tick & 1)),
        at_rest
    );
    // The rotor swings ten times a second over 250 counts, a ninth of an electrical turn (7 pole pairs), until the given time.
    let swings = |until: u32| {
        move |tick: u32| {
            let phase = i64::from(tick % 100);
            if tick < until {
                5 * (phase - 50).abs()
            } else {
                125
            }
        }
    };
    let for_a_second = ticks_until_the_field_turns(swings(at_rest + 1_000));
    assert!(
        (1_000..=1_500).contains(&(for_a_second - at_rest)),
        "{for_a_second}"
    );
    let for_ever = ticks_until_the_field_turns(swings(u32::MAX));
    assert_eq!(for_ever - at_rest, 3_000);
}

#[cfg(feature = "large")]
#[test]
fn a_bad_reading_before_the_check_of_a_stored_alignment_only_costs_new_offsets() {
    let config = CalibrationConfig::new(&DeviceSettings::default(), &IHM08M1);
    let code = IHM08M1.offset_code << 4;
    let offsets = Some(Offsets {
        a: code,
        b: code,
        spread: 0,
    });
    let kept = Alignment {
        offset: Angle(0),
        against: false,
    };
    let mut calibration = Calibration::of_kept(config, kept);
    let mut report = CurrentReport {
        offsets,
        ..CurrentReport::default()
    };
    // A hand turns the shaft for a second. Then a bad reading discards the offsets for 60 control periods.
    for tick in 0..1_060_i64 {
        report.offsets = offsets.filter(|_| tick < 1_000);
        let progress = calibration.tick(tick as u32, tick, &report);
        assert!(
            matches!(progress, Progress::Running(_)),
            "{tick}: {progress:?}"
        );
    }
    // Offsets that never come are still a failure.
    let ended = (0..1_000).find_map(|tick| match calibration.tick(tick, 0, &report) {
        Progress::Running(_) => None,
        ended => Some((tick, ended)),
    });
    let (tick, ended) = ended.expect("a failure");
    assert!(
        tick < 500 && ended == failed(Reason::OffsetsLate),
        "{tick}: {ended:?}"
    );
}

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

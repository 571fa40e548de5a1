//! Tests of the check of a device's settings: both sides of every bound, bounds between settings, and the message of a refusal.

use touchstone_control::{LawKind, Regulate, Si};
use touchstone_drive::wire::{checked, hardware};
use touchstone_protocol::settings::fields::{FIELDS, Field, Kind};
use touchstone_protocol::settings::{
    DriveKind, EncoderKind, LawSettings, Reason, SettingsError, VALUE_MAX,
};
use touchstone_protocol::{Board, Decimal, DeviceSettings};

/// Settings of a board with which each single setting may take its whole range.
fn roomy(board: Board) -> DeviceSettings {
    let mut settings = DeviceSettings::defaults(board);
    let largest = hardware(board).current_max_a;
    settings.encoder.kind = EncoderKind::Incremental;
    settings.timing.rate_hz = 500;
    settings.law = LawSettings::thesis();
    settings.law.force_limit_n_m = Si::lit("0.000001");
    settings.motor.torque_constant_n_m_per_a = Si::lit("10");
    settings.motor.current_limit_a = largest;
    settings.limits.trip_current_a = largest;
    settings.limits.bus_min_v = Si::lit("10");
    settings.limits.bus_max_v = DeviceSettings::defaults(board).limits.bus_max_v;
    settings.limits.derate_from_celsius = Si::lit("20");
    settings.limits.fault_from_celsius = Si::lit("110");
    settings.calibration.current_a = Si::lit("0.05");
    settings
}

/// Sets a numeric field of the settings, whatever its number type. Returns whether the field exists and takes the value.
fn set(settings: &mut DeviceSettings, field: &Field, value: Decimal) -> bool {
    let mut buffer = [0; VALUE_MAX];
    let bytes = match field.kind {
        Kind::Number { .. } => postcard::to_slice(&value, &mut buffer),
        _ if value.0 < Si::ZERO => return false,
        _ => postcard::to_slice(&value.0.to_num::<u32>(), &mut buffer),
    };
    settings.set(field.path, bytes.expect("room")).is_ok()
}

/// Changes other settings so that the setting at `path` may take both ends of its range.
fn companions(settings: &mut DeviceSettings, path: &str) {
    let small = Si::lit("0.05");
    match path {
        "limits.trip_current_a" => {
            settings.motor.current_limit_a = small;
            settings.calibration.current_a = small;
        }
        "limits.bus_min_v" if settings.limits.bus_max_v < Si::lit("48") => {
            settings.limits.bus_max_v = Si::lit("48");
        }
        "drive.analogue_full_scale_n_m" => settings.drive.kind = DriveKind::Analogue,
        "limits.fault_from_celsius" => settings.limits.derate_from_celsius = Si::lit("20"),
        _ => {}
    }
}

/// Settings whose range is wider than the device's number format holds, each with the power of the control rate in its coefficient.
/// Their coefficients add up to the stiffness `m/T² + k_f + d_f/T + d_g/T` of the filter, with control period `T`. Their ranges are
/// those of the control crate, for all number formats and rates.
const PARTS_OF_THE_SUM: [(&str, u32); 4] = [
    ("law.filter.mass_kg_m2", 2),
    ("law.filter.stiffness_n_m_per_rad", 0),
    ("law.filter.damping_n_m_s_per_rad", 1),
    ("law.filter.ground_damping_n_m_s_per_rad", 1),
];

/// Path of the setting for the virtual damping `B`. Its range is that of the control crate, for all number formats and rates; a
/// device's number format holds `B/T` (control period `T`) up to 2^19 N·m/rad.
const DAMPER: &str = "law.virtual_damping_n_m_s_per_rad";

/// For each board, checks the settings with this value in this field: `None` if they are accepted, else the error.
fn said(field: &Field, value: Decimal) -> [Option<SettingsError>; Board::ALL.len()] {
    Board::ALL.map(|board| {
        let mut settings = roomy(board);
        companions(&mut settings, field.path);
        assert!(set(&mut settings, field, value), "{}", field.path);
        checked(&settings, board).err()
    })
}

#[test]
fn both_ends_of_every_range_are_accepted_on_some_board() {
    for field in FIELDS {
        let Some((least, most)) = field.kind.range() else {
            continue;
        };
        let is_part =
            PARTS_OF_THE_SUM.iter().any(|(path, _)| *path == field.path) || field.path == DAMPER;
        for value in [least, most] {
            let accepted = said(field, value).contains(&None);
            let is_wanted = !(is_part && value == most);
            assert_eq!(
                accepted,
                is_wanted,
                "{} = {value}: {:?}",
                field.path,
                said(field, value)
            );
        }
    }
}

/// Checks the largest coefficient of each term of the filter `m/T² + k_f + d_f/T + d_g/T`. Twice the sum must fit the number format
/// `fixed32`, with 12 fractional and 19 integer bits. With the other terms at their least, each term may reach just below 2^18
/// N·m/rad, and the refusal of a larger one names that term.
#[test]
fn a_part_of_the_filters_sum_may_be_what_the_format_holds() {
    let room = Si::from_num(1 << 18);
    let least_stiffness = Si::lit("0.01");
    for (path, power) in PARTS_OF_THE_SUM {
        let field = FIELDS.iter().find(|field| field.path == path);
        let field = field.expect(path);
        let refused = |board, value| {
            let mut settings = roomy(board);
            let filter = &mut settings.law.filter;
            filter.mass_kg_m2 = Si::ZERO;
            filter.stiffness_n_m_per_rad = least_stiffness;
            filter.damping_n_m_s_per_rad = Si::ZERO;
            filter.ground_damping_n_m_s_per_rad = Si::ZERO;
            assert!(set(&mut settings, field, Decimal(value)), "{path}");
            checked(&settings, board).err()
        };
        for board in Board::ALL {
            let rate = i64::from(roomy(board).timing.rate_hz).pow(power);
            let others = if power == 0 {
                Si::ZERO
            } else {
                least_stiffness
            };
            let largest = Si::from_bits(((room - others).to_bits() - 1) / rate);
            assert_eq!(refused(board, largest), None, "{path} = {largest}");
            let error = refused(board, largest + Si::DELTA).expect(path);
            assert_eq!((error.path, error.reason), (path, Reason::OutOfFormat));
        }
    }
}

#[test]
fn beyond_every_range_the_path_the_value_and_the_range_are_named() {
    for field in FIELDS {
        let Some((least, most)) = field.kind.range() else {
            continue;
        };
        let step = match field.kind {
            Kind::Whole { .. } => Si::ONE,
            _ => Si::DELTA,
        };
        for value in [least.0 - step, most.0 + step].map(Decimal) {
            let mut settings = roomy(Board::NucleoG474re);
            if !set(&mut settings, field, value) {
                // Negative values, or values beyond the type, are refused earlier.
                continue;
            }
            let invalid = checked(&settings, Board::NucleoG474re).expect_err(field.path);
            assert_eq!(
                invalid,
                SettingsError {
                    path: field.path,
                    value,
                    reason: Reason::Outside { least, most }
                }
            );
            let text = invalid.to_string();
            for part in [
                field.path,
                &value.to_string(),
                &least.to_string(),
                field.unit,
            ] {
                assert!(text.contains(part), "{text}");
            }
        }
    }
}

/// The message with which a board refuses its default settings after `change`.
fn refusal(board: Board, change: impl Fn(&mut DeviceSettings)) -> String {
    let mut settings = DeviceSettings::defaults(board);
    settings.law = LawSettings::thesis();
    change(&mut settings);
    let invalid = checked(&settings, board).expect_err("accepted");
    // Every path fits its buffer and names a single setting.
    assert!(FIELDS.iter().any(|field| field.path == invalid.path));
    invalid.to_string()
}

#[test]
fn settings_are_checked_against_each_other_and_the_board() {
    let (big, small) = (Board::NucleoG474re, Board::BG431bEsc1);
    assert_eq!(
        refusal(big, |s| s.law.force_limit_n_m = Si::lit("0.6")),
        "law.force_limit_n_m = 0.6 is outside 0.000001 to 0.5 N·m"
    );
    assert_eq!(
        refusal(big, |s| s.timing.rate_hz = 3000),
        "timing.rate_hz = 3000 Hz is no whole fraction of 20000 Hz"
    );
    assert_eq!(
        refusal(big, |s| s.encoder.counts_per_rev = 4000),
        "encoder.counts_per_rev = 4000 is outside 16384 to 16384 counts/rev"
    );
    assert_eq!(
        refusal(big, |s| s.motor.current_limit_a = Si::lit("4.5")),
        "motor.current_limit_a = 4.5 is outside 0.05 to 4 A"
    );
    assert_eq!(
        refusal(big, |s| s.limits.bus_min_v = Si::lit("31")),
        "limits.bus_min_v = 31 is outside 10 to 30 V"
    );
    assert_eq!(
        refusal(small, |s| s.limits.bus_max_v = Si::lit("27")),
        "limits.bus_max_v = 27 is outside 10 to 26 V"
    );
    assert_eq!(
        refusal(small, |s| s.encoder.kind = EncoderKind::As5047p),
        "encoder.kind: this board has no connector for it"
    );
    assert_eq!(
        refusal(small, |s| s.drive.kind = DriveKind::Analogue),
        "drive.kind: this board has no connector for it"
    );
    let shield = Board::NucleoG474reIhm16m1;
    assert_eq!(
        refusal(shield, |s| s.drive.kind = DriveKind::Analogue),
        "drive.kind: this board has no connector for it"
    );
    assert_eq!(
        refusal(shield, |s| {
            s.law.force_limit_n_m = Si::lit("0.04");
            s.limits.trip_current_a = Si::lit("2.6");
        }),
        "limits.trip_current_a = 2.6 is outside 0.05 to 2.5 A"
    );
    let compensated = refusal(big, |s| {
        s.law.kind = LawKind::EnhancedSfa;
        s.law.regulate = Regulate::MassCompensated;
    });
    assert!(
        compensated.starts_with("wall.k_desired_n_m_per_rad = 5 is outside 0 to 0.99999"),
        "{compensated}"
    );
    let format = refusal(big, |s| s.law.filter.mass_kg_m2 = Si::lit("0.9"));
    assert!(
        format.starts_with("law.filter.mass_kg_m2: the coefficient 18000"),
        "{format}"
    );
}

#[test]
fn the_law_is_the_one_of_the_settings() {
    // All fields of the law are changed: the settings tree must give the same law settings as direct conversion.
    let mut settings = DeviceSettings::defaults(Board::NucleoG474re);
    settings.law = LawSettings::thesis();
    let law = touchstone_control::Settings {
        position: touchstone_control::PositionSettings::of_counts_per_rev(16_384),
        ..touchstone_control::Settings::thesis()
    };
    assert_eq!(settings.law(), law);
    settings.timing.rate_hz = 2000;
    settings.wall.k_desired_n_m_per_rad = Si::lit("1.5");
    settings.law.filter.ground_damping_n_m_s_per_rad = Si::lit("0.02");
    let changed = touchstone_control::Settings {
        rate_hz: 2000,
        k_desired: Si::lit("1.5"),
        filter: touchstone_control::FilterSettings {
            ground_damping: Si::lit("0.02"),
            ..law.filter
        },
        ..law
    };
    assert_eq!(settings.law(), changed);
}

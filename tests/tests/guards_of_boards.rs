//! Tests that `proofs/coq/Boards.v` describes the energy guards of the shipped boards. Its numbers must equal the guard
//! coefficients from each board's default settings, with the delay and lag of the board's current loop, and the device that they
//! assume.

use touchstone_control::{Fixed32, Guard};
use touchstone_drive::{change, wire};
use touchstone_protocol::{Board, DeviceSettings};

const fn name(board: Board) -> &'static str {
    match board {
        Board::NucleoG474re | Board::BG431bEsc1 => "gimbal",
        Board::NucleoG474reIhm16m1 | Board::NucleoG431rbIhm16m1 => "kit",
        Board::NucleoG474reSimplefocMini => "mini",
    }
}

#[test]
fn the_theorem_is_about_the_guards_of_the_boards() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../proofs/coq/Boards.v");
    let text = std::fs::read_to_string(path).expect("readable");
    let has = |what: String| assert!(text.contains(&what), "Boards.v has no `{what}`");
    for board in Board::ALL {
        let settings = DeviceSettings::defaults(board);
        let (law, change) =
            change::law_settings(&settings, wire::hardware(board)).expect("defaults");
        assert!(change.is_some(), "{board:?} reads its encoder once more");
        let device = law.guarded_device();
        let guard = Guard::<Fixed32>::new(&law.guard, &device).expect("defaults");
        for (field, value) in [
            ("capacity", guard.capacity.0.to_bits()),
            ("furthest", guard.furthest.0.to_bits().into()),
            ("count", guard.count.0.to_bits().into()),
            ("slack", guard.slack.0.to_bits().into()),
            ("per_reach", guard.per_reach.0.to_bits().into()),
        ] {
            has(format!("  {field} := {value};\n"));
        }
        let name = name(board);
        let six = [
            guard.refill.0.to_bits(),
            guard.damping.0.to_bits().into(),
            guard.late.0.to_bits().into(),
            guard.stray.0.to_bits().into(),
            guard.in_flight.0.to_bits().into(),
            guard.overrun.0.to_bits().into(),
        ]
        .map(|x: i64| x.to_string())
        .join(" ");
        has(format!("Definition {name} : guard := of_board {six}."));
        // The device as the guard is configured. All boards have the same rate, largest displacement and count.
        let (delay, lag) = (law.guard.delay.to_bits(), law.guard.lag.to_bits());
        let damping = law.guard.share_of_damping.to_num::<f64>()
            * law.guard.damping.to_num::<f64>()
            * f64::from(device.rate_hz);
        let damping = match name {
            "gimbal" => near(damping, 0.32, "32 # 100"),
            _ => near(damping, 0.0072, "72 # 10000"),
        };
        has(format!(
            "Definition {name}_device : device := told ({damping}) {delay} {lag}."
        ));
        assert_eq!((device.rate_hz, device.count.to_bits()), (1000, 1_647_100));
        assert!(
            text.contains("tick := 4294967296 # 1000 in") && text.contains("(1647100 # 256) + 2")
        );
        assert_eq!(law.guard.overspeed, 60);
    }
}

/// Asserts that `found` is within 1e-5 of `wanted`; returns `text`, the same number as written in Coq.
fn near(found: f64, wanted: f64, text: &'static str) -> &'static str {
    assert!((found - wanted).abs() < 1e-5 * wanted, "{found}");
    text
}

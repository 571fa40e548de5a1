//! Tests that the settings which `touchstone setup` writes keep the energy guard's bound on a board, whatever an imported law file
//! contains. The bound also holds for a hand that was optimised against the guard in that file.

use touchstone_control::{ChangeOfForce, GuardSettings, Si};
use touchstone_drive::change::law_settings;
use touchstone_drive::wire::hardware;
use touchstone_link::guard::hold;
use touchstone_protocol::{Board, DeviceSettings};
use touchstone_tests::adversary::Way;
use touchstone_tests::board_loop::BoardLoop;
use touchstone_tests::port::{Port, SpringDamper};

/// Settings from an imported law file. Its energy guard is configured for positions read once per control period, and for a delay
/// of one and a half PWM periods, a fifth of the board's. The damping that the guard relies on (0.8 of the configured one) is all
/// that the device has.
fn of_a_file() -> DeviceSettings {
    let mut settings = DeviceSettings::defaults(Board::NucleoG474re);
    let guard = &mut settings.law.guard;
    guard.change = ChangeOfForce::Estimated;
    guard.delay_s = Si::lit("0.000075");
    guard.damping_n_m_s_per_rad = Si::lit("0.0005");
    settings
}

/// The simulated port between board and hand, with an energy guard of these settings, and the guard's settings.
fn port(settings: &DeviceSettings) -> (Port, GuardSettings) {
    let (board, _) = BoardLoop::shipped();
    let (law, change) = law_settings(settings, hardware(Board::NucleoG474re)).unwrap();
    let mut port = Port::new(law, 0.0, true, true);
    port.count_rad = law.position.count.to_num();
    port.guard = Some(law.guard);
    port.board = Some(board);
    port.reads = change.is_some();
    (port, law.guard)
}

#[test]
fn a_pattern_found_against_a_files_guard_gets_no_more_than_promised_from_what_setup_leaves() {
    let file = of_a_file();
    let mut left = file.clone();
    // 0.8 of the measured damping.
    hold(&mut left, Board::NucleoG474re, Si::lit("0.00032"));
    let ((mut weak, _), (mut held, guard)) = (port(&file), port(&left));
    // A hostile law: only the guard limits its force.
    for port in [&mut weak, &mut held] {
        port.law = SpringDamper { k: 20.0, b: 0.0 }.into();
        port.force_limit_n_m = 0.5;
    }
    // 45 mJ and half a count under the force that 45 mJ allow; `any_accepted_window` of proofs/coq/AcceptedWindow.v.
    let bound_j = 0.045_145;
    assert_eq!(guard.capacity, Si::lit("0.045"));
    let (mut worst_j, mut left_j) = (0.0_f64, 0.0_f64);
    for way in [Way::Sines, Way::Policy, Way::Gripped] {
        for seed in 1..=2 {
            let (numbers, _) = way.worst(&weak, 600, 500, seed);
            let taken = way.play(&weak, &numbers, 10_000).above_refill_j;
            let now = way.play(&held, &numbers, 10_000).above_refill_j;
            println!(
                "{way:?} {seed}: {:.1} mJ in 10 s from the file's guard, {:.1} mJ from what setup leaves",
                1e3 * taken,
                1e3 * now
            );
            assert!(now <= bound_j, "{way:?}: {numbers:?}");
            (worst_j, left_j) = (worst_j.max(taken), left_j.max(now));
        }
    }
    // The file's guard does not keep the bound, so the search does find energy to get out.
    assert!(worst_j > 2.0 * bound_j, "{worst_j}");
    assert!(left_j > 0.5 * bound_j, "{left_j}");
}

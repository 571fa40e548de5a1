//! Tests that a simulated copy of a device calculates the device's force bit for bit from complete telemetry, whatever the control
//! law remembers. After lost telemetry the copy gives no force until it has synchronised, and then the force to 1e-5 N·m.

use touchstone_control::Si;
use touchstone_drive::DeviceSettings;
use touchstone_drive::twin::Twin;
use touchstone_protocol::{Board, Command, Limit, Limits, Phase, Telemetry};
use touchstone_tests::knob::honest;

fn shipped(guard: bool) -> DeviceSettings {
    let mut settings = DeviceSettings::defaults(Board::NucleoG474re);
    settings.wall.surface_rad = Si::lit("0.3");
    settings.limits.fade_in_s = Si::lit("0.05");
    settings.law.guard.on = guard;
    settings
}

/// Simulates a knob that is switched on twice, pressed twice each time, and switched off in the middle of a press. Returns every
/// telemetry record.
fn records(settings: &DeviceSettings) -> Vec<Telemetry> {
    let mut knob = honest(settings).armed();
    let start = knob.rig.now().angle_rad;
    let mut all = vec![Telemetry::from(&knob.record)];
    for tick in 0..6_000 {
        let into = f64::from(tick % 1_500) / 1_500.0;
        knob.rest_rad = start + 0.8 * (1.0 - (std::f64::consts::TAU * into).cos()) / 2.0;
        match tick {
            2_560 => knob.ask(Command::Disarm),
            2_990 => knob.ask(Command::Arm),
            _ => {}
        }
        all.push(Telemetry::from(&knob.tick()));
    }
    all
}

#[test]
fn every_force_is_the_models_to_the_bit() {
    // With the small account (2 mJ) the guard limits the force. Then the energy that the guard charges when the first arming ends
    // also limits the forces of the second arming.
    for (guard, capacity) in [(false, "0.045"), (true, "0.045"), (true, "0.002")] {
        let mut settings = shipped(guard);
        settings.law.guard.capacity_j = Si::lit(capacity);
        let mut twin = Twin::new(&settings, Board::NucleoG474re).unwrap();
        let mut all = records(&settings);
        // The copy gets telemetry before the device is armed, as if a web page had been opened earlier.
        let ready = Telemetry {
            tick: all[0].tick - 1,
            phase: Phase::Ready,
            ..all[0]
        };
        all.insert(0, ready);
        let (mut judged, mut pushed, mut held_back) = (0, 0, 0);
        for record in &all {
            let model = twin.tick(record);
            assert_eq!(model.is_some(), record.phase == Phase::Armed, "{record:?}");
            if let Some(force) = model {
                assert_eq!(force, record.force_n_m, "guard {guard}: {record:?}");
                judged += 1;
                pushed += u32::from(force != 0);
                held_back += u32::from(Limits::from_wire(record.limits).has(Limit::FadeIn));
            }
        }
        assert!(
            judged > 5_000 && pushed > 1_000 && held_back >= 100,
            "{judged} {pushed} {held_back}"
        );
    }
}

#[test]
fn what_is_missing_is_not_guessed_and_found_in_again() {
    let settings = shipped(false);
    let mut all = records(&settings);
    let lost = 700..720;
    let resumed = all[lost.end].tick;
    all.drain(lost);
    let mut twin = Twin::new(&settings, Board::NucleoG474re).unwrap();
    let mut silent = 0;
    let mut worst: f64 = 0.0;
    let mut judged = 0;
    for record in &all {
        let model = twin.tick(record);
        match model {
            Some(force) if record.tick >= resumed => {
                judged += 1;
                worst = worst.max((force - record.force_n_m).to_num::<f64>().abs());
            }
            None if record.tick >= resumed && record.phase == Phase::Armed => silent += 1,
            _ => {}
        }
    }
    // No force is given for the rest of the press in which telemetry was lost, and outside the wall until the copy has
    // synchronised.
    assert!(
        (500..2_300).contains(&silent),
        "{silent} ticks without a model"
    );
    assert!(judged > 1_000, "{judged}");
    // From the second arming on, the copy is exact again. Before, its force differs a little, because the effect of the missed
    // ticks on the estimated states decays but does not vanish.
    assert!(worst < 1e-5, "{worst} N·m");
}

#[test]
fn another_stiffness_is_seen() {
    let settings = shipped(false);
    let mut other = settings.clone();
    other.wall.k_desired_n_m_per_rad = settings.wall.k_desired_n_m_per_rad * Si::lit("0.99");
    let all = records(&settings);
    let mut twin = Twin::new(&other, Board::NucleoG474re).unwrap();
    let before = Telemetry {
        tick: all[0].tick - 1,
        phase: Phase::Ready,
        ..all[0]
    };
    twin.tick(&before);
    let differing = all.iter().filter(|record| {
        twin.tick(record)
            .is_some_and(|force| force != record.force_n_m)
    });
    assert!(differing.count() > 1_000);
}

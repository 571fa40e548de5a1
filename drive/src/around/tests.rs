//! Tests of what runs when environments, armings and calibrations follow each other.

use super::*;
use crate::change::law_settings;
use crate::hardware::IHM08M1;
use touchstone_control::{ChangeOfForce, Si};
use touchstone_protocol::settings::environment::DetentsBeside;
use touchstone_protocol::{CoggingMap, Decimal};

/// An environment of 24 detents of 0.05 N·m a turn, without a wall.
pub(crate) fn detents() -> Surround {
    Surround {
        first_wall: false,
        detents: Some(DetentsBeside {
            per_rev: 24,
            pitch_rad: Decimal(Si::ZERO),
            strength_n_m: Decimal(Si::lit("0.05")),
            centre_rad: Decimal(Si::ZERO),
        }),
        ..Surround::default()
    }
}

fn settings(change: ChangeOfForce) -> DeviceSettings {
    let mut settings = DeviceSettings::default();
    settings.law.guard.change = change;
    settings
}

fn law(settings: &DeviceSettings) -> Law {
    Controller::new(&law_settings(settings, &IHM08M1).unwrap().0).unwrap()
}

/// A knob with the settings' wall, and with nothing prepared around it.
#[derive(Clone)]
struct Knob {
    scale: CountScale,
    fresh: Law,
    law: Law,
    around: Around,
}

impl Knob {
    fn new() -> Self {
        let settings = settings(ChangeOfForce::Estimated);
        let fresh = law(&settings);
        Self {
            scale: CountScale::new(settings.encoder.counts_per_rev, Si::ZERO).unwrap(),
            fresh,
            law: fresh,
            around: Around::new(),
        }
    }

    fn prepare(&mut self, all: &Surround, is_armed: bool, settings_wait: bool) -> CountsFrom {
        let settings = settings(ChangeOfForce::Estimated);
        let surrounding = Surrounding::new(&settings, &IHM08M1, all).unwrap();
        self.around
            .prepare(&surrounding, &mut self.law, is_armed, settings_wait)
    }

    fn arm(&mut self) {
        self.around.armed(&mut self.law, &self.fresh);
    }

    fn tick(&mut self, count: i64) -> Force<Fixed32> {
        let here = Here {
            count,
            penetration: self.scale.penetration(count),
            since_change: None,
        };
        self.around.tick(&mut self.law, &self.scale, &here)
    }

    /// A hand takes energy out for 20 control periods: towards the middle of a detent, from a third of the distance to the next.
    /// Then the outputs are switched off.
    fn pull(&mut self) {
        for tick in 0..20 {
            self.tick(220 - 10 * tick);
        }
        self.switch_off();
    }

    fn switch_off(&mut self) {
        self.around.switched_off(&mut self.law);
    }

    /// What is left in the account of the guard that acts now.
    fn account(&self) -> i64 {
        let guard = match self.around.running() {
            Some(environment) => environment.guard,
            None => self.law.guard,
        };
        guard.unwrap().account().0.to_bits()
    }
}

/// The guard of an environment knows the board's delay, as the guard of the settings' wall does.
#[test]
fn the_guard_of_an_environment_is_that_of_the_wall() {
    for change in [ChangeOfForce::Estimated, ChangeOfForce::Measured] {
        let settings = settings(change);
        let surrounding = Surrounding::new(&settings, &IHM08M1, &detents()).unwrap();
        let guard = surrounding.environment.guard;
        assert!(
            guard.is_some() && guard == law(&settings).guard,
            "{change:?}"
        );
    }
}

/// Arms the knob a hundred times with detents, and with the settings' wall in between. A hand takes energy out meanwhile. Only
/// the time in which a force acts refills the guard's account, never an arming.
#[test]
fn arming_again_fills_no_account() {
    let mut knob = Knob::new();
    let full = knob.account();
    let mut least = full;
    for arming in 0..100_i64 {
        let is_wall = arming % 3 == 2;
        let before = knob.account();
        // Every third arming renders the detents of the one before.
        if arming % 3 != 1 {
            let all = if is_wall {
                Surround::default()
            } else {
                detents()
            };
            knob.prepare(&all, false, false);
        }
        knob.arm();
        assert_eq!(knob.around.runs(), !is_wall, "{arming}");
        assert_eq!(knob.account(), before, "{arming}");
        knob.pull();
        least = least.min(knob.account());
    }
    assert!(least < full / 2, "{least} of {full}");
}

/// While an environment runs, its guard gets the acting force and the switching off, and the wall's guard does not.
#[test]
fn the_guard_of_what_runs_gets_what_acts() {
    let mut knob = Knob::new();
    knob.prepare(&detents(), false, false);
    knob.arm();
    assert_ne!(knob.tick(220), Force::zero());
    let wall = knob.law.guard;
    let acts: [fn(&mut Knob); 2] = [
        |knob| knob.around.commanded(&mut knob.law, Force::zero()),
        Knob::switch_off,
    ];
    for act in acts {
        knob.tick(220);
        let before = knob.around.running().unwrap().guard;
        act(&mut knob);
        assert_ne!(knob.around.running().unwrap().guard, before);
        assert_eq!(knob.law.guard, wall);
    }
}

/// An environment that was requested while the device was armed, and has not run yet, runs from the next arming on.
#[test]
fn an_arming_begins_what_waits_for_a_tick() {
    let mut knob = Knob::new();
    knob.arm();
    assert_eq!(knob.prepare(&detents(), true, false), CountsFrom::NextTick);
    knob.switch_off();
    knob.arm();
    assert!(knob.around.runs());
}

/// What was prepared for other settings replaces what runs at the calibration, and the same hand's account goes on.
#[test]
fn a_calibration_ends_what_runs() {
    let mut knob = Knob::new();
    let full = knob.account();
    knob.prepare(&detents(), false, false);
    knob.arm();
    knob.pull();
    let left = knob.account();
    assert!(left < full);
    let counts_from = knob.prepare(&Surround::default(), false, true);
    assert_eq!(counts_from, CountsFrom::Calibration);
    assert!(knob.around.runs());
    knob.around.calibrated(&mut knob.law);
    assert!(!knob.around.runs());
    assert_eq!(knob.account(), left);
    knob.arm();
    assert!(!knob.around.runs());
}

/// The force goes on without a jump only if a force acts: before the first tick after an arming, the last force is that of an
/// earlier arming, at another place.
#[test]
fn a_change_goes_on_from_the_force_of_this_arming_only() {
    for (ticked, count) in [(false, 170), (true, 40)] {
        let mut knob = Knob::new();
        knob.arm();
        let before = knob.tick(40);
        let at_once = {
            let mut other = knob.clone();
            other.switch_off();
            other.prepare(&detents(), false, false);
            other.arm();
            other.tick(count)
        };
        if !ticked {
            knob.switch_off();
            knob.arm();
        }
        knob.prepare(&detents(), true, false);
        let change = knob.tick(count);
        // 0.5 N·m/s in a control period of 1 ms.
        let is_near = |force: Force<Fixed32>| (change.0 - force.0).abs() <= 0.0005;
        assert_eq!(is_near(before), ticked, "{before:?} {change:?}");
        assert_eq!(is_near(at_once), !ticked, "{at_once:?} {change:?}");
    }
}

/// A map of the cogging that belongs to settings that wait is used from the calibration on.
#[test]
fn a_map_that_waits_is_not_used() {
    let map = Played::new(&CoggingMap::default(), &DeviceSettings::default(), &IHM08M1);
    let mut knob = Knob::new();
    assert!(knob.around.played().is_none());
    knob.around.play(Some(&map), true);
    assert!(knob.around.played().is_none());
    knob.around.calibrated(&mut knob.law);
    assert!(knob.around.played().is_some());
    knob.around.play(Some(&map), false);
    assert!(knob.around.played().is_some());
    knob.around.play(None, false);
    assert!(knob.around.played().is_none());
}

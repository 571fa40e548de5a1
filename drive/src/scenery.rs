//! The forces that the knob renders: the single wall of the settings, or an environment on boards with enough memory.
//!
//! It is not a part of the device: an environment has some kilobytes, too large for a stack.

use touchstone_control::law::View;
use touchstone_control::{Controller, CountScale, Fixed32, Force, Position};

type Law = Controller<Fixed32>;

/// Position and displacement of the device at a tick.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Here {
    /// The encoder's count.
    #[cfg_attr(
        not(feature = "large"),
        allow(dead_code, reason = "the wall alone has one surface")
    )]
    pub count: i64,
    /// Penetration of that position behind the surface of the settings' wall.
    pub penetration: Position<Fixed32>,
    /// Displacement since the force changed; `None` where it is not measured.
    pub since_change: Option<Position<Fixed32>>,
}

/// The calls that a control tick makes to the rendered wall or environment. The law of the settings' wall belongs to the device.
pub(crate) trait Scenery {
    /// Starts after an arming: all memory is cleared except the energy in the guard's account.
    fn armed(&mut self, law: &mut Law, fresh: &Law);
    /// Restarts the law while the device stays armed, after a motion at which no force is allowed.
    fn again(&mut self, law: &mut Law, fresh: &Law);
    /// Runs one tick while armed; returns the force against `+x`. The encoder's scale is passed by reference, as a copy takes time.
    fn tick(&mut self, law: &mut Law, scale: &CountScale, here: &Here) -> Force<Fixed32>;
    /// Reports the force that was really commanded, after later stages changed it.
    fn commanded(&mut self, law: &mut Law, force: Force<Fixed32>);
    /// Reports that the outputs are switched off, after a tick that commanded no force or at an unknown time.
    fn switched_off(&mut self, law: &mut Law);
    /// Whether the guard has switched the force off because of overspeed.
    fn is_tripped(&self, law: &Law) -> bool;
    /// Whether a wall gives no force because the device is deeper inside it than positions reach.
    fn is_beyond_reach(&self, law: &Law, penetration: Position<Fixed32>) -> bool;
    /// Internal values of the wall that is touched.
    fn view(&self, law: &Law) -> View<Fixed32>;
    /// Whether an environment runs in the place of the settings' single wall.
    fn runs(&self) -> bool;
    /// Reports that a calibration has changed to other settings.
    fn calibrated(&mut self, law: &mut Law);
    /// The cogging map with which the board compensates cogging; `None` without one.
    #[cfg(feature = "large")]
    fn played(&self) -> Option<&crate::cogging::Played>;
}

/// The single wall of the settings, without an environment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WallAlone;

impl Scenery for WallAlone {
    #[inline(always)]
    fn armed(&mut self, law: &mut Law, fresh: &Law) {
        law.resume(fresh);
    }

    #[inline(always)]
    fn again(&mut self, law: &mut Law, fresh: &Law) {
        law.resume(fresh);
    }

    #[inline(always)]
    fn tick(&mut self, law: &mut Law, _: &CountScale, here: &Here) -> Force<Fixed32> {
        law_tick(law, here.penetration, here.since_change)
    }

    #[inline(always)]
    fn commanded(&mut self, law: &mut Law, force: Force<Fixed32>) {
        law.commanded(force);
    }

    #[inline(always)]
    fn switched_off(&mut self, law: &mut Law) {
        law.switched_off();
    }

    #[inline(always)]
    fn is_tripped(&self, law: &Law) -> bool {
        law.tripped()
    }

    #[inline(always)]
    fn is_beyond_reach(&self, law: &Law, penetration: Position<Fixed32>) -> bool {
        law.is_beyond_reach(penetration)
    }

    #[inline(always)]
    fn view(&self, law: &Law) -> View<Fixed32> {
        law.view()
    }

    #[inline(always)]
    fn runs(&self) -> bool {
        false
    }

    #[inline(always)]
    fn calibrated(&mut self, _law: &mut Law) {}

    #[cfg(feature = "large")]
    #[inline(always)]
    fn played(&self) -> Option<&crate::cogging::Played> {
        None
    }
}

/// Runs the law's tick. It is a separate function in every program, so that its time can be counted (`cargo xtask cycles`).
#[inline(never)]
pub(crate) fn law_tick(
    law: &mut Law,
    penetration: Position<Fixed32>,
    since_change: Option<Position<Fixed32>>,
) -> Force<Fixed32> {
    let at_change = since_change.map(|since| penetration - since);
    law.tick_with_change(penetration, at_change)
}

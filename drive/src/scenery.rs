//! What the knob displays: the single wall of the settings, or an environment on boards with room for it.
//!
//! Not a part of the device: an environment is some kilobytes, too large for a stack.

use touchstone_control::law::View;
use touchstone_control::{Controller, CountScale, Fixed32, Force, Position};

type Law = Controller<Fixed32>;

/// Where the device is at a tick.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Here {
    /// The count.
    #[cfg_attr(
        not(feature = "large"),
        allow(dead_code, reason = "the wall alone has one surface")
    )]
    pub count: i64,
    /// How deep that is behind the surface of the settings' wall.
    pub penetration: Position<Fixed32>,
    /// How far it has moved since the force changed; `None` where that is not measured.
    pub since_change: Option<Position<Fixed32>>,
}

/// What a control tick needs of the displayed wall or environment. The law of the settings' wall belongs to the
/// device.
pub(crate) trait Scenery {
    /// The device was just armed: all memory is new but the guard's account.
    fn armed(&mut self, law: &mut Law, fresh: &Law);
    /// Restarts the law where the device stays armed, after a motion too fast for any force.
    fn again(&mut self, law: &mut Law, fresh: &Law);
    /// Runs one tick while armed; returns the force against `+x`. The encoder's scale is passed by reference, as a
    /// copy takes time.
    fn tick(&mut self, law: &mut Law, scale: &CountScale, here: &Here) -> Force<Fixed32>;
    /// What became of that force.
    fn commanded(&mut self, law: &mut Law, force: Force<Fixed32>);
    /// The outputs are switched off, after a tick that commanded no force, or at an unknown time.
    fn switched_off(&mut self, law: &mut Law);
    /// Whether the guard has switched the force off for overspeed.
    fn is_tripped(&self, law: &Law) -> bool;
    /// Whether a wall gives no force because the device is deeper inside it than positions reach.
    fn is_beyond_reach(&self, law: &Law, penetration: Position<Fixed32>) -> bool;
    /// Inner values of the wall that is touched.
    fn view(&self, law: &Law) -> View<Fixed32>;
    /// Whether an environment runs in the place of the wall alone.
    fn runs(&self) -> bool;
    /// A calibration changed over to other settings.
    fn calibrated(&mut self, law: &mut Law);
    /// The map of the cogging, where one is played.
    #[cfg(feature = "large")]
    fn played(&self) -> Option<&crate::cogging::Played>;
}

/// The wall of the settings, and nothing else.
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

/// The law's tick. It is a function of its own in every program, so that its cost can be counted (`cargo xtask
/// cycles`).
#[inline(never)]
pub(crate) fn law_tick(
    law: &mut Law,
    penetration: Position<Fixed32>,
    since_change: Option<Position<Fixed32>>,
) -> Force<Fixed32> {
    let at_change = since_change.map(|since| penetration - since);
    law.tick_with_change(penetration, at_change)
}

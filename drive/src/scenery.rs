//! The forces that the knob renders: the single wall of the settings, or an environment of several walls and detents on boards with
//! enough memory.
//!
//! An environment is not a part of the device struct, because its kilobytes are too large for a stack.

use touchstone_control::law::View;
use touchstone_control::{Controller, CountScale, Fixed32, Force, Position};

type Law = Controller<Fixed32>;

/// Position and displacement of the device in a control period.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Here {
    /// Encoder count at the device's position.
    #[cfg_attr(
        not(feature = "large"),
        allow(dead_code, reason = "the wall alone has one surface")
    )]
    pub count: i64,
    /// Penetration at this position behind the surface of the settings' wall.
    pub penetration: Position<Fixed32>,
    /// Displacement since the force changed; `None` if it is not measured.
    pub since_change: Option<Position<Fixed32>>,
}

/// The calls that a control period makes to what it renders: the single wall of the settings or an environment (walls and detents).
/// The control law of the settings' wall belongs to the device, so it is passed in.
pub(crate) trait Scenery {
    /// Starts rendering after the device was armed. All memory is cleared, except the energy in the energy guard's account.
    fn armed(&mut self, law: &mut Law, fresh: &Law);
    /// Restarts the control law while the device stays armed, after the energy guard has tripped without a fault.
    fn again(&mut self, law: &mut Law, fresh: &Law);
    /// Runs one control period while armed; returns the force, positive against rising positions (`+x`). The encoder's scale is
    /// passed by reference, because a copy takes time.
    fn tick(&mut self, law: &mut Law, scale: &CountScale, here: &Here) -> Force<Fixed32>;
    /// Reports to the control law the force that was really commanded, after later stages changed it.
    fn commanded(&mut self, law: &mut Law, force: Force<Fixed32>);
    /// Reports to the control law that the outputs are switched off, after a control period without force or at an unknown time.
    fn switched_off(&mut self, law: &mut Law);
    /// Whether the energy guard has switched the force off, because the shaft turns too fast or is at the end of the range of
    /// positions.
    fn is_tripped(&self, law: &Law) -> bool;
    /// Whether a wall gives no force because the device is deeper inside it than the position's number format reaches.
    fn is_beyond_reach(&self, law: &Law, penetration: Position<Fixed32>) -> bool;
    /// Internal values of the wall that the device touches, for telemetry.
    fn view(&self, law: &Law) -> View<Fixed32>;
    /// Whether an environment (walls and detents) is rendered in place of the settings' single wall.
    fn runs(&self) -> bool;
    /// Reports that a calibration has switched to other settings.
    fn calibrated(&mut self, law: &mut Law);
    /// The cogging map with which the board compensates cogging; `None` without one.
    #[cfg(feature = "large")]
    fn played(&self) -> Option<&crate::cogging::Played>;
}

/// Renders only the single wall of the settings, without an environment of further walls and detents.
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

/// Runs one period of the control law. The function is never inlined, so that `cargo xtask cycles` can count its processor cycles.
#[inline(never)]
pub(crate) fn law_tick(
    law: &mut Law,
    penetration: Position<Fixed32>,
    since_change: Option<Position<Fixed32>>,
) -> Force<Fixed32> {
    let at_change = since_change.map(|since| penetration - since);
    law.tick_with_change(penetration, at_change)
}

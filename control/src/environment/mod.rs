//! All haptic effects of one axis: several walls, detents, a drawn torque profile, and the further parts of a feel (spring to a
//! centre, friction, click, inertia). A wall is solid above or below its surface. One energy guard limits the sum of their forces.
//!
//! ```text
//! angle -> each wall: penetration -> states -> surface -> law \
//!       -> detents --------------------------------------------> sum -> saturation -> guard -> force
//!       -> profile -------------------------------------------->
//!       -> feel ----------------------------------------------->
//! ```
//!
//! **All walls are calculated at every tick.** Each wall has its own law with its own memory. When a contact has ended, its law
//! gives no force and keeps no energy and no offset, so a touch of another wall does not influence it. The sum of all forces is
//! limited as one force and passes one guard. So the guard's account also bounds the energy that a hand gets by going from one wall
//! to the next. Estimators get the sum of all forces, since the sum moves the device.
//!
//! **Signs.** Forces here act against `+x`, like the force of a wall that is solid above its surface. A wall that is solid below is
//! calculated as the mirror image of one above. So an environment and its mirror image answer mirrored motions with mirrored
//! forces, bit for bit.
//!
//! **Many turns.** A knob may turn for 340 million turns: detents and the guard's energy account are the same at every turn, bit
//! for bit. A wall acts up to a distance of 128 rad from its surface (with 32 bits). Further outside there is no wall to feel.
//! Further inside the wall is off, which [`Environment::is_beyond_reach`] reports.
//!
//! Objects on three axes are in [`crate::space::environment`]: there a point is inside one shape, here inside any number of walls.

mod changing;
mod detents;
mod face;
pub mod feel;
pub mod inertia;
pub mod profile;
mod refused;
mod refused_message;
mod viscous;

use changing::Carried;
pub use detents::{DetentSettings, Detents, Spacing};
pub use face::{Counted, Face, Reached, Reading, Side, turn_of};
pub use feel::{CentreSettings, ClickSettings, DrySettings, Feel, FeelSettings};
pub use inertia::InertiaSettings;
pub use profile::{Extent, MOST_POINTS, Profile, ProfileSettings, Shape, WHOLE};
pub use refused::Refused;
pub use viscous::ViscousSettings;

use crate::controller::Controller;
use crate::guard::{displacement, quantum};
use crate::law::{Contact, Impact, View, YieldingSurface};
use crate::validate::largest_force;
use crate::{AnyLaw, Force, Guard, Guarded, Number, Position, Settings, Si, States};

/// The most walls that an environment can have: two end stops and four walls between them.
pub const MOST_WALLS: usize = 6;

/// Converts a coefficient to the number format. Refuses a value that does not fit, with the setting's path in a scene.
fn ratio<N: Number>(path: &'static str, value: Si) -> Result<N::Ratio, Refused> {
    N::ratio(value).ok_or(Refused::PartOfFormat { path, value })
}

/// Settings of a wall: position and side of its surface, and its stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WallSettings {
    /// The wall's surface and its solid side.
    pub face: Face,
    /// Desired stiffness of the wall, N·m/rad.
    pub k_desired: Si,
}

/// A wall, the control law that renders it, and the law's memory.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Walled<N: Number> {
    wall: WallSettings,
    reached: Reached,
    states: States<N>,
    surface: YieldingSurface<N>,
    law: AnyLaw<N>,
    impact: Option<Impact<N>>,
}

impl<N: Number> Walled<N> {
    /// Clears the memory of the wall's control law and of its source of position and velocity.
    #[cold]
    fn forget(&mut self) {
        self.states.forget();
        self.surface.forget_push();
        self.law.forget();
        if let Some(impact) = &mut self.impact {
            impact.forget_touch();
        }
    }
}

/// Walls, detents, a torque profile and further parts of a feel on one axis, behind one energy guard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Environment<N: Number> {
    walls: [Option<Walled<N>>; MOST_WALLS],
    detents: Option<Detents<N>>,
    profile: Option<Profile<N>>,
    feel: Option<Feel<N>>,
    limit: Force<N>,
    /// The energy guard behind the sum of all forces.
    pub guard: Option<Guarded<N>>,
    /// Step in rad (m) to which positions are rounded before the guard's energy account gets their differences.
    step: Si,
    /// The position at the last tick, rounded to whole steps.
    last: Option<Si>,
    /// Largest position of the number format, to either side.
    end: Position<N>,
    /// Whether a wall was off at the last tick, because the device was deeper inside it than the number format of positions
    /// reaches.
    beyond_reach: bool,
    commanded: Force<N>,
    /// The force of the last tick, before any later stage (such as a current limit) changes it.
    shown: Force<N>,
    /// The remaining force difference to a replaced environment, while the difference fades; `None` if no difference fades.
    carried: Option<Carried<N>>,
}

impl<N: Number> Environment<N> {
    /// Makes the environment in the state at power-up. All walls use the same settings of law and guard, except for the desired
    /// stiffness.
    ///
    /// # Errors
    /// The setting that is refused, and the wall to which it belongs.
    #[cold]
    #[inline(never)]
    pub fn new(
        settings: &Settings,
        walls: &[WallSettings],
        detents: Option<&DetentSettings>,
    ) -> Result<Self, Refused> {
        if walls.len() > MOST_WALLS {
            return Err(Refused::TooManyWalls);
        }
        let mut environment = Self {
            walls: [None; MOST_WALLS],
            detents: None,
            profile: None,
            feel: None,
            limit: largest_force(settings).map_err(Refused::Law)?,
            guard: None,
            step: quantum::<N>(),
            last: None,
            end: Position(N::saturating_signal(Si::MAX)),
            beyond_reach: false,
            commanded: Force::zero(),
            shown: Force::zero(),
            carried: None,
        };
        settings.validate().map_err(Refused::Law)?;
        if settings.guard.on {
            let guard = Guard::new(&settings.guard, &settings.guarded_device());
            environment.guard = Some(Guarded::new(guard.map_err(Refused::Law)?));
        }
        let slots = environment.walls.iter_mut();
        let pulse = Impact::pulse_of(settings).map_err(Refused::Law)?;
        // A board takes long to compute a law's coefficients, and walls often have the same settings, so a wall's law is copied
        // from the previous wall.
        let mut last: Option<Walled<N>> = None;
        for (place, (slot, wall)) in (0_u8..).zip(slots.zip(walls)) {
            let own = Settings {
                k_desired: wall.k_desired,
                ..*settings
            };
            let refused = |error| Refused::Wall(place, error);
            let states = match &last {
                Some(last) => last.states,
                None => Controller::<N>::states_of(&own).map_err(refused)?,
            };
            let law = match &last {
                Some(last) if last.wall.k_desired == wall.k_desired => last.law,
                _ => AnyLaw::new(&own).map_err(refused)?,
            };
            let wall = *wall;
            last = Some(Walled {
                wall,
                reached: wall.face.reached(),
                states,
                surface: YieldingSurface::surface_of(&own).map_err(refused)?,
                law,
                impact: pulse,
            });
            *slot = last;
        }
        if let Some(detents) = detents {
            environment.detents = Some(detents.detents(settings.force_limit)?);
        }
        Ok(environment)
    }

    /// This environment with a torque profile, whose force is added to those of walls and detents. `force_limit` is the largest
    /// force of the law's settings.
    ///
    /// # Errors
    /// The profile's setting that is refused.
    #[cold]
    pub fn with_profile(
        mut self,
        profile: &ProfileSettings,
        force_limit: Si,
    ) -> Result<Self, Refused> {
        self.profile = Some(profile.profile(force_limit)?);
        Ok(self)
    }

    /// This environment with further parts of a feel, whose forces are added to those of walls, detents and profile. `settings` are
    /// those of the law.
    ///
    /// # Errors
    /// The setting of a part that is refused.
    #[cold]
    pub fn with_feel(mut self, feel: &FeelSettings, settings: &Settings) -> Result<Self, Refused> {
        self.feel = (*feel != FeelSettings::default())
            .then(|| feel.feel(settings))
            .transpose()?;
        Ok(self)
    }

    /// Returns this new environment with the guard's energy of `before`, for when the force is switched on again (arming). Nothing
    /// else is taken over from `before`.
    #[must_use]
    pub fn resumed(self, before: &Self) -> Self {
        let guard = match (self.guard, &before.guard) {
            (Some(guard), Some(before)) => Some(guard.resumed(before)),
            (guard, _) => guard,
        };
        Self { guard, ..self }
    }

    /// Runs one control period: takes the device's position, and its displacement since the last change of force (`None` if the
    /// position is not measured at that change). Returns the force against `+x`.
    ///
    /// If a later stage changes that force, the caller must report it with [`Environment::commanded`].
    #[inline]
    pub fn tick(&mut self, at: &impl Reading<N>, since_change: Option<Position<N>>) -> Force<N> {
        let mut wanted = match &self.detents {
            None => Force::zero(),
            Some(detents) => detents.force(at),
        };
        if let Some(profile) = &self.profile {
            wanted = wanted + profile.force(at);
        }
        let (end, commanded) = (self.end, self.commanded);
        self.beyond_reach = false;
        for wall in self.walls.iter_mut().flatten() {
            let e = at.penetration(&wall.reached);
            if e >= end || e <= -end {
                wall.forget();
                self.beyond_reach |= e >= end;
                continue;
            }
            let Walled {
                wall,
                states,
                surface,
                law,
                impact,
                ..
            } = wall;
            let side = wall.face.side;
            states.commanded(side.seen(commanded));
            let sample = surface.from_surface(states.sample(e));
            let mut force = law.tick(sample);
            surface.give_way(sample, force);
            if let Some(impact) = impact {
                force = impact.with_pulse_and_vibration(sample, force);
            }
            wanted = wanted + side.seen(force);
        }
        if let Some(feel) = &self.feel {
            // These parts need the position in two more forms. Without such parts, this check costs an environment three
            // instructions on a Cortex-M4.
            let (beyond, now) = (feel.beyond(at), at.on_steps(self.step));
            wanted = self.felt_onto(beyond, now, wanted);
        }
        if self.carried.is_some() {
            wanted = self.carried_onto(wanted);
        }
        let wanted = wanted.within(self.limit);
        let force = self.guarded(at.on_steps(self.step), since_change, wanted);
        self.commanded = force;
        self.shown = force;
        force
    }

    /// Adds the further parts of the feel to the walls' force. The function is not part of [`Environment::tick`], so that it does
    /// not slow an environment without such parts.
    #[cold]
    #[inline(never)]
    fn felt_onto(&mut self, beyond: i32, now: Si, wanted: Force<N>) -> Force<N> {
        let moved = self.moved_to(now);
        match &mut self.feel {
            Some(feel) => wanted + feel.tick(beyond, now, moved),
            None => wanted,
        }
    }

    /// The displacement from the last tick's position to this one; 0 at the first tick.
    #[inline(always)]
    fn moved_to(&self, now: Si) -> Position<N> {
        displacement(self.last, now)
    }

    /// Runs the guard on positions of any size, because a knob can turn beyond the largest position of [`Guarded::tick`], 128 rad
    /// with 32 bits. A test checks that both functions give the same energy account, bit for bit.
    #[inline(always)]
    fn guarded(
        &mut self,
        now: Si,
        since_change: Option<Position<N>>,
        wanted: Force<N>,
    ) -> Force<N> {
        let last = self.last.replace(now);
        match &mut self.guard {
            None => wanted,
            Some(guard) => guard.tick_without_end(last, now, since_change, wanted),
        }
    }

    /// Whether a wall was off at the last tick, because the device was deeper inside it than the number format of positions
    /// reaches.
    #[must_use]
    pub const fn is_beyond_reach(&self) -> bool {
        self.beyond_reach
    }

    /// Reports the force that really was commanded, if a later stage changed the last tick's force. Estimators and guard then
    /// calculate with it.
    #[inline]
    pub fn commanded(&mut self, force: Force<N>) {
        self.commanded = force;
        if let Some(guard) = &mut self.guard {
            guard.commanded(force);
        }
    }

    /// Reports that the force is switched off, with or without a tick before: see [`Guard::switched_off`].
    ///
    /// [`Guard::switched_off`]: crate::Guard::switched_off
    pub fn switched_off(&mut self) {
        self.commanded = Force::zero();
        if let Some(guard) = &mut self.guard {
            guard.switched_off();
        }
    }

    /// Whether the guard has switched the force off: for overspeed, or because a force was requested beyond
    /// [`crate::guard::FURTHEST_ANGLE`].
    #[must_use]
    pub fn tripped(&self) -> bool {
        self.guard.as_ref().is_some_and(|guard| guard.tripped)
    }

    /// The internal values of the wall that is touched, or of the first wall if none is; `None` without a wall.
    pub fn view(&self) -> Option<View<N>> {
        let mut views = self.walls.iter().flatten().map(|wall| wall.law.view());
        let first = views.next()?;
        if first.contact != Contact::Free {
            return Some(first);
        }
        let touched = views.find(|view| view.contact != Contact::Free);
        Some(touched.unwrap_or(first))
    }
}

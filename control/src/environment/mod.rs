//! What there is to touch on one axis: several walls, solid above or below their surfaces, detents, and a drawn profile; one guard for
//! all of it.
//!
//! ```text
//! angle -> each wall: penetration -> states -> law \
//!       -> detents ---------------------------------> sum -> saturation -> guard -> force
//!       -> profile --------------------------------->
//! ```
//!
//! **Nothing is switched.** Every wall has a law with a memory of its own and is told where the device is at every tick, so that a law never
//! learns that another wall was touched. Outside its own it gives no force and has no memory. What all of them ask for together is limited as
//! one force, and one guard answers for it, whose account therefore bounds what a hand gets out by going from one wall to the next as well.
//! Estimators are told the force of all, for it is what moves the device.
//!
//! **Signs.** Forces here act against `+x`, as those of a wall that is solid above its surface. A wall that is solid below is the mirror image of
//! one above, and is calculated as that, so that an environment and its mirror image answer mirrored motions with mirrored forces, bit for bit.
//!
//! **No end.** A knob may turn on for 340 million turns: detents and the guard's energy account are the same at every turn, bit for bit. A wall is felt as
//! far as positions reach, 128 rad of 32 bits: further outside nothing is to be felt, and deeper inside it is off, which
//! [`Environment::is_beyond_reach`] says.
//!
//! Objects of three axes are in [`crate::space::environment`]: there a point is inside of one shape, here of any number.

mod changing;
mod detents;
mod face;
pub mod profile;
mod refused;

use changing::Carried;
pub use detents::{DetentSettings, Detents, Spacing};
pub use face::{Counted, Face, Reached, Reading, Side, turn_of};
pub use profile::{Extent, MOST_POINTS, Profile, ProfileSettings, Shape, WHOLE};
pub use refused::Refused;

use crate::controller::Controller;
use crate::guard::quantum;
use crate::law::{Contact, View};
use crate::{
    AnyLaw, Field, Force, Guard, Guarded, Number, Position, Settings, SettingsError, Si, States,
};

/// Walls that an environment has at most: two endstops and four between them.
pub const MOST_WALLS: usize = 6;

/// From such an angle on, to either side, no force is shown: twice the furthest that any guard answers for in a tick (1,000 rad/s, one tick
/// a second), and some counts, before the end of [`Si`], where an angle stands still while the device moves on.
const EDGE: Si = Si::lit("2147481600");

/// A wall: where it is, and the stiffness that it shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WallSettings {
    /// The surface and its solid side.
    pub face: Face,
    /// `k_de`, N·m/rad.
    pub k_desired: Si,
}

/// A wall with its law and the law's memory.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Walled<N: Number> {
    wall: WallSettings,
    reached: Reached,
    states: States<N>,
    law: AnyLaw<N>,
}

impl<N: Number> Walled<N> {
    /// Clears all memory.
    #[cold]
    fn forget(&mut self) {
        self.states.forget();
        self.law.forget();
    }
}

/// Walls and detents behind one guard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Environment<N: Number> {
    walls: [Option<Walled<N>>; MOST_WALLS],
    detents: Option<Detents<N>>,
    profile: Option<Profile<N>>,
    limit: Force<N>,
    /// The energy guard behind the sum of all forces.
    pub guard: Option<Guarded<N>>,
    /// A step of a position, for the guard's energy account.
    step: Si,
    /// The last position, in whole steps.
    last: Option<Si>,
    /// Where positions end, to either side.
    end: Position<N>,
    /// Whether a wall was off at the last tick, since the device is deeper inside than positions reach.
    beyond_reach: bool,
    commanded: Force<N>,
    /// The force of the last tick, before any later stage.
    shown: Force<N>,
    /// The rest of the force before a change, while it fades.
    carried: Option<Carried<N>>,
}

impl<N: Number> Environment<N> {
    /// The environment as at power-up. All walls share the law's settings but for `k_desired`, and the guard's.
    ///
    /// # Errors
    /// The setting that is refused, and the wall that has it.
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
            limit: Force(N::signal(settings.force_limit).ok_or(Refused::Law(
                SettingsError::OutOfFormat {
                    field: Field::ForceLimit,
                    value: settings.force_limit,
                    format: N::NAME,
                },
            ))?),
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
        // A law is long to compute on a board, and walls are often alike.
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
                law,
            });
            *slot = last;
        }
        if let Some(detents) = detents {
            environment.detents = Some(detents.detents(settings.force_limit)?);
        }
        Ok(environment)
    }

    /// This environment with a profile, whose force is added to the others'. `force_limit` is that of the law's settings.
    ///
    /// # Errors
    /// The setting of the profile that is refused.
    #[cold]
    pub fn with_profile(
        mut self,
        profile: &ProfileSettings,
        force_limit: Si,
    ) -> Result<Self, Refused> {
        self.profile = Some(profile.profile(force_limit)?);
        Ok(self)
    }

    /// This environment in the place of one that ran before, for the next arming: all memory is cleared but the
    /// guard's account.
    #[must_use]
    pub fn resumed(self, before: &Self) -> Self {
        let guard = match (self.guard, &before.guard) {
            (Some(guard), Some(before)) => Some(guard.resumed(before)),
            (guard, _) => guard,
        };
        Self { guard, ..self }
    }

    /// Runs one control period: takes where the device is, and how far it has moved since the force changed (where
    /// that is measured), returns the force against `+x`.
    ///
    /// If a later stage changes that force, [`Environment::commanded`] must follow.
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
                wall, states, law, ..
            } = wall;
            let side = wall.face.side;
            states.commanded(side.seen(commanded));
            let force = law.tick(states.sample(e));
            wanted = wanted + side.seen(force);
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

    #[inline(always)]
    fn guarded(
        &mut self,
        now: Si,
        since_change: Option<Position<N>>,
        wanted: Force<N>,
    ) -> Force<N> {
        let Some(guard) = &mut self.guard else {
            return wanted;
        };
        // In whole steps of the format, of which a turn has a whole number. So displacements add up to the way, are the same at every turn
        // and never end. A turn is wrong by a part in 10^8 for that with 32 bits, as a torque is.
        let last = self.last.replace(now).unwrap_or(now);
        let moved = Position(N::saturating_signal(now.saturating_sub(last)));
        let before_change = since_change.map_or(Position::zero(), |since| moved - since);
        guard.tripped |= wanted != Force::zero() && now.saturating_abs() >= EDGE;
        // By the force that acted, so that the mirror image of a motion has the mirror image of its roundings.
        let (force, older) = (guard.state.force, guard.state.older);
        let other_end = force < Force::zero() || (force == Force::zero() && older < Force::zero());
        guard.moved_from(other_end, moved, before_change, wanted)
    }

    /// Whether a wall was off at the last tick: the device was deeper inside than positions reach.
    #[must_use]
    pub const fn is_beyond_reach(&self) -> bool {
        self.beyond_reach
    }

    /// What became of the last tick's force, where a later stage changed it: estimators and guard then count with that.
    #[inline]
    pub fn commanded(&mut self, force: Force<N>) {
        self.commanded = force;
        if let Some(guard) = &mut self.guard {
            guard.commanded(force);
        }
    }

    /// The force is switched off, after the last tick or without one: [`Guard::switched_off`].
    ///
    /// [`Guard::switched_off`]: crate::Guard::switched_off
    pub fn switched_off(&mut self) {
        self.commanded = Force::zero();
        if let Some(guard) = &mut self.guard {
            guard.switched_off();
        }
    }

    /// Whether the guard has switched the force off for overspeed.
    #[must_use]
    pub fn tripped(&self) -> bool {
        self.guard.as_ref().is_some_and(|guard| guard.tripped)
    }

    /// The inside of the wall that is touched, else of the first one; `None` without a wall.
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

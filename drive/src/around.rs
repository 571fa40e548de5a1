//! The environments (several walls and detents) of a board: one that runs, and memory for the next one.
//!
//! ```text
//! armed:      prepare -> next tick:        replaces what runs, without a jump of the force
//! not armed:  prepare -> at once:          runs from the next arming on
//! if other settings wait for a calibration, the prepared environment waits for that calibration as well
//! ```
//!
//! If the user requests only the single wall of the settings, the device's own control law renders it, in the same time as on a
//! board without environments. If the request comes while the device is armed, an environment renders that wall until the next
//! arming.

use crate::change::ChangeConfig;
use crate::cogging::Played;
use crate::hardware::Hardware;
use crate::scenery::{Here, Scenery, law_tick};
use touchstone_control::environment::{Counted, Environment, WallSettings};
use touchstone_control::law::{Contact, View};
use touchstone_control::{Controller, CountScale, Fixed32, Force, Guarded, Position};
use touchstone_protocol::DeviceSettings;
use touchstone_protocol::settings::SettingsError;
use touchstone_protocol::settings::environment::{CountsFrom, Surround};

type Law = Controller<Fixed32>;

/// An environment of walls and detents, with its coefficients computed from the settings.
#[derive(Debug, Clone, Copy)]
pub struct Surrounding {
    environment: Environment<Fixed32>,
    is_more: bool,
    /// The single wall of the device's settings, in whose place the environment (walls and detents) may be rendered.
    first: WallSettings,
    per_tick: Force<Fixed32>,
}

impl Surrounding {
    /// Checks an environment (walls and detents) and computes its coefficients.
    ///
    /// # Errors
    /// A setting is refused; the error names it.
    #[cold]
    #[inline(never)]
    pub fn new(
        settings: &DeviceSettings,
        hardware: &Hardware,
        environment: &Surround,
    ) -> Result<Self, SettingsError> {
        Ok(Self {
            environment: built(settings, hardware, environment)?,
            is_more: environment.is_more_than_the_wall(),
            first: Surround::first(settings),
            per_tick: environment.change_per_tick(settings),
        })
    }
}

/// Computes the coefficients of an environment (walls and detents). If the settings require that the position is measured when
/// the force changes, the energy guard's delay and lag are those that are calculated for the board, not the configured ones.
///
/// # Errors
/// A setting is refused; the error names it.
pub fn built(
    settings: &DeviceSettings,
    hardware: &Hardware,
    environment: &Surround,
) -> Result<Environment<Fixed32>, SettingsError> {
    let mut told = settings.clone();
    if let Some(change) = ChangeConfig::new(settings, hardware)? {
        told.law.guard.delay_s = change.delay_s;
        told.law.guard.lag_s = change.lag_s;
    }
    environment.built(&told)
}

/// The event for which the prepared environment (walls and detents) waits before it is rendered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Waits {
    Nothing,
    ForTheTick,
    ForTheCalibration,
}

/// The environment (walls and detents) that a board renders, and the environment that is prepared to replace it.
#[derive(Debug, Clone)]
pub struct Around {
    places: [Option<Surrounding>; 2],
    use_second: bool,
    waits: Waits,
    /// Whether the environment (walls and detents) is rendered in place of the single wall of the settings.
    runs: bool,
    /// Whether a control period has run since the arming. `count` and `shown` hold the last period's encoder count and force.
    ticked: bool,
    count: i64,
    shown: Force<Fixed32>,
    /// The cogging map in use; `map_waits`: whether it is used only from the next calibration on.
    map: Option<Played>,
    map_waits: bool,
}

impl Around {
    /// Starts without an environment of walls and detents: the board renders the single wall of the settings.
    #[must_use]
    #[allow(clippy::new_without_default, reason = "for a static")]
    pub const fn new() -> Self {
        Self {
            places: [None; 2],
            use_second: false,
            waits: Waits::Nothing,
            runs: false,
            ticked: false,
            count: 0,
            shown: Force(fixed::types::I8F24::ZERO),
            map: None,
            map_waits: false,
        }
    }

    /// Sets the cogging map with which the board compensates cogging. `settings_wait` means that other settings wait for a
    /// calibration; then no map is used until that calibration.
    pub(crate) fn play(&mut self, map: Option<&Played>, settings_wait: bool) {
        self.map = map.cloned();
        self.map_waits = settings_wait;
    }

    /// Prepares an environment (walls and detents) and returns from when on it is rendered. `settings_wait` means that its
    /// coefficients come from settings that wait for a calibration.
    pub(crate) fn prepare(
        &mut self,
        surrounding: &Surrounding,
        law: &mut Law,
        is_armed: bool,
        settings_wait: bool,
    ) -> CountsFrom {
        let [first, second] = &mut self.places;
        *(if self.use_second { first } else { second }) = Some(*surrounding);
        if settings_wait {
            self.waits = Waits::ForTheCalibration;
            CountsFrom::Calibration
        } else if is_armed {
            self.waits = Waits::ForTheTick;
            CountsFrom::NextTick
        } else {
            self.end(law);
            self.turn();
            CountsFrom::Arming
        }
    }

    const fn turn(&mut self) {
        self.use_second ^= true;
        self.waits = Waits::Nothing;
    }

    #[inline(always)]
    const fn now(&mut self) -> Option<&mut Surrounding> {
        let [first, second] = &mut self.places;
        if self.use_second { second } else { first }.as_mut()
    }

    #[inline(always)]
    const fn running(&self) -> Option<&Environment<Fixed32>> {
        let [first, second] = &self.places;
        match if self.use_second { second } else { first } {
            Some(now) if self.runs => Some(&now.environment),
            _ => None,
        }
    }

    /// Ends the rendering of the environment (walls and detents). The energy that its energy guard has left passes to the energy
    /// guard of the settings' wall, because the same hand holds the knob.
    #[cold]
    #[inline(never)]
    fn end(&mut self, law: &mut Law) {
        if let Some(account) = self
            .running()
            .and_then(|environment| environment.guard.as_ref())
            .map(Guarded::account)
            && let Some(guard) = &mut law.guard
        {
            guard.resume(account);
        }
        self.runs = false;
    }

    /// When the device is armed: starts the environment (walls and detents) that was prepared last.
    #[cold]
    #[inline(never)]
    fn begin(&mut self, law: &Law) {
        if self.waits == Waits::ForTheTick {
            self.turn();
        }
        let account = law.guard.as_ref().map(Guarded::account);
        if let Some(now) = self.now().filter(|now| now.is_more) {
            now.environment.begin(account);
            self.runs = true;
        }
    }

    /// Switches to the prepared environment (walls and detents) while the device is armed, without a jump of the force.
    #[cold]
    #[inline(never)]
    fn take_over(&mut self, law: &Law, scale: CountScale) {
        self.turn();
        let [first, second] = &mut self.places;
        let (new, before) = if self.use_second {
            (second, first)
        } else {
            (first, second)
        };
        let Some(new) = new else { return };
        match before {
            Some(before) if self.runs => {
                new.environment.take_over(&before.environment, new.per_tick)
            }
            _ if self.ticked => {
                let at = Counted {
                    scale,
                    count: self.count,
                };
                new.environment
                    .take_over_from(law, &new.first, (&at, self.shown), new.per_tick);
            }
            // The device is armed, but no control period has run since.
            _ => new
                .environment
                .begin(law.guard.as_ref().map(Guarded::account)),
        }
        self.runs = true;
    }
}

impl Scenery for Around {
    // For the single wall the functions below add only two comparisons, because that wall's control law is the longest computation
    // of a control period.
    #[inline(always)]
    fn armed(&mut self, law: &mut Law, fresh: &Law) {
        if self.runs {
            self.end(law);
        }
        law.resume(fresh);
        self.ticked = false;
        let is_more = self.now().is_some_and(|now| now.is_more);
        if is_more || self.waits == Waits::ForTheTick {
            self.begin(law);
        }
    }

    #[cold]
    #[inline(never)]
    fn again(&mut self, law: &mut Law, fresh: &Law) {
        if !self.runs {
            law.resume(fresh);
        } else if let Some(now) = self.now() {
            now.environment.begin(None);
        }
        self.ticked = false;
    }

    #[inline(always)]
    fn tick(&mut self, law: &mut Law, scale: &CountScale, here: &Here) -> Force<Fixed32> {
        if self.waits == Waits::ForTheTick {
            self.take_over(law, *scale);
        }
        let force = match (self.runs, self.now()) {
            (true, Some(now)) => environment_tick(&mut now.environment, scale, here),
            _ => law_tick(law, here.penetration, here.since_change),
        };
        self.ticked = true;
        self.count = here.count;
        self.shown = force;
        force
    }

    #[inline(always)]
    fn commanded(&mut self, law: &mut Law, force: Force<Fixed32>) {
        match (self.runs, self.now()) {
            (true, Some(now)) => now.environment.commanded(force),
            _ => law.commanded(force),
        }
    }

    fn switched_off(&mut self, law: &mut Law) {
        match (self.runs, self.now()) {
            (true, Some(now)) => now.environment.switched_off(),
            _ => law.switched_off(),
        }
    }

    #[inline(always)]
    fn is_tripped(&self, law: &Law) -> bool {
        self.running()
            .map_or_else(|| law.tripped(), Environment::tripped)
    }

    #[inline(always)]
    fn is_beyond_reach(&self, law: &Law, penetration: Position<Fixed32>) -> bool {
        match self.running() {
            None => law.is_beyond_reach(penetration),
            Some(environment) => environment.is_beyond_reach(),
        }
    }

    #[inline(always)]
    fn view(&self, law: &Law) -> View<Fixed32> {
        match self.running() {
            None => law.view(),
            Some(environment) => seen(environment),
        }
    }

    #[inline(always)]
    fn runs(&self) -> bool {
        self.runs
    }

    #[inline(always)]
    fn played(&self) -> Option<&Played> {
        self.map.as_ref().filter(|_| !self.map_waits)
    }

    fn calibrated(&mut self, law: &mut Law) {
        self.map_waits = false;
        if self.waits == Waits::ForTheCalibration {
            self.end(law);
            self.turn();
        }
    }
}

/// Internal values of the wall that the device touches, for telemetry; an environment without walls reports no contact.
#[inline(never)]
fn seen(environment: &Environment<Fixed32>) -> View<Fixed32> {
    environment.view().unwrap_or(View {
        contact: Contact::Free,
        energy: None,
        offset: Position::zero(),
        mass: None,
    })
}

/// Runs one control period of an environment (walls and detents). The function is never inlined, so that its processor cycles can
/// be counted.
#[inline(never)]
fn environment_tick(
    environment: &mut Environment<Fixed32>,
    scale: &CountScale,
    here: &Here,
) -> Force<Fixed32> {
    let at = Counted {
        scale: *scale,
        count: here.count,
    };
    environment.tick(&at, here.since_change)
}

#[cfg(test)]
pub(crate) mod tests;

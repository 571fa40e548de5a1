//! Environments at work on a board: one that runs, and room for the one that takes its place.
//!
//! ```text
//! armed:      prepare -> next tick:        takes over from what runs, no jump
//! not armed:  prepare -> at once:          runs from the next arming on
//! other settings wait for a calibration -> prepare waits for it as well
//! ```
//!
//! The wall alone is the device's own law, as on boards without an environment, and costs what it costs there. Only a change
//! under a hand makes an environment of it, until the next arming.

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

/// What settings and an environment are computed into.
#[derive(Debug, Clone, Copy)]
pub struct Surrounding {
    environment: Environment<Fixed32>,
    is_more: bool,
    /// The wall of the device's settings.
    first: WallSettings,
    per_tick: Force<Fixed32>,
}

impl Surrounding {
    /// Checks and computes.
    ///
    /// # Errors
    /// The setting that is refused.
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

/// An environment. Where the position is measured when the force changes, its guard also gets the board's own delay.
///
/// # Errors
/// The setting that is refused.
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

/// What waits in the place that does not run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Waits {
    Nothing,
    ForTheTick,
    ForTheCalibration,
}

/// The environments of a board.
#[derive(Debug, Clone)]
pub struct Around {
    places: [Option<Surrounding>; 2],
    use_second: bool,
    waits: Waits,
    /// An environment runs, and not the wall alone.
    runs: bool,
    /// Since the arming there was a tick, at this count, with this force.
    ticked: bool,
    count: i64,
    shown: Force<Fixed32>,
    /// The map of the cogging, and whether it waits for a calibration.
    map: Option<Played>,
    map_waits: bool,
}

impl Around {
    /// An environment with one wall and nothing else.
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

    /// Takes the map of the cogging; `settings_wait` as in [`Around::prepare`], and nothing is played until then.
    pub(crate) fn play(&mut self, map: Option<&Played>, settings_wait: bool) {
        self.map = map.cloned();
        self.map_waits = settings_wait;
    }

    /// Takes an environment; from when on it counts. `settings_wait` if settings wait for a calibration, with which it was computed.
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

    /// No environment runs any more. The wall's own guard has the account while nothing runs: it is one hand's, whatever is touched.
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

    /// Starts, after an arming, the environment that was prepared last.
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

    /// Changes over under a hand.
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
            // Armed, and no tick yet.
            _ => new
                .environment
                .begin(law.guard.as_ref().map(Guarded::account)),
        }
        self.runs = true;
    }
}

impl Scenery for Around {
    // The wall alone pays for two questions: what it does itself is the longest thing that a tick does.
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

/// Inner values of the wall that is touched; detents alone have none.
#[inline(never)]
fn seen(environment: &Environment<Fixed32>) -> View<Fixed32> {
    environment.view().unwrap_or(View {
        contact: Contact::Free,
        energy: None,
        offset: Position::zero(),
        mass: None,
    })
}

/// The environment's tick. It is a function of its own in every program, as the law's tick is.
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

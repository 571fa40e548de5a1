//! The thread of a haptic device: opens the device, and renders wall and follower's forces on it through the guard.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, mpsc};
use touchstone_control::{LawKind, Settings, Si, StatesKind};
use touchstone_device::haptic::{
    DataSheet, DeviceTwin, HapticDevice, HapticFault, Rest, SimulatedArm,
};
use touchstone_device::servo::{
    DevicePace, Ending, ForceLaw, Pace, RealTime, ServoLimits, ServoReport, first_of_threads, play,
};
use touchstone_device::{
    Fading, FollowedWall, FollowerForces, Inverse3, Obstacle, Omega3, WallSettings, guard_settings,
};
use touchstone_dhd::LibrarySearch;
use touchstone_lab::thesis::space::tuned_wall::TunedWall;
use touchstone_lab::thesis::space::{self, Object};
use touchstone_world::plant::{FIRM_TRANSLATION, OMEGA3_AXIS};

/// What the caller wants, in the units of the arguments.
pub struct Wanted {
    pub device: String,
    pub object: Option<Object>,
    pub rate_hz: u32,
    pub stiffness_n_per_mm: Option<f64>,
    pub force_limit_n: Option<f64>,
    pub fading: Fading,
    pub late_limit_s: f64,
    pub library: Option<String>,
    pub service: Option<String>,
    pub hand: Option<[f64; 3]>,
    pub priority: bool,
}

/// State after the servo loop's last control period; Python may read it at any time.
#[derive(Clone, Copy, Default)]
pub struct Seen {
    pub position_m: [f64; 3],
    pub force_n: [f64; 3],
    pub account_j: f64,
    pub ticks: u64,
}

#[derive(Default)]
pub struct Shared {
    pub seen: Mutex<Seen>,
    pub stop: AtomicBool,
}

pub fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Properties of the device and its wall, known once the device is open.
pub struct Opened {
    pub name: String,
    pub rate_hz: u32,
    pub force_limit_n: f64,
    pub wall: String,
}

/// Beginning of the message if a device did not confirm its release.
const MAY_BE_ON: &str = "THE MOTORS MAY STILL BE ON";

/// How a servo loop ended: its report, or an error message.
pub type Ended = Result<ServoReport, String>;

/// The wall with the follower's forces. After each control period it writes its state to [`Shared`], where Python reads the
/// state.
struct Watched<'m> {
    law: FollowedWall<'m>,
    shared: Arc<Shared>,
    position_m: [f64; 3],
    ticks: u64,
}

impl ForceLaw for Watched<'_> {
    fn tick(&mut self, position_m: [f64; 3]) -> Result<[f64; 3], HapticFault> {
        self.position_m = position_m;
        self.law.tick(position_m)
    }

    fn commanded(&mut self, force_n: [f64; 3]) {
        self.law.commanded(force_n);
        self.ticks += 1;
        // If Python reads at this moment, this tick is not written, because the loop must not wait.
        if let Ok(mut seen) = self.shared.seen.try_lock() {
            *seen = Seen {
                position_m: self.position_m,
                force_n,
                account_j: self.law.account_j().unwrap_or(0.0),
                ticks: self.ticks,
            };
        }
    }
}

fn told(fault: &HapticFault, place: &str) -> String {
    fault.at(place).to_string()
}

/// Opens the device, with its motors off.
fn opened(wanted: &Wanted) -> Result<Box<dyn HapticDevice>, String> {
    match wanted.device.as_str() {
        "omega3" => {
            let file = wanted.library.as_deref().map(Path::new);
            let library = LibrarySearch::new(file).load().map_err(|missing| {
                format!("Force Dimension's library: {missing}; {}", missing.fix())
            })?;
            let omega = Omega3::open(Arc::new(library)).map_err(|why| told(&why, "omega.3"))?;
            Ok(Box::new(omega))
        }
        "inverse3" => {
            let service = wanted
                .service
                .as_deref()
                .unwrap_or(touchstone_device::SERVICE);
            let inverse = Inverse3::connect(service).map_err(|why| told(&why, "Inverse3"))?;
            Ok(Box::new(inverse))
        }
        _ => {
            let at = wanted.hand.unwrap_or([0.0; 3]);
            let twin = DeviceTwin {
                hand: wanted.hand.map(|_| FIRM_TRANSLATION),
                ..DeviceTwin::default()
            };
            let rest: Rest = Box::new(move |_| at);
            let arm = SimulatedArm::new(twin, wanted.rate_hz, rest);
            Ok(Box::new(arm.map_err(|why| told(&why, "simulated"))?))
        }
    }
}

/// Returns the settings of the wall and their description. They are the tuned ones if some exist for the device at this rate and
/// the caller gives no stiffness, else those of the thesis.
fn chosen(
    wanted: &Wanted,
    sheet: &DataSheet,
    rate_hz: u32,
    force_n: f64,
) -> (WallSettings, String) {
    let tuned = sheet
        .axes
        .and_then(|axes| TunedWall::for_axes(&axes, rate_hz))
        .filter(|_| wanted.stiffness_n_per_mm.is_none());
    let law = match &tuned {
        Some(tuned) => tuned.settings(rate_hz, force_n),
        None => {
            // Same as `touchstone device run`: 1 N/mm if mass and damping of the device are unknown.
            let own = if sheet.axes.is_some() { 5.0 } else { 1.0 };
            let stiffness = wanted.stiffness_n_per_mm.unwrap_or(own);
            Settings {
                rate_hz,
                force_limit: Si::saturating_from_num(force_n),
                ..space::settings(LawKind::EnhancedSfa, stiffness)
            }
        }
    };
    let source = tuned.map_or("the thesis' settings".into(), |it| {
        format!("tuned for {}", it.name)
    });
    let stiffness = law.k_desired.to_num::<f64>() * 1e-3;
    let about = match wanted.object {
        Some(object) => format!("{}, {stiffness} N/mm, {source}", object.name()),
        None => "none".to_owned(),
    };
    let damping = sheet.least_damping_n_s_per_m.unwrap_or(OMEGA3_AXIS.damping);
    let estimator = (law.states == StatesKind::Estimated).then_some([law.estimator; 3]);
    let settings = WallSettings {
        law,
        per_axis: false,
        guard: Some(guard_settings(damping, sheet.delay_s, rate_hz)),
        estimator,
        count_m: sheet.count_m,
    };
    (settings, about)
}

/// The body of the thread: opens the device, reports that the device is open, and renders wall and guard on it until
/// `shared.stop` is set or a fault occurs.
pub fn played(
    wanted: &Wanted,
    forces: FollowerForces,
    shared: &Arc<Shared>,
    ready: &mpsc::Sender<Opened>,
) -> Ended {
    let mut device = opened(wanted)?;
    let sheet = device.sheet().clone();
    let (slowest, fastest) = sheet.rates_hz;
    let rate_hz = if sheet.sets_the_pace {
        fastest
    } else {
        wanted.rate_hz
    };
    if !(slowest..=fastest).contains(&rate_hz) {
        return Err(format!(
            "rate_hz = {rate_hz}: {} does {slowest} to {fastest} Hz; give one of these",
            sheet.name
        ));
    }
    let force_n = wanted
        .force_limit_n
        .unwrap_or(sheet.force_n)
        .min(sheet.force_n);
    let (settings, about) = chosen(wanted, &sheet, rate_hz, force_n);
    let obstacle = wanted.object.map(|object| Obstacle::Shape(object.shape()));
    let law = FollowedWall::new(&settings, obstacle, forces, wanted.fading).map_err(|why| {
        format!("the wall: {why}; change stiffness_n_per_mm, rate_hz or force_limit_n")
    })?;
    let mut law = Watched {
        law,
        shared: Arc::clone(shared),
        position_m: [0.0; 3],
        ticks: 0,
    };
    let limits = ServoLimits {
        force_n,
        late_s: wanted.late_limit_s,
        ..ServoLimits::of(&sheet)
    };
    if wanted.priority {
        // If real-time priority is refused, this is no error, because late periods are counted and bounded.
        let _ = first_of_threads();
    }
    let mut pace: Box<dyn Pace> = match sheet.sets_the_pace {
        true => Box::new(DevicePace::new(rate_hz)),
        false => Box::new(RealTime::new(rate_hz)),
    };
    let mut ready = Some((
        ready,
        Opened {
            name: sheet.name.clone(),
            rate_hz,
            force_limit_n: force_n,
            wall: about,
        },
    ));
    let stop = &shared.stop;
    let more = |_: &_| {
        // Sent after the first period, so that a position is known once the caller gets the device.
        if let Some((ready, opened)) = ready.take() {
            let _ = ready.send(opened);
        }
        !stop.load(Ordering::Relaxed)
    };
    let report = play(&mut device, &mut law, &limits, rate_hz, &mut *pace, more);
    let place = |fault: &HapticFault| told(fault, &sheet.name);
    match (&report.ending, &report.release) {
        (_, Err(fault)) => Err(format!(
            "{MAY_BE_ON}: {}; switch the device's power off",
            place(fault)
        )),
        (Ending::Fault(fault), _) => Err(place(fault)),
        _ => Ok(report),
    }
}

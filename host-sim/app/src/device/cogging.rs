//! `touchstone device cogging`: measures a map of the motor's cogging torque, checks it, stores it on the board or deletes it.

use super::spin;
use super::{calibration_limit, status_of};
use crate::interrupt::{self, INTERRUPTED};
use crate::out::{self, note, say, tell};
use clap::Subcommand;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use touchstone_device::{Client, MAY_BE_ON};
use touchstone_drive::cogging::SHARE;
use touchstone_drive::sweep::{QUARTERS_PER_S, TURNS};
use touchstone_drive::wire::hardware;
use touchstone_lab::identify::cogging::{KnownKnob, MeasuredCogging, NoMap, SweepTick, Swept};
use touchstone_protocol::settings::kept as kept_start;
use touchstone_protocol::{
    CoggingMap, CoggingReport, DeviceCommand, DeviceSettings, MeasuringPart, Phase, Reply, Request,
    Sweep, Telemetry, Unkept,
};
use touchstone_sim::error::{Error, Result};

/// The actions on a cogging map.
#[derive(Debug, Clone, Copy, Subcommand)]
pub enum CoggingAction {
    /// Measures, checks and stores a cogging map: HANDS OFF, THE SHAFT TURNS SLOWLY, both ways and twice, for a minute.
    Measure,
    /// Measures the shaft's ripple without and with the stored cogging map: HANDS OFF, THE SHAFT TURNS SLOWLY.
    Check,
    /// Deletes the cogging map, and saves the settings without it.
    Forget,
}

/// Largest fraction of the shaft's ripple that may remain with a cogging map. If more remains, the map does not belong to this
/// motor. A map that is half a period off doubles the ripple.
const LEFT_MOST: f64 = 0.7;
/// Time that a measurement of cogging takes in addition to its calibration and its turns.
const SWEEP_REST: Duration = Duration::from_secs(10);

/// A cogging map, and the ripple of the shaft with and without it.
#[derive(Debug, Clone)]
pub struct Tried {
    /// The measured cogging map.
    pub found: MeasuredCogging,
    /// Ripple of the shaft in a slow turn, rad: first without the map, then with it.
    pub ripple_rad: [f64; 2],
}

impl Tried {
    /// Fraction of the shaft's ripple that remains with the cogging map.
    pub fn left(&self) -> f64 {
        self.ripple_rad[1] / self.ripple_rad[0]
    }

    /// The cogging map and the ripples as JSON for programs.
    pub fn json(&self) -> serde_json::Value {
        serde_json::json!({
            "rms_n_m": self.found.rms_n_m,
            "peak_n_m": self.found.peak_n_m,
            "unrepeated_share": self.found.unrepeated,
            "ripple_before_rad": self.ripple_rad[0],
            "ripple_after_rad": self.ripple_rad[1],
            "orders": self.found.map.harmonics.iter().map(|it| it.order).collect::<Vec<_>>(),
        })
    }

    /// The cogging map and the ripples as lines of text for people.
    pub fn lines(&self) -> [String; 3] {
        let found = &self.found;
        let orders: Vec<String> = found
            .map
            .harmonics
            .iter()
            .map(|it| it.order.to_string())
            .collect();
        [
            format!(
                "cogging {:.3} mN·m rms, {:.3} at most; {} periods a turn",
                1e3 * found.rms_n_m,
                1e3 * found.peak_n_m,
                orders.join(", ")
            ),
            format!(
                "repeats  within {:.0} % from turn to turn",
                100.0 * found.unrepeated
            ),
            format!(
                "ripple   of a slow turn {:.2e} rad without the map, {:.2e} with it ({:.0} %)",
                self.ripple_rad[0],
                self.ripple_rad[1],
                100.0 * self.left()
            ),
        ]
    }
}

/// Shows, measures, checks or deletes the cogging map of a board.
pub fn main(client: &mut Client, action: Option<CoggingAction>) -> Result<()> {
    let settings = client.settings()?;
    may_keep(client, &settings)?;
    let Some(action) = action else {
        return shown(client, &settings);
    };
    at_rest(client)?;
    if let CoggingAction::Forget = action {
        client.tell(&Request::ForgetCogging)?;
        client.tell(&Request::Save)?;
        return out::result(
            || serde_json::json!({ "kept": false }),
            || {
                tell!("deleted and saved");
                Ok(())
            },
        );
    }
    let stop = interrupt::noted()?;
    tell!("HANDS OFF: THE SHAFT TURNS SLOWLY, both ways and twice, for a minute");
    let tried = match action {
        CoggingAction::Check => check(client, &settings, &stop)?,
        _ => measure(client, &settings, &stop)?,
    };
    out::result(
        || tried.json(),
        || {
            for line in tried.lines() {
                say!("{line}");
            }
            if let CoggingAction::Measure = action {
                tell!("stored and saved; next: touchstone device calibrate");
            }
            Ok(())
        },
    )
}

/// Checks that this board can store a cogging map with these settings. The error gives the reason if not.
pub fn may_keep(client: &Client, settings: &DeviceSettings) -> Result<()> {
    let board = client.identity().board;
    let why = if !board.is_large() && board.has_bus() {
        Some("it has too little flash for it")
    } else if !board.is_large() {
        Some("it has no connector for an absolute encoder")
    } else if hardware(board).gives_voltage() {
        Some("it measures no current")
    } else {
        kept_start::may_keep(settings).err().map(Unkept::words)
    };
    why.map_or(Ok(()), |why| {
        Err(Error::device(
            client.place(),
            format!("this board cannot store a map of the cogging: {why}"),
            "use a magnetic encoder on a NUCLEO-G474RE with a shield that measures currents",
        ))
    })
}

fn report(client: &mut Client) -> Result<CoggingReport> {
    match client.ask(&Request::Cogging)? {
        Reply::Cogging(report) => Ok(report),
        other => Err(client.odd(&other)),
    }
}

fn shown(client: &mut Client, settings: &DeviceSettings) -> Result<()> {
    let board = client.identity().board;
    let kept = report(client)?.kept;
    let usable = kept.as_ref().map(|kept| kept.usable(settings, board));
    let line = match &usable {
        None => "no map is stored; to measure one: touchstone device cogging measure".into(),
        Some(Ok(map)) => format!(
            "a map of {} harmonics is stored and used",
            map.harmonics.len()
        ),
        Some(Err(why)) => format!("a map is stored and NOT USED: {}", why.words()),
    };
    out::result(
        || {
            serde_json::json!({
                "kept": kept.is_some(),
                "played": matches!(usable, Some(Ok(_))),
            })
        },
        || {
            say!("{line}");
            Ok(())
        },
    )
}

/// Stops the device, so that it can save settings. Returns an error if the wall is on.
pub fn at_rest(client: &mut Client) -> Result<()> {
    match status_of(client)?.phase {
        Phase::Armed => Err(Error::device(
            client.place(),
            "the wall is on",
            "let go of the knob, then: touchstone device stop",
        )),
        Phase::Ready | Phase::Calibrating | Phase::Fault => {
            client.tell(&Request::Command(DeviceCommand::Stop))
        }
        Phase::Boot | Phase::Stopped => Ok(()),
    }
}

/// Measures a cogging map, checks it and saves it on the board. A map with which `LEFT_MOST` of the ripple or more remains is not
/// stored. The device is left stopped.
pub fn measure(client: &mut Client, settings: &DeviceSettings, stop: &AtomicBool) -> Result<Tried> {
    guarded(client, settings, |client, asked| {
        let (before, known) = swept(client, asked, stop, Sweep::Bare)?;
        let found = before.map(&known).map_err(|why| no_map(client, &why))?;
        client.tell(&Request::KeepCogging(found.map.clone()))?;
        let after = tried(client, asked, stop, &found.map);
        let ripple_rad = match after {
            Ok(after) => [before.ripple_rad(&found.map), after],
            Err(error) => return forgotten(client, error),
        };
        let tried = Tried { found, ripple_rad };
        match judged(client, &tried) {
            Ok(()) => Ok(tried),
            Err(error) => forgotten(client, error),
        }
    })
    .and_then(|tried| client.tell(&Request::Save).map(|()| tried))
}

/// Checks the stored cogging map: measures the shaft's ripple without and with it.
fn check(client: &mut Client, settings: &DeviceSettings, stop: &AtomicBool) -> Result<Tried> {
    let board = client.identity().board;
    let kept = report(client)?.kept.ok_or(Unkept::None);
    let usable = kept.and_then(|kept| kept.usable(settings, board).cloned());
    let map = usable.map_err(|why| {
        let problem = match why {
            Unkept::None => "no map is stored".into(),
            why => format!("the stored map is not used: {}", why.words()),
        };
        Error::device(client.place(), problem, AGAIN)
    })?;
    guarded(client, settings, |client, asked| {
        let (before, known) = swept(client, asked, stop, Sweep::Bare)?;
        let found = before.map(&known).map_err(|why| no_map(client, &why))?;
        client.tell(&Request::Command(DeviceCommand::Stop))?;
        let after = tried(client, asked, stop, &map)?;
        let ripple_rad = [before.ripple_rad(&map), after];
        let tried = Tried { found, ripple_rad };
        judged(client, &tried).map(|()| tried)
    })
}

const AGAIN: &str = "measure it: touchstone device cogging measure";

/// Measures the shaft's ripple while the stored cogging map is in use, rad.
fn tried(
    client: &mut Client,
    asked: &DeviceSettings,
    stop: &AtomicBool,
    map: &CoggingMap,
) -> Result<f64> {
    client.tell(&Request::Command(DeviceCommand::Stop))?;
    let (after, _) = swept(client, asked, stop, Sweep::Compensated)?;
    Ok(after.ripple_rad(map))
}

fn judged(client: &Client, tried: &Tried) -> Result<()> {
    let left = tried.left();
    // NaN fails this comparison and is refused, too.
    if left < LEFT_MOST {
        return Ok(());
    }
    Err(Error::device(
        client.place(),
        format!(
            "with the map the shaft's ripple is {:.0} % of the ripple without it, so the map does not fit this motor",
            100.0 * left
        ),
        AGAIN,
    ))
}

/// Deletes the cogging map from the board after a failed check, and returns the check's error.
fn forgotten<T>(client: &mut Client, error: Error) -> Result<T> {
    client.tell(&Request::Command(DeviceCommand::Stop))?;
    client.tell(&Request::ForgetCogging)?;
    Err(error)
}

fn no_map(client: &Client, why: &NoMap) -> Error {
    let fix = match why {
        NoMap::Nothing { .. } => {
            "a map is not needed; to measure weaker cogging, reduce the friction or use a finer current sensor"
        }
        NoMap::TooLarge { .. } => "raise motor.current_limit_a, if motor and board allow it",
        NoMap::Incomplete { .. } | NoMap::DoesNotRepeat { .. } => {
            "take your hand off the knob, see that the shaft turns freely and nothing is loose, and run the same command again"
        }
    };
    Error::device(client.place(), why.to_string(), fix)
}

/// Runs an action in which the device switches off at the latest 1 s after the last request from the computer ([`spin::watched`]),
/// for instance after a pulled cable. Afterwards, even after an error, the device is stopped and gets its settings back.
fn guarded<T>(
    client: &mut Client,
    settings: &DeviceSettings,
    work: impl FnOnce(&mut Client, &DeviceSettings) -> Result<T>,
) -> Result<T> {
    let asked = spin::watched(settings);
    client.tell(&Request::SetAll(asked.clone()))?;
    let done = work(client, &asked);
    let decimation = settings.telemetry.decimation;
    let back = client
        .tell(&Request::Command(DeviceCommand::Stop))
        .and_then(|()| client.tell(&Request::SetAll(settings.clone())))
        .and_then(|()| client.tell(&Request::Telemetry { decimation }));
    match (done, back) {
        // That the device may still be on is more urgent than why the work failed.
        (Err(failure), Err(off)) => Err(if off.to_string().contains(MAY_BE_ON) {
            off
        } else {
            failure
        }),
        (done, back) => done.and_then(|done| back.map(|()| done)),
    }
}

/// Runs one calibration with a cogging sweep; takes the device from stopped to ready.
fn swept(
    client: &mut Client,
    settings: &DeviceSettings,
    stop: &AtomicBool,
    sweep: Sweep,
) -> Result<(Swept, KnownKnob)> {
    let rate = settings.timing.rate_hz;
    let decimation = u16::try_from(rate / 1_000).unwrap_or(1).max(1);
    client.tell(&Request::Telemetry { decimation })?;
    client.tell(&Request::Sweep(sweep))?;
    let calibrate = client.tell(&Request::Command(DeviceCommand::Calibrate));
    calibrate.map_err(|refused| spin::fault(client).unwrap_or(refused))?;
    client.forget_telemetry();
    // Time of the turns, s: `TURNS` each way, and a quarter of a turn more each way.
    let quarters = 2 * (4 * TURNS + 1) / QUARTERS_PER_S;
    let turning = Duration::from_secs(quarters.unsigned_abs());
    let limit = calibration_limit(settings) + turning + SWEEP_REST;
    let Some(ticks) = spin::listen(client, limit, stop, told)? else {
        client.tell(&Request::Command(DeviceCommand::Stop))?;
        note!("interrupted: the motor is off, and nothing was saved");
        std::process::exit(INTERRUPTED);
    };
    let against = report(client)?.against.ok_or_else(|| {
        Error::device(
            client.place(),
            "the calibration was lost",
            "the same command again",
        )
    })?;
    let known = KnownKnob {
        rate_hz: rate.into(),
        counts_per_rev: settings.encoder.counts_per_rev.into(),
        torque_constant_n_m_per_a: settings.motor.torque_constant_n_m_per_a.to_num(),
        inertia_kg_m2: settings.law.estimator.inertia_kg_m2.to_num(),
        against,
        most_a: settings.motor.current_limit_a.to_num::<f64>() / f64::from(SHARE),
    };
    let swept = Swept::new(&ticks, &known).map_err(|why| no_map(client, &why))?;
    Ok((swept, known))
}

fn told(record: &Telemetry) -> Option<SweepTick> {
    let part = record.measuring?.part;
    matches!(part, MeasuringPart::Forward | MeasuringPart::Backward).then(|| SweepTick {
        tick: record.tick,
        part,
        count: record.count,
        current_a: 1e-3 * f64::from(record.current_q_ma),
    })
}

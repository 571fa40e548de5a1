//! Start-up and supervision, the same for all boards, once a board's pins are set up.

use core::sync::atomic::Ordering::Relaxed;

use embassy_executor::Spawner;
use embassy_stm32::usart::BufferedUart;
use embassy_time::Ticker;
use static_cell::StaticCell;
use touchstone_drive::{CurrentLoop, Device, ResetReason, wire};
use touchstone_protocol::session::Session;
use touchstone_protocol::settings::DeviceSettings;
use touchstone_protocol::{Context, FaultCode, Phase, State, flash};

use crate::control::{CONTROL, Control, RING};
use crate::exchange::{CONTROL_LIVES, CURRENT_LIVES, LATE_PERIODS};
use crate::requests::Thread;
use crate::serial::{LINK_LIVES, link};
use crate::shared::InThread;
use crate::storage::{self, Storage};
use crate::{board, crash, cycles, interrupts, supply, watchdog};

static SESSION: StaticCell<Session> = StaticCell::new();
static CONTROLLER: StaticCell<Control> = StaticCell::new();
static CURRENT_LOOP: StaticCell<CurrentLoop> = StaticCell::new();

/// Runs the program after the board's set-up, with the serial port to the computer and the flash pages of the settings. It never
/// returns.
pub async fn run(spawner: Spawner, serial: BufferedUart<'static>, storage: Storage) -> ! {
    // SAFETY: this function runs in the executor, which runs in the thread and not in an interrupt.
    let here = unsafe { InThread::new() };
    let current = start(spawner, serial, storage, here);
    // SAFETY: this is called once, after the control tick has received its state. It is called only here, because `start` needs the
    // stack for itself.
    unsafe { interrupts::start(current) };
    supervise(here).await
}

/// Does everything that comes before the first interrupt. This function is not part of the async function [`run`]: a future's
/// variables lie in a static, those of this function on the stack.
#[inline(never)]
fn start(
    spawner: Spawner,
    serial: BufferedUart<'static>,
    mut storage: Storage,
    here: InThread,
) -> &'static mut CurrentLoop {
    watchdog::start();
    supply::start();
    // SAFETY: this is called once, at the start. No other code uses the processor's own peripherals.
    cycles::start(&mut unsafe { cortex_m::Peripherals::steal() });
    let reason = ResetReason::of(&crash::take_reset_flags());
    defmt::info!(
        "touchstone {=str} on {=str}, started after: {=str}",
        env!("CARGO_PKG_VERSION"),
        board::BOARD.name(),
        reason.words()
    );
    let (session, are_refused) = session(&mut storage);
    let current = control(session.settings(), reason, are_refused, here);
    // The computations below take a while, so the watchdog is fed before them.
    #[cfg(feature = "g474re")]
    watchdog::feed();
    #[cfg(feature = "g474re")]
    let _ = crate::surround::give(here, session.settings(), session.environment());
    #[cfg(feature = "g474re")]
    crate::surround::play(here, session.settings(), session.cogging(board::BOARD));
    #[cfg(feature = "g474re")]
    crate::autostart::begin(here, session, reason);
    let device = Thread::new(storage, reason, here);
    match link(serial, session, device) {
        Ok(task) => spawner.spawn(task),
        Err(_) => defmt::panic!("the link's task exists already"),
    }
    current
}

/// Makes the protocol session with the settings in flash, or with the defaults. Also returns whether settings in flash were
/// refused (damaged, of another layout, or not valid).
#[inline(never)]
fn session(kept: &mut Storage) -> (&'static mut Session, bool) {
    let defaults = DeviceSettings::defaults(board::BOARD);
    let start = flash::load(kept, storage::pages(), defaults, &|settings| {
        wire::checked(settings, board::BOARD)
    });
    let are_refused = start.refused.is_some();
    let session = Session::new(start.settings, !are_refused);
    #[cfg(feature = "g474re")]
    let session = session
        .with_environment(start.environment)
        .with_kept(start.kept)
        .with_cogging(start.cogging);
    (SESSION.init(session), are_refused)
}

/// Makes the control interrupt's data and the current loop.
#[inline(never)]
fn control(
    settings: &DeviceSettings,
    reason: ResetReason,
    are_refused: bool,
    here: InThread,
) -> &'static mut CurrentLoop {
    let control = CONTROLLER.init_with(|| match Device::new(settings, &board::HARDWARE) {
        Ok(device) => Control::new(device, settings),
        Err(_) => defmt::panic!("settings that were checked are refused"),
    });
    control.device.started(reason);
    if are_refused {
        control.device.report_fault(FaultCode::SettingsInvalid, 0);
    }
    board::magnetic::prepare(settings.encoder.kind);
    RING.in_thread(here, |ring| ring.restart(settings.timing.rate_hz));
    let current = CURRENT_LOOP.init(CurrentLoop::new(control.device.current_config()));
    CONTROL.in_thread(here, |place| *place = Some(control));
    current
}

/// Writes the device's state to the debug log when it has changed. The control interrupt does not log, because logging takes time.
fn tell_state(here: InThread, told: &mut Option<State>) {
    let state = CONTROL.in_thread(here, |control| {
        control.as_ref().map(|control| control.state)
    });
    if state == *told {
        return;
    }
    *told = state;
    match state {
        Some(State::Fault(Context { code, tick, value })) => defmt::error!(
            "fault {=u8} with {=i32} in tick {=u32}: see docs/faults.md",
            code as u8,
            value,
            tick
        ),
        Some(state) => defmt::info!("{=str}", Phase::from(state).name()),
        None => {}
    }
}

/// Feeds the independent watchdog only when current loop, control interrupt and serial link have all run since the last feeding.
async fn supervise(here: InThread) -> ! {
    let mut ticker = Ticker::every(watchdog::SUPERVISION);
    let stages = [&CURRENT_LIVES, &CONTROL_LIVES, &LINK_LIVES];
    let mut late = 0;
    let mut told = None;
    loop {
        ticker.next().await;
        #[cfg(feature = "g474re")]
        crate::autostart::step(here);
        tell_state(here, &mut told);
        let now_late = LATE_PERIODS.load(Relaxed);
        if now_late != late {
            late = now_late;
            defmt::warn!(
                "{=u32} PWM periods in which the current loop came too late",
                late
            );
        }
        if stages.iter().all(|stage| stage.load(Relaxed)) {
            stages.iter().for_each(|stage| stage.store(false, Relaxed));
            watchdog::feed();
        }
    }
}

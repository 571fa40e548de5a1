//! What both boards do once their pins are set up.

use core::sync::atomic::Ordering::Relaxed;

use embassy_executor::Spawner;
use embassy_stm32::usart::BufferedUart;
use embassy_time::{Duration, Ticker};
use heapless::spsc::Queue;
use static_cell::{ConstStaticCell, StaticCell};
use touchstone_drive::{CurrentConfig, CurrentLoop, Device, ResetReason, Settings, wire};
use touchstone_protocol::session::Session;
use touchstone_protocol::settings::DeviceSettings;
use touchstone_protocol::{FaultCode, Telemetry, flash};

use crate::control::{CONTROL, Control, QUEUED};
use crate::interrupts::{self, CONTROL_LIVES, CURRENT_LIVES, Current};
use crate::requests::Thread;
use crate::serial::{self, LINK_LIVES};
use crate::storage::{PAGES, Storage};
use crate::{board, crash, cycles, supply, watchdog};

/// A board, set up.
pub struct Board {
    /// The link to the desktop.
    pub serial: BufferedUart<'static>,
    /// Where settings are kept.
    pub storage: Storage,
}

static CONFIGS: ConstStaticCell<Queue<CurrentConfig, 2>> = ConstStaticCell::new(Queue::new());
static STATE: StaticCell<Control> = StaticCell::new();
static CURRENT: StaticCell<Current> = StaticCell::new();
static TELEMETRY: ConstStaticCell<Queue<Telemetry, QUEUED>> = ConstStaticCell::new(Queue::new());

/// The supervisor looks this often.
const SUPERVISION: Duration = Duration::from_millis(10);

/// The program after the board's set-up; ends with the next reset.
pub async fn run(spawner: Spawner, board: Board) -> ! {
    start(spawner, board);
    supervise().await
}

/// Not a part of the future above: what it needs once is on the stack, not in a static for ever.
#[inline(never)]
fn start(spawner: Spawner, mut board: Board) {
    watchdog::start();
    supply::start();
    // SAFETY: once, at the start; nobody else uses the processor's own peripherals.
    cycles::start(&mut unsafe { cortex_m::Peripherals::steal() });
    let reason = ResetReason::of(&crash::take_reset_flags());
    let defaults = DeviceSettings::defaults(board::BOARD);
    let start = flash::load(&mut board.storage, PAGES, defaults, &|settings| {
        wire::checked(settings, board::BOARD).map(|_| ())
    });
    let settings = Settings::from(&start.settings);
    let Ok(mut device) = Device::new(&settings, &board::HARDWARE) else {
        defmt::panic!("settings that were checked are refused");
    };
    device.started(reason);
    if start.refused.is_some() {
        device.report_fault(FaultCode::SettingsInvalid, 0);
    }
    let (configs, next_configs) = CONFIGS.take().split();
    let (telemetry, to_send) = TELEMETRY.take().split();
    let current = CURRENT.init(Current {
        current_loop: CurrentLoop::new(device.current_config()),
        configs: next_configs,
    });
    board::prepare_magnetic(settings.encoder.kind);
    let decimation = start.settings.telemetry.decimation;
    let control = STATE.init(Control::new(
        device, &settings, decimation, configs, telemetry,
    ));
    CONTROL.in_thread(|place| *place = Some(control));
    // SAFETY: once, and the control tick has its state.
    unsafe { interrupts::start(current) };
    let session = Session::new(start.settings, start.refused.is_none());
    let device = Thread {
        storage: board.storage,
        reset_reason: reason.into(),
    };
    match serial::link(board.serial, session, device, to_send) {
        Ok(link) => spawner.spawn(link),
        Err(_) => defmt::panic!("the link's task exists already"),
    }
}

/// Feeds the watchdog when every stage has shown a sign of life since the last feeding, and only then.
async fn supervise() -> ! {
    let mut ticker = Ticker::every(SUPERVISION);
    let stages = [&CURRENT_LIVES, &CONTROL_LIVES, &LINK_LIVES];
    loop {
        ticker.next().await;
        if stages.iter().all(|stage| stage.load(Relaxed)) {
            stages.iter().for_each(|stage| stage.store(false, Relaxed));
            watchdog::feed();
        }
    }
}

//! Connects the automatic start, which the main thread runs, with the control interrupt's data. Also hands over the stored encoder
//! alignment. Not compiled for boards with an STM32G431.

use core::sync::atomic::Ordering::Relaxed;

use touchstone_drive::ResetReason;
use touchstone_drive::autostart::{Autostart, AutostartInput, STEP_MS};
use touchstone_protocol::session::Session;
use touchstone_protocol::{Command, SelfStart, State};

use crate::board;
use crate::control::{Control, control};
use crate::exchange::{HEARD, SPOKEN};
use crate::shared::InThread;

const _: () = assert!(STEP_MS as u64 == crate::watchdog::SUPERVISION.as_millis());

/// Hands the stored encoder alignment to the control interrupt, if it fits the settings in use.
pub fn give(control: &mut Control, session: &Session) {
    let kept = session.kept().usable(session.settings(), board::BOARD);
    control.device.keep(kept.ok().map(Into::into));
}

/// Prepares the automatic start before the first control period, and hands over the stored encoder alignment.
pub fn begin(here: InThread, session: &Session, reason: ResetReason) {
    let settings = session.settings();
    let usable = session.kept().usable(settings, board::BOARD);
    let has_alignment = usable.is_ok() && !settings.calibration.measures;
    control(here, |control| {
        give(control, session);
        control.autostart = Autostart::new(session.kept().autostart, reason, has_alignment);
    });
}

/// Runs one step of the automatic start. The supervision task calls it at each of its checks, every 10 ms.
pub fn step(here: InThread) {
    let desktop_spoke = SPOKEN.load(Relaxed);
    let is_stop_pressed = board::is_stop_pressed();
    let steps = control(here, |control| {
        let before = control.autostart.told();
        let now = AutostartInput {
            state: control.state,
            is_supplied: control.device.is_supplied(),
            count: control.device.record().count,
            is_stop_pressed,
            desktop_spoke,
        };
        if let Some(command) = control.autostart.step(&now) {
            // A gate driver reports an error while it has no supply, and nobody is there to give `stop` after that.
            if command == Command::Calibrate && control.state == State::Boot {
                control.clear_latches();
            }
            control.command = Some(command);
        }
        let told = control.autostart.told();
        (control.autostart.stands_in(desktop_spoke), before, told)
    });
    let Some((stands_in, before, told)) = steps else {
        return;
    };
    if stands_in {
        HEARD.store(true, Relaxed);
    }
    if before != told {
        tell(told);
    }
}

fn tell(told: SelfStart) {
    defmt::info!("start by itself: {=str}", told.words());
}

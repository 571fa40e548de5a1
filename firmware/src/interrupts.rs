//! The interrupts of current loop, timer break, supply and control period. Their code has no unbounded wait and no panic.
//!
//! ```text
//! TIM1 -> ADC1, ADC2 -> ADC1_2 (priority 0): the current loop -> every N-th time LPTIM1 (priority 2): the control interrupt
//! ```

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

use cortex_m::peripheral::NVIC;
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use touchstone_drive::{BridgeCommand, CurrentLoop, CurrentSample};

use crate::control::{CONTROL, Readings};
use crate::exchange::{
    BREAK, BROWN_OUT, COMMAND, CONFIG, CONTROL_LIVES, CURRENT_CYCLES_MAX, CURRENT_LIVES,
    LATE_PERIODS, REPORT,
};
use crate::shared::{Owned, raise};
use crate::{analogue, board, cycles, pwm, supply, window};

/// Whether the current loop has switched the outputs on and not off since. Other code that switches the outputs off also makes the
/// current loop switch them off, in the same or the next PWM period.
static SWITCHED_ON: AtomicBool = AtomicBool::new(false);
/// The cycle counter's value at which the control interrupt became due.
static DUE: AtomicU32 = AtomicU32::new(0);
/// Whether a control period is due and has not begun. If false, the control interrupt only reads the encoder. That reading comes
/// when the new force begins to act, because the energy guard needs the position at that time.
static TICK_DUE: AtomicBool = AtomicBool::new(false);
/// Largest allowed lateness of the second encoder reading of a control period, in processor cycles. The reading must be made when
/// the force changes; one that would come later is left out.
const CHANGE_LATE: u32 = pwm::HALF_PERIOD / 2;
/// Whether the last PWM period's new compare values were written too late, after the counter had turned at the bottom. They then
/// take effect a period later.
static LATE: AtomicBool = AtomicBool::new(false);
static CURRENT: Owned<&'static mut CurrentLoop> = Owned::empty();

/// Gives the current loop to its interrupt, sets the interrupts' priorities and enables the interrupts.
///
/// # Safety
/// Call it once, after [`CONTROL`] was filled.
pub unsafe fn start(current: &'static mut CurrentLoop) {
    // SAFETY: the interrupt is enabled below, and this runs once.
    unsafe { CURRENT.give(current) };
    interrupt::ADC1_2.set_priority(Priority::P0);
    interrupt::TIM1_BRK_TIM15.set_priority(Priority::P1);
    interrupt::LPTIM1.set_priority(Priority::P2);
    // Clears an earlier break, which the set-up of the comparators or a memory error during the start (`crash`) may have caused. A
    // break whose cause is still active returns at once.
    pwm::clear_break();
    NVIC::unpend(interrupt::TIM1_BRK_TIM15);
    // SAFETY: their handlers share with other code only what `shared` describes.
    unsafe {
        interrupt::TIM1_BRK_TIM15.enable();
        interrupt::LPTIM1.enable();
        interrupt::ADC1_2.enable();
    }
    window::start();
}

/// Priority 0, once a PWM period, when the conversions of the currents have finished: runs the current loop.
#[interrupt]
fn ADC1_2() {
    let begun = cycles::now();
    let readings = board::readings();
    // SAFETY: only this handler uses the value, and it calls `mine` once per run.
    let Some(current) = (unsafe { CURRENT.mine() }) else {
        return;
    };
    // SAFETY: only code of this interrupt priority calls `take`.
    if let Some(config) = unsafe { CONFIG.take() } {
        current.reconfigure(config);
    }
    let is_broken = board::driver_complains()
        || pwm::is_broken()
        || BREAK.load(Relaxed)
        || BROWN_OUT.load(Relaxed);
    let output = current.tick(&CurrentSample {
        phase_a: readings.phase_a,
        phase_b: readings.phase_b,
        bus: readings.bus,
        temperature: readings.temperature,
        hardware_break: is_broken,
        late: LATE.load(Relaxed),
        command: COMMAND.get(),
    });
    match output.bridge {
        BridgeCommand::Off => {
            pwm::outputs_off();
            SWITCHED_ON.store(false, Relaxed);
        }
        BridgeCommand::On(duty) => {
            pwm::set_duty(duty);
            // Switches on once, not in every period. Otherwise this line would undo a break that begins and ends after its check
            // above (the emulator found this with a break of 2 us). After switching on, the break is checked once more.
            if !SWITCHED_ON.load(Relaxed) {
                SWITCHED_ON.store(true, Relaxed);
                pwm::outputs_on();
                if pwm::is_broken() {
                    pwm::outputs_off();
                }
            }
        }
    }
    if output.is_stale {
        analogue::off();
    }
    REPORT.put(current.report());
    // If a control tick becomes due, it replaces a pending second encoder reading. While a tick is still due, no reading is
    // requested.
    if output.pend_control || output.reads_change && !TICK_DUE.load(Relaxed) {
        TICK_DUE.store(output.pend_control, Relaxed);
        DUE.store(begun, Relaxed);
        NVIC::pend(interrupt::LPTIM1);
    }
    CURRENT_LIVES.store(true, Relaxed);
    let took = cycles::now().wrapping_sub(begun);
    raise(&CURRENT_CYCLES_MAX, took);
    // The counter's direction alone is not enough: a whole period later the counter counts down again.
    let is_late = took > pwm::HALF_PERIOD || !pwm::is_before_bottom();
    LATE.store(is_late, Relaxed);
    if is_late {
        LATE_PERIODS.store(LATE_PERIODS.load(Relaxed).saturating_add(1), Relaxed);
    }
    window::refresh();
}

/// Priority 1, after the hardware break has switched the outputs off. While the break input stays active, this interrupt would
/// occur again and again. So the handler disables it until the control interrupt clears the break.
#[interrupt]
fn TIM1_BRK_TIM15() {
    pwm::silence_break();
    BREAK.store(true, Relaxed);
}

/// Priority 1, when the processor's supply has fallen below 2.9 V.
#[interrupt]
fn PVD_PVM() {
    BROWN_OUT.store(true, Relaxed);
    pwm::outputs_off();
    analogue::off();
    supply::take();
}

/// Priority 2: runs one control period, or the second encoder reading within a control period. The current loop sets this interrupt
/// pending; no timer does.
#[interrupt]
fn LPTIM1() {
    // Read first: a tick that becomes due after this line belongs to the next run of the interrupt.
    let is_tick = TICK_DUE.load(Relaxed);
    let begun = cycles::now();
    // SAFETY: only this handler uses the value, and it calls `mine` once per run.
    let Some(control) = (unsafe { CONTROL.mine() }) else {
        return;
    };
    let lateness = begun.wrapping_sub(DUE.load(Relaxed));
    if !is_tick {
        if lateness < CHANGE_LATE {
            control.read_change();
        }
        return;
    }
    TICK_DUE.store(false, Relaxed);
    control.tick(&Readings {
        hardware_break: BREAK.load(Relaxed),
        brown_out: BROWN_OUT.load(Relaxed),
        lateness,
    });
    CONTROL_LIVES.store(true, Relaxed);
    control.ended(cycles::now().wrapping_sub(begun));
}

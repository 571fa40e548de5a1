//! Exception entry and return (ARMv7-M reference manual, B1.5.6 and B1.5.8). All frames are on the main stack, because the firmware
//! uses no other stack.

use unicorn_engine::RegisterARM;

use super::state::{Halt, Machine};
use crate::cpu::decode::{EXCEPTION, TAIL_CHAIN};
use crate::cpu::nvic::{HARD_FAULT, Masks};

/// Registers of the exception frame, in the order of their addresses.
const FRAME: [RegisterARM; 8] = [
    RegisterARM::R0,
    RegisterARM::R1,
    RegisterARM::R2,
    RegisterARM::R3,
    RegisterARM::R12,
    RegisterARM::LR,
    RegisterARM::PC,
    RegisterARM::XPSR,
];

/// Number of single-precision registers that an exception frame holds when the floating-point unit was used.
const FLOATS: i32 = 16;
const FRAME_BYTES: u32 = 0x20;
const EXTENDED_BYTES: u32 = 0x68;
/// Bit 9 of the stacked xPSR: the stack pointer was moved by four bytes to align the frame to eight.
const ALIGNED: u32 = 1 << 9;

impl Machine {
    fn masks(&self) -> Masks {
        Masks {
            primask: self.register(RegisterARM::PRIMASK) & 1 != 0,
            basepri: self.register(RegisterARM::BASEPRI) as u8,
            faultmask: self.register(RegisterARM::FAULTMASK) & 1 != 0,
        }
    }

    /// Enters the pending exception of highest priority, unless the interrupt masks block it.
    pub(super) fn deliver(&mut self) {
        if !self.chip().nvic.any_pending() {
            return;
        }
        let masks = self.masks();
        if let Some(exception) = self.chip().nvic.next(masks) {
            self.asleep = None;
            self.enter(exception);
        }
    }

    fn enter(&mut self, exception: usize) {
        let stack = self.register(RegisterARM::SP);
        if self
            .memory(stack.wrapping_sub(EXTENDED_BYTES + 4), 4)
            .is_empty()
        {
            // Neither this frame nor that of the resulting fault can be stacked.
            self.lock_up(format!(
                "exception {exception} with the stack at 0x{stack:08x}"
            ));
            return;
        }
        let value = self.push_frame();
        self.chip_mut().core.spend_cycles(EXCEPTION);
        self.start_handler(exception, value);
    }

    /// Pushes the exception frame onto the stack. Returns the EXC_RETURN value with which a return removes the frame.
    fn push_frame(&mut self) -> u32 {
        let float = self.chip().core.float_used;
        let stack = self.register(RegisterARM::SP);
        let bytes = if float { EXTENDED_BYTES } else { FRAME_BYTES };
        let frame = (stack - bytes) & !7;
        let mut content = Vec::with_capacity(bytes as usize);
        for register in FRAME {
            let mut value = self.register(register);
            if register as i32 == RegisterARM::XPSR as i32 {
                value = (value & !0x3ff) | self.running_number() as u32 | 1 << 24;
                if stack & 4 != 0 {
                    value |= ALIGNED;
                }
            }
            if register as i32 == RegisterARM::PC as i32 {
                value &= !1;
            }
            content.extend(value.to_le_bytes());
        }
        if float {
            for index in 0..FLOATS {
                let single = self
                    .unicorn
                    .reg_read(RegisterARM::S0 as i32 + index)
                    .unwrap_or(0) as u32;
                content.extend(single.to_le_bytes());
            }
            content.extend(self.register(RegisterARM::FPSCR).to_le_bytes());
            content.extend([0; 4]);
        }
        self.set_memory(frame, &content);
        self.set_register(RegisterARM::SP, frame);
        self.chip_mut().core.float_used = false;
        // Return to a handler or to the thread, with the basic or the extended frame.
        let to = if self.chip().running.is_empty() {
            0xffff_fff9
        } else {
            0xffff_fff1
        };
        if float { to & !0x10 } else { to }
    }

    fn running_number(&self) -> usize {
        self.chip()
            .running
            .last()
            .map_or(0, |running| running.exception)
    }

    fn start_handler(&mut self, exception: usize, return_value: u32) {
        let vectors = self.chip().vectors();
        let handler = self.word(vectors + 4 * exception as u32);
        self.set_register(RegisterARM::LR, return_value);
        // Thumb mode, no IT block and no flags, as after a reset.
        self.set_register(RegisterARM::XPSR, 1 << 24);
        self.set_register(RegisterARM::PC, handler | 1);
        self.chip_mut().begin_handler(exception);
    }

    /// Returns from an exception: carries out the program's jump to the EXC_RETURN value `value`.
    ///
    /// Errors: no exception is running, or the value is not a valid EXC_RETURN for the main stack.
    pub(super) fn leave(&mut self, value: u32) -> Result<(), Halt> {
        if self.chip_mut().end_handler().is_none()
            || value & 0xffff_ff00 != 0xffff_ff00
            || value & 0xf == 0xd
        {
            return Err(Halt::BadReturn(format!("a return to 0x{value:08x}")));
        }
        self.set_register(RegisterARM::FAULTMASK, 0);
        // Tail-chaining: the next handler is entered without changing the stacked frame.
        let masks = self.masks();
        if let Some(exception) = self.chip().nvic.next(masks) {
            self.chip_mut().core.spend_cycles(TAIL_CHAIN);
            self.chip_mut().core.float_used = false;
            self.start_handler(exception, value);
            return Ok(());
        }
        self.pop_frame(value & 0x10 == 0);
        self.chip_mut().core.spend_cycles(EXCEPTION);
        Ok(())
    }

    fn pop_frame(&mut self, float: bool) {
        let frame = self.register(RegisterARM::SP);
        let bytes = if float { EXTENDED_BYTES } else { FRAME_BYTES };
        let mut status = 0;
        for (index, register) in FRAME.into_iter().enumerate() {
            let mut value = self.word(frame + 4 * index as u32);
            if register as i32 == RegisterARM::XPSR as i32 {
                status = value;
                value = (value & !(0x1ff | ALIGNED)) | 1 << 24;
            }
            if register as i32 == RegisterARM::PC as i32 {
                value |= 1;
            }
            self.set_register(register, value);
        }
        if float {
            for index in 0..FLOATS {
                let single = self.word(frame + FRAME_BYTES + 4 * index as u32);
                let _ = self
                    .unicorn
                    .reg_write(RegisterARM::S0 as i32 + index, u64::from(single));
            }
            let flags = self.word(frame + FRAME_BYTES + 4 * FLOATS as u32);
            self.set_register(RegisterARM::FPSCR, flags);
        }
        self.chip_mut().core.float_used = float;
        let moved = if status & ALIGNED != 0 { 4 } else { 0 };
        self.set_register(RegisterARM::SP, frame + bytes + moved);
    }

    /// Handles an invalid access or instruction: enters HardFault, or locks the processor up if HardFault is already running.
    /// `what` describes the access for the report.
    pub(super) fn fault(&mut self, pc: u32, what: &str) -> Result<(), Halt> {
        let name = format!("{what} at 0x{pc:08x}");
        if self.chip().nvic.is_active(HARD_FAULT) {
            self.lock_up(name);
            return Ok(());
        }
        self.chip_mut().faults.push(name);
        self.enter(HARD_FAULT);
        Ok(())
    }
}

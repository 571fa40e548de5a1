//! The run loop: it executes a slice of instructions, then the events that have become due, then the next slice.

use unicorn_engine::RegisterARM;

use super::state::{Halt, Machine};
use crate::cpu::core::Stop;
use crate::peripheral::NEVER;
use crate::peripheral::flash::{self, Change};

impl Machine {
    /// Runs until the time `until`, in processor cycles.
    ///
    /// # Errors
    /// The reason why the run ended before that time.
    pub fn run_until(&mut self, until: u64) -> Result<(), Halt> {
        while self.chip().core.now < until {
            self.slice(until)?;
        }
        Ok(())
    }

    fn slice(&mut self, until: u64) -> Result<(), Halt> {
        self.apply_flash_changes()?;
        self.chip_mut().advance();
        if let Some(cause) = self.chip_mut().reset_request.take() {
            self.reset(cause);
            return Ok(());
        }
        let chip = self.chip_mut();
        let next = chip.next_event().min(until);
        if chip.flash.busy_until() > chip.core.now {
            // The processor stands still while flash is written, because it fetches from the same flash bank.
            chip.core.now = next.min(chip.flash.busy_until());
            return Ok(());
        }
        if self.locked {
            let chip = self.chip_mut();
            let next = chip.next_event().min(until);
            chip.core.now = next.max(chip.core.now + 1);
            return Ok(());
        }
        self.deliver();
        if let Some(sleep) = self.asleep {
            let chip = self.chip_mut();
            let wakes = match sleep {
                Stop::WaitEvent => std::mem::take(&mut chip.core.event),
                _ => chip.nvic.any_pending(),
            };
            if !wakes {
                let next = chip.next_event().min(until);
                chip.core.now = next.max(chip.core.now + 1);
                return Ok(());
            }
            self.asleep = None;
        }
        self.execute(until)
    }

    fn execute(&mut self, until: u64) -> Result<(), Halt> {
        let chip = self.chip_mut();
        chip.core.interrupted = false;
        chip.core.limit = chip.next_event().min(until);
        chip.core.stop = Stop::Slice;
        let start = u64::from(self.register(RegisterARM::PC) | 1);
        let ended = self.unicorn.emu_start(start, NEVER >> 1, 0, 0);
        let pc = self.register(RegisterARM::PC);
        // Unicorn does not fetch from this address, but raises an exception of its own.
        if pc & 0xffff_ff80 == 0xffff_ff80 {
            return self.leave(pc | 1);
        }
        if let Err(error) = ended {
            return self.fault(pc, &format!("{error:?}"));
        }
        match self.chip().core.stop {
            Stop::Slice => Ok(()),
            stop @ (Stop::WaitEvent | Stop::WaitInterrupt) => {
                self.set_register(RegisterARM::PC, (pc + 2) | 1);
                self.asleep = Some(stop);
                Ok(())
            }
            Stop::Unsupported => Err(Halt::Unsupported(format!("the instruction at 0x{pc:08x}"))),
        }
    }

    /// Applies the program's flash writes and erasures to the emulated memory.
    fn apply_flash_changes(&mut self) -> Result<(), Halt> {
        for (address, before) in std::mem::take(&mut self.chip_mut().flash.stores) {
            self.set_memory(address, &before.to_le_bytes());
        }
        if self.chip().flash.changes.is_empty() {
            return Ok(());
        }
        let flash = &mut self.chip_mut().flash;
        let changes = std::mem::take(&mut flash.changes);
        let cut = flash.cut_at.is_some_and(|at| flash.count > at);
        for change in changes {
            match change {
                Change::Program(address, bytes) => {
                    let before = self.memory(address, 8);
                    // A double word that is not erased can only be programmed to zeros, because of its error-correction bits.
                    if before.iter().any(|byte| *byte != 0xff) && bytes != [0; 8] {
                        self.chip_mut().flash.refuse();
                    } else if cut {
                        // The power was cut while this doubleword was programmed. Some of its bits keep their old value, different
                        // ones at each cut. Its check bits are wrong.
                        let not_yet = self.chip().flash.not_yet();
                        let torn = bytes.iter().zip(not_yet.to_le_bytes());
                        let torn: Vec<u8> = torn.map(|(byte, not_yet)| byte | not_yet).collect();
                        self.set_memory(address, &torn);
                        self.chip_mut().flash.torn.insert(address);
                    } else {
                        self.set_memory(address, &bytes);
                    }
                }
                Change::Erase(address) => {
                    let length = if cut { flash::PAGE / 2 } else { flash::PAGE };
                    self.set_memory(address, &vec![0xff; length as usize]);
                    let erased = address..address + length;
                    let torn = &mut self.chip_mut().flash.torn;
                    torn.retain(|place| !erased.contains(place));
                }
            }
        }
        if cut { Err(Halt::PowerCut) } else { Ok(()) }
    }
}

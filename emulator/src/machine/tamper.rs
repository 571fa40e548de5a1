//! Faults inside the processor: an exhausted stack, a program counter that jumps, a stuck interrupt mask.

use unicorn_engine::RegisterARM;

use super::state::Machine;
use crate::cpu::RAM;

impl Machine {
    /// Moves the thread's stack pointer to its end, so that the next use overflows it. Only while the thread runs or
    /// sleeps: a handler with a moved stack would return to a random address, which no overflow does.
    ///
    /// # Errors
    /// The thread does not run within 50 ms.
    pub fn exhaust_stack(&mut self) -> Result<(), String> {
        self.run_to(None)?;
        self.set_register(RegisterARM::SP, RAM + 8);
        Ok(())
    }

    /// Runs until the handler of an exception runs (the thread for `None`), and lets it go on at another address.
    ///
    /// # Errors
    /// The program does not run within 50 ms.
    pub fn divert(&mut self, exception: Option<usize>, address: u32) -> Result<(), String> {
        self.run_to(exception)?;
        self.asleep = None;
        self.set_register(RegisterARM::PC, address | 1);
        Ok(())
    }

    /// Masks a priority and all below it, as a thread does that shares their state, and forgets to end it.
    ///
    /// # Errors
    /// The thread does not run within 50 ms.
    pub fn mask(&mut self, priority: u32) -> Result<(), String> {
        self.run_to(None)?;
        self.set_register(RegisterARM::BASEPRI, priority);
        Ok(())
    }

    /// Ends the masking of interrupts.
    pub fn unmask(&mut self) {
        self.set_register(RegisterARM::BASEPRI, 0);
    }

    /// Runs until the handler of an exception runs, or the thread.
    ///
    /// # Errors
    /// The program does not run within 50 ms.
    pub fn run_to(&mut self, exception: Option<usize>) -> Result<(), String> {
        let end = self.chip().core.now + 50_000 * 170;
        while self.chip().core.now < end {
            let here = self.chip().running.last().map(|running| running.exception);
            if here == exception {
                return Ok(());
            }
            // In steps that are shorter than any handler.
            let next = self.chip().core.now + 20;
            self.run_until(next).map_err(|halt| format!("{halt:?}"))?;
        }
        Err(format!("exception {exception:?} did not run"))
    }
}

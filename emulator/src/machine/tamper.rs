//! Injects faults inside the processor: an exhausted stack, a jump of the program counter, interrupts that stay masked.

use unicorn_engine::RegisterARM;

use super::state::Machine;
use crate::cpu::RAM;

impl Machine {
    /// Moves the stack pointer of the main program to the end of the stack, so that the next push overflows it. The fault is
    /// injected only while no exception handler runs: a handler would return to a random address, which a real overflow does not
    /// cause.
    ///
    /// # Errors
    /// The main program does not run within 50 ms.
    pub fn exhaust_stack(&mut self) -> Result<(), String> {
        self.run_to(None)?;
        self.set_register(RegisterARM::SP, RAM + 8);
        Ok(())
    }

    /// Runs until the handler of `exception` runs (the main program for `None`), then continues execution at `address`.
    ///
    /// # Errors
    /// The handler or the main program does not run within 50 ms.
    pub fn divert(&mut self, exception: Option<usize>, address: u32) -> Result<(), String> {
        self.run_to(exception)?;
        self.asleep = None;
        self.set_register(RegisterARM::PC, address | 1);
        Ok(())
    }

    /// Masks the interrupts of `priority` and of all lower priorities through BASEPRI, like a critical section of the main program
    /// that never ends.
    ///
    /// # Errors
    /// The main program does not run within 50 ms.
    pub fn mask(&mut self, priority: u32) -> Result<(), String> {
        self.run_to(None)?;
        self.set_register(RegisterARM::BASEPRI, priority);
        Ok(())
    }

    /// Ends the masking of interrupts that [`Machine::mask`] began.
    pub fn unmask(&mut self) {
        self.set_register(RegisterARM::BASEPRI, 0);
    }

    /// Runs until the handler of `exception` runs; for `None`, until the main program runs.
    ///
    /// # Errors
    /// The handler or the main program does not run within 50 ms.
    pub fn run_to(&mut self, exception: Option<usize>) -> Result<(), String> {
        let end = self.chip().core.now + 50_000 * 170;
        while self.chip().core.now < end {
            let here = self.chip().running.last().map(|running| running.exception);
            if here == exception {
                return Ok(());
            }
            // Each step is shorter than any handler, so no handler begins and ends within one step.
            let next = self.chip().core.now + 20;
            self.run_until(next).map_err(|halt| format!("{halt:?}"))?;
        }
        Err(format!("exception {exception:?} did not run"))
    }
}

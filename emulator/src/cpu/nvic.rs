//! The interrupt controller: decides which exception runs next, from pending, enabled and active exceptions, priorities and masks.
//!
//! Numbers are those of exceptions: 3 HardFault, 14 PendSV, 15 SysTick, 16 + n interrupt n. All bits of a priority decide about
//! preemption (the reset value of `PRIGROUP`; the firmware does not change it).

/// Exception number of interrupt 0; interrupt n has 16 + n.
pub const FIRST: usize = 16;
/// Number of modelled exceptions: 16 of the system and 112 interrupts.
const COUNT: usize = 128;
/// Exception number of HardFault.
pub const HARD_FAULT: usize = 3;

/// The processor's registers that mask exceptions.
#[derive(Debug, Clone, Copy, Default)]
pub struct Masks {
    /// Register PRIMASK: while true, all exceptions of configurable priority are masked.
    pub primask: bool,
    /// Register BASEPRI: exceptions of this priority and below are masked; 0 masks none.
    pub basepri: u8,
    /// Register FAULTMASK: while true, all exceptions except NMI are masked.
    pub faultmask: bool,
}

/// The lowest priority, at which the main program runs.
const THREAD: i16 = 256;

/// The interrupt controller (NVIC).
#[derive(Debug, Clone)]
pub struct Nvic {
    enabled: u128,
    pending: u128,
    active: u128,
    lines: u128,
    priority: [u8; COUNT],
}

impl Default for Nvic {
    fn default() -> Self {
        Self {
            // The system exceptions are always enabled.
            enabled: 0xffff,
            pending: 0,
            active: 0,
            lines: 0,
            priority: [0; COUNT],
        }
    }
}

impl Nvic {
    /// Takes the levels of all interrupt lines; a rising line makes its interrupt pending.
    pub fn set_lines(&mut self, interrupts: u128) {
        let lines = interrupts << FIRST;
        self.pending |= lines & !self.lines;
        self.lines = lines;
    }

    /// Makes an exception pending by software.
    pub fn pend(&mut self, exception: usize) {
        self.pending |= 1 << exception;
    }

    /// Clears a pending exception.
    pub fn unpend(&mut self, exception: usize) {
        self.pending &= !(1 << exception);
    }

    /// Whether any exception is pending.
    #[must_use]
    pub const fn any_pending(&self) -> bool {
        self.pending & self.enabled != 0
    }

    fn priority_of(&self, exception: usize) -> i16 {
        match exception {
            1 => -3,
            2 => -2,
            HARD_FAULT => -1,
            other => i16::from(self.priority[other] & 0xf0),
        }
    }

    /// Priority at which the processor runs now, with the mask registers taken into account.
    fn current(&self, masks: Masks) -> i16 {
        let running = bits(self.active)
            .map(|exception| self.priority_of(exception))
            .min();
        let mut priority = running.unwrap_or(THREAD);
        if masks.basepri & 0xf0 != 0 {
            priority = priority.min(i16::from(masks.basepri & 0xf0));
        }
        if masks.primask {
            priority = priority.min(0);
        }
        if masks.faultmask {
            priority = priority.min(-1);
        }
        priority
    }

    /// The exception to be entered now, if any; among equal priorities the one with the lowest number.
    #[must_use]
    pub fn next(&self, masks: Masks) -> Option<usize> {
        let waiting = self.pending & self.enabled;
        if waiting == 0 {
            return None;
        }
        let best =
            bits(waiting).min_by_key(|exception| (self.priority_of(*exception), *exception))?;
        (self.priority_of(best) < self.current(masks)).then_some(best)
    }

    /// Marks an exception as running.
    pub fn enter(&mut self, exception: usize) {
        self.pending &= !(1 << exception);
        self.active |= 1 << exception;
    }

    /// Marks an exception as finished; it becomes pending again if its interrupt line is still high.
    pub fn leave(&mut self, exception: usize) {
        self.active &= !(1 << exception);
        self.pending |= self.lines & 1 << exception;
    }

    /// Whether an exception's handler runs, or was preempted while it ran.
    #[must_use]
    pub const fn is_active(&self, exception: usize) -> bool {
        self.active >> exception & 1 != 0
    }

    /// Reads a register of the NVIC, `offset` from 0xE000E100.
    #[must_use]
    pub fn read(&self, offset: u32) -> u32 {
        let word = |set: u128, at: u32| (set >> FIRST >> (32 * (at / 4))) as u32;
        match offset {
            0x000..0x010 => word(self.enabled, offset),
            0x080..0x090 => word(self.enabled, offset - 0x80),
            0x100..0x110 => word(self.pending, offset - 0x100),
            0x180..0x190 => word(self.pending, offset - 0x180),
            0x200..0x210 => word(self.active, offset - 0x200),
            0x300..0x370 => {
                let at = FIRST + ((offset as usize - 0x300) & !3);
                u32::from_le_bytes([0, 1, 2, 3].map(|byte| self.priority[at + byte]))
            }
            _ => 0,
        }
    }

    /// Writes a register of the NVIC, `size` bytes at `offset` from 0xE000E100.
    pub fn write(&mut self, offset: u32, value: u32, size: usize) {
        let mask = |at: u32| u128::from(value) << FIRST << (32 * (at / 4));
        match offset {
            0x000..0x010 => self.enabled |= mask(offset),
            0x080..0x090 => self.enabled &= !mask(offset - 0x80),
            0x100..0x110 => self.pending |= mask(offset - 0x100),
            // An interrupt whose line is still active stays pending (DUI0553, "Hardware and software control of interrupts"; from
            // memory).
            0x180..0x190 => self.pending &= !mask(offset - 0x180) | self.lines,
            0x300..0x370 => {
                let at = FIRST + offset as usize - 0x300;
                for (byte, value) in value.to_le_bytes().into_iter().take(size).enumerate() {
                    // Four bits are implemented.
                    self.priority[at + byte] = value & 0xf0;
                }
            }
            _ => {}
        }
    }

    /// Sets the priority of a system exception (number 4 to 15).
    pub fn set_system_priority(&mut self, exception: usize, priority: u8) {
        self.priority[exception] = priority & 0xf0;
    }

    /// Reads a system exception's priority.
    #[must_use]
    pub fn system_priority(&self, exception: usize) -> u8 {
        self.priority[exception]
    }
}

fn bits(mut set: u128) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let at = set.trailing_zeros();
        set &= set.wrapping_sub(1);
        (at < 128).then_some(at as usize)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(priorities: &[(usize, u8)]) -> Nvic {
        let mut nvic = Nvic::default();
        for (interrupt, priority) in priorities {
            nvic.write(0x300 + *interrupt as u32, u32::from(*priority), 1);
            nvic.write(4 * (*interrupt as u32 / 32), 1 << (interrupt % 32), 4);
        }
        nvic
    }

    #[test]
    fn the_more_urgent_first_and_only_the_more_urgent_interrupts() {
        let mut nvic = with(&[(18, 0x00), (49, 0x20), (91, 0x60)]);
        nvic.pend(FIRST + 49);
        nvic.pend(FIRST + 91);
        assert_eq!(nvic.next(Masks::default()), Some(FIRST + 49));
        nvic.enter(FIRST + 49);
        assert_eq!(nvic.next(Masks::default()), None, "91 waits for 49");
        nvic.pend(FIRST + 18);
        assert_eq!(nvic.next(Masks::default()), Some(FIRST + 18));
        nvic.enter(FIRST + 18);
        nvic.leave(FIRST + 18);
        nvic.leave(FIRST + 49);
        assert_eq!(nvic.next(Masks::default()), Some(FIRST + 91));
    }

    #[test]
    fn masks_hold_back() {
        let mut nvic = with(&[(18, 0x00), (49, 0x20), (91, 0x60)]);
        let basepri = Masks {
            basepri: 0x30,
            ..Masks::default()
        };
        nvic.pend(FIRST + 91);
        assert_eq!(nvic.next(basepri), None);
        nvic.pend(FIRST + 49);
        assert_eq!(nvic.next(basepri), Some(FIRST + 49));
        let primask = Masks {
            primask: true,
            ..Masks::default()
        };
        assert_eq!(nvic.next(primask), None);
        nvic.pend(HARD_FAULT);
        assert_eq!(nvic.next(primask), Some(HARD_FAULT));
    }

    #[test]
    fn a_line_that_is_up_is_not_taken_back() {
        let mut nvic = with(&[(18, 0)]);
        nvic.set_lines(1 << 18);
        nvic.write(0x180, 1 << 18, 4);
        assert_eq!(nvic.next(Masks::default()), Some(FIRST + 18));
        nvic.set_lines(0);
        nvic.write(0x180, 1 << 18, 4);
        assert_eq!(nvic.next(Masks::default()), None);
    }

    #[test]
    fn a_line_that_stays_up_comes_again() {
        let mut nvic = with(&[(18, 0)]);
        nvic.set_lines(1 << 18);
        nvic.enter(FIRST + 18);
        nvic.set_lines(1 << 18);
        assert_eq!(nvic.next(Masks::default()), None);
        nvic.leave(FIRST + 18);
        assert_eq!(nvic.next(Masks::default()), Some(FIRST + 18));
        nvic.enter(FIRST + 18);
        nvic.set_lines(0);
        nvic.leave(FIRST + 18);
        assert_eq!(nvic.next(Masks::default()), None);
    }
}

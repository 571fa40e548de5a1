//! A serial port with its FIFOs. A byte takes the time that follows from the configured baud rate.

use std::collections::VecDeque;

use super::plain::Plain;
use super::{NEVER, Peripheral};

const CR1: u32 = 0x00;
const CR3: u32 = 0x08;
const BRR: u32 = 0x0c;
const RQR: u32 = 0x18;
const ISR: u32 = 0x1c;
const ICR: u32 = 0x20;
const RDR: u32 = 0x24;
const TDR: u32 = 0x28;
const PRESC: u32 = 0x2c;

const FE: u32 = 1 << 1;
const ORE: u32 = 1 << 3;
const IDLE: u32 = 1 << 4;
const RXNE: u32 = 1 << 5;
const TC: u32 = 1 << 6;
const TXE: u32 = 1 << 7;
const FIFO_ENABLED: u32 = 1 << 29;

const DEPTH: usize = 8;

/// A serial port of the chip: USART or LPUART.
#[derive(Debug, Clone)]
pub struct Uart {
    interrupt: u32,
    low_power: bool,
    registers: Plain,
    status: u32,
    sending: Option<(u64, u8)>,
    send: VecDeque<u8>,
    receive: VecDeque<u8>,
    /// Bytes that the other side of the line has still to send, each with a flag for a framing error.
    line: VecDeque<(u8, bool)>,
    arrives: u64,
    idle_at: u64,
    /// All bytes that the program has sent, in order.
    pub sent: Vec<u8>,
    /// Number of received bytes that were lost because the program did not read them in time.
    pub overruns: u64,
}

impl Uart {
    /// A serial port with this interrupt number. `low_power` selects an LPUART, whose baud-rate register counts in 256ths of a
    /// clock cycle.
    #[must_use]
    pub fn new(interrupt: u32, low_power: bool) -> Self {
        Self {
            interrupt,
            low_power,
            registers: Plain::default(),
            status: TC,
            sending: None,
            send: VecDeque::new(),
            receive: VecDeque::new(),
            line: VecDeque::new(),
            arrives: NEVER,
            idle_at: NEVER,
            sent: Vec::new(),
            overruns: 0,
        }
    }

    /// Processor cycles per byte on the line: start bit, eight data bits and stop bit.
    #[must_use]
    pub fn byte_time(&self) -> u64 {
        const DIVIDERS: [u64; 12] = [1, 2, 4, 6, 8, 10, 12, 16, 32, 64, 128, 256];
        let divider = DIVIDERS[(self.registers.get(PRESC) & 15).min(11) as usize];
        let rate = u64::from(self.registers.get(BRR)).max(1) * divider;
        if self.low_power {
            10 * rate / 256
        } else {
            10 * rate
        }
    }

    fn is_on(&self, bit: u32) -> bool {
        self.registers.get(CR1) & (1 | bit) == 1 | bit
    }

    fn depth(&self) -> usize {
        if self.registers.get(CR1) & FIFO_ENABLED != 0 {
            DEPTH
        } else {
            1
        }
    }

    /// Lets the other side of the line send bytes, after those that it is already sending.
    pub fn put(&mut self, bytes: &[u8], now: u64) {
        self.put_with_errors(bytes, false, now);
    }

    /// Same as `put`, with a framing error in each byte if `framing_error` is set, as with a wrong baud rate or a disturbed line.
    pub fn put_with_errors(&mut self, bytes: &[u8], framing_error: bool, now: u64) {
        self.line
            .extend(bytes.iter().map(|byte| (*byte, framing_error)));
        if self.arrives == NEVER && !self.line.is_empty() {
            self.arrives = now + self.byte_time();
            self.idle_at = NEVER;
        }
    }

    /// Number of bytes that the other side of the line has still to send.
    #[must_use]
    pub fn on_the_line(&self) -> usize {
        self.line.len()
    }

    fn receive(&mut self, now: u64) {
        let Some((byte, framing_error)) = self.line.pop_front() else {
            return;
        };
        // RE.
        if self.is_on(4) {
            if self.receive.len() < self.depth() {
                self.receive.push_back(byte);
                self.status |= if framing_error { FE } else { 0 };
            } else {
                self.status |= ORE;
                self.overruns += 1;
            }
        }
        (self.arrives, self.idle_at) = match self.line.is_empty() {
            true => (NEVER, now + self.byte_time()),
            false => (now + self.byte_time(), NEVER),
        };
    }

    fn flags(&self) -> u32 {
        let mut flags = self.status;
        if !self.receive.is_empty() {
            flags |= RXNE;
        }
        if self.send.len() < self.depth() {
            flags |= TXE;
        }
        // TEACK and REACK follow their bits.
        flags | u32::from(self.is_on(8)) << 21 | u32::from(self.is_on(4)) << 22
    }
}

impl Peripheral for Uart {
    fn read(&mut self, offset: u32, now: u64) -> u32 {
        match offset {
            ISR => self.flags(),
            RDR => u32::from(self.receive.pop_front().unwrap_or(0)),
            _ => self.registers.read(offset, now),
        }
    }

    fn write(&mut self, offset: u32, value: u32, now: u64) {
        match offset {
            ICR => self.status &= !(value & (0xf | IDLE | TC)),
            RQR if value & 8 != 0 => self.receive.clear(),
            TDR => {
                // TE.
                if !self.is_on(8) {
                    return;
                }
                self.status &= !TC;
                if self.sending.is_none() {
                    self.sending = Some((now + self.byte_time(), value as u8));
                } else if self.send.len() < self.depth() {
                    self.send.push_back(value as u8);
                }
            }
            _ => self.registers.write(offset, value, now),
        }
    }

    fn next_event(&self) -> u64 {
        let sent = self.sending.map_or(NEVER, |(time, _)| time);
        sent.min(self.arrives).min(self.idle_at)
    }

    fn advance(&mut self, now: u64) {
        while let Some((time, byte)) = self.sending.filter(|(time, _)| *time <= now) {
            self.sent.push(byte);
            self.sending = self
                .send
                .pop_front()
                .map(|next| (time + self.byte_time(), next));
            if self.sending.is_none() {
                self.status |= TC;
            }
        }
        while self.arrives <= now {
            self.receive(self.arrives);
        }
        if self.idle_at <= now {
            self.idle_at = NEVER;
            if self.is_on(4) {
                self.status |= IDLE;
            }
        }
    }

    fn lines(&self) -> u128 {
        let (cr1, flags) = (self.registers.get(CR1), self.flags());
        // IDLEIE, RXNEIE, TCIE and TXEIE are at the bit positions of their flags. An overrun raises the receive interrupt.
        let mut up = flags & cr1 & (IDLE | RXNE | TC | TXE) != 0;
        up |= cr1 & RXNE != 0 && flags & ORE != 0;
        // EIE.
        up |= self.registers.get(CR3) & 1 != 0 && flags & (FE | ORE | 4) != 0;
        u128::from(up && cr1 & 1 != 0) << self.interrupt
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn port() -> Uart {
        let mut port = Uart::new(91, true);
        // 921,600 baud from 170 MHz.
        port.write(BRR, 47_222, 0);
        port.write(CR1, 1 | 4 | 8 | RXNE | IDLE | FIFO_ENABLED, 0);
        port
    }

    #[test]
    fn bytes_take_their_time() {
        let mut port = port();
        assert_eq!(port.byte_time(), 1_844);
        port.write(TDR, 0x55, 0);
        port.write(TDR, 0xaa, 10);
        port.advance(1_843);
        assert!(port.sent.is_empty());
        port.advance(1_844);
        assert_eq!(port.sent, [0x55]);
        assert_eq!(port.flags() & TC, 0);
        port.advance(2 * 1_844);
        assert_eq!(port.sent, [0x55, 0xaa]);
        assert_ne!(port.flags() & TC, 0);
    }

    #[test]
    fn received_bytes_interrupt_then_idle_then_overrun() {
        let mut port = port();
        port.put(&[1, 2], 0);
        port.advance(1_844);
        assert_eq!(port.lines(), 1 << 91);
        assert_eq!(port.read(RDR, 0), 1);
        assert_eq!(port.lines(), 0);
        port.advance(2 * 1_844);
        assert_eq!(port.read(RDR, 0), 2);
        port.advance(3 * 1_844);
        assert_eq!(port.flags() & IDLE, IDLE);
        port.write(ICR, IDLE, 0);
        port.put(&[0; 9], 10_000);
        port.advance(100_000);
        assert_eq!((port.overruns, port.flags() & ORE), (1, ORE));
    }
}

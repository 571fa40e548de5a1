//! Ring buffer with at least the last second before a fault: 1,000 records of 12 bytes, frozen when a fault is latched.

use crate::record::Record;
use touchstone_protocol::{Limits, State};

/// Number of records that the ring buffer holds.
pub const RECORDS: usize = 1_000;
/// Size of a record in the ring buffer, bytes.
pub const BYTES: usize = 12;

/// The values of one control period that the ring buffer keeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CompactRecord {
    /// Low 16 bits of the control period's number.
    pub tick: u16,
    /// Low 24 bits of the encoder count, sign-extended.
    pub count: i32,
    /// Force in 1/4,096 N·m, saturating at ±8 N·m.
    pub force: i16,
    /// Measured current `i_q` in 1/1,024 A, saturating at ±32 A.
    pub current: i16,
    /// Lateness of the control period in units of 64 processor cycles, saturating.
    pub lateness: u8,
    /// The limits that act in this period.
    pub limits: Limits,
    /// State of the device: 0 boot, 1 calibrating, 2 ready, 3 armed, 4 fault, 5 stopped.
    pub state: u8,
}

/// The number of a state in records and on the wire, 0 to 5.
#[must_use]
pub const fn state_number(state: State) -> u8 {
    match state {
        State::Boot => 0,
        State::Calibrating => 1,
        State::Ready => 2,
        State::Armed => 3,
        State::Fault(_) => 4,
        State::Stopped => 5,
    }
}

/// Shifts a value right by `shift` bits and limits it to 16 bits.
fn short(bits: i32, shift: u32) -> i16 {
    let shifted = bits >> shift;
    i16::try_from(shifted).unwrap_or(if shifted < 0 { i16::MIN } else { i16::MAX })
}

impl CompactRecord {
    /// Makes a compact record from the telemetry record of a control period.
    #[must_use]
    pub fn of(record: &Record) -> Self {
        Self {
            tick: record.tick as u16,
            count: (record.count as i32) << 8 >> 8,
            force: short(record.force.0.to_bits(), 24 - 12),
            current: short(record.current.q.to_bits(), 16 - 10),
            lateness: u8::try_from(record.timing.lateness >> 6).unwrap_or(u8::MAX),
            limits: record.limits,
            state: state_number(record.state),
        }
    }

    /// The record as little-endian bytes. Sizes: tick 2, count 3, force 2, current 2, lateness 1, limits 1, state 1.
    #[must_use]
    pub const fn to_bytes(&self) -> [u8; BYTES] {
        let [t0, t1] = self.tick.to_le_bytes();
        let [c0, c1, c2, _] = self.count.to_le_bytes();
        let [f0, f1] = self.force.to_le_bytes();
        let [i0, i1] = self.current.to_le_bytes();
        [
            t0,
            t1,
            c0,
            c1,
            c2,
            f0,
            f1,
            i0,
            i1,
            self.lateness,
            self.limits.to_wire(),
            self.state,
        ]
    }

    /// The record that these bytes hold.
    #[must_use]
    pub const fn from_bytes(bytes: &[u8; BYTES]) -> Self {
        let [t0, t1, c0, c1, c2, f0, f1, i0, i1, lateness, limits, state] = *bytes;
        Self {
            tick: u16::from_le_bytes([t0, t1]),
            // The three bytes go into the upper bytes and are shifted down, which extends the sign.
            count: i32::from_le_bytes([0, c0, c1, c2]) >> 8,
            force: i16::from_le_bytes([f0, f1]),
            current: i16::from_le_bytes([i0, i1]),
            lateness,
            limits: Limits::from_wire(limits),
            state,
        }
    }
}

/// A ring buffer of the last records; reading begins with the oldest.
#[derive(Debug, Clone)]
pub struct Ring {
    records: [[u8; BYTES]; RECORDS],
    /// Index at which the next record is stored.
    next: usize,
    length: usize,
    /// Number of control periods that are left out between two stored records; `since`: control periods since the last stored
    /// record.
    skipped: u16,
    since: u16,
    frozen: bool,
}

impl Ring {
    /// An empty ring for this control rate. Above 1 kHz only every n-th control period is stored, so that the ring holds at least a
    /// second. At 1 kHz and below, the ring is all zeros, so that it needs no flash as a static variable.
    #[must_use]
    pub const fn new(rate_hz: u32) -> Self {
        Self {
            records: [[0; BYTES]; RECORDS],
            next: 0,
            length: 0,
            skipped: Self::skipped_at(rate_hz),
            since: 0,
            frozen: false,
        }
    }

    const fn skipped_at(rate_hz: u32) -> u16 {
        (rate_hz.saturating_sub(1) / RECORDS as u32) as u16
    }

    /// Empties the ring for another control rate.
    pub fn restart(&mut self, rate_hz: u32) {
        self.skipped = Self::skipped_at(rate_hz);
        self.thaw();
    }

    /// Stores a control period's record if its turn has come (see [`Ring::every`]). The period of a fault is always stored and is
    /// the last one.
    pub fn push(&mut self, record: &Record) {
        if self.frozen {
            return;
        }
        self.since = self.since.saturating_add(1);
        let fault = matches!(record.state, State::Fault(_));
        if self.since > self.skipped || fault {
            self.since = 0;
            self.append(CompactRecord::of(record).to_bytes());
        }
        self.frozen = fault;
    }

    fn append(&mut self, bytes: [u8; BYTES]) {
        if let Some(place) = self.records.get_mut(self.next) {
            *place = bytes;
        }
        self.next += 1;
        if self.next >= RECORDS {
            self.next = 0;
        }
        self.length = (self.length + 1).min(RECORDS);
    }

    /// Empties the ring and lets it record again after a fault.
    pub fn thaw(&mut self) {
        self.frozen = false;
        self.length = 0;
        self.next = 0;
        self.since = 0;
    }

    /// Whether a fault has stopped the ring.
    #[must_use]
    pub const fn is_frozen(&self) -> bool {
        self.frozen
    }

    /// The number n if every n-th control period is stored.
    #[must_use]
    pub const fn every(&self) -> u16 {
        self.skipped.saturating_add(1)
    }

    /// Number of stored records.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.length
    }

    /// Whether the ring has no records.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.length == 0
    }

    /// The bytes of the record with this index; 0 is the oldest. `None` if there is no such record.
    #[must_use]
    pub fn get(&self, index: usize) -> Option<&[u8; BYTES]> {
        if index >= self.length {
            return None;
        }
        let first = if self.length < RECORDS { 0 } else { self.next };
        let place = first + index;
        self.records.get(if place >= RECORDS {
            place - RECORDS
        } else {
            place
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_control::Force;
    use touchstone_protocol::{Context, FaultCode, Limit};

    fn record(tick: u32) -> Record {
        Record {
            tick,
            state: State::Armed,
            count: -5 - i64::from(tick),
            ..Record::empty()
        }
    }

    fn ticks(ring: &Ring) -> Vec<u16> {
        (0..ring.len())
            .map(|i| CompactRecord::from_bytes(ring.get(i).unwrap()).tick)
            .collect()
    }

    #[test]
    fn bytes_come_back() {
        for count in [0, 1, -1, 0x7F_FFFF, -0x80_0000] {
            let kept = CompactRecord {
                tick: 0xABCD,
                count,
                force: -2,
                current: i16::MIN,
                lateness: 9,
                limits: Limits::NONE.with(Limit::Voltage, true),
                state: 3,
            };
            assert_eq!(CompactRecord::from_bytes(&kept.to_bytes()), kept);
        }
        let far = Record {
            count: -3,
            force: Force(fixed::types::I8F24::lit("-0.5")),
            ..record(1)
        };
        assert_eq!(CompactRecord::of(&far).count, -3);
        assert_eq!(CompactRecord::of(&far).force, -2_048);
        let beyond = Record {
            force: Force(fixed::types::I8F24::MAX),
            ..record(1)
        };
        assert_eq!(CompactRecord::of(&beyond).force, i16::MAX);
    }

    #[test]
    fn the_last_second_in_order() {
        let mut ring = Ring::new(1_000);
        assert!(ring.is_empty() && ring.get(0).is_none());
        for tick in 1..=2_345 {
            ring.push(&record(tick));
        }
        assert_eq!(ring.len(), RECORDS);
        assert_eq!(ticks(&ring), (1_346..=2_345).collect::<Vec<u16>>());
        assert!(ring.get(RECORDS).is_none());
    }

    #[test]
    fn a_fault_is_the_last_record_until_thawed() {
        let mut ring = Ring::new(10_000);
        assert_eq!(ring.every(), 10);
        let fault = State::Fault(Context {
            code: FaultCode::OverCurrent,
            tick: 25,
            value: 1,
        });
        for tick in 1..=40 {
            ring.push(&Record {
                state: if tick >= 25 { fault } else { State::Armed },
                ..record(tick)
            });
        }
        assert_eq!(ticks(&ring), [10, 20, 25]);
        assert!(ring.is_frozen());
        ring.thaw();
        assert!(ring.is_empty() && !ring.is_frozen());
        for tick in 41..=50 {
            ring.push(&record(tick));
        }
        assert_eq!(ticks(&ring), [50]);
    }

    #[test]
    fn it_takes_twelve_kilobytes() {
        assert!(size_of::<Ring>() <= 12_040);
    }
}

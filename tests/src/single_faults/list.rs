//! The list of all single faults, with their names.

use super::broken::{Host, Memory, Motor};
use super::encoder::Encoder as E;
use super::tamper::{Breaks, Bridge, Sensor, Supply, Timing};
use touchstone_drive::{EncoderKind, ResetReason};
use touchstone_protocol::{Board, DeviceSettings};

/// A single fault.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fault {
    /// Its name in tables.
    pub name: &'static str,
    /// The part to which it belongs.
    pub group: Group,
    /// What breaks.
    pub breaks: Breaks,
    /// Whether runs with this fault may equal that of a healthy board.
    pub same: Same,
}

/// Whether, and why, runs with a fault may equal that of a healthy board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Same {
    /// None may: every run must differ.
    Nowhere,
    /// Some may, for this reason. At least one run must differ.
    Somewhere(&'static str),
    /// All runs must be equal, for this reason.
    Everywhere(&'static str),
}

/// The parts that break.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Group {
    Control,
    Encoder,
    Magnet,
    Sensors,
    Phases,
    Mechanics,
    Driver,
    Supply,
    Host,
    Memory,
    Timing,
}

const fn fault(group: Group, name: &'static str, breaks: Breaks) -> Fault {
    Fault {
        name,
        group,
        breaks,
        same: Same::Nowhere,
    }
}

const fn encoder(name: &'static str, encoder: E) -> Fault {
    fault(Group::Encoder, name, Breaks::Encoder(encoder))
}

const fn magnet(name: &'static str, degrees: f64, ticks: u32) -> Fault {
    let slip = E::Slip(degrees, ticks);
    fault(Group::Magnet, name, Breaks::Encoder(slip))
}

const fn sensor(name: &'static str, phase: usize, sensor: Sensor) -> Fault {
    fault(Group::Sensors, name, Breaks::Sensor(phase, sensor))
}

const fn phases(name: &'static str, motor: Motor) -> Fault {
    fault(Group::Phases, name, Breaks::Motor(motor))
}

const fn mechanics(name: &'static str, motor: Motor) -> Fault {
    fault(Group::Mechanics, name, Breaks::Motor(motor))
}

const fn driver(name: &'static str, bridge: Bridge) -> Fault {
    fault(Group::Driver, name, Breaks::Bridge(bridge))
}

const fn supply(name: &'static str, supply: Supply) -> Fault {
    fault(Group::Supply, name, Breaks::Supply(supply))
}

const fn host(name: &'static str, host: Host) -> Fault {
    fault(Group::Host, name, Breaks::Host(host))
}

const fn memory(name: &'static str, memory: Memory) -> Fault {
    fault(Group::Memory, name, Breaks::Memory(memory))
}

const fn timing(name: &'static str, timing: Timing) -> Fault {
    fault(Group::Timing, name, Breaks::Timing(timing))
}

impl Fault {
    const fn same(self, same: Same) -> Self {
        Self { same, ..self }
    }

    /// Why this fault cannot occur on a board; `None` if it can.
    #[must_use]
    pub fn not_on(&self, board: Board) -> Option<&'static str> {
        let kind = DeviceSettings::defaults(board).encoder.kind;
        let counts_edges = kind == EncoderKind::Incremental;
        match self.breaks {
            Breaks::Sensor(..) if !board.senses_current() => Some("it has no current sensors"),
            Breaks::Supply(Supply::Thermistor(_)) if !board.senses_current() => {
                Some("it has no thermistor")
            }
            Breaks::Encoder(E::Damaged | E::Bit(..)) if counts_edges => {
                Some("its encoder gives edges and no words")
            }
            Breaks::Memory(Memory::Alignment(_)) if counts_edges || !board.is_large() => {
                Some("it keeps no alignment")
            }
            Breaks::Host(Host::Environment) if !super::broken::has_environment(board) => {
                Some("it has one wall only")
            }
            _ => None,
        }
    }
}

const REFUSED: Same = Same::Everywhere(
    "an armed board refuses it, and a ready one uses it only after its next calibration",
);
const ARMED: Same = Same::Somewhere("an armed board refuses it");
const NO_CURRENT: Same = Same::Somewhere("the phase carries no current there");
const NO_COUNT: Same = Same::Somewhere("it is less than a count there, or the bit is so anyway");

/// All faults. The first entry is a board without a fault.
pub const FAULTS: &[Fault] = &[
    fault(Group::Control, "none", Breaks::Nothing)
        .same(Same::Everywhere("it is the healthy board")),
    memory("none, after a restart", Memory::Right)
        .same(Same::Everywhere("it is the healthy board")),
    encoder("encoder silent", E::Silent),
    encoder("encoder silent in every 2nd tick", E::SilentEvery(2)),
    encoder("encoder silent in every 10th tick", E::SilentEvery(10)),
    encoder("encoder silent in every 40th tick", E::SilentEvery(40)),
    encoder("encoder's words damaged", E::Damaged),
    encoder("encoder frozen", E::Frozen),
    encoder("encoder jumps by 20 counts", E::Jump(20)),
    encoder("encoder jumps by 500 counts", E::Jump(500)),
    encoder("encoder jumps back by 500 counts", E::Jump(-500)),
    encoder("encoder jumps by 4,000 counts", E::Jump(4_000)),
    encoder("encoder's bit 0 stays 1", E::Bit(0, true)).same(NO_COUNT),
    encoder("encoder's bit 4 stays 1", E::Bit(4, true)).same(NO_COUNT),
    encoder("encoder's bit 8 stays 1", E::Bit(8, true)).same(NO_COUNT),
    encoder("encoder's bit 8 stays 0", E::Bit(8, false)).same(NO_COUNT),
    encoder("encoder's bit 11 stays 1", E::Bit(11, true)).same(NO_COUNT),
    encoder("encoder's bit 13 stays 1", E::Bit(13, true)).same(NO_COUNT),
    encoder("encoder counts backwards", E::Mirrored),
    encoder("encoder counts half", E::Half),
    encoder("encoder's noise 3 counts rms", E::Noise(3.0)),
    encoder("encoder's noise 14 counts rms", E::Noise(14.0)),
    encoder("encoder 1 tick late", E::Old(1)),
    encoder("encoder 3 ticks late", E::Old(3)),
    encoder("encoder 10 ticks late", E::Old(10)),
    encoder("second reading missing", E::SecondMissing),
    encoder(
        "second reading missing in every 2nd tick",
        E::SecondEvery(2),
    ),
    encoder(
        "second reading missing in every 10th tick",
        E::SecondEvery(10),
    ),
    encoder("second reading frozen", E::SecondFrozen).same(NO_COUNT),
    encoder("second reading a tick late", E::SecondOld),
    encoder("second reading the first again", E::SecondSame),
    magnet("magnet slips by 30 degrees at once", 30.0, 1),
    magnet("magnet slips by 60 degrees at once", 60.0, 1),
    magnet("magnet slips by 90 degrees at once", 90.0, 1),
    magnet("magnet slips by -90 degrees at once", -90.0, 1),
    magnet("magnet slips by 120 degrees at once", 120.0, 1),
    magnet("magnet slips by -120 degrees at once", -120.0, 1),
    magnet("magnet slips by 180 degrees at once", 180.0, 1),
    magnet("magnet slips by 60 degrees in 0.2 s", 60.0, 200),
    magnet("magnet slips by 90 degrees in 0.2 s", 90.0, 200),
    magnet("magnet slips by 120 degrees in 0.2 s", 120.0, 200),
    magnet("magnet slips by -120 degrees in 0.2 s", -120.0, 200),
    magnet("magnet slips by 180 degrees in 0.2 s", 180.0, 200),
    magnet("magnet slips by 360 degrees in 1 s", 360.0, 1_000),
    fault(
        Group::Magnet,
        "magnet creeps, a count in 4 ms",
        Breaks::Encoder(E::Creep(4)),
    ),
    fault(
        Group::Magnet,
        "magnet loose by 1 degree",
        Breaks::Encoder(E::Loose(45)),
    ),
    fault(
        Group::Magnet,
        "magnet loose by 10 degrees",
        Breaks::Encoder(E::Loose(455)),
    ),
    fault(
        Group::Magnet,
        "magnet off its centre, 2 degrees",
        Breaks::Encoder(E::Eccentric(91.0)),
    )
    .same(NO_COUNT),
    sensor("sensor A stays at rest", 0, Sensor::Rests).same(NO_CURRENT),
    sensor("sensor B stays at rest", 1, Sensor::Rests).same(NO_CURRENT),
    sensor("sensor A frozen", 0, Sensor::Frozen).same(NO_CURRENT),
    sensor("sensor B frozen", 1, Sensor::Frozen).same(NO_CURRENT),
    sensor("sensor A of half gain", 0, Sensor::Gain(50)).same(NO_CURRENT),
    sensor("sensor B of half gain", 1, Sensor::Gain(50)).same(NO_CURRENT),
    sensor("sensor A of double gain", 0, Sensor::Gain(200)).same(NO_CURRENT),
    sensor("sensor A reversed", 0, Sensor::Gain(-100)).same(NO_CURRENT),
    sensor("sensor B reversed", 1, Sensor::Gain(-100)).same(NO_CURRENT),
    sensor(
        "sensor A off by a tenth of the trip current",
        0,
        Sensor::Offset(10),
    ),
    sensor(
        "sensor B off by a quarter of the trip current",
        1,
        Sensor::Offset(25),
    ),
    sensor(
        "sensor A off by half of the trip current",
        0,
        Sensor::Offset(50),
    ),
    sensor("sensor A at its end", 0, Sensor::Saturated),
    sensor("sensor A noisy, a tenth of the limit", 0, Sensor::Noise(10)),
    sensor("sensor B noisy, half of the limit", 1, Sensor::Noise(50)),
    sensor("sensors exchanged", 0, Sensor::Exchanged).same(NO_CURRENT),
    phases("phase A open", Motor::Open(0)).same(NO_CURRENT),
    phases("phase B open", Motor::Open(1)).same(NO_CURRENT),
    phases("phase C open", Motor::Open(2)).same(NO_CURRENT),
    phases("phases B, C exchanged", Motor::Order([0, 2, 1])).same(NO_CURRENT),
    phases("phases A, B exchanged", Motor::Order([1, 0, 2])).same(NO_CURRENT),
    phases("phases one on", Motor::Order([1, 2, 0])).same(NO_CURRENT),
    driver("two phases shorted", Bridge::Short),
    phases("a third of the turns shorted", Motor::Turns(0.67)),
    phases(
        "windings of 1.4 times the resistance",
        Motor::Resistance(1.4),
    ),
    phases("windings of 3 times the resistance", Motor::Resistance(3.0)),
    phases("magnets of 0.6 times the strength", Motor::Magnets(0.6)),
    fault(
        Group::Memory,
        "electrical angle wrong by 30 degrees",
        Breaks::Motor(Motor::Angle(30.0)),
    ),
    fault(
        Group::Memory,
        "electrical angle wrong by 90 degrees",
        Breaks::Motor(Motor::Angle(90.0)),
    ),
    fault(
        Group::Memory,
        "electrical angle wrong by 120 degrees",
        Breaks::Motor(Motor::Angle(120.0)),
    ),
    fault(
        Group::Memory,
        "electrical angle wrong by 180 degrees",
        Breaks::Motor(Motor::Angle(180.0)),
    ),
    mechanics("knob comes off the shaft", Motor::KnobOff),
    mechanics("bearings without damping", Motor::NoDamping),
    mechanics("bearings jam", Motor::Jams),
    driver("leg A stays low", Bridge::Leg(0, 0.0)),
    driver("leg A stays high", Bridge::Leg(0, 1.0)),
    driver("leg B stays at half", Bridge::Leg(1, 0.5)),
    driver("leg C stays low", Bridge::Leg(2, 0.0)),
    driver("leg C stays high", Bridge::Leg(2, 1.0)),
    driver("bridge off, and nothing says so", Bridge::Dead),
    driver("dead time of 3 %", Bridge::DeadTime(0.03)),
    driver("driver's fault line says fault", Bridge::Line),
    driver("driver's fault line can only say good", Bridge::LineGood)
        .same(Same::Everywhere("the line matters only in a second fault")),
    supply("supply sags to 0.7 in 0.5 s", Supply::To(0.7, 500)),
    supply("supply sags to 0.85 in 0.5 s", Supply::To(0.85, 500)),
    supply("supply gone", Supply::To(0.0, 1)),
    supply("supply dips to 0.5 for 5 ms", Supply::Dip(0.5, 5)),
    supply("supply at 1.4 times", Supply::To(1.4, 5)),
    supply("supply's sensor reads 0.85", Supply::Reads(0.85)),
    supply("supply's sensor reads 1.2", Supply::Reads(1.2)),
    supply("supply's sensor frozen, supply at 0.7", Supply::Frozen(0.7)),
    supply("thermistor broken off", Supply::Thermistor(0)),
    supply("thermistor shorted", Supply::Thermistor(4_095)),
    host("computer silent", Host::Silent),
    host("settings without sense", Host::Garbage).same(REFUSED),
    host("settings of another knob", Host::Others).same(REFUSED),
    host("arm in every tick", Host::Arms).same(ARMED),
    host("disarm and arm, every 10 ms", Host::ArmsAgain),
    host("calibrate in every tick", Host::Calibrates).same(ARMED),
    host("zero in every tick", Host::Zeros).same(ARMED),
    host("environment changes every 40 ms", Host::Environment),
    memory("stored settings damaged", Memory::Damaged),
    memory(
        "kept alignment wrong by 15 degrees",
        Memory::Alignment(15.0),
    ),
    memory(
        "kept alignment wrong by 45 degrees",
        Memory::Alignment(45.0),
    ),
    memory(
        "kept alignment wrong by 90 degrees",
        Memory::Alignment(90.0),
    ),
    memory(
        "kept alignment wrong by 180 degrees",
        Memory::Alignment(180.0),
    ),
    memory("settings of a motor of half the size", Memory::Motor(0.5)),
    memory(
        "settings of a motor of 1.3 times the size",
        Memory::Motor(1.3),
    ),
    memory(
        "settings with 0.7 times the resistance",
        Memory::Resistance(0.7),
    ),
    memory(
        "settings with 1.4 times the resistance",
        Memory::Resistance(1.4),
    ),
    memory("settings with 11 pole pairs", Memory::PolePairs(11)),
    memory("settings with 4,096 encoder counts", Memory::Counts(4_096)),
    memory(
        "brown-out of the processor",
        Memory::Reset(ResetReason::BrownOut),
    ),
    memory(
        "watchdog of the processor",
        Memory::Reset(ResetReason::WindowWatchdog),
    ),
    timing("ticks 0.4 ms late", Timing::Late(8)),
    timing("ticks 0.6 ms late", Timing::Late(12)),
    timing("ticks 0.2 ms late, not told", Timing::LateUntold(4)),
    timing("ticks 0.4 ms late, not told", Timing::LateUntold(8)),
    timing("one tick missing", Timing::MissesOnce),
    timing("every 10th tick missing", Timing::Misses(10)),
    timing("no more ticks", Timing::Hangs),
    timing("every 2nd tick twice", Timing::Twice(2)),
    timing("every 10th tick twice", Timing::Twice(10)),
    timing("current loop late in every period", Timing::LateLoop(1)),
    timing("current loop late in every 3rd period", Timing::LateLoop(3))
        .same(Same::Everywhere("it is in time again before it counts")),
    timing("clock 1.1 times too slow", Timing::Clock(1.1)),
    timing("clock 1.3 times too slow", Timing::Clock(1.3)),
    timing("clock 1.3 times too fast", Timing::Clock(1.0 / 1.3)),
];

//! What can be wrong with motor, computer and memory of a board.

use touchstone_drive::ResetReason;
use touchstone_protocol::Board;

/// A fault of the motor, its wires, or what it turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motor {
    /// The wire of a phase is open.
    Open(usize),
    /// The wires are connected in this order.
    Order([usize; 3]),
    /// This fraction of the windings' turns is left; the others are shorted.
    Turns(f64),
    /// The windings' resistance is this many times the right one.
    Resistance(f64),
    /// The magnets have this fraction of their strength.
    Magnets(f64),
    /// The alignment becomes wrong by this many electrical degrees; the encoder's readings stay right.
    Angle(f64),
    /// The knob comes off: the hand no longer acts on the shaft, which keeps its inertia.
    KnobOff,
    /// The bearings lose all their damping.
    NoDamping,
    /// The bearings jam: their damping becomes 1 N·m·s/rad.
    Jams,
}

/// A fault of the computer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Host {
    /// The computer sends nothing more.
    Silent,
    /// The computer sends invalid settings, 100 times a second.
    Garbage,
    /// The computer sends valid settings with twice the wall's stiffness and another number of pole pairs, 100 times a second.
    Others,
    /// The computer sends the command to arm in every tick.
    Arms,
    /// The computer sends the commands to disarm and arm in turn, one every 10 ticks.
    ArmsAgain,
    /// The computer sends the command to calibrate in every tick.
    Calibrates,
    /// The computer makes the present position zero, in every tick.
    Zeros,
    /// The environment changes every 40 ms: walls, end stops and detents come and go.
    Environment,
}

/// Which stored data are wrong at the next start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Memory {
    /// None: the run with which the others are compared.
    Right,
    /// A bit of the stored settings is flipped.
    Damaged,
    /// The stored alignment is wrong by this many electrical degrees.
    Alignment(f64),
    /// The settings are those of another motor: resistance, inductance and torque constant are this many times the motor's.
    Motor(f64),
    /// The resistance in the settings is this many times the motor's.
    Resistance(f64),
    /// The settings have another number of pole pairs.
    PolePairs(u8),
    /// The settings have another number of encoder counts per turn.
    Counts(u32),
    /// The processor restarted for this reason.
    Reset(ResetReason),
}

/// Whether a board can have an environment (further walls, end stops, detents): only boards with a larger chip can.
pub(super) const fn has_environment(board: Board) -> bool {
    board.is_large()
}

//! Every leaf of the tree once more, with its unit, its bounds and what it means: for validation, and for people.

use super::{
    Decimal, DeviceSettings, DriveKind, EncoderKind, FirstContact, IdealStep, Invalid, Law,
    Observer, OffsetUpdate, Reason, Regulate,
};

/// What a leaf may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A number from `least` to `most`.
    Number {
        /// Smallest allowed.
        least: Decimal,
        /// Largest allowed.
        most: Decimal,
    },
    /// A whole number from `least` to `most`.
    Whole {
        /// Smallest allowed.
        least: u32,
        /// Largest allowed.
        most: u32,
    },
    /// One of these words.
    Choice(&'static [&'static str]),
    /// `true` or `false`.
    Flag,
}

impl Kind {
    /// The range as decimals, of what has one.
    #[must_use]
    pub fn range(&self) -> Option<(Decimal, Decimal)> {
        match *self {
            Kind::Number { least, most } => Some((least, most)),
            Kind::Whole { least, most } => {
                Some((Decimal::from_num(least), Decimal::from_num(most)))
            }
            Kind::Choice(_) | Kind::Flag => None,
        }
    }
}

/// A leaf of [`DeviceSettings`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Field {
    /// Its path, e.g. `wall.k_desired_n_m_per_rad`.
    pub path: &'static str,
    /// What it may hold.
    pub kind: Kind,
    /// Its unit, empty for a pure number or a word.
    pub unit: &'static str,
    /// What it means.
    pub about: &'static str,
}

/// The leaf of a path.
#[must_use]
pub fn field(path: &str) -> Option<&'static Field> {
    FIELDS.iter().find(|field| field.path == path)
}

/// The smallest value of a number; for constants, so that the table need not be in a program.
///
/// # Panics
/// If no number has this path.
pub(super) const fn least(path: &str) -> Decimal {
    let mut index = 0;
    while index < FIELDS.len() {
        let Field {
            path: other, kind, ..
        } = &FIELDS[index];
        if let Kind::Number { least, .. } = kind
            && equal(path.as_bytes(), other.as_bytes())
        {
            return *least;
        }
        index += 1;
    }
    panic!("no number has this path")
}

/// `==` in constants.
const fn equal(mut left: &[u8], mut right: &[u8]) -> bool {
    while let ([first, left_rest @ ..], [other, right_rest @ ..]) = (left, right) {
        if *first != *other {
            return false;
        }
        (left, right) = (left_rest, right_rest);
    }
    left.is_empty() && right.is_empty()
}

/// A number as such, whatever its type; nothing for words and flags, whose type is their range.
trait Leaf {
    fn number(&self) -> Option<Decimal> {
        None
    }
}

macro_rules! leaf {
    (number: $($whole:ty)*; word: $($word:ty)*) => {
        $(impl Leaf for $whole {
            fn number(&self) -> Option<Decimal> {
                Some(Decimal::from_num(*self))
            }
        })*
        $(impl Leaf for $word {})*
    };
}
leaf!(number: u8 u16 u32; word: bool Law Observer FirstContact Regulate OffsetUpdate IdealStep EncoderKind DriveKind);

impl Leaf for Decimal {
    fn number(&self) -> Option<Decimal> {
        Some(*self)
    }
}

const fn number(least: &'static str, most: &'static str) -> Kind {
    Kind::Number {
        least: Decimal::lit(least),
        most: Decimal::lit(most),
    }
}

const fn whole(least: u32, most: u32) -> Kind {
    Kind::Whole { least, most }
}

const fn word(words: &'static [&'static str]) -> Kind {
    Kind::Choice(words)
}

/// The table for people and the check of the numbers, of one list. Firmware has the second only: the texts of a `const` that
/// nothing uses are not in the program.
macro_rules! fields {
    ($($head:ident $(. $tail:ident)*: $kind:expr, $unit:literal, $about:literal;)+) => {
        /// Every leaf, in the order of the tree.
        pub const FIELDS: &[Field] = &[$(Field {
            path: concat!(stringify!($head) $(, ".", stringify!($tail))*),
            kind: $kind,
            unit: $unit,
            about: $about,
        },)+];

        /// Every number against its own range; the first that is outside.
        pub(super) fn check(settings: &DeviceSettings) -> Result<(), Invalid> {
            $(within(
                concat!(stringify!($head) $(, ".", stringify!($tail))*),
                settings.$head $(.$tail)*.number(),
                const { $kind },
            )?;)+
            Ok(())
        }
    };
}

fn within(path: &str, value: Option<Decimal>, kind: Kind) -> Result<(), Invalid> {
    let (Some(value), Some((least, most))) = (value, kind.range()) else {
        return Ok(());
    };
    if value < least || value > most {
        return Err(Invalid::new(path, value, Reason::Outside { least, most }));
    }
    Ok(())
}

// Bounds of the wall: those of `control`, or narrower where this device cannot do more; a test holds the two together.
fields! {
    control.rate_hz: whole(500, 10_000), "Hz",
        "control rate, a whole fraction of 20000 Hz";
    wall.surface_rad: number("-100", "100"), "rad",
        "where the surface is, from the zero of the calibration; inside is beyond it";
    wall.law: word(Law::WORDS), "",
        "the control law";
    wall.k_desired_n_m_per_rad: number("0", "10000"), "N·m/rad",
        "desired stiffness k_de";
    wall.k_soft_n_m_per_rad: number("0.01", "10000"), "N·m/rad",
        "soft stiffness k_v, stable by itself: at most k_c = 2 c_i/T";
    wall.device_damping_n_m_s_per_rad: number("0", "10"), "N·m·s/rad",
        "damping c_i that device and fingertip are trusted to have";
    wall.virtual_damping_n_m_s_per_rad: number("0", "10"), "N·m·s/rad",
        "virtual damping of the law spring-damper";
    wall.observer: word(Observer::WORDS), "",
        "energy observer; thesis counts the sampling leak with the wrong sign";
    wall.count_device_damping: Kind::Flag, "",
        "tdpa: count c_i as dissipation";
    wall.first_contact: word(FirstContact::WORDS), "",
        "what happens to the force when the first contact ends";
    wall.regulate: word(Regulate::WORDS), "",
        "which stiffness the offset regulates";
    wall.offset_update: word(OffsetUpdate::WORDS), "",
        "when the offset is changed";
    wall.ideal_step: word(IdealStep::WORDS), "",
        "what the ideal step supposes of the hand";
    wall.step_of_ideal: number("0", "1"), "",
        "c, the part of the ideal step that is taken";
    wall.limit_of_force: number("0", "1"), "",
        "b, the largest step of the force as a part of it";
    wall.limit_of_penetration: number("0", "1"), "",
        "a, the largest step of the offset as a part of the penetration";
    wall.filter.mass_kg_m2: number("0", "1"), "kg·m²",
        "virtual inertia";
    wall.filter.stiffness_n_m_per_rad: number("0.01", "10000"), "N·m/rad",
        "coupling stiffness k_f, at most 2 (c_i - c_f)/T";
    wall.filter.damping_n_m_s_per_rad: number("0", "10"), "N·m·s/rad",
        "coupling damping c_f";
    wall.filter.ground_damping_n_m_s_per_rad: number("0", "10"), "N·m·s/rad",
        "damping of the virtual mass to ground c_env, at least k_v T/2";
    wall.energy_credit_j: number("0", "10"), "J",
        "energy that one contact may give beyond what it took; 0 is strictly passive";
    wall.force_limit_n_m: number("0.000001", "50"), "N·m",
        "largest torque ever commanded, at most torque constant times current limit";
    encoder.kind: word(EncoderKind::WORDS), "",
        "which encoder is connected";
    encoder.counts_per_rev: whole(4, 1_000_000), "counts/rev",
        "counts a revolution, all edges counted; 16384 for as5047p and mt6701";
    encoder.reversed: Kind::Flag, "",
        "turning the other way is positive";
    encoder.bad_readings: whole(1, 10), "readings",
        "bad readings in a row that make a fault; the outputs are off from the first";
    drive.kind: word(DriveKind::WORDS), "",
        "what moves the shaft";
    drive.analogue_full_scale_n_m: number("0.01", "100"), "N·m",
        "analogue: torque at the upper end of the output; none in the middle";
    motor.pole_pairs: whole(1, 50), "",
        "pole pairs; the calibration checks them";
    motor.resistance_ohm: number("0.01", "100"), "Ω",
        "resistance of one phase to the star point: half of that between two wires";
    motor.inductance_h: number("0.000005", "0.1"), "H",
        "inductance of one phase to the star point: half of that between two wires";
    motor.torque_constant_n_m_per_a: number("0.001", "10"), "N·m/A",
        "torque for a q-axis current of 1 A (the amplitude of a phase current)";
    motor.current_limit_a: number("0.05", "25"), "A",
        "largest current that is ever asked for, at most the trip current";
    motor.current_bandwidth_hz: number("50", "1500"), "Hz",
        "bandwidth of the current loop";
    limits.trip_current_a: number("0.05", "25"), "A",
        "phase current that switches off; at most 15 on nucleo-g474re";
    limits.bus_min_v: number("8", "48"), "V",
        "bus voltage below which it switches off";
    limits.bus_max_v: number("8", "48"), "V",
        "bus voltage above which it switches off; at most 30 on b-g431b-esc1";
    limits.derate_from_celsius: number("20", "109"), "°C",
        "from here the current is reduced";
    limits.fault_from_celsius: number("30", "110"), "°C",
        "switches off; the reduced current reaches zero here";
    limits.max_speed_rad_per_s: number("1", "1000"), "rad/s",
        "speed above which it switches off";
    limits.fade_in_s: number("0", "10"), "s",
        "time over which the torque fades in after arming";
    calibration.current_a: number("0.05", "25"), "A",
        "current of the field that turns the shaft, at most the current limit";
    calibration.electrical_turns_per_s: number("0.2", "20"), "turns/s",
        "speed of that field, electrical turns";
    telemetry.decimation: whole(0, 1000), "ticks",
        "one record every so many control ticks; 0 sends none";
}

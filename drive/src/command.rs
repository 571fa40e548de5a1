//! Converts a torque to a command for the drive: a current for this board's bridge, or a voltage for an external amplifier.

use crate::Amps;
use crate::angle::Angle;
use crate::current::{CurrentCommand, CurrentMode};
use crate::settings::{DriveKind, MotorSettings, out_of_format};
use crate::transform::Dq;
use crate::units::{clamp_i32, narrow, product, quotient};
use fixed::types::I8F24;
use touchstone_control::{Fixed32, Force, Number as _, Si};
use touchstone_protocol::settings::{DriveSettings, SettingsError};
use touchstone_protocol::{DeviceSettings, Limit, Limits};

/// A code of the 12-bit analogue output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DacCode(
    /// The code, 0 to 4,095.
    pub u16,
);

impl DacCode {
    /// The middle of the output's range, which commands zero torque.
    pub const ZERO: Self = Self(2_048);
}

/// Command to the drive for a control period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DriveCommand {
    /// The drive is off: bridge off, amplifier disabled and its input at zero.
    Off,
    /// The three-phase bridge is driven; holds the current loop's command.
    Current(CurrentCommand),
    /// A code for the external amplifier, which is enabled.
    Analogue(DacCode),
}

/// Position and motion of the rotor, for the drives that need them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rotor {
    /// Number of the control period, as a sign of life for the current loop.
    pub tick: u32,
    /// Electrical angle of the rotor.
    pub angle: Angle,
    /// Change of the electrical angle in a PWM period, 2^-32 turns.
    pub advance: i32,
    /// Whether the electrical angle falls when the encoder count rises.
    pub against: bool,
    /// Fraction of the current limit that the temperatures of power stage and motor allow, in 1/65,536 (65,536: the whole limit).
    pub derating: u32,
    /// Current that the cogging map adds, A; positive if its torque acts towards rising positions (`+x`).
    #[cfg(feature = "large")]
    pub map: Amps,
}

impl Rotor {
    /// The cogging map's current, limited to `left`, the current limit that the temperatures allow; 0 without a map.
    #[inline(always)]
    #[cfg(feature = "large")]
    fn added(&self, left: Amps) -> Amps {
        self.map.min(left).max(left.saturating_neg())
    }

    /// Returns zero, since this build has no cogging map.
    #[inline(always)]
    #[cfg(not(feature = "large"))]
    const fn added(&self, _left: Amps) -> Amps {
        Amps::ZERO
    }

    /// The current loop's command for a current whose torque acts towards rising positions (`+x`).
    #[inline(always)]
    pub(crate) const fn along(&self, current: Amps) -> CurrentCommand {
        CurrentCommand {
            tick: self.tick,
            mode: CurrentMode::Drive,
            angle: self.angle,
            advance: self.advance,
            current: Dq {
                d: Amps::ZERO,
                q: if self.against {
                    current.saturating_neg()
                } else {
                    current
                },
            },
        }
    }
}

/// The drive command for a torque, and the limits that are in effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Driven {
    /// The command to the drive.
    pub command: DriveCommand,
    /// [`Limit::Current`] if the current limit made the torque smaller; [`Limit::Temperature`] while the temperature lowers that
    /// limit.
    pub limits: Limits,
    /// The torque that remains after the limits, N·m; positive towards rising positions (`+x`).
    pub torque: Force<Fixed32>,
}

/// Turns a torque into a command for the motor's drive.
pub trait Drive {
    /// Returns the drive command for a torque that is positive towards rising positions (`+x`).
    fn command(&self, torque: Force<Fixed32>, rotor: &Rotor) -> Driven;
}

/// A three-phase motor on this board's bridge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ThreePhase {
    /// Inverse of the torque constant, `1/k_t`, A/(N·m).
    amps_per_nm: Amps,
    /// Torque constant `k_t`, N·m/A.
    nm_per_amp: I8F24,
    limit: Amps,
}

impl ThreePhase {
    /// Computes torque constant and its inverse from the motor's settings.
    ///
    /// # Errors
    /// The inverse of the torque constant does not fit its fixed-point format.
    #[inline]
    pub fn new(motor: &MotorSettings) -> Result<Self, SettingsError> {
        let inverse = quotient(Si::ONE, motor.torque_constant_n_m_per_a);
        let amps_per_nm = narrow(inverse);
        if amps_per_nm <= Amps::ZERO || amps_per_nm == Amps::MAX {
            return Err(out_of_format("motor.torque_constant_n_m_per_a", inverse));
        }
        Ok(Self {
            amps_per_nm,
            nm_per_amp: Fixed32::saturating_signal(motor.torque_constant_n_m_per_a),
            limit: narrow(motor.current_limit_a),
        })
    }
}

impl Drive for ThreePhase {
    fn command(&self, torque: Force<Fixed32>, rotor: &Rotor) -> Driven {
        let along = Amps::from_bits(product(torque.0.to_bits(), self.amps_per_nm.to_bits(), 24));
        // This is at most the limit, because the derating is at most 1.
        let left = (i64::from(self.limit.to_bits()) * i64::from(rotor.derating.min(1 << 16))) >> 16;
        let left = Amps::from_bits(clamp_i32(left));
        let added = rotor.added(left);
        // Range of the wall's current. The cogging map's current shifts it, but it always includes zero.
        let (least, most) = (
            left.saturating_neg().saturating_sub(added),
            left.saturating_sub(added),
        );
        let given = along.min(most).max(least);
        let command = rotor.along(given.saturating_add(added));
        let limited = given != along;
        let most = if given < Amps::ZERO {
            least.saturating_neg()
        } else {
            most
        };
        let most = product(most.to_bits(), self.nm_per_amp.to_bits(), 16);
        Driven {
            command: DriveCommand::Current(command),
            limits: Limits::NONE
                .with(Limit::Current, limited)
                .with(Limit::Temperature, rotor.derating < 1 << 16),
            torque: if limited {
                torque.within(Force(I8F24::from_bits(most)))
            } else {
                torque
            },
        }
    }
}

/// A servo amplifier connected to the analogue output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Analogue {
    /// Codes of the analogue output per N·m, with 16 fractional bits.
    codes_per_nm: i32,
}

impl Analogue {
    /// Computes the codes of the analogue output per N·m from the amplifier's settings.
    ///
    /// # Errors
    /// The inverse of the full-scale torque does not fit its fixed-point format.
    #[inline]
    pub fn new(drive: &DriveSettings) -> Result<Self, SettingsError> {
        let codes = quotient(Si::const_from_int(2_047), drive.analogue_full_scale_n_m);
        let codes_per_nm = narrow(codes).to_bits();
        if codes_per_nm <= 0 || codes_per_nm == i32::MAX {
            return Err(out_of_format("drive.analogue_full_scale_n_m", codes));
        }
        Ok(Self { codes_per_nm })
    }
}

impl Drive for Analogue {
    fn command(&self, torque: Force<Fixed32>, _rotor: &Rotor) -> Driven {
        // Removes 24 + 16 fractional bits, rounding to the nearest.
        let wide = i64::from(torque.0.to_bits()) * i64::from(self.codes_per_nm);
        let wanted = clamp_i32((wide + (1 << 39)) >> 40);
        let given = wanted.clamp(-2_047, 2_047);
        let code = DacCode(u16::try_from(given + 2_048).unwrap_or(DacCode::ZERO.0));
        Driven {
            command: DriveCommand::Analogue(code),
            limits: Limits::NONE.with(Limit::Current, given != wanted),
            // The force limit is at most the full scale.
            torque,
        }
    }
}

/// The drive that the settings choose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnyDrive {
    /// The command goes to this board's three-phase bridge.
    ThreePhase(ThreePhase),
    /// The command goes to the analogue output.
    Analogue(Analogue),
}

impl AnyDrive {
    /// Computes the drive's coefficients from the settings.
    ///
    /// # Errors
    /// A coefficient does not fit its fixed-point format.
    #[inline]
    pub fn new(settings: &DeviceSettings) -> Result<Self, SettingsError> {
        Ok(match settings.drive.kind {
            DriveKind::ThreePhase => Self::ThreePhase(ThreePhase::new(&settings.motor)?),
            DriveKind::Analogue => Self::Analogue(Analogue::new(&settings.drive)?),
        })
    }
}

impl Drive for AnyDrive {
    fn command(&self, torque: Force<Fixed32>, rotor: &Rotor) -> Driven {
        match self {
            Self::ThreePhase(drive) => drive.command(torque, rotor),
            Self::Analogue(drive) => drive.command(torque, rotor),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn torque(nm: f64) -> Force<Fixed32> {
        Force(I8F24::from_num(nm))
    }

    const ROTOR: Rotor = Rotor {
        tick: 7,
        angle: Angle(0x1234),
        advance: -5,
        against: false,
        derating: 1 << 16,
        #[cfg(feature = "large")]
        map: Amps::ZERO,
    };

    fn current(nm: f64, rotor: Rotor) -> (f64, Limits) {
        let drive = ThreePhase::new(&DeviceSettings::default().motor).unwrap();
        let driven = drive.command(torque(nm), &rotor);
        let DriveCommand::Current(command) = driven.command else {
            panic!("{driven:?}")
        };
        let limits = driven.limits;
        // The reported torque is that of the current, and never more than requested.
        let (left, given) = (
            driven.torque.0.to_num::<f64>(),
            0.25 * command.current.q.to_num::<f64>(),
        );
        assert!(
            (left.abs() - given.abs()).abs() < 1e-4 && left.abs() <= nm.abs() + 1e-6,
            "{left} {given}"
        );
        assert_eq!(
            (command.tick, command.mode, command.current.d),
            (7, CurrentMode::Drive, Amps::ZERO)
        );
        assert_eq!(
            (command.angle, command.advance),
            (rotor.angle, rotor.advance)
        );
        (command.current.q.to_num(), limits)
    }

    #[test]
    fn a_torque_is_a_current_by_the_torque_constant_and_direction() {
        // The torque constant is 0.25 N·m/A, the current limit 2 A.
        for (nm, amps) in [(0.0, 0.0), (0.1, 0.4), (-0.1, -0.4), (0.49, 1.96)] {
            let (q, limits) = current(nm, ROTOR);
            assert!(
                (q - amps).abs() < 1e-4 && limits == Limits::NONE,
                "{nm}: {q}"
            );
            let (q, _) = current(
                nm,
                Rotor {
                    against: true,
                    ..ROTOR
                },
            );
            assert!((q + amps).abs() < 1e-4, "{nm}: {q}");
        }
    }

    #[test]
    fn the_limit_and_what_the_temperature_leaves_of_it() {
        let (q, limits) = current(-100.0, ROTOR);
        assert!(q == -2.0 && limits.has(Limit::Current) && !limits.has(Limit::Temperature));
        let warm = Rotor {
            derating: 1 << 14,
            ..ROTOR
        };
        let (q, limits) = current(0.4, warm);
        assert!(q == 0.5 && limits.has(Limit::Current) && limits.has(Limit::Temperature));
        let (q, limits) = current(0.05, warm);
        assert!(
            (q - 0.2).abs() < 1e-4 && !limits.has(Limit::Current) && limits.has(Limit::Temperature)
        );
        assert_eq!(
            current(
                0.4,
                Rotor {
                    derating: 0,
                    ..ROTOR
                }
            )
            .0,
            0.0
        );
    }

    #[cfg(feature = "large")]
    #[test]
    fn a_map_adds_its_current_and_takes_no_force_for_its_own() {
        let drive = ThreePhase::new(&DeviceSettings::default().motor).unwrap();
        let asked = |nm: f64, map: f64, derating: u32| {
            let rotor = Rotor {
                map: Amps::from_num(map),
                derating,
                ..ROTOR
            };
            let driven = drive.command(torque(nm), &rotor);
            let DriveCommand::Current(command) = driven.command else {
                panic!("{driven:?}")
            };
            let is_limited = driven.limits.has(Limit::Current);
            let q: f64 = command.current.q.to_num();
            (q, driven.torque.0.to_num::<f64>(), is_limited)
        };
        let near = |a: f64, b: f64| (a - b).abs() < 1e-4;
        // The cogging map uses a part of the 2 A. The reported force is that of the remaining current. This force never has the
        // sign opposite to the requested one, nor is it larger.
        for (nm, map, derating, q, told, limited) in [
            (0.1, 0.05, 1 << 16, 0.45, 0.1, false),
            (0.5, 0.1, 1 << 16, 2.0, 0.475, true),
            (-0.5, 0.1, 1 << 16, -1.9, -0.5, false),
            (-0.6, 0.1, 1 << 16, -2.0, -0.525, true),
            (0.1, 0.5, 1 << 13, 0.25, 0.0, true),
            (-0.1, 0.5, 1 << 13, -0.15, -0.1, false),
            (0.1, 0.5, 0, 0.0, 0.0, true),
        ] {
            let found = asked(nm, map, derating);
            assert!(
                near(found.0, q) && near(found.1, told) && found.2 == limited,
                "{nm} {map} {derating}: {found:?}"
            );
        }
    }

    #[test]
    fn the_analogue_output_spans_its_full_scale_around_the_middle() {
        // The upper end of the range is 1 N·m.
        let drive = Analogue::new(&DeviceSettings::default().drive).unwrap();
        for (nm, code) in [
            (0.0, 2_048),
            (1.0, 4_095),
            (-1.0, 1),
            (0.5, 3_072),
            (0.000_1, 2_048),
            (0.000_3, 2_049),
        ] {
            let driven = drive.command(torque(nm), &ROTOR);
            assert_eq!(
                (driven.command, driven.limits),
                (DriveCommand::Analogue(DacCode(code)), Limits::NONE),
                "{nm}"
            );
        }
        for (nm, code) in [(1.1, 4_095), (-100.0, 1)] {
            let driven = drive.command(torque(nm), &ROTOR);
            assert_eq!(driven.command, DriveCommand::Analogue(DacCode(code)));
            assert!(driven.limits.has(Limit::Current));
        }
    }
}

//! What a board stores for its next start: the alignment of its encoder with its motor, and whether the board starts by itself.
//!
//! Only an absolute encoder's alignment can be stored, because an incremental encoder counts from the position at power-on. The
//! stored data are valid only for the hardware with which they were measured. They are not among the settings: a settings file of
//! another knob must neither bring that knob's alignment nor make this knob start automatically.

use super::{DeviceSettings, DriveKind, EncoderKind};
use crate::Board;
use serde::{Deserialize, Serialize};

/// Most bytes that a [`KeptStart`] takes in flash (a test checks it).
pub const KEPT_MAX: usize = 24;

/// The data that a board stores for its next start: the encoder's alignment and whether the board starts by itself.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeptStart {
    /// The encoder's alignment with the motor, if one is stored.
    pub alignment: Option<KeptAlignment>,
    /// Whether the board checks the encoder's alignment and arms by itself when power comes on.
    pub autostart: bool,
}

/// The encoder's alignment with the motor, and the hardware with which it was measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeptAlignment {
    /// Electrical angle of the motor at the encoder's own zero, in units of a turn/65,536.
    pub offset: u16,
    /// Whether the motor's electrical angle falls when the encoder count rises.
    pub against: bool,
    /// The hardware with which the alignment was measured.
    pub with: MeasuredWith,
}

/// The hardware with which stored data (alignment or cogging map) were measured. With other hardware these data are not valid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct MeasuredWith {
    /// The board. Another shield may connect the motor's phases in another order.
    pub board: Board,
    /// The type of encoder.
    #[serde(with = "super::leaf")]
    pub encoder: EncoderKind,
    /// Whether the setting `encoder.reversed` was on, which reverses the direction of counting.
    pub reversed: bool,
    /// Encoder counts per turn of the shaft.
    pub counts_per_rev: u32,
    /// Number of the motor's pole pairs.
    pub pole_pairs: u8,
}

/// Why an encoder alignment or a cogging map cannot be stored, or why a stored one cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unkept {
    /// The encoder is incremental, so it has no zero of its own.
    Incremental,
    /// The drive is an external amplifier with an analogue command, which needs no alignment.
    NothingToAlign,
    /// The settings were changed after the last calibration. The changes apply from the next calibration, so data measured before
    /// do not fit.
    SettingsWait,
    /// No data are stored.
    None,
    /// The data were measured on another board.
    OtherBoard,
    /// The data were measured with another encoder, or with other settings of the same one.
    OtherEncoder,
    /// The data were measured with another number of pole pairs.
    OtherPolePairs,
}

impl Unkept {
    /// The reason as text for people.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Incremental => {
                "an incremental encoder counts from the angle at which it was switched on, so data that depend on the angle cannot be stored"
            }
            Self::NothingToAlign => "an analogue drive has no alignment",
            Self::SettingsWait => "settings were changed since the calibration",
            Self::None => "no alignment is stored",
            Self::OtherBoard => "it was measured on another board",
            Self::OtherEncoder => {
                "it was measured with another encoder, or with other encoder settings"
            }
            Self::OtherPolePairs => "it was measured with another number of pole pairs",
        }
    }
}

/// State of the automatic start since the board was switched on. The numbers never change.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u8)]
pub enum SelfStart {
    /// The automatic start is switched off.
    #[default]
    Off = 0,
    /// The board waits until the supply is in its range and the shaft is at rest.
    Waiting = 1,
    /// The board checks the stored encoder alignment.
    Checking = 2,
    /// The board has switched its outputs on automatically.
    Started = 3,
    /// Not started: the processor was reset without a power-on.
    NoPowerOn = 4,
    /// Not started: no stored alignment fits the settings, or the settings request a measurement of the motor.
    NoAlignment = 5,
    /// Not started: a desktop sent a request first, so the desktop decides when to arm.
    DesktopSpoke = 6,
    /// Not started: the supply was not in its range in time, the shaft did not come to rest, or the device left the expected state.
    NotReady = 7,
    /// Not started: the stop button was pressed.
    StopPressed = 8,
    /// Not started: a fault occurred; it stays stored until a command clears it.
    Faulted = 9,
}

impl SelfStart {
    /// All states of the automatic start, in the order of their numbers.
    pub const ALL: [Self; 10] = [
        Self::Off,
        Self::Waiting,
        Self::Checking,
        Self::Started,
        Self::NoPowerOn,
        Self::NoAlignment,
        Self::DesktopSpoke,
        Self::NotReady,
        Self::StopPressed,
        Self::Faulted,
    ];

    /// The state as text for people.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Off => "was not requested at this start",
            Self::Waiting => "waits for the supply and for a shaft at rest",
            Self::Checking => "checks the stored alignment",
            Self::Started => "armed by itself",
            Self::NoPowerOn => "did not start: this was a reset, not a start of the power supply",
            Self::NoAlignment => {
                "did not start: no stored alignment fits the settings, or the settings request a measurement"
            }
            Self::DesktopSpoke => "did not start: a computer sent a request first",
            Self::NotReady => {
                "did not start: the supply stayed outside its range, or the shaft did not come to rest"
            }
            Self::StopPressed => "did not start: the stop button was pressed",
            Self::Faulted => "did not start: there is a fault",
        }
    }
}

/// A board's report on its automatic start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct StartReport {
    /// The data that are stored for the next start; `Save` writes them to flash.
    pub kept: KeptStart,
    /// Whether the encoder alignment in use is a stored one that the calibration only checked, instead of searching for it.
    pub was_checked: bool,
    /// How the automatic start went.
    pub self_start: SelfStart,
}

/// Checks whether an encoder alignment or a cogging map can be stored with these settings.
///
/// # Errors
/// The reason for the refusal.
pub const fn may_keep(settings: &DeviceSettings) -> Result<(), Unkept> {
    match (settings.drive.kind, settings.encoder.kind) {
        (DriveKind::Analogue, _) => Err(Unkept::NothingToAlign),
        (_, EncoderKind::Incremental) => Err(Unkept::Incremental),
        _ => Ok(()),
    }
}

impl MeasuredWith {
    /// The hardware that these settings and this board describe.
    #[must_use]
    pub const fn new(settings: &DeviceSettings, board: Board) -> Self {
        Self {
            board,
            encoder: settings.encoder.kind,
            reversed: settings.encoder.reversed,
            counts_per_rev: settings.encoder.counts_per_rev,
            pole_pairs: settings.motor.pole_pairs,
        }
    }

    /// Checks whether the data were measured with the hardware that the present settings describe.
    ///
    /// # Errors
    /// The settings allow no stored data, or the part of the hardware that differs.
    pub fn fits(&self, settings: &DeviceSettings, board: Board) -> Result<(), Unkept> {
        may_keep(settings)?;
        let now = Self::new(settings, board);
        if *self == now {
            Ok(())
        } else if self.board != now.board {
            Err(Unkept::OtherBoard)
        } else if self.pole_pairs != now.pole_pairs {
            Err(Unkept::OtherPolePairs)
        } else {
            Err(Unkept::OtherEncoder)
        }
    }
}

impl KeptAlignment {
    /// An encoder alignment that was measured with the hardware that these settings describe.
    #[must_use]
    pub const fn new(offset: u16, against: bool, settings: &DeviceSettings, board: Board) -> Self {
        Self {
            offset,
            against,
            with: MeasuredWith::new(settings, board),
        }
    }
}

impl KeptStart {
    /// The stored encoder alignment, if it was measured with the hardware that the present settings describe.
    ///
    /// # Errors
    /// The reason why no stored alignment can be used.
    pub fn usable(&self, settings: &DeviceSettings, board: Board) -> Result<KeptAlignment, Unkept> {
        may_keep(settings)?;
        let kept = self.alignment.ok_or(Unkept::None)?;
        kept.with.fits(settings, board)?;
        Ok(kept)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(settings: &DeviceSettings, board: Board) -> KeptStart {
        KeptStart {
            alignment: Some(KeptAlignment::new(u16::MAX, true, settings, board)),
            autostart: true,
        }
    }

    #[test]
    fn it_is_used_with_what_it_was_measured_with_and_with_nothing_else() {
        let board = Board::NucleoG474re;
        let settings = DeviceSettings::defaults(board);
        let start = kept(&settings, board);
        assert_eq!(
            start.usable(&settings, board).ok().map(|it| it.offset),
            Some(u16::MAX)
        );
        assert_eq!(
            start.usable(&settings, Board::NucleoG474reIhm16m1),
            Err(Unkept::OtherBoard)
        );
        type Change = fn(&mut DeviceSettings);
        let changes: [(Change, Unkept); 6] = [
            (|it| it.motor.pole_pairs = 11, Unkept::OtherPolePairs),
            (
                |it| it.encoder.kind = EncoderKind::Mt6701,
                Unkept::OtherEncoder,
            ),
            (|it| it.encoder.reversed = true, Unkept::OtherEncoder),
            (|it| it.encoder.counts_per_rev = 4_096, Unkept::OtherEncoder),
            (
                |it| it.encoder.kind = EncoderKind::Incremental,
                Unkept::Incremental,
            ),
            (
                |it| it.drive.kind = DriveKind::Analogue,
                Unkept::NothingToAlign,
            ),
        ];
        for (change, why) in changes {
            let mut other = settings.clone();
            change(&mut other);
            assert_eq!(start.usable(&other, board), Err(why));
            // With the original settings the stored alignment is usable again.
            assert!(start.usable(&settings, board).is_ok());
        }
        assert_eq!(
            KeptStart::default().usable(&settings, board),
            Err(Unkept::None)
        );
    }

    #[test]
    fn the_longest_fits_and_the_numbers_are_in_order() {
        let mut settings = DeviceSettings::defaults(Board::NucleoG474reIhm16m1);
        settings.encoder.counts_per_rev = u32::MAX;
        let mut buffer = [0; KEPT_MAX];
        let start = kept(&settings, Board::NucleoG474reIhm16m1);
        assert!(postcard::to_slice(&start, &mut buffer).is_ok());
        for (number, it) in SelfStart::ALL.into_iter().enumerate() {
            assert_eq!(it as usize, number);
        }
    }
}

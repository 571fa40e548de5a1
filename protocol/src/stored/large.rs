//! What larger chips store beside the settings: the environment (walls, end stops, detents), the data for the next start, and the
//! map of the motor's cogging torque. `small.rs` has the same functions for chips without room for them.

use super::{Check, Refused, WALL_ALONE, content, sealed};
use crate::frame::message;
use crate::settings::DeviceSettings;
use crate::settings::cogging::{COGGING_MAX, KeptCogging};
use crate::settings::environment::{ENVIRONMENT_MAX, Surround};
use crate::settings::kept::{KEPT_MAX, KeptStart};

/// Version of the layout. It must get a number that no layout had before when the fields of a stored type, their order, their types
/// or their meaning change: [`DeviceSettings`], [`Surround`] with its parts, [`KeptStart`] or [`KeptCogging`]. Otherwise a board
/// takes what it stored for damaged. A change of [`DeviceSettings`] also needs a new number for `WALL_ALONE` in `stored.rs`.
pub const LAYOUT_VERSION: u16 = 12;

/// Most bytes that are stored beside the settings.
pub(super) const BESIDE_MAX: usize = ENVIRONMENT_MAX + KEPT_MAX + COGGING_MAX;

/// The data with which a device starts: settings, environment (walls, end stops, detents), encoder alignment and cogging map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Start {
    /// The settings to use.
    pub settings: DeviceSettings,
    /// The environment that the knob renders: walls, end stops, detents and torque profile.
    pub environment: Surround,
    /// The data stored for the next start: the encoder's alignment and whether the board starts by itself.
    pub kept: KeptStart,
    /// The map of the motor's cogging torque, if one is stored.
    pub cogging: Option<KeptCogging>,
    /// Why the defaults are used although an image was stored. The device then latches `SettingsInvalid`.
    pub refused: Option<Refused>,
}

impl Start {
    /// A start with these settings, one wall and no stored data. `refused` is the reason if an image was refused.
    pub(crate) fn defaults(settings: DeviceSettings, refused: Option<Refused>) -> Self {
        Self {
            settings,
            environment: Surround::default(),
            kept: KeptStart::default(),
            cogging: None,
            refused,
        }
    }
}

/// Encodes the image of the settings into `buffer`.
///
/// # Errors
/// The buffer is too small; [`IMAGE_MAX`](super::IMAGE_MAX) bytes are always enough.
pub fn encode<'b>(
    settings: &DeviceSettings,
    buffer: &'b mut [u8],
) -> Result<&'b [u8], postcard::Error> {
    encode_with(
        settings,
        &Surround::default(),
        &KeptStart::default(),
        None,
        buffer,
    )
}

/// Encodes the image of the settings, the environment, the data for the next start, and the cogging map.
///
/// # Errors
/// The buffer is too small; [`IMAGE_MAX`](super::IMAGE_MAX) bytes are always enough.
pub fn encode_with<'b>(
    settings: &DeviceSettings,
    environment: &Surround,
    kept: &KeptStart,
    cogging: Option<&KeptCogging>,
    buffer: &'b mut [u8],
) -> Result<&'b [u8], postcard::Error> {
    sealed(&(settings, environment, kept, cogging), buffer)
}

/// Decodes an image: settings, environment, the data for the start, and the cogging map. `check` validates the settings, and the
/// environment is checked against them.
///
/// # Errors
/// The image is damaged, of an unknown layout, or not valid.
pub fn decode_with(image: &[u8], check: Check<'_>) -> Result<Start, Refused> {
    let (version, content) = content(image)?;
    type Read = (DeviceSettings, Surround, KeptStart, Option<KeptCogging>);
    let read: Option<Read> = match version {
        WALL_ALONE => {
            message(content).map(|it| (it, Surround::default(), KeptStart::default(), None))
        }
        _ => message(content),
    };
    let (settings, environment, kept, cogging) = read.ok_or(Refused::Damaged)?;
    check(&settings)
        .and_then(|()| environment.check(&settings))
        .map_err(Refused::Invalid)?;
    Ok(Start {
        environment,
        kept,
        cogging,
        ..Start::defaults(settings, None)
    })
}

/// Decodes the settings of an image. `check` validates them.
///
/// # Errors
/// The image is damaged, of an unknown layout, or not valid.
pub fn decode(image: &[u8], check: Check<'_>) -> Result<DeviceSettings, Refused> {
    decode_with(image, check).map(|start| start.settings)
}

/// Decodes all data of an image with which the device starts.
pub(super) fn read(image: &[u8], check: Check<'_>) -> Result<Start, Refused> {
    decode_with(image, check)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::cogging::{CoggingHarmonic, CoggingMap};
    use crate::settings::environment::{
        DetentsBeside, Points, ProfileBeside, TravelEnds, WallBeside,
    };
    use crate::settings::kept::{KeptAlignment, MeasuredWith};
    use crate::settings::parts::Parts;
    use crate::stored::tests::pinned;
    use crate::stored::{IMAGE_MAX, start};
    use crate::{Board, Decimal};
    use touchstone_control::Si;
    use touchstone_control::environment::{
        CentreSettings, ClickSettings, DrySettings, FeelSettings, InertiaSettings, Shape, Spacing,
        ViscousSettings,
    };

    /// An environment with every part.
    fn every_part() -> Surround {
        let number = |whole: i32| Decimal(Si::from_num(whole));
        let part = |whole: i32| Si::from_num(whole);
        Surround {
            first_wall: false,
            further: [Some(WallBeside {
                at_rad: number(1),
                below: true,
                stiffness_n_m_per_rad: Some(number(2)),
            }); 3],
            endstops: Some(TravelEnds {
                lower_rad: number(-1),
                upper_rad: number(3),
                stiffness_n_m_per_rad: Some(number(4)),
            }),
            detents: Some(DetentsBeside {
                per_rev: 24,
                pitch_rad: number(5),
                strength_n_m: number(6),
                centre_rad: number(7),
            }),
            change_n_m_per_s: number(8),
            profile: Some(ProfileBeside {
                per_rev: 300,
                start_rad: number(9),
                end_rad: number(10),
                strength_n_m: number(11),
                shape: Points(Shape::new(&[0, 100, -100]).expect("a shape")),
            }),
            parts: Parts(FeelSettings {
                spring: Some(CentreSettings {
                    centre: part(12),
                    stiffness: part(13),
                    strength: part(14),
                }),
                viscous: Some(ViscousSettings {
                    damping: part(15),
                    bandwidth_hz: part(16),
                }),
                dry: Some(DrySettings {
                    strength: part(17),
                    stretch: part(18),
                }),
                click: Some(ClickSettings {
                    spacing: Spacing::PerTurn(12),
                    centre: part(19),
                    strength: part(20),
                    duration_s: part(21),
                }),
                inertia: Some(InertiaSettings {
                    inertia: part(22),
                    bandwidth_hz: part(23),
                }),
            }),
        }
    }

    #[test]
    fn everything_is_stored_as_the_layout_version_says() {
        let board = Board::NucleoG474re;
        let settings = DeviceSettings::defaults(board);
        let kept = KeptStart {
            alignment: Some(KeptAlignment::new(1000, true, &settings, board)),
            autostart: true,
        };
        let harmonic = CoggingHarmonic {
            order: 6,
            cos: 300,
            sin: -7,
        };
        let cogging = KeptCogging {
            with: MeasuredWith::new(&settings, board),
            map: CoggingMap {
                harmonics: [harmonic].into_iter().collect(),
            },
        };
        let mut buffer = [0; IMAGE_MAX];
        let image = encode(&settings, &mut buffer).expect("room");
        let (version, stored) = content(image).expect("undamaged");
        assert_eq!(pinned(version, stored), (12, 277, 0x30f4_6c3e));
        let image = encode_with(&settings, &every_part(), &kept, Some(&cogging), &mut buffer);
        let (version, stored) = content(image.expect("room")).expect("undamaged");
        assert_eq!(pinned(version, stored), (12, 472, 0xa7b9_13f1));
    }

    #[test]
    fn a_stored_environment_that_is_not_valid_means_defaults_and_says_so() {
        let settings = DeviceSettings::defaults(Board::NucleoG474re);
        let with = |strength_n_m: &str| Surround {
            detents: Some(DetentsBeside {
                per_rev: 24,
                pitch_rad: Decimal(Si::ZERO),
                strength_n_m: Decimal(strength_n_m.parse().expect("a number")),
                centre_rad: Decimal(Si::ZERO),
            }),
            ..Surround::default()
        };
        let mut buffer = [0; IMAGE_MAX];
        let mut start_with = |environment: &Surround| {
            let kept = KeptStart::default();
            let image = encode_with(&settings, environment, &kept, None, &mut buffer);
            start(Some(image.expect("room")), settings.clone(), &|_| Ok(()))
        };
        let good = with("0.02");
        let start = start_with(&good);
        assert_eq!((start.environment, start.refused), (good, None));
        // More than the force limit.
        let start = start_with(&with("100"));
        assert_eq!(start.environment, Surround::default());
        match start.refused {
            Some(Refused::Invalid(why)) => assert_eq!(why.path, "environment.detents.strength_n_m"),
            other => panic!("{other:?}"),
        }
    }
}

//! The further parts of a knob's feel on the wire and in flash: spring to a centre, viscous and dry friction, click,
//! inertia.

use super::Decimal;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use touchstone_control::environment::{
    CentreSettings, ClickSettings, DrySettings, FeelSettings, InertiaSettings, Spacing,
    ViscousSettings,
};

/// The parts of a feel; on the wire five optional tuples of numbers, in the order of the fields of [`FeelSettings`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Parts(pub FeelSettings);

type Pair = (Decimal, Decimal);
/// The click's number of positions per turn (0: the next number is their distance in rad), distance, centre, strength, duration.
type Click = (u16, Decimal, Decimal, Decimal, Decimal);
type OnWire = (
    Option<(Decimal, Decimal, Decimal)>,
    Option<Pair>,
    Option<Pair>,
    Option<Click>,
    Option<Pair>,
);

impl Serialize for Parts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let FeelSettings {
            spring,
            viscous,
            dry,
            click,
            inertia,
        } = self.0;
        let on_wire: OnWire = (
            spring.map(|it| {
                (
                    Decimal(it.centre),
                    Decimal(it.stiffness),
                    Decimal(it.strength),
                )
            }),
            viscous.map(|it| (Decimal(it.damping), Decimal(it.bandwidth_hz))),
            dry.map(|it| (Decimal(it.strength), Decimal(it.stretch))),
            click.map(|it| {
                let (per_turn, pitch) = match it.spacing {
                    Spacing::PerTurn(per_turn) => (per_turn, Decimal::default()),
                    Spacing::Pitch(pitch) => (0, Decimal(pitch)),
                };
                (
                    per_turn,
                    pitch,
                    Decimal(it.centre),
                    Decimal(it.strength),
                    Decimal(it.duration_s),
                )
            }),
            inertia.map(|it| (Decimal(it.inertia), Decimal(it.bandwidth_hz))),
        );
        on_wire.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Parts {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (spring, viscous, dry, click, inertia) = OnWire::deserialize(deserializer)?;
        Ok(Self(FeelSettings {
            spring: spring.map(|(centre, stiffness, strength)| CentreSettings {
                centre: centre.0,
                stiffness: stiffness.0,
                strength: strength.0,
            }),
            viscous: viscous.map(|(damping, bandwidth_hz)| ViscousSettings {
                damping: damping.0,
                bandwidth_hz: bandwidth_hz.0,
            }),
            dry: dry.map(|(strength, stretch)| DrySettings {
                strength: strength.0,
                stretch: stretch.0,
            }),
            click: click.map(
                |(per_turn, pitch, centre, strength, duration_s)| ClickSettings {
                    spacing: match per_turn {
                        0 => Spacing::Pitch(pitch.0),
                        per_turn => Spacing::PerTurn(per_turn),
                    },
                    centre: centre.0,
                    strength: strength.0,
                    duration_s: duration_s.0,
                },
            ),
            inertia: inertia.map(|(inertia, bandwidth_hz)| InertiaSettings {
                inertia: inertia.0,
                bandwidth_hz: bandwidth_hz.0,
            }),
        }))
    }
}

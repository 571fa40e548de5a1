//! Translates a SmartKnob's configuration to an environment (detents, end stops) that a board renders.

use super::messages::KnobConfig;
use touchstone_control::Si;
use touchstone_control::environment::{MOST_POINTS, Shape, WHOLE};
use touchstone_protocol::settings::environment::{
    DetentsBeside, Points, ProfileBeside, Surround, TravelEnds,
};
use touchstone_protocol::{Decimal, DeviceSettings};
use touchstone_sim::positions::{MOST_HYSTERESIS, Positions};

/// Narrowest and widest distance between two positions that a board accepts, rad.
const WIDTHS: std::ops::RangeInclusive<f32> = 0.001..=std::f32::consts::TAU;
/// Number of a torque profile's points per position: the points are a third of a position's width apart.
const POINTS_A_POSITION: i64 = 3;

/// A SmartKnob's configuration translated for a board: the detents and end stops to render, and the angles of the positions.
#[derive(Debug)]
pub struct Played {
    /// The detents, end stops and torque profile that the board renders.
    pub environment: Surround,
    /// The positions with their angles, under the numbers that the configuration uses.
    pub positions: Positions,
    /// Notes on parts of the configuration that the board renders differently.
    pub notes: Vec<String>,
}

/// Stiffness and torque on this board for the strength values of a SmartKnob, which have no unit.
#[derive(Debug, Clone, Copy)]
pub struct Strength {
    /// Stiffness of a detent of strength 1 at its middle, N·m/rad.
    pub detent_n_m_per_rad: f64,
    /// Stiffness of an end stop of strength 1, N·m/rad: the same as that of the board's wall.
    pub endstop_n_m_per_rad: f64,
    /// Largest torque that the board may command, N·m.
    pub most_n_m: f64,
}

impl Strength {
    /// The strengths for a board with these settings.
    pub fn of(settings: &DeviceSettings, detent_n_m_per_rad: f64) -> Self {
        Self {
            detent_n_m_per_rad,
            endstop_n_m_per_rad: settings.wall.k_desired_n_m_per_rad.to_num(),
            most_n_m: settings.law.force_limit_n_m.to_num(),
        }
    }
}

/// Why a SmartKnob's configuration is invalid, as the text that is logged; `None` for a valid one. A SmartKnob itself makes the
/// same checks, but not whether all numbers are finite and the width is within `WIDTHS`.
pub fn refused(config: &KnobConfig) -> Option<&'static str> {
    let numbers = [
        config.position_width_radians,
        config.detent_strength_unit,
        config.endstop_strength_unit,
        config.snap_point,
        config.sub_position_unit,
        config.snap_point_bias,
    ];
    if numbers.iter().any(|number| !number.is_finite()) {
        Some("Ignoring invalid config: a number is not finite")
    } else if config.detent_strength_unit < 0.0 {
        Some("Ignoring invalid config: detent_strength_unit cannot be negative")
    } else if config.endstop_strength_unit < 0.0 {
        Some("Ignoring invalid config: endstop_strength_unit cannot be negative")
    } else if config.snap_point < 0.5 {
        Some("Ignoring invalid config: snap_point must be >= 0.5 for stability")
    } else if config.detent_positions.len() > 5 {
        Some("Ignoring invalid config: detent_positions_count is too large")
    } else if config.snap_point_bias < 0.0 {
        Some("Ignoring invalid config: snap_point_bias cannot be negative")
    } else if !WIDTHS.contains(&config.position_width_radians) {
        Some("Ignoring invalid config: position_width_radians is outside 0.001 to 6.283")
    } else {
        None
    }
}

/// Larger than the rounding of a sum of two of the configuration's `f32` numbers.
const ROUNDING: f64 = 1e-6;

/// Translates a SmartKnob's configuration to an environment (detents, end stops) in which `position` is at the angle `centre_rad`.
/// The configuration must have passed [`refused`].
pub fn played(config: &KnobConfig, position: i32, centre_rad: f64, strength: Strength) -> Played {
    let width = f64::from(config.position_width_radians);
    let place = |number: i64| centre_rad + (number - i64::from(position)) as f64 * width;
    let bounds = (config.min_position <= config.max_position)
        .then(|| [config.min_position, config.max_position].map(i64::from));
    let mut notes = Vec::new();
    let torque = detent_torque(config, width, strength, &mut notes);
    let is_magnetic = !config.detent_positions.is_empty();
    let mut positions = Positions::every(width, place(0));
    positions.hysteresis = f64::from(config.snap_point) - 0.5;
    positions.bias = f64::from(config.snap_point_bias);
    // A SmartKnob's detents move with its present position. The detents here stay, so from a snap point of 1 on the knob could rest in
    // a detent under its neighbour's number.
    if torque > 0.0 && positions.hysteresis + positions.bias > MOST_HYSTERESIS + ROUNDING {
        let (snap, bias) = (0.5 + positions.hysteresis, positions.bias);
        positions.hysteresis = positions.hysteresis.min(MOST_HYSTERESIS);
        positions.bias = MOST_HYSTERESIS - positions.hysteresis;
        let changes = |now: f64, wanted: f64| {
            let [now, wanted] = [now, wanted].map(|share| (1e3 * share).round() / 1e3);
            format!("{now} of the way to the next detent instead of {wanted}")
        };
        let mut note = format!(
            "the position changes at {}",
            changes(0.5 + MOST_HYSTERESIS, snap + bias)
        );
        if bias > 0.0 {
            let back = 0.5 + positions.hysteresis - positions.bias;
            note += &format!(", and back towards 0 at {}", changes(back, snap - bias));
        }
        notes.push(note);
    }
    positions.ends = bounds.map(|[first, last]| (first, last));
    let ends = bounds.filter(|_| config.endstop_strength_unit > 0.0);
    Played {
        environment: Surround {
            first_wall: false,
            endstops: ends.map(|[first, last]| TravelEnds {
                lower_rad: decimal(place(first)),
                // A knob with one position has equal ends, but the upper end must be above the lower one.
                upper_rad: decimal(place(last).max(place(first) + 1e-6)),
                stiffness_n_m_per_rad: Some(decimal(
                    f64::from(config.endstop_strength_unit) * strength.endstop_n_m_per_rad,
                )),
            }),
            detents: (torque > 0.0 && !is_magnetic).then(|| DetentsBeside {
                per_rev: 0,
                pitch_rad: decimal(width),
                strength_n_m: decimal(torque),
                centre_rad: decimal(place(i64::from(position))),
            }),
            profile: (torque > 0.0 && is_magnetic)
                .then(|| magnetic(config, position, &place, torque, &mut notes))
                .flatten(),
            ..Surround::default()
        },
        positions,
        notes,
    }
}

fn detent_torque(
    config: &KnobConfig,
    width: f64,
    strength: Strength,
    notes: &mut Vec<String>,
) -> f64 {
    // A triangular torque with this stiffness at its middle is largest a quarter of a width away from the middle.
    let stiffness = f64::from(config.detent_strength_unit) * strength.detent_n_m_per_rad;
    let torque = stiffness * width / 4.0;
    if torque > strength.most_n_m {
        notes.push(format!(
            "detents have {} N·m, the largest torque of the board, instead of {torque:.3}",
            strength.most_n_m
        ));
    }
    torque.min(strength.most_n_m)
}

/// Makes a torque profile with detents at only some of the positions. Each detent acts up to two thirds of a position's width from
/// its middle; beyond, the knob is free. `None` if no such profile is possible.
fn magnetic(
    config: &KnobConfig,
    position: i32,
    place: &dyn Fn(i64) -> f64,
    torque: f64,
    notes: &mut Vec<String>,
) -> Option<ProfileBeside> {
    // Keeps the detents nearest to `position`, as far as all kept ones fit into the points of one profile.
    let room = (MOST_POINTS as i64 - 5) / POINTS_A_POSITION;
    let mut wanted: Vec<i64> = config
        .detent_positions
        .iter()
        .copied()
        .map(i64::from)
        .collect();
    wanted.sort_unstable_by_key(|number| (number - i64::from(position)).abs());
    let (mut low, mut high) = (wanted.first().copied()?, wanted.first().copied()?);
    let all = wanted.len();
    wanted.retain(|number| {
        let (least, most) = (low.min(*number), high.max(*number));
        let fits = most - least <= room;
        if fits {
            (low, high) = (least, most);
        }
        fits
    });
    if wanted.len() < all {
        notes.push(format!(
            "only {} of {all} positions have a detent: too many for the board's table, so detents are up to {room} positions apart",
            wanted.len()
        ));
    }
    let mut points: Vec<i16> = vec![0; usize::try_from((high - low) * POINTS_A_POSITION + 5).ok()?];
    for number in &wanted {
        let middle = usize::try_from((number - low) * POINTS_A_POSITION + 2).ok()?;
        *points.get_mut(middle - 1)? = WHOLE;
        *points.get_mut(middle + 1)? = -WHOLE;
    }
    let third = f64::from(config.position_width_radians) / POINTS_A_POSITION as f64;
    Some(ProfileBeside {
        per_rev: 0,
        start_rad: decimal(place(low) - 2.0 * third),
        end_rad: decimal(place(high) + 2.0 * third),
        strength_n_m: decimal(torque),
        shape: Points(Shape::new(&points).ok()?),
    })
}

fn decimal(value: f64) -> Decimal {
    Decimal(Si::saturating_from_num(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A snap point beyond the distance of two positions holds where no detent pulls, and is shortened with a note where one does.
    #[test]
    fn a_snap_point_beyond_the_next_detent_is_shortened_and_noted() {
        let strength = Strength {
            detent_n_m_per_rad: 1.0,
            endstop_n_m_per_rad: 1.0,
            most_n_m: 0.1,
        };
        let out = "the position changes at 0.99 of the way to the next detent instead of";
        let back = |now, wanted| {
            format!(
                ", and back towards 0 at {now} of the way to the next detent instead of {wanted}"
            )
        };
        for (detent_strength_unit, snap_point, snap_point_bias, [hysteresis, bias], note) in [
            (0.0, 1.1, 0.0, [0.6, 0.0], None),
            (0.0, 1.1, 0.4, [0.6, 0.4], None),
            (1.0, 1.1, 0.0, [0.49, 0.0], Some(format!("{out} 1.1"))),
            (1.0, 0.75, 0.0, [0.25, 0.0], None),
            (1.0, 0.55, 0.4, [0.05, 0.4], None),
            // As `f32`, this number and this sum are above 0.99.
            (1.0, 0.99, 0.0, [0.49, 0.0], None),
            (1.0, 0.55, 0.44, [0.05, 0.44], None),
            (
                1.0,
                0.75,
                0.4,
                [0.25, 0.24],
                Some(format!("{out} 1.15") + &back(0.51, 0.35)),
            ),
            (
                1.0,
                1.1,
                0.4,
                [0.49, 0.0],
                Some(format!("{out} 1.5") + &back(0.99, 0.7)),
            ),
        ] {
            let config = KnobConfig {
                max_position: -1,
                position_width_radians: 0.1,
                detent_strength_unit,
                snap_point,
                snap_point_bias,
                ..KnobConfig::default()
            };
            let played = played(&config, 0, 0.0, strength);
            assert!(
                (played.positions.hysteresis - hysteresis).abs() < 1e-6
                    && (played.positions.bias - bias).abs() < 1e-6,
                "{snap_point}, {snap_point_bias}"
            );
            assert_eq!(played.notes, Vec::from_iter(note));
        }
    }
}

//! The scorecard of a knob's feel: how well the hand feels its torque, whether the knob rests, and whether a program counts its
//! positions correctly.
//!
//! Three simulated grips turn the knob slowly, rest on it, and spin it. The commanded torque is compared with the drawn torque.
//! The drawn torque is that of the same settings in 64-bit floats, at the true angle, in the same tick and without the energy
//! guard.

use serde::Serialize;
use std::f64::consts::TAU;
use touchstone_control::environment::Environment;
use touchstone_sim::error::Result;
use touchstone_sim::positions::{HYSTERESIS, Positions};
use touchstone_sim::run::live::Live;
use touchstone_sim::run::surroundings::{Placed, environment};
use touchstone_sim::scene::{Grip, Scene};

use super::cases::GRIPS;

/// Speed of the hand's rest point in the slow turn, rad/s.
const SLOW_RAD_PER_S: f64 = 0.5;
/// Speeds at which the hand spins the knob, rad/s. People turn knobs at 1 to 10 rad/s; a flick reaches 20.
const SPINS_RAD_PER_S: [f64; 4] = [2.0, 5.0, 10.0, 20.0];
/// Acceleration of the hand's rest point, rad/s².
const ACCELERATION_RAD_PER_S2: f64 = 100.0;
/// Time for which the hand rests, s. Buzz (motion of a knob at rest) is measured in the second half.
const REST_S: f64 = 4.0;
/// Distance from an end stop within which torques are not compared, rad. A wall's law on estimated states pushes before its
/// surface.
const NEAR_A_WALL_RAD: f64 = 0.1;
/// Rate at which a program reads the knob's angle, Hz: that of `touchstone events`.
const READ_HZ: f64 = 250.0;
/// Fraction of the distance between positions by which the knob must turn back between two opposite changes of the counted
/// position. It is twice the hysteresis, less the motion between two readings.
const TURNED_BACK: f64 = 0.4;
/// Angle by which the slow turn goes to either side in a feel without positions, rad.
const SLOW_TURN_RAD: f64 = 1.5;
/// Width of the angle ranges in which both directions of the slow turn are compared, encoder counts.
const BIN_COUNTS: f64 = 4.0;

/// The scorecard of a feel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FeelCard {
    /// Name of the scene.
    pub scene: String,
    /// Angle between two positions, rad; `None` if the feel has no positions.
    pub pitch_rad: Option<f64>,
    /// Results for each grip.
    pub grips: Vec<Felt>,
}

/// Results for a feel with one grip.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Felt {
    /// The grip's name.
    pub grip: &'static str,
    /// Largest drawn torque in the slow turn, away from end stops, N·m.
    pub drawn_n_m: f64,
    /// Largest commanded torque divided by the largest drawn torque; `None` if the drawn torque is zero.
    pub peak_share: Option<f64>,
    /// Largest difference between commanded and drawn torque, divided by the largest drawn torque; `None` if the drawn torque is
    /// zero.
    pub off_share: Option<f64>,
    /// Largest difference between the mean commanded torques of the two directions at one angle, N·m.
    pub hysteresis_n_m: f64,
    /// Largest peak-to-peak motion at rest, encoder counts. The hand rests at a position, and at two fifths of the way to the
    /// next.
    pub buzz_counts: f64,
    /// Largest speed of the knob in the slow turn, rad/s: how fast it snaps into the next position.
    pub snap_rad_per_s: f64,
    /// Number of positions that the program counted while the knob was spun.
    pub crossings: u64,
    /// Number of readings in which the counted position was not that of the knob.
    pub lost: u64,
    /// Number of times that the counted position changed back although the knob did not turn back.
    pub doubled: u64,
    /// Fraction of the ticks at each spinning speed in which the energy guard reduced the torque.
    pub limited_share: [f64; SPINS_RAD_PER_S.len()],
    /// Most energy that the hand got out beyond what it had put in since the start, J.
    pub energy_out_j: f64,
    /// Energy that the guard allows until the end, J: its capacity, and its refill over the time. Infinite without a guard.
    pub energy_allowed_j: f64,
}

impl Felt {
    /// Whether every position was counted exactly once.
    #[must_use]
    pub const fn counts_right(&self) -> bool {
        self.lost == 0 && self.doubled == 0
    }
}

/// A simulated knob in the hand, with what was measured so far.
struct Hand {
    live: Live,
    drawn: Environment<f64>,
    rest_rad: f64,
    speed_rad_per_s: f64,
    period_s: f64,
    surface_rad: f64,
    ends: (f64, f64),
    /// Angle of the knob at the start, rad; the hand moves around it.
    start_rad: f64,
    guard_j: (f64, f64),
    energy_out_j: f64,
}

/// Result of one simulated tick.
struct Given {
    angle_rad: f64,
    velocity_rad_per_s: f64,
    told_rad: f64,
    force_n_m: f64,
    drawn_n_m: f64,
    limited: bool,
}

impl Hand {
    fn new(scene: &Scene) -> Result<Self> {
        let exact = scene.with(|it| {
            it.law.guard.on = false;
            it.encoder = None;
        })?;
        let around = scene.environment.clone().unwrap_or_default();
        let ends = around.endstops.as_ref();
        let guard = &scene.law.guard;
        let start_rad = scene.device.initial_angle_rad.unwrap_or(0.0);
        Ok(Self {
            live: Live::new(scene)?,
            drawn: environment::<f64>(&exact)?,
            rest_rad: start_rad,
            start_rad,
            speed_rad_per_s: 0.0,
            period_s: scene.timing.period_s(),
            surface_rad: scene.wall.surface_rad,
            ends: ends.map_or((f64::MIN, f64::MAX), |ends| {
                (ends.lower_rad, ends.upper_rad)
            }),
            guard_j: match guard.on {
                true => (guard.capacity_j, guard.refill_w),
                false => (f64::INFINITY, 0.0),
            },
            energy_out_j: 0.0,
        })
    }

    fn tick(&mut self) -> Given {
        self.rest_rad += self.speed_rad_per_s * self.period_s;
        let moment = self.live.tick(self.rest_rad);
        let tick = moment.tick;
        self.energy_out_j = self.energy_out_j.max(-moment.energies.hand_j());
        let drawn = self.drawn.tick(&Placed(tick.angle_rad), None);
        Given {
            angle_rad: tick.angle_rad,
            velocity_rad_per_s: tick.velocity_rad_per_s,
            told_rad: tick.told_rad + self.surface_rad,
            force_n_m: tick.force_n_m,
            drawn_n_m: drawn.to_f64(),
            limited: tick.inside.guard.is_some_and(|guard| guard.limited),
        }
    }

    fn is_free(&self, angle_rad: f64) -> bool {
        let (lower, upper) = self.ends;
        lower + NEAR_A_WALL_RAD < angle_rad && angle_rad < upper - NEAR_A_WALL_RAD
    }

    /// Moves the rest point towards `to_rad` at a speed until it arrives; calls `each` with every tick.
    fn go(&mut self, to_rad: f64, speed_rad_per_s: f64, mut each: impl FnMut(&mut Self, &Given)) {
        let way = (to_rad - self.rest_rad).signum();
        let step = ACCELERATION_RAD_PER_S2 * self.period_s;
        while (to_rad - self.rest_rad) * way > 0.0 {
            let more = way * speed_rad_per_s - self.speed_rad_per_s;
            self.speed_rad_per_s += more.clamp(-step, step);
            let given = self.tick();
            each(self, &given);
        }
        self.speed_rad_per_s = 0.0;
    }

    /// Keeps the rest point for some seconds; returns the knob's peak-to-peak motion in the second half, rad.
    fn rest(&mut self, seconds: f64) -> f64 {
        let ticks = (seconds / self.period_s) as u64;
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for tick in 0..ticks {
            let given = self.tick();
            if tick >= ticks / 2 {
                least = least.min(given.angle_rad);
                most = most.max(given.angle_rad);
            }
        }
        most - least
    }
}

/// Judges a feel in three grips. If the feel has positions, each grip also spins the knob in rounds, until `crossings` positions
/// were counted or a round counts none.
///
/// # Errors
/// The scene cannot be run.
pub fn feel_card(scene: &Scene, crossings: u64) -> Result<FeelCard> {
    let around = scene.environment.clone().unwrap_or_default();
    let positions = Positions::of(&around);
    let felt = GRIPS.map(|grip| felt(scene, grip, positions, crossings));
    Ok(FeelCard {
        scene: scene.name.clone(),
        pitch_rad: positions.map(|it| it.pitch_rad),
        grips: felt.into_iter().collect::<Result<_>>()?,
    })
}

fn felt(scene: &Scene, grip: Grip, positions: Option<Positions>, crossings: u64) -> Result<Felt> {
    let scene = scene.with(|it| {
        it.operator.grip = grip;
        it.operator.hand = None;
    })?;
    let count_rad = (scene.encoder.as_ref()).map_or(TAU / 40_000.0, |it| it.step_rad());
    let mut hand = Hand::new(&scene)?;
    let (lower, upper) = hand.ends;
    let turn_rad = match positions {
        Some(it) => (6.0 * it.pitch_rad).max(0.5),
        None => SLOW_TURN_RAD,
    };
    // The hand may push against an end stop, but must not turn the knob through it.
    let start_rad = hand.start_rad;
    let (low, high) = (
        (start_rad - turn_rad).max(lower - 0.2),
        (start_rad + turn_rad).min(upper + 0.2),
    );
    let mut felt = Felt {
        grip: grip.name(),
        drawn_n_m: 0.0,
        peak_share: None,
        off_share: None,
        hysteresis_n_m: 0.0,
        buzz_counts: 0.0,
        snap_rad_per_s: 0.0,
        crossings: 0,
        lost: 0,
        doubled: 0,
        limited_share: [0.0; SPINS_RAD_PER_S.len()],
        energy_out_j: 0.0,
        energy_allowed_j: 0.0,
    };
    slow(&mut hand, &mut felt, (low, high), BIN_COUNTS * count_rad);
    let pitch_rad = positions.map_or(0.5, |it| it.pitch_rad);
    for share in [0.0, 0.4] {
        let origin_rad = positions.map_or(start_rad, |it| it.angle_of(it.nearest_to(start_rad)));
        hand.go(origin_rad + share * pitch_rad, SLOW_RAD_PER_S, |_, _| {});
        felt.buzz_counts = felt.buzz_counts.max(hand.rest(REST_S) / count_rad);
    }
    if let Some(positions) = positions {
        spin(&mut hand, &mut felt, positions, count_rad, crossings);
    }
    let (capacity_j, refill_w) = hand.guard_j;
    felt.energy_out_j = hand.energy_out_j;
    felt.energy_allowed_j = capacity_j + refill_w * hand.live.ticks() as f64 * hand.period_s;
    Ok(felt)
}

/// Turns the knob slowly to and fro, and compares the commanded torque with the drawn torque.
fn slow(hand: &mut Hand, felt: &mut Felt, (low, high): (f64, f64), bin_rad: f64) {
    let bins = ((high - low) / bin_rad).ceil() as usize + 1;
    let mut means = [(); 2].map(|()| vec![(0.0, 0_u32); bins]);
    let (mut most, mut off) = (0.0_f64, 0.0_f64);
    hand.go(low, SLOW_RAD_PER_S, |_, _| {});
    for (to, means) in [high, low].into_iter().zip(&mut means) {
        hand.go(to, SLOW_RAD_PER_S, |hand, given| {
            if !hand.is_free(given.angle_rad) {
                return;
            }
            felt.drawn_n_m = felt.drawn_n_m.max(given.drawn_n_m.abs());
            felt.snap_rad_per_s = felt.snap_rad_per_s.max(given.velocity_rad_per_s.abs());
            most = most.max(given.force_n_m.abs());
            off = off.max((given.force_n_m - given.drawn_n_m).abs());
            let bin = (given.angle_rad - low) / bin_rad;
            if let Some((sum, ticks)) = means.get_mut(bin as usize).filter(|_| bin >= 0.0) {
                (*sum, *ticks) = (*sum + given.force_n_m, *ticks + 1);
            }
        });
    }
    let [up, down] = means;
    for (up, down) in up.iter().zip(&down) {
        if up.1 > 0 && down.1 > 0 {
            let apart = (up.0 / f64::from(up.1) - down.0 / f64::from(down.1)).abs();
            felt.hysteresis_n_m = felt.hysteresis_n_m.max(apart);
        }
    }
    if felt.drawn_n_m > 0.0 {
        felt.peak_share = Some(most / felt.drawn_n_m);
        felt.off_share = Some(off / felt.drawn_n_m);
    }
}

/// Spins the knob to and fro at several speeds, while a program counts its positions.
fn spin(hand: &mut Hand, felt: &mut Felt, positions: Positions, count_rad: f64, crossings: u64) {
    let (lower, upper) = hand.ends;
    let pitch_rad = positions.pitch_rad;
    let each = (READ_HZ.recip() / hand.period_s).round().max(1.0) as u64;
    let turn_rad = (24.0 * pitch_rad).max(6.0);
    let (low, high) = (
        (hand.start_rad - turn_rad).max(lower),
        (hand.start_rad + turn_rad).min(upper),
    );
    let mut counter = positions;
    counter.hysteresis = HYSTERESIS;
    let mut ticks = 0_u64;
    // Direction of the last change of the counted position, and the knob's angle at that change.
    let mut changed = (0, 0.0);
    let mut limited = [(0_u64, 0_u64); SPINS_RAD_PER_S.len()];
    let mut read = |felt: &mut Felt, given: &Given| {
        ticks += 1;
        if !ticks.is_multiple_of(each) {
            return;
        }
        if let Some(place) = counter.take(given.told_rad) {
            felt.crossings += place.change.unsigned_abs();
            let (change, at_rad) = changed;
            let is_back = place.change * change < 0;
            let turned = (given.angle_rad - at_rad).abs() / pitch_rad;
            felt.doubled += u64::from(is_back && turned < TURNED_BACK);
            changed = (place.change, given.angle_rad);
        }
        // Beyond an end the counted position must stay the last one.
        let inside = given.angle_rad.clamp(lower, upper);
        let inside = match positions.listed_between() {
            Some((first, last)) => inside.clamp(first, last),
            None => inside,
        };
        let beside = counter.beside(inside).abs();
        // The angle that the encoder reports is exact to one count.
        felt.lost += u64::from(beside > 0.5 + HYSTERESIS + count_rad / pitch_rad);
    };
    let mut round = 0;
    loop {
        let before = felt.crossings;
        for (speed, (limited, all)) in SPINS_RAD_PER_S.into_iter().zip(&mut limited) {
            for to in [high, low] {
                hand.go(to, speed, |_, given| {
                    read(felt, given);
                    (*limited, *all) = (*limited + u64::from(given.limited), *all + 1);
                });
            }
        }
        round += 1;
        // A hand that cannot leave a position counts none.
        if felt.crossings >= crossings || felt.crossings == before || round > 100_000 {
            break;
        }
    }
    felt.limited_share = limited.map(|(limited, all)| limited as f64 / all.max(1) as f64);
}

//! Detents at listed angles, each with its own torque and width. This file converts the list to a torque profile, which the control
//! law of every board can render.

use super::problem::Problem;
use super::torque_profile::TorqueProfile;
use serde::{Deserialize, Serialize};
use touchstone_control::environment::MOST_POINTS;

/// Largest number of detents in a list.
pub const MOST_DETENTS: usize = 16;

/// Largest allowed loss of a detent's largest torque in the profile, as a fraction of the listed torque.
const PEAK_OFF: f64 = 0.05;
/// Largest allowed distance from a listed angle to the angle at which the knob rests in the profile, as a fraction of the detent's
/// width.
const REST_OFF: f64 = 0.01;
/// Angles that differ by at most this value count as equal, rad.
const SAME_RAD: f64 = 1e-6;

/// Detents at listed angles. Each detent pulls the knob to its angle within half its width to either side. The torque is largest at
/// a quarter of the width. Between two detents with a gap the knob turns freely.
///
/// The list takes the place of `[environment.profile]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DetentList {
    /// Angles of 1 to 16 detents, rad, rising. Default: five, 30° apart, from -60° to 60°.
    pub positions_rad: Vec<f64>,
    /// Largest torque of each detent, N·m, from 0 to the force limit of the control law. A single value applies to all. Default
    /// 0.02.
    pub strengths_n_m: Vec<f64>,
    /// Width of each detent, rad. A single value applies to all. Neighbours may touch, but not overlap. Default 30°, so that the
    /// five default detents touch.
    pub widths_rad: Vec<f64>,
}

impl Default for DetentList {
    fn default() -> Self {
        let step = 30_f64.to_radians();
        DetentList {
            positions_rad: (-2..=2).map(|i| nine(f64::from(i) * step)).collect(),
            strengths_n_m: vec![0.02],
            widths_rad: vec![nine(step)],
        }
    }
}

/// Rounds a number to the nine decimals that scenes print.
fn nine(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}

/// One detent of a list.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Detent {
    at: f64,
    strength: f64,
    width: f64,
}

const POSITIONS: &str = "environment.detent_list.positions_rad";
const STRENGTHS: &str = "environment.detent_list.strengths_n_m";
const WIDTHS: &str = "environment.detent_list.widths_rad";

impl DetentList {
    /// Whether any detent has a torque above 0.
    #[must_use]
    pub fn acts(&self) -> bool {
        self.strengths_n_m.iter().any(|it| *it > 0.0)
    }

    fn detents(&self) -> Result<Vec<Detent>, Problem> {
        let count = self.positions_rad.len();
        for (path, list) in [(STRENGTHS, &self.strengths_n_m), (WIDTHS, &self.widths_rad)] {
            if list.len() != 1 && list.len() != count {
                let problem = format!("{} values for {count} detents", list.len());
                return Err(Problem::new(
                    path,
                    problem,
                    "give one value, or one for each detent",
                ));
            }
        }
        let of = |list: &[f64], i: usize| list.get(i).or(list.first()).copied().unwrap_or(0.0);
        let detents: Vec<Detent> = (self.positions_rad.iter().enumerate())
            .map(|(i, at)| Detent {
                at: *at,
                strength: of(&self.strengths_n_m, i),
                width: of(&self.widths_rad, i),
            })
            .collect();
        for (i, pair) in detents.windows(2).enumerate() {
            let [a, b] = [pair[0], pair[1]];
            if b.at <= a.at {
                let problem = format!("must rise, but {} rad follows {} rad", b.at, a.at);
                return Err(Problem::new(
                    POSITIONS,
                    problem,
                    "write the angles in rising order",
                ));
            }
            if a.at + a.width / 2.0 > b.at - b.width / 2.0 + SAME_RAD {
                let (first, second, apart) = (i + 1, i + 2, b.at - a.at);
                let both = 0.5 * (a.width + b.width);
                let problem = format!(
                    "detents {first} and {second} overlap: they are {apart:.4} rad apart, half their widths together is {both:.4} rad"
                );
                let fix = format!("make them narrower, at most {:.4} rad", floor(apart, 1e4));
                return Err(Problem::new(WIDTHS, problem, fix));
            }
        }
        Ok(detents)
    }

    /// The angles at which the knob rests, rad.
    #[must_use]
    pub fn rests(&self) -> &[f64] {
        &self.positions_rad
    }

    /// Converts the list to a torque profile that is not repeated.
    ///
    /// The profile's points are equally spaced. A corner is an end, a largest torque or the rest of a listed detent. The number of
    /// points is the smallest at which every corner lies on a point, else that at which the worst corner is nearest to a point. The
    /// points on both sides of a detent's angle have its listed stiffness, so the torque is 0 exactly at the angle. The point
    /// nearest to a largest torque has that torque.
    ///
    /// # Errors
    /// The lists do not match each other, or a detent is too narrow for the distance between the profile's points.
    pub(crate) fn profile(&self) -> Result<TorqueProfile, Problem> {
        let detents = self.detents()?;
        let (Some(first), Some(last)) = (detents.first(), detents.last()) else {
            let fix = "give at least one angle";
            return Err(Problem::new(POSITIONS, "has no detent", fix));
        };
        let start = first.at - first.width / 2.0;
        let end = last.at + last.width / 2.0;
        let steps = steps(&detents, start, end);
        let step = (end - start) / steps as f64;
        let most = detents.iter().map(|it| it.strength).fold(0.0, f64::max);
        let mut torques = vec![0.0; steps + 1];
        for detent in &detents {
            detent.draw(&mut torques, start, step);
        }
        // Beyond its ends a profile keeps the torque of its end points, so these are set to 0.
        (torques[0], torques[steps]) = (0.0, 0.0);
        for (i, detent) in detents.iter().enumerate() {
            if let Some(off) = detent.off(&torques, start, step) {
                let least = (8.0 * (end - start) / (MOST_POINTS - 1) as f64 * 1e4).ceil() / 1e4;
                return Err(Problem::new(
                    WIDTHS,
                    format!(
                        "detent {} of {} rad is too narrow for a list that spans {:.4} rad and has {MOST_POINTS} points: {off}",
                        i + 1,
                        detent.width,
                        end - start,
                    ),
                    format!(
                        "make it at least {least} rad wide, or make all distances and quarters of widths multiples of one angle"
                    ),
                ));
            }
        }
        Ok(TorqueProfile {
            per_rev: 0,
            start_rad: start,
            end_rad: end,
            strength_n_m: most,
            shape: torques
                .iter()
                .map(|it| if most > 0.0 { it / most } else { 0.0 })
                .collect(),
        })
    }
}

fn floor(value: f64, per: f64) -> f64 {
    (value * per).floor() / per
}

/// The number of steps between the first and the last point of the profile.
fn steps(detents: &[Detent], start: f64, end: f64) -> usize {
    let length = end - start;
    let corners = detents.iter().flat_map(|it| {
        let quarter = it.width / 4.0;
        [-2.0, -1.0, 0.0, 1.0, 2.0].map(|by| (it.at + by * quarter, quarter))
    });
    let corners: Vec<(f64, f64)> = corners.collect();
    // Distance from the worst corner to the nearest point, in quarters of its detent's width.
    let worst = |steps: usize| {
        let step = length / steps as f64;
        let off = corners.iter().map(|(at, quarter)| {
            let place = (at - start) / step;
            // A detent needs points at its largest torques.
            let coarse = if step > quarter * (1.0 + 1e-6) {
                step / quarter
            } else {
                0.0
            };
            coarse + (place - place.round()).abs() * step / quarter
        });
        off.fold(0.0, f64::max)
    };
    let mut best = (f64::INFINITY, MOST_POINTS - 1);
    for steps in 4..MOST_POINTS {
        let off = worst(steps);
        // Of equally good numbers the smallest is kept.
        if off < best.0 - 1e-6 {
            best = (off, steps);
        }
    }
    best.1
}

impl Detent {
    /// Writes the detent's torque, positive towards larger angles, to the points of the profile.
    fn draw(&self, torques: &mut [f64], start: f64, step: f64) {
        let quarter = self.width / 4.0;
        for (i, torque) in torques.iter_mut().enumerate() {
            let beside = start + step * i as f64 - self.at;
            let size = beside.abs() / quarter;
            if size < 2.0 {
                let share = if size <= 1.0 { size } else { 2.0 - size };
                *torque = -beside.signum() * share * self.strength;
            }
        }
        for side in [-1.0, 1.0] {
            let peak = ((self.at + side * quarter - start) / step).round();
            let beside = start + step * peak - self.at;
            // A point next to the detent's angle keeps the torque of the stiffness, unless it is exactly at the largest torque.
            if (beside.abs() > step || (beside.abs() / quarter - 1.0).abs() < 1e-6)
                && let Some(torque) = torques.get_mut(peak as usize)
            {
                *torque = -side * self.strength;
            }
        }
    }

    /// Text on the property of the drawn detent that differs too much from the listed one; `None` if all are within their limits.
    fn off(&self, torques: &[f64], start: f64, step: f64) -> Option<String> {
        let place = |at: f64| (at - start) / step;
        let at = |at: f64| {
            let place = place(at).clamp(0.0, (torques.len() - 1) as f64);
            let before = place.floor() as usize;
            let after = (before + 1).min(torques.len() - 1);
            torques[before] + (torques[after] - torques[before]) * (place - before as f64)
        };
        let (from, to) = (self.at - self.width / 2.0, self.at + self.width / 2.0);
        for side in [(from, 1.0), (to, -1.0)] {
            let (end, sign) = side;
            let points = torques.iter().enumerate().filter(|(i, _)| {
                let angle = start + step * *i as f64;
                angle > self.at.min(end) - SAME_RAD && angle < self.at.max(end) + SAME_RAD
            });
            let most = points.map(|(_, it)| it * sign).fold(0.0, f64::max);
            if most < self.strength * (1.0 - PEAK_OFF) {
                let share = 100.0 * most / self.strength;
                return Some(format!("it would give {share:.0} % of its torque"));
            }
        }
        // The stiffness at rest is 4 strength / width. Torque over stiffness is the distance from the listed angle to the rest.
        let beside = at(self.at).abs() * self.width / 4.0 / self.strength.max(f64::MIN_POSITIVE);
        (beside > REST_OFF * self.width)
            .then(|| format!("it would rest {beside:.4} rad beside its angle"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(positions: &[f64], strengths: &[f64], widths: &[f64]) -> DetentList {
        DetentList {
            positions_rad: positions.to_vec(),
            strengths_n_m: strengths.to_vec(),
            widths_rad: widths.to_vec(),
        }
    }

    /// The listed torque at an angle.
    fn listed(list: &DetentList, angle: f64) -> f64 {
        let mut sum = 0.0;
        for it in list.detents().unwrap() {
            let size = (angle - it.at) / (it.width / 4.0);
            let share = match size.abs() {
                size if size <= 1.0 => size,
                size => (2.0 - size).max(0.0),
            };
            sum -= size.signum() * share * it.strength;
        }
        sum
    }

    fn drawn(profile: &TorqueProfile, angle: f64) -> f64 {
        let last = profile.shape.len() - 1;
        let length = profile.end_rad - profile.start_rad;
        let place = ((angle - profile.start_rad) / length).clamp(0.0, 1.0) * last as f64;
        let before = (place as usize).min(last - 1);
        let [a, b] = [profile.shape[before], profile.shape[before + 1]];
        profile.strength_n_m * (a + (b - a) * (place - before as f64))
    }

    #[test]
    fn a_list_on_a_grid_is_drawn_exactly() {
        let detents = list(
            &[-0.6, 0.0, 0.4, 1.2],
            &[0.01, 0.02, 0.03, 0.02],
            &[0.4, 0.4, 0.4, 0.8],
        );
        let profile = detents.profile().unwrap();
        assert!(profile.shape.len() <= 30, "{}", profile.shape.len());
        for i in -1500..2000 {
            let angle = f64::from(i) * 1e-3;
            let off = drawn(&profile, angle) - listed(&detents, angle);
            assert!(off.abs() < 1e-9, "{angle}: {off}");
        }
        // Sixteen detents that touch.
        let many: Vec<f64> = (0..16).map(f64::from).collect();
        let profile = list(&many, &[0.02], &[1.0]).profile().unwrap();
        assert_eq!(profile.shape.len(), 65);
    }

    #[test]
    fn a_list_beside_every_grid_rests_where_it_says() {
        let positions = [0.0, 0.317, 0.911, 1.113, 1.9];
        let detents = list(
            &positions,
            &[0.02, 0.01, 0.02, 0.015, 0.02],
            &[0.21, 0.23, 0.19, 0.21, 0.3],
        );
        let profile = detents.profile().unwrap();
        for (i, at) in positions.iter().enumerate() {
            assert!(drawn(&profile, *at).abs() < 1e-6, "{i}");
            let (strength, width) = (
                detents.detents().unwrap()[i].strength,
                detents.detents().unwrap()[i].width,
            );
            let slope = (drawn(&profile, at - 0.005) - drawn(&profile, at + 0.005)) / 0.01;
            assert!(
                (slope / (4.0 * strength / width) - 1.0).abs() < 0.01,
                "{i}: {slope}"
            );
            for side in [-1.0, 1.0] {
                let most = (0..100)
                    .map(|i| -side * drawn(&profile, at + side * width / 200.0 * f64::from(i)))
                    .fold(0.0, f64::max);
                assert!(
                    (most / strength - 1.0).abs() < 0.05,
                    "{i}: {most} of {strength}"
                );
            }
        }
        // Between two detents that do not touch, the knob turns freely.
        assert!(drawn(&profile, 1.5).abs() < 1e-12 && drawn(&profile, 2.4).abs() < 1e-12);
    }

    /// The worst values over all detents of a list. First: loss of the largest torque in the profile, as a fraction of the listed
    /// torque. Second: distance from the listed angle to the rest, as a fraction of the width.
    fn worst(list: &DetentList, profile: &TorqueProfile) -> [f64; 2] {
        let mut worst = [0.0_f64; 2];
        for it in list.detents().unwrap() {
            for side in [-1.0, 1.0] {
                let torque = |i: i32| drawn(profile, it.at + side * it.width * f64::from(i) / 8e3);
                let most = (0..=4000).map(|i| -side * torque(i)).fold(0.0, f64::max);
                worst[0] = worst[0].max(1.0 - most / it.strength);
            }
            worst[1] = worst[1].max(drawn(profile, it.at).abs() / it.strength / 4.0);
        }
        worst
    }

    /// Tests random lists whose angles and widths have no common grid. An accepted list keeps its torques and rest angles within
    /// the limits. A refused list is accepted after its remedy was followed at most three times.
    #[test]
    fn a_list_without_a_grid_keeps_its_torques_or_has_a_remedy() {
        let mut bits = 1_u64;
        let mut random = |from: f64, to: f64| {
            bits = bits
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            from + (to - from) * (bits >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (mut refused, mut weakest) = (0, 0.0_f64);
        for _ in 0..300 {
            let count = 1 + random(0.0, 5.0) as usize;
            let mut widths: Vec<f64> = (0..count).map(|_| random(0.05, 0.4)).collect();
            let strengths: Vec<f64> = (0..count).map(|_| random(0.005, 0.05)).collect();
            let gaps: Vec<f64> = (1..count).map(|_| random(0.0, 0.3)).collect();
            let first = random(-3.0, 3.0);
            let placed = |widths: &[f64]| {
                let mut positions = vec![first];
                for (pair, gap) in widths.windows(2).zip(&gaps) {
                    positions
                        .push(positions[positions.len() - 1] + 0.5 * (pair[0] + pair[1]) + gap);
                }
                list(&positions, &strengths, widths)
            };
            // Wider detents make the list longer, and a longer list needs wider detents.
            for _ in 0..3 {
                let Err(no) = placed(&widths).profile() else {
                    break;
                };
                refused += 1;
                let least = no.fix.strip_prefix("make it at least ").unwrap();
                let least: f64 = least.split(' ').next().unwrap().parse().unwrap();
                widths.iter_mut().for_each(|it| *it = it.max(least));
            }
            let it = placed(&widths);
            let profile = it
                .profile()
                .unwrap_or_else(|no| panic!("{}: {it:?}", no.problem));
            assert!(profile.shape.len() <= MOST_POINTS);
            let [weaker, beside] = worst(&it, &profile);
            assert!(weaker <= PEAK_OFF && beside <= REST_OFF, "{it:?}");
            weakest = weakest.max(weaker);
        }
        assert!(refused > 10 && weakest > 0.01, "{refused}, {weakest}");
    }

    #[test]
    fn a_list_without_torque_is_a_profile_of_zeros() {
        let none = list(&[0.0, 1.0], &[0.0], &[0.4]);
        assert!(!none.acts() && list(&[0.0, 1.0], &[0.0, 0.1], &[0.4]).acts());
        let profile = none.profile().unwrap();
        assert!(profile.shape.iter().all(|it| *it == 0.0), "{profile:?}");
    }

    /// Tests that detents are accepted that touch except for rounding errors.
    #[test]
    fn neighbours_may_touch() {
        assert_eq!(DetentList::default().profile().unwrap().shape.len(), 21);
        let tenths: Vec<f64> = (0..16).map(|i| f64::from(i) * 0.1 - 0.7).collect();
        assert!(list(&tenths, &[0.02], &[0.1]).profile().is_ok());
    }

    #[test]
    fn what_does_not_fit_is_refused_with_a_remedy() {
        let refused = |it: DetentList| {
            let no = it.profile().unwrap_err();
            format!(
                "{}: {}; {}",
                no.path.rsplit('.').next().unwrap(),
                no.problem,
                no.fix
            )
        };
        for (it, words) in [
            (
                list(&[0.0, 1.0], &[0.1; 3], &[0.2]),
                "strengths_n_m: 3 values for 2 detents; give one value",
            ),
            (
                list(&[1.0, 0.0], &[0.1], &[0.2]),
                "positions_rad: must rise",
            ),
            (
                list(&[1.0, 1.0], &[0.1], &[0.2]),
                "positions_rad: must rise",
            ),
            (
                list(&[0.0, 1.0], &[0.1], &[1.0, 0.2, 0.2]),
                "widths_rad: 3 values for 2 detents",
            ),
            (
                list(&[0.0, 1.0], &[0.1], &[1.2]),
                "widths_rad: detents 1 and 2 overlap",
            ),
            (
                list(&[0.0, 6.1234], &[0.1], &[0.0517]),
                "widths_rad: detent 1 of 0.0517 rad is too narrow",
            ),
            (list(&[], &[0.1], &[0.2]), "positions_rad: has no detent"),
        ] {
            let told = refused(it);
            assert!(told.starts_with(words), "{told}");
        }
    }
}

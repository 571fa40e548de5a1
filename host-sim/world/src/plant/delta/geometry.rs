//! Where the joints of a delta are for a place of its effector, and back.
//!
//! Each leg has a frame of its own: `u` away from the base's centre through its motor, `v` across, `w` up. With an arm of `a` at an angle `θ`, the
//! forearm closes the loop where (Stamper, *A three degree of freedom parallel manipulator with only translational degrees of freedom*,
//! University of Maryland, PhD 97-4, 1997)
//!
//! ```text
//! (u - a cos θ)² + (w - a sin θ)² = L²        L = ends + sqrt(b² - v²)
//! ```
//!
//! which is linear in `cos θ` and `sin θ`: the joints of a place are known in closed form. Back it goes by Newton's method. Its first
//! derivative gives the rows of the joints' slopes, radians per metre, and its second their curvature.

use nalgebra::{Matrix3, Vector3};

/// Lengths of a delta.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeltaGeometry {
    /// Arm, from the motor's axis to the elbow, m.
    pub arm_m: f64,
    /// Long sides of the parallelogram, m.
    pub forearm_m: f64,
    /// From the axes of elbow and effector to the parallelogram's short sides, both together, m.
    pub ends_m: f64,
    /// From the base's centre to each motor's axis, less that from the effector's centre to its joints, m.
    pub reach_m: f64,
    /// Sideways distance of the legs' joints at the effector from those at the base, m.
    pub aside_m: f64,
    /// Directions of the legs around the vertical, rad.
    pub legs_rad: [f64; 3],
    /// Height of the origin above the base, m.
    pub height_m: f64,
}

/// The Novint Falcon's, as libnifalcon has it (`FalconGeometry.h`, after Stamper): arm 60 mm, forearm 102.5 and twice 11.25 mm, motors at 40 mm,
/// effector's joints at 14.43 mm, -23.09 and 25 mm aside. Its origin is put 120 mm above the base.
pub const FALCON_GEOMETRY: DeltaGeometry = DeltaGeometry {
    arm_m: 0.060,
    forearm_m: 0.1025,
    ends_m: 2.0 * 0.01125,
    reach_m: 0.040 - 0.01443,
    aside_m: 0.02309 - 0.025,
    // 90°, -30° and -150°, each 15° on.
    legs_rad: [
        105.0 * std::f64::consts::PI / 180.0,
        -15.0 * std::f64::consts::PI / 180.0,
        -135.0 * std::f64::consts::PI / 180.0,
    ],
    height_m: 0.120,
};

/// Why a place is refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Unreachable {
    /// The legs do not get there.
    #[error("leg {0} does not reach")]
    TooFar(usize),
    /// An arm and its forearm are nearly in line: the motor does not move the effector.
    #[error("arm and forearm of leg {0} are nearly in line")]
    Stretched(usize),
    /// The forearms lie nearly in a plane: the effector moves though the motors hold.
    #[error("the forearms lie nearly in a plane")]
    Flat,
    /// No place was found for these angles.
    #[error("no place for these joint angles")]
    NoPlace,
}

/// Least sine of the angle between an arm and its forearm.
const LEAST_BEND: f64 = 0.1;
/// Least volume of the three forearms' directions of unit length.
const LEAST_VOLUME: f64 = 0.05;
/// Newton's steps from a place nearby.
const STEPS: usize = 40;
/// Angles agree to this, rad: far below an encoder's step.
const AGREE_RAD: f64 = 1e-13;

/// A place with its joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeltaPose {
    /// Where the effector is, m from the origin.
    pub place_m: Vector3<f64>,
    /// Angles of the arms above the base's plane, outwards, rad.
    pub joints_rad: Vector3<f64>,
    /// Radians of each joint per metre: `dθ = slopes · dx`, and by the power that both have in common `F = slopesᵀ τ`.
    pub slopes: Matrix3<f64>,
    /// For each leg: `X`, `W`, `v`, `sqrt(b² - v²)`, `L`, and the arm's turn.
    legs: [Leg; 3],
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Leg {
    x: f64,
    w: f64,
    v: f64,
    root: f64,
    length: f64,
    turns: f64,
    sin: f64,
    cos: f64,
}

impl DeltaGeometry {
    /// A leg's directions `u` and `v`.
    fn frame(&self, leg: usize) -> (Vector3<f64>, Vector3<f64>) {
        let (sin, cos) = libm::sincos(self.legs_rad[leg]);
        (Vector3::new(cos, sin, 0.0), Vector3::new(-sin, cos, 0.0))
    }

    /// The joints of a place.
    ///
    /// # Errors
    /// The position cannot be reached, or is too close to a singular one.
    pub fn pose(&self, place_m: Vector3<f64>) -> Result<DeltaPose, Unreachable> {
        let mut joints_rad = Vector3::zeros();
        let mut slopes = Matrix3::zeros();
        let mut legs = [None; 3];
        let mut volume = Matrix3::zeros();
        for (i, kept) in legs.iter_mut().enumerate() {
            let (along, across) = self.frame(i);
            let u = along.dot(&place_m) - self.reach_m;
            let v = across.dot(&place_m) + self.aside_m;
            let w = place_m.z + self.height_m;
            let square = self.forearm_m * self.forearm_m - v * v;
            if square <= 0.0 {
                return Err(Unreachable::TooFar(i));
            }
            let root = libm::sqrt(square);
            let length = self.ends_m + root;
            let far = libm::hypot(u, w);
            let cosine =
                (far * far + self.arm_m * self.arm_m - length * length) / (2.0 * self.arm_m * far);
            // At the motor's axis itself it is no number.
            if cosine.is_nan() || cosine.abs() >= 1.0 {
                return Err(Unreachable::TooFar(i));
            }
            // Of the two, the elbow outwards.
            let angle = libm::atan2(w, u) - libm::acos(cosine);
            let (sin, cos) = libm::sincos(angle);
            let (x, w) = (u - self.arm_m * cos, w - self.arm_m * sin);
            let turns = self.arm_m * (x * sin - w * cos);
            if turns.abs() < LEAST_BEND * self.arm_m * length {
                return Err(Unreachable::Stretched(i));
            }
            let forearm = along * x + Vector3::z() * w + across * (length * v / root);
            joints_rad[i] = angle;
            slopes.set_row(i, &(-forearm / turns).transpose());
            volume.set_row(i, &forearm.normalize().transpose());
            *kept = Some(Leg {
                x,
                w,
                v,
                root,
                length,
                turns,
                sin,
                cos,
            });
        }
        if volume.determinant().abs() < LEAST_VOLUME {
            return Err(Unreachable::Flat);
        }
        let [Some(a), Some(b), Some(c)] = legs else {
            return Err(Unreachable::NoPlace);
        };
        Ok(DeltaPose {
            place_m,
            joints_rad,
            slopes,
            legs: [a, b, c],
        })
    }

    /// The place of joint angles, by Newton's method from a place nearby.
    ///
    /// # Errors
    /// There is no such position, or it cannot be used.
    pub fn place(
        &self,
        joints_rad: Vector3<f64>,
        near_m: Vector3<f64>,
    ) -> Result<DeltaPose, Unreachable> {
        let mut pose = self.pose(near_m)?;
        for _ in 0..STEPS {
            let off = joints_rad - pose.joints_rad;
            if off.amax() <= AGREE_RAD {
                return Ok(pose);
            }
            let step = pose.slopes.try_inverse().ok_or(Unreachable::Flat)? * off;
            // Half of it where the whole leads out of reach.
            let next = [1.0, 0.5, 0.25, 0.125]
                .into_iter()
                .find_map(|share| self.pose(pose.place_m + step * share).ok());
            pose = next.ok_or(Unreachable::NoPlace)?;
        }
        let off = joints_rad - pose.joints_rad;
        // The last digit of an angle may never settle.
        match off.amax() <= 100.0 * AGREE_RAD {
            true => Ok(pose),
            false => Err(Unreachable::NoPlace),
        }
    }

    /// Accelerations of the joints of an effector that goes straight on at a velocity, rad/s².
    #[must_use]
    pub fn curvature(&self, pose: &DeltaPose, velocity: Vector3<f64>) -> Vector3<f64> {
        let rates = pose.slopes * velocity;
        let mut curvature = Vector3::zeros();
        for (i, leg) in pose.legs.iter().enumerate() {
            let (along, across) = self.frame(i);
            let (u_rate, v_rate) = (along.dot(&velocity), across.dot(&velocity));
            let turn = rates[i];
            let arm = self.arm_m;
            let x_rate = u_rate + arm * leg.sin * turn;
            let w_rate = velocity.z - arm * leg.cos * turn;
            let length_rate = -leg.v / leg.root * v_rate;
            let cube = leg.root * leg.root * leg.root;
            let length_bend = -self.forearm_m * self.forearm_m / cube * v_rate * v_rate;
            let sum = x_rate * x_rate + w_rate * w_rate
                - length_rate * length_rate
                - leg.length * length_bend
                + arm * (leg.x * leg.cos + leg.w * leg.sin) * turn * turn;
            curvature[i] = -sum / leg.turns;
        }
        curvature
    }
}

impl DeltaPose {
    /// The slopes turned round, metres of the effector per radian of each joint: `τ = metres_per_radianᵀ F`.
    #[must_use]
    pub fn metres_per_radian(&self) -> Matrix3<f64> {
        // `pose` refuses places where there is no inverse.
        self.slopes.try_inverse().unwrap_or_default()
    }

    /// The force that torques make at the effector, N.
    #[must_use]
    pub fn force_n(&self, torques_n_m: Vector3<f64>) -> Vector3<f64> {
        self.slopes.tr_mul(&torques_n_m)
    }

    /// The torques that make a force, N·m.
    #[must_use]
    pub fn torques_n_m(&self, force_n: Vector3<f64>) -> Vector3<f64> {
        self.metres_per_radian().tr_mul(&force_n)
    }
}

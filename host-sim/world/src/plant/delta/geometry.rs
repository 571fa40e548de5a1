//! Geometry of a delta mechanism: joint angles for a position of its effector, and the reverse.
//!
//! Each leg has its own frame: `u` points from the base's centre through the leg's motor, `v` sideways, `w` up. With an arm of
//! length `a` at an angle `θ`, the forearm closes the loop if (Stamper, *A three degree of freedom parallel manipulator with only
//! translational degrees of freedom*, University of Maryland, PhD 97-4, 1997)
//!
//! ```text
//! (u - a cos θ)² + (w - a sin θ)² = L²        L = ends + sqrt(b² - v²)
//! ```
//!
//! `b` is the length of the forearm, and `ends` the length of its two end pieces. The equation is linear in `cos θ` and `sin θ`, so
//! a position gives its joint angles in closed form. Newton's method gives the position for joint angles. The first derivative
//! gives the slopes of the joint angles (radians per metre), the second derivative their curvature.

use nalgebra::{Matrix3, Vector3};

/// Lengths of a delta mechanism.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeltaGeometry {
    /// Length of the arm, from the motor's axis to the elbow, m.
    pub arm_m: f64,
    /// Length of the parallelogram's long sides, m.
    pub forearm_m: f64,
    /// Length of both end pieces of a forearm together, m: from the elbow's axis to the parallelogram, and from the parallelogram
    /// to the effector's axis.
    pub ends_m: f64,
    /// Distance of each motor's axis from the base's centre, minus the distance of the effector's joints from the effector's
    /// centre, m.
    pub reach_m: f64,
    /// Sideways distance of a leg's joint at the effector from its joint at the base, m.
    pub aside_m: f64,
    /// Directions of the three legs around the vertical axis, rad.
    pub legs_rad: [f64; 3],
    /// Height of the origin of the coordinates above the base, m.
    pub height_m: f64,
}

/// Lengths of the Novint Falcon, from `FalconGeometry.h` of the library libnifalcon (after Stamper). The arm has 60 mm, the forearm
/// 102.5 mm plus twice 11.25 mm. Distances from the centre are 40 mm for the motors and 14.43 mm for the effector's joints; their
/// sideways offsets are 25 mm and 23.09 mm. The origin lies 120 mm above the base.
pub const FALCON_GEOMETRY: DeltaGeometry = DeltaGeometry {
    arm_m: 0.060,
    forearm_m: 0.1025,
    ends_m: 2.0 * 0.01125,
    reach_m: 0.040 - 0.01443,
    aside_m: 0.02309 - 0.025,
    // The directions 90°, -30° and -150°, each turned by 15°.
    legs_rad: [
        105.0 * std::f64::consts::PI / 180.0,
        -15.0 * std::f64::consts::PI / 180.0,
        -135.0 * std::f64::consts::PI / 180.0,
    ],
    height_m: 0.120,
};

/// Reason why the mechanism cannot take a position. The number is the index of the leg, from 0.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Unreachable {
    /// The leg is too short for the position.
    #[error("leg {0} does not reach")]
    TooFar(usize),
    /// Arm and forearm of the leg are nearly in line, so that the leg's motor does not move the effector.
    #[error("arm and forearm of leg {0} are nearly in line")]
    Stretched(usize),
    /// The three forearms lie nearly in one plane, so that the effector can move although the motors hold.
    #[error("the forearms lie nearly in a plane")]
    Flat,
    /// Newton's method found no position for these joint angles.
    #[error("no position fits these joint angles")]
    NoPlace,
}

/// Smallest accepted sine of the angle between an arm and its forearm; a smaller one means that the leg is nearly stretched.
const LEAST_BEND: f64 = 0.1;
/// Smallest accepted volume spanned by unit vectors along the three forearms; a smaller one means that they lie nearly in one
/// plane.
const LEAST_VOLUME: f64 = 0.05;
/// Largest number of steps of Newton's method, which starts from a position nearby.
const STEPS: usize = 40;
/// Accepted error of joint angles in Newton's method, rad; far below an encoder's resolution.
const AGREE_RAD: f64 = 1e-13;

/// A position of the effector with its joint angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeltaPose {
    /// Position of the effector relative to the origin, m.
    pub place_m: Vector3<f64>,
    /// Angles of the arms above the plane of the base, measured outwards, rad.
    pub joints_rad: Vector3<f64>,
    /// Change of each joint angle per displacement of the effector, rad/m: `dθ = slopes · dx`. The power at the joints equals that
    /// at the effector, so the force is `F = slopesᵀ τ` for the motor torques `τ`.
    pub slopes: Matrix3<f64>,
    /// Intermediate values of the closed-form solution for each leg.
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
    /// Directions in a leg's frame: outwards from the base's centre, and sideways.
    fn frame(&self, leg: usize) -> (Vector3<f64>, Vector3<f64>) {
        let (sin, cos) = libm::sincos(self.legs_rad[leg]);
        (Vector3::new(cos, sin, 0.0), Vector3::new(-sin, cos, 0.0))
    }

    /// The joint angles and slopes for this position of the effector.
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
            // At the motor's axis itself the cosine is NaN.
            if cosine.is_nan() || cosine.abs() >= 1.0 {
                return Err(Unreachable::TooFar(i));
            }
            // Of the two solutions, the one with the elbow outwards.
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

    /// The position of the effector for these joint angles, by Newton's method from a position nearby.
    ///
    /// # Errors
    /// There is no such position, or it is too close to a singular one.
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
            // A shorter step if the whole step leads out of reach.
            let next = [1.0, 0.5, 0.25, 0.125]
                .into_iter()
                .find_map(|share| self.pose(pose.place_m + step * share).ok());
            pose = next.ok_or(Unreachable::NoPlace)?;
        }
        let off = joints_rad - pose.joints_rad;
        // The last digit of an angle may never settle, so a larger error is accepted in the end.
        match off.amax() <= 100.0 * AGREE_RAD {
            true => Ok(pose),
            false => Err(Unreachable::NoPlace),
        }
    }

    /// Accelerations of the joints while the effector moves in a straight line at constant velocity, rad/s².
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
    /// Displacement of the effector per change of each joint angle, m/rad: the inverse of the slopes. It gives the torques `τ` of a
    /// force `F` as `τ = metres_per_radianᵀ F`.
    #[must_use]
    pub fn metres_per_radian(&self) -> Matrix3<f64> {
        // `pose` refuses places where there is no inverse.
        self.slopes.try_inverse().unwrap_or_default()
    }

    /// The force at the effector that motor torques (N·m) make, N.
    #[must_use]
    pub fn force_n(&self, torques_n_m: Vector3<f64>) -> Vector3<f64> {
        self.slopes.tr_mul(&torques_n_m)
    }

    /// The motor torques that make a force (N) at the effector, N·m.
    #[must_use]
    pub fn torques_n_m(&self, force_n: Vector3<f64>) -> Vector3<f64> {
        self.metres_per_radian().tr_mul(&force_n)
    }
}

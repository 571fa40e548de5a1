//! The windings of a motor without saliency (equal inductance in all directions), with a closed-form solution over an interval of
//! constant speed.
//!
//! The phase currents are written as one complex number in the stator's frame (amplitude-invariant:
//! `i = 2/3 (i_a + i_b e^{2πj/3} + i_c e^{4πj/3})`):
//!
//! ```text
//! L di/dt = v - R i - j ω λ e^{jθ}          torque = 3/2 p λ Im(i e^{-jθ})
//! ```
//!
//! `v` is the voltage, `R` and `L` are resistance and inductance of a phase, `λ` is the flux linkage and `p` the number of pole
//! pairs. The rotor has the electrical angle `θ` and the electrical speed `ω`.
//!
//! For constant `v` and `ω` the solution is `i = v/R + i_p e^{jθ} + c e^{-Rt/L}` with `i_p = -jωλ/(R + jωL)`; the initial current
//! gives `c`. The mean torque over the interval follows in closed form.

use nalgebra::Complex;

type C = Complex<f64>;

/// The electrical parameters of a motor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorParameters {
    /// Resistance of a phase to the star point, Ω.
    pub resistance_ohm: f64,
    /// Inductance of a phase to the star point, H.
    pub inductance_h: f64,
    /// Amplitude of a phase's flux linkage `λ`, Wb (V·s): the back-EMF's amplitude divided by the electrical speed.
    pub flux_linkage_wb: f64,
    /// Number of pole pairs.
    pub pole_pairs: u32,
    /// Electrical angle of the rotor at shaft angle 0, rad.
    pub electrical_zero_rad: f64,
    /// Whether two phases are swapped: the electrical angle then falls when the shaft's angle rises.
    pub reversed: bool,
}

/// A gimbal-type motor: 0.25 N·m/A with 7 pole pairs, 6 Ω, 3 mH. It gives 0.5 N·m at 2 A, which a bus of 24 V can drive.
pub const GIMBAL: MotorParameters = MotorParameters {
    resistance_ohm: 6.0,
    inductance_h: 3e-3,
    // k_t = 3/2 p λ
    flux_linkage_wb: 0.25 / (1.5 * 7.0),
    pole_pairs: 7,
    electrical_zero_rad: 0.0,
    reversed: false,
};

impl MotorParameters {
    /// Torque constant: N·m per ampere of the q-axis current. It is 3/2 times pole pairs times flux linkage.
    #[must_use]
    pub fn torque_constant_nm_per_a(&self) -> f64 {
        1.5 * f64::from(self.pole_pairs) * self.flux_linkage_wb
    }

    /// Electrical angle of the rotor at a shaft angle, rad.
    #[must_use]
    pub fn electrical_rad(&self, angle_rad: f64) -> f64 {
        self.ratio() * angle_rad + self.electrical_zero_rad
    }

    /// Electrical turns per turn of the shaft; negative if two phases are swapped.
    fn ratio(&self) -> f64 {
        let p = f64::from(self.pole_pairs);
        if self.reversed { -p } else { p }
    }
}

/// The windings with their present current, prepared for intervals of one length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Windings {
    motor: MotorParameters,
    interval_s: f64,
    /// Factor by which a current without voltage decays in an interval `T`: `e^{-RT/L}`, with phase resistance `R` and inductance
    /// `L`.
    decay: f64,
    current: C,
}

/// The complex number `size e^{j angle}`, with the same bits on every machine.
fn polar(size: f64, angle_rad: f64) -> C {
    let (sin, cos) = libm::sincos(angle_rad);
    C::new(size * cos, size * sin)
}

/// The complex number `e^{2πj/3}`, which turns a vector by a third of a turn.
fn third() -> C {
    polar(1.0, std::f64::consts::TAU / 3.0)
}

/// The complex vector in the stator's frame of three phase quantities (amplitude-invariant Clarke transform).
fn vector([a, b, c]: [f64; 3]) -> C {
    let t = third();
    (C::from(a) + t * b + t.conj() * c) * (2.0 / 3.0)
}

/// The integral `∫₀ᵀ e^{-jωt} dt` over the interval `T`, accurate for small `ωT` too.
fn turning_integral(omega: f64, interval: f64) -> C {
    let half = 0.5 * omega * interval;
    let sinc = if half.abs() < 1e-4 {
        1.0 - half * half / 6.0
    } else {
        libm::sin(half) / half
    };
    polar(interval * sinc, -half)
}

impl Windings {
    /// Windings without current, for intervals of `interval_s` seconds.
    #[must_use]
    pub fn new(motor: MotorParameters, interval_s: f64) -> Self {
        Self {
            motor,
            interval_s,
            decay: libm::exp(-motor.resistance_ohm / motor.inductance_h * interval_s),
            current: C::ZERO,
        }
    }

    /// The same windings with the same current for intervals of another length, such as a part of a PWM period.
    #[must_use]
    pub fn with_interval(self, interval_s: f64) -> Self {
        Self {
            current: self.current,
            ..Self::new(self.motor, interval_s)
        }
    }

    /// Windings of another motor with the same current, for intervals of `interval_s` seconds.
    #[must_use]
    pub fn of_motor(self, motor: MotorParameters, interval_s: f64) -> Self {
        Self {
            current: self.current,
            ..Self::new(motor, interval_s)
        }
    }

    /// The motor's parameters.
    #[must_use]
    pub const fn motor(&self) -> &MotorParameters {
        &self.motor
    }

    /// Currents of phases A, B, C into the motor, A; their sum is zero.
    #[must_use]
    pub fn currents_a(&self) -> [f64; 3] {
        let t = third();
        [self.current, self.current * t.conj(), self.current * t].map(|i| i.re)
    }

    /// Currents `(i_d, i_q)` along and across the rotor's flux at this shaft angle, A.
    #[must_use]
    pub fn dq_a(&self, angle_rad: f64) -> (f64, f64) {
        let i = self.current * polar(1.0, -self.motor.electrical_rad(angle_rad));
        (i.re, i.im)
    }

    /// Advances by one interval with constant phase voltages against any common point. The shaft starts at `angle_rad` and turns at
    /// constant speed. Returns the mean torque on the shaft, N·m, in the direction of positive angles.
    pub fn step(&mut self, phases_v: [f64; 3], angle_rad: f64, speed_rad_per_s: f64) -> f64 {
        let MotorParameters {
            resistance_ohm: r,
            inductance_h: l,
            flux_linkage_wb: lambda,
            ..
        } = self.motor;
        let omega = self.motor.ratio() * speed_rad_per_s;
        let theta = self.motor.electrical_rad(angle_rad);
        let t = self.interval_s;
        let v = vector(phases_v);
        let turning = C::new(0.0, -omega * lambda) / C::new(r, omega * l);
        let constant = v / r;
        let (before, after) = (polar(1.0, theta), polar(1.0, theta + omega * t));
        let transient = self.current - constant - turning * before;
        self.current = constant + turning * after + transient * self.decay;
        // Computes ∫ i e^{-jθ} dt term by term; the transient term rotates and decays.
        let rate = C::new(r / l, omega);
        let end = polar(self.decay, -omega * t);
        let integral = turning * t
            + before.conj()
                * (constant * turning_integral(omega, t) + transient * (C::from(1.0) - end) / rate);
        self.torque(integral.im / t)
    }

    /// Takes the current from a phase that is not connected.
    pub fn cut(&mut self, phase: usize) {
        let axis = polar(1.0, std::f64::consts::TAU * phase as f64 / 3.0);
        self.current -= axis * (self.current * axis.conj()).re;
    }

    /// Same as [`Windings::step`] with one phase that is not connected. The current then keeps to one direction of the stator's
    /// frame, in which the motor's equation is the same, so the current is exact. The mean torque is approximated by the mean of
    /// the torques at the interval's two ends.
    pub fn step_without(
        &mut self,
        open: usize,
        phases_v: [f64; 3],
        angle_rad: f64,
        speed_rad_per_s: f64,
    ) -> f64 {
        self.cut(open);
        let before = self.dq_a(angle_rad).1;
        self.step(phases_v, angle_rad, speed_rad_per_s);
        self.cut(open);
        let after = self.dq_a(angle_rad + speed_rad_per_s * self.interval_s).1;
        self.torque((before + after) / 2.0)
    }

    /// Advances by one interval with all switches open: the current continues through the diodes against the bus voltage until it
    /// is zero. Returns the mean torque on the shaft, N·m, in the direction of positive angles.
    ///
    /// While the current flows, the diodes hold the voltage vector at `-2/3 (bus_v + 2 diode_v)` along the current; the smaller
    /// back-EMF is neglected. Afterwards no current flows. This model is valid while the back-EMF between two phases is below the
    /// bus voltage; a faster motor would brake.
    pub fn freewheel(&mut self, bus_v: f64, diode_v: f64, angle_rad: f64) -> f64 {
        let size = libm::hypot(self.current.re, self.current.im);
        if size == 0.0 {
            return 0.0;
        }
        let MotorParameters {
            resistance_ohm: r,
            inductance_h: l,
            ..
        } = self.motor;
        let limit = (2.0 / 3.0 * (bus_v + 2.0 * diode_v)).max(1e-3) / r;
        let until = (l / r * libm::log1p(size / limit)).min(self.interval_s);
        let decay = libm::exp(-r / l * until);
        let left = ((size + limit) * decay - limit).max(0.0);
        let left = if until < self.interval_s { 0.0 } else { left };
        // Integral of the current's magnitude, which is (size + limit) e^{-Rt/L} - limit over time.
        let integral = (size + limit) * (1.0 - decay) * l / r - limit * until;
        let direction = self.current / size;
        self.current = direction * left;
        let q = (direction * polar(1.0, -self.motor.electrical_rad(angle_rad))).im;
        self.torque(q * integral / self.interval_s)
    }

    /// Torque of a q-axis current `q` in A, N·m, in the direction of positive angles.
    fn torque(&self, q: f64) -> f64 {
        let torque = self.motor.torque_constant_nm_per_a() * q;
        if self.motor.reversed { -torque } else { torque }
    }
}

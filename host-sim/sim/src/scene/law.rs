//! The control law's parameters as a scene gives them. Their defaults stand here and nowhere else.

use serde::{Deserialize, Serialize};

use crate::run::record::LawKind;

/// Number format that the law computes in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Number {
    /// Fixed point, 32 bits: what the firmware runs.
    Fixed32,
    /// Fixed point, 16 bits: small enough to prove exhaustively.
    Fixed16,
    /// IEEE single precision.
    F32,
    /// IEEE double precision: the reference.
    F64,
}

impl Number {
    /// Name in scenes and results.
    pub fn name(self) -> &'static str {
        match self {
            Number::Fixed32 => "fixed32",
            Number::Fixed16 => "fixed16",
            Number::F32 => "f32",
            Number::F64 => "f64",
        }
    }
}

/// How the law's own observer adds up energy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Observer {
    /// `f(n-1)·(e(n) - e(n-1))`: the port's true energy under a zero-order hold.
    Exact,
    /// `f(n)·(e(n) - e(n-1))`, thesis (2.1) and (2.4): the sampling leak has the opposite sign.
    Thesis,
}

/// What happens to force and offset when the first contact ends, that is at the first turn of the motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FirstContact {
    /// Keep the force and choose the offset to match, thesis (2.17).
    KeepForce,
    /// Keep the offset at zero and let the force step down to the soft spring, thesis §3.2.
    ZeroOffset,
}

/// Where the augmentation compares displayed with desired stiffness when the law has a filter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Regulate {
    /// At the filter's mass: the HIP then feels less, thesis (3.4).
    Mass,
    /// At the mass, with the desired stiffness raised by thesis (3.5); needs `k_de < k_f`.
    MassCompensated,
    /// At the HIP, thesis (3.6).
    Hip,
}

/// When the enhanced law changes the offset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OffsetUpdate {
    /// At inward ticks of the virtual mass only, thesis Algorithm 3.1.
    Inward,
    /// At every tick of contact, in the direction of the error.
    EveryTick,
}

/// What the offset's ideal step supposes of the hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum IdealStep {
    /// The position stays, thesis (3.7): `|k_de e - |f||/k_v`.
    Position,
    /// The force stays and the hand gives way: `|e - |f|/k_de|`.
    Force,
}

/// Parameters of all laws. Each law takes what it has a use for and ignores the rest, so that laws compare in one
/// scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Law {
    /// Which law. Default `enhanced-sfa`.
    pub kind: LawKind,
    /// Number format. Default `fixed32`.
    pub number: Number,
    /// Soft spring `k_v` of the augmentation, N·m/rad, above 0. Default 0.8.
    pub k_v_n_m_per_rad: f64,
    /// Damping `c_i` that the law counts on (device and fingertip), N·m·s/rad, above 0. Default 5e-4.
    pub c_i_n_m_s_per_rad: f64,
    /// Energy observer. Default `exact`.
    pub observer: Observer,
    /// TDPA: let the observer count the energy that `c_i` dissipates. Default false.
    pub count_device_damping: bool,
    /// Virtual damping of the law `spring-damper`, N·m·s/rad, 0 or more. Default 2e-4.
    pub virtual_damping_n_m_s_per_rad: f64,
    /// Rule at the end of the first contact. Absent: [`Law::first_contact`] says which one the law has of its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_contact: Option<FirstContact>,
    /// Where the stiffness is regulated. Default `hip`.
    pub regulate: Regulate,
    /// When the enhanced law changes the offset. Default `every-tick`.
    pub offset_update: OffsetUpdate,
    /// What the ideal step supposes of the hand. Default `force`.
    pub ideal_step: IdealStep,
    /// Energy that one contact of the enhanced law may give beyond what it took, J, 0 or more. Default 0.02.
    pub energy_credit_j: f64,
    /// `a` of thesis (3.11): the offset's step is at most this share of the penetration, 0 to 1. Default 0.03.
    pub limit_a_of_penetration: f64,
    /// `b` of thesis (3.9): the force's step is at most this share of the force, 0 to 1. Default 0.03.
    pub limit_b_of_force: f64,
    /// `c` of thesis (3.8): the offset's step is this share of the ideal one, 0 to 1. Default 0.012.
    pub step_c_of_ideal: f64,
    /// Largest force that the law commands, N·m, above 0. Default 0.5.
    pub force_limit_n_m: f64,
    /// Virtual-mass filter of `enhanced-sfa`.
    pub filter: Filter,
}

impl Law {
    /// Rule at the end of the first contact: the one given, else `keep-force` for the original augmentation (thesis
    /// 2.17) and `zero-offset` for every later one (§3.2).
    pub fn first_contact(&self) -> FirstContact {
        self.first_contact.unwrap_or(match self.kind {
            LawKind::Sfa => FirstContact::KeepForce,
            _ => FirstContact::ZeroOffset,
        })
    }
}

impl Default for Law {
    fn default() -> Self {
        Law {
            // What the project is about.
            kind: LawKind::EnhancedSfa,
            // What the firmware runs.
            number: Number::Fixed32,
            // Captions of thesis Figs. 3.2 and 3.5; below k_c = 2 c_i / T = 1, so the spring is passive unaided.
            k_v_n_m_per_rad: 0.8,
            // Thesis §5.1, found with Algorithm 2.1.
            c_i_n_m_s_per_rad: 5e-4,
            // The thesis' form reports the sampling leak with the wrong sign.
            observer: Observer::Exact,
            // The thesis' TDPA does not (§5.1.3 shows what that costs).
            count_device_damping: false,
            // Below the device's own damping: passivity asks b > K T/2 + B, so virtual damping eats the margin it is
            // to widen.
            virtual_damping_n_m_s_per_rad: 2e-4,
            first_contact: None,
            // The only choice that shows k_de at the hand without a bound from k_f.
            regulate: Regulate::Hip,
            // Inward-only is a ratchet: it goes on only as long as something jitters, and overshoots.
            offset_update: OffsetUpdate::EveryTick,
            // What a coupling k_f stores under the thesis' press, F²/(2 k_f) = 5 mJ, four times over.
            energy_credit_j: 0.02,
            // One `step_c_of_ideal` then serves all stiffnesses.
            ideal_step: IdealStep::Force,
            // a, b, c and the filter: from a search over grips, encoders, touch and press, and k_de from 1 to 20 k_c.
            // The thesis asks for "a fraction" only.
            limit_a_of_penetration: 0.03,
            // Weber: a torque step of 12.7 % is just felt at 60 mN·m (Jandura and Srinivasan 1994); stay well below.
            limit_b_of_force: 0.03,
            step_c_of_ideal: 0.012,
            // The thesis knob's torque limit: five times the thesis' typical push.
            force_limit_n_m: 0.5,
            filter: Filter::default(),
        }
    }
}

/// Virtual mass between HIP and wall, thesis §3.5 and Fig. 3.11.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Filter {
    /// Virtual mass, kg·m², above 0. Default 3e-6.
    pub mass_kg_m2: f64,
    /// Spring `k_f` between HIP and mass, N·m/rad, above 0. Default 1.
    pub stiffness_n_m_per_rad: f64,
    /// Damper `c_f` between HIP and mass, N·m·s/rad, 0 or more. Default 0.
    pub damping_n_m_s_per_rad: f64,
    /// Damper `c_env` between mass and ground, N·m·s/rad, 0 or more. Default 0.01.
    pub damping_to_ground_n_m_s_per_rad: f64,
}

impl Default for Filter {
    fn default() -> Self {
        Filter {
            // A thirtieth of the device's inertia: not felt.
            mass_kg_m2: 3e-6,
            // 2 (c_i - c_f) / T at 1 kHz: the most that sampling allows without help from the hand.
            stiffness_n_m_per_rad: 1.0,
            // What it takes is lost to k_f; the damper to ground is enough.
            damping_n_m_s_per_rad: 0.0,
            // Far above k_v T / 2 at 1 kHz, the least that keeps the soft spring passive on the force of the previous mass
            // position: it sets how fast the mass follows (12 ms), and so how calm it is.
            damping_to_ground_n_m_s_per_rad: 0.01,
        }
    }
}

//! Settings: what a person chooses, in SI, exact and without floats, so that a microcontroller validates the very same
//! values by the very same code as the desktop.

/// An SI value in `I32F32`: ±2.1e9 in steps of 2.3e-10.
pub type Si = fixed::types::I32F32;

use crate::ObserverForm;

/// Which law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LawKind {
    /// Virtual spring (1.6).
    Spring,
    /// Virtual spring with virtual damping (§1.2.6).
    SpringDamper,
    /// Time-domain passivity approach.
    Tdpa,
    /// Force bounding approach.
    Fba,
    /// Original successive force augmentation.
    Sfa,
    /// Successive force augmentation with the offset changed at every inward tick.
    SfaContinuous,
    /// Enhanced successive force augmentation.
    #[default]
    EnhancedSfa,
}

/// What happens to the force when the first contact ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FirstContact {
    /// The offset is set so that the force goes on (2.17).
    KeepForce,
    /// The offset stays zero and the force drops to the soft spring's (§3.2): the stable choice.
    #[default]
    ZeroOffset,
}

/// Which stiffness the offset regulates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Regulate {
    /// Force over position of the virtual mass, towards `k_de`: the HIP feels less, by (3.4).
    Mass,
    /// The same, towards the stiffness of (3.5), so that the HIP feels `k_de`; needs `k_de < k_f`.
    MassCompensated,
    /// Force over position of the HIP, towards `k_de` (3.6).
    #[default]
    Hip,
}

/// When the offset is changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OffsetUpdate {
    /// When the motion turns from outward to inward (2.14).
    TurnInward,
    /// At every inward tick (3.2, Algorithm 3.1).
    Inward,
    /// At every tick of contact, in the direction of the error. Inward-only is a ratchet: it moves on only as long as
    /// something jitters, and overshoots what it cannot take back; see the README for the difference.
    #[default]
    EveryTick,
}

/// What the offset's ideal step supposes of the hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum IdealStep {
    /// The position stays: `|k_de e - |f||/k_v` (3.7). A soft hand gives way by as much as the offset grows, so that this
    /// step is too long by `k_de/k_v`, and `c` must be chosen anew for every `k_de`.
    Position,
    /// The force stays and the position follows the offset: `|e - |f|/k_de|`, the way that the HIP still has to go. One `c`
    /// then serves all stiffnesses.
    #[default]
    Force,
}

/// The virtual-mass filter, per its physical parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FilterSettings {
    /// Virtual mass, kg·m² (kg).
    pub mass: Si,
    /// Coupling stiffness `k_f`, N·m/rad (N/m).
    pub stiffness: Si,
    /// Coupling damping `c_f`, N·m·s/rad (N·s/m).
    pub damping: Si,
    /// Damping to ground `c_env`, N·m·s/rad (N·s/m).
    pub ground_damping: Si,
}

/// Everything that a law needs to know, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Which law.
    pub law: LawKind,
    /// Control rate `1/T`, Hz.
    pub rate_hz: u32,
    /// Desired stiffness `k_de`, N·m/rad (N/m).
    pub k_desired: Si,
    /// Soft, inherently stable stiffness `k_v`, N·m/rad (N/m).
    pub k_soft: Si,
    /// Damping `c_i` that device and fingertip are trusted to have, N·m·s/rad (N·s/m); `k_c = 2 c_i/T`.
    pub device_damping: Si,
    /// Virtual damping of the spring-damper law, N·m·s/rad (N·s/m).
    pub virtual_damping: Si,
    /// Observer form of TDPA, alone or inside the enhanced law.
    pub observer: ObserverForm,
    /// TDPA: count `c_i` as dissipation (2.6).
    pub count_device_damping: bool,
    /// What happens when the first contact ends.
    pub first_contact: FirstContact,
    /// Which stiffness the offset regulates.
    pub regulate: Regulate,
    /// When the offset is changed.
    pub offset_update: OffsetUpdate,
    /// What the ideal step supposes of the hand.
    pub ideal_step: IdealStep,
    /// `c` of (3.8), 0..=1.
    pub step_of_ideal: Si,
    /// `b` of (3.9), 0..=1.
    pub limit_of_force: Si,
    /// `a` of (3.11), 0..=1.
    pub limit_of_penetration: Si,
    /// The filter of the enhanced law.
    pub filter: FilterSettings,
    /// Energy that one contact of the enhanced law may give beyond what it took, J.
    pub energy_credit: Si,
    /// Largest force ever commanded, N·m (N).
    pub force_limit: Si,
}

/// `Si` from a decimal literal, at compile time.
macro_rules! si {
    ($text:literal) => {
        const { Si::lit($text) }
    };
}

impl Default for Settings {
    /// The thesis' knob at 1 kHz (§5.1), with our choices for what the thesis leaves out.
    fn default() -> Self {
        Self {
            law: LawKind::EnhancedSfa,
            rate_hz: 1000,
            k_desired: si!("5"),
            // Captions of Figs. 3.2 and 3.5.
            k_soft: si!("0.8"),
            // §5.1: found by Algorithm 2.1, so that k_c = 1 N·m/rad.
            device_damping: si!("0.0005"),
            virtual_damping: si!("0.0002"),
            observer: ObserverForm::Exact,
            count_device_damping: false,
            first_contact: FirstContact::ZeroOffset,
            regulate: Regulate::Hip,
            offset_update: OffsetUpdate::EveryTick,
            // a, b, c and the filter: found by a search over grips, encoders, presses and k_de of 1 to 20 k_c.
            ideal_step: IdealStep::Force,
            step_of_ideal: si!("0.012"),
            limit_of_force: si!("0.03"),
            limit_of_penetration: si!("0.03"),
            filter: FilterSettings {
                mass: si!("0.000003"),
                // The sampling bound 2 (c_i - c_f)/T: as stiff as passivity at the physical port allows.
                stiffness: si!("1"),
                damping: si!("0"),
                // Far above the bound k_v T/2 = 4e-4: it sets how fast the mass follows (12 ms at k_f), and so how calm it is.
                ground_damping: si!("0.01"),
            },
            // Twice F²/(2 k_f) at the thesis' press of 0.1 N·m, and a reserve for a harder one.
            energy_credit: si!("0.02"),
            force_limit: si!("0.5"),
        }
    }
}

//! The control laws as linear systems, in the phases in which they are linear.
//!
//! A law receives the penetration `e` and the displacement `m` per tick (control period `T`), from samples or from an estimator,
//! and returns the force `f`. All signals are deviations from a point of rest inside the wall. `k_de` is the requested stiffness.
//!
//! **Spring, with or without damping; TDPA and FBA while they do not reduce the force**: `f = k_de e + (B/T) m` (5), with the
//! damping `B = 0` for all but the spring-damper.
//!
//! **Enhanced augmentation** after the first contact. A spring `k_f` and a damper `c_f` couple its virtual mass, at the position
//! `e_f`, to the device. The mass presses on a soft spring `k_v` with the offset `O` and the force `p`. `c_env` is the mass'
//! damping to ground, `d` its displacement per tick. The coefficients are `M` (the mass divided by `T²`), `C = c_f/T` and
//! `D = M + k_f + C + c_env/T`. The stiffness `k_t` at the mass is `k_de`, or `k_de k_f/(k_f - k_de)` if the spring `k_f` is
//! compensated (`law.regulate` is `mass-compensated`).
//!
//! ```text
//! O(n)   = O(n-1) + κ (k_de e(n) - f(n-1))                  regulated at the device   (6)
//! O(n)   = O(n-1) + κ (k_t e_f(n-1) - p(n-1))               regulated at the mass     (7)
//! p(n)   = k_v (e_f(n-1) + O(n))                            the wall on the mass      (8)
//! d(n)   = (M d(n-1) + k_f (e(n) - e_f(n-1)) + C m(n) - p(n))/D                       (9)
//! e_f(n) = e_f(n-1) + d(n)                                                            (10)
//! f(n)   = k_f (e(n) - e_f(n)) + C (m(n) - d(n))                                      (11)
//! ```
//!
//! As in the implementation, two values are one tick old: the force with which the offset `O` is compared, and the mass' position
//! in the wall's force. The law moves the offset by the fraction `c` of an ideal step per tick. The gain `κ` is `c/k_v` or
//! `c/k_de` (setting `law.ideal_step`) while this fraction is the smallest of the law's three bounds on a step of the offset.
//! While another bound is smaller, so is `κ`. Near rest the fraction of the ideal step is always the smallest, because only that
//! bound vanishes with the error. With a frozen offset `κ = 0`, and the constant `O` is left out.
//!
//! **Original and continuous augmentation**: `f = k_v (e + O)`. While the motion goes inward, `O` changes per tick by `±g m`, with
//! `g = k_c/k_v - 1` and the largest stiffness `k_c` that sampling allows. So the force changes by `k_v (1 ± g) m` inward and by
//! `k_v m` outward (12). This is a stiffness times the displacement; the stiffness changes from tick to tick within
//! `[k_v (1 - g), k_v (1 + g)]`.
//!
//! In the first contact every law is the spring `k_de` until the motion turns.

use super::linear_law::{LinearLaw, Phase};
use touchstone_control::law::EnhancedSfa;
use touchstone_control::{AnyLaw, OffsetUpdate, Regulate};

/// Name of the linear phase in which the law changes its offset (shift of the wall's surface) at every tick.
pub const OFFSET_UPDATED: &str = "offset updated";

/// How a control law may change between its linear phases.
#[derive(Debug, Clone, PartialEq)]
pub enum Switching {
    /// The control law is linear in a single phase.
    Never,
    /// The control law changes between two linear phases that differ in one gain, in any order; every gain between the two may
    /// occur.
    Between(Box<[LinearLaw; 2]>),
}

/// A control law as a set of linear phases, with further properties that the certificate needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Phases {
    /// Linear phases in which the control law can stay. The loop must be stable in each of them.
    pub lasting: Vec<Phase>,
    /// How the control law changes between its phases.
    pub switching: Switching,
    /// Whether the gain depends on the direction of the motion, and not only on its amplitude. Such a gain can feed energy into a
    /// motion.
    pub by_direction: bool,
    /// Largest press in N·m that the law's energy loan covers. Under this press the spring that couples hand and virtual mass
    /// stores at most the energy of the loan. Absent for laws without a loan.
    pub loan_covers_n_m: Option<f64>,
    /// Stiffness of the spring that the law is at the start of a contact, N·m/rad. Absent if the law stays a spring when the motion
    /// turns.
    pub first_contact: Option<f64>,
    /// How the law reduces its force by an energy account; `None` if it does not. With a reduction, a press may rest although the
    /// phases are unstable.
    pub clamps: Option<Clamp>,
}

/// How a control law reduces its force to keep an energy bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clamp {
    /// Time-domain passivity approach: the force is reduced when the wall would give out more energy than it took.
    Tdpa,
    /// Force bounding approach: the force is limited to what the device's damping can absorb.
    Fba,
}

impl Phases {
    /// Derives the linear phases of a control law.
    #[must_use]
    pub fn of(controller: &AnyLaw<f64>) -> Self {
        let springs = |stiffness: f64, damping: f64, clamps| Self {
            lasting: vec![Phase {
                name: "spring",
                law: LinearLaw::spring(stiffness, damping),
            }],
            switching: Switching::Never,
            by_direction: false,
            loan_covers_n_m: None,
            first_contact: None,
            clamps,
        };
        match controller {
            AnyLaw::Spring(law, _) => springs(law.desired.0, law.damping.0, None),
            AnyLaw::Damped(law, _) => Self {
                lasting: super::damped::phases(law),
                ..springs(0.0, 0.0, None)
            },
            AnyLaw::Tdpa(law, _) => springs(law.desired.0, 0.0, Some(Clamp::Tdpa)),
            AnyLaw::Fba(law, _) => springs(law.desired.0, 0.0, Some(Clamp::Fba)),
            AnyLaw::Sfa(law, _) => {
                let (soft, gain) = (law.soft.0, law.gain.0);
                let spring = |stiffness| LinearLaw::spring(stiffness, 0.0);
                let phase = |name, stiffness| Phase {
                    name,
                    law: spring(stiffness),
                };
                Self {
                    lasting: vec![
                        phase("outward, k_v", soft),
                        phase("inward, k_c", soft * (1.0 + gain)),
                    ],
                    switching: Switching::Between(Box::new([
                        spring(soft * (1.0 - gain)),
                        spring(soft * (1.0 + gain)),
                    ])),
                    by_direction: true,
                    loan_covers_n_m: None,
                    first_contact: Some(law.desired.0),
                    clamps: None,
                }
            }
            AnyLaw::Enhanced(law, _) => {
                let updated = enhanced(law, Offset::Updated);
                let mut lasting = vec![Phase {
                    name: "offset held",
                    law: enhanced(law, Offset::Frozen),
                }];
                if law.augmentation.of_ideal.0 > 0.0 {
                    lasting.push(Phase {
                        name: if law.update == OffsetUpdate::EveryTick {
                            OFFSET_UPDATED
                        } else {
                            "offset updated inward"
                        },
                        law: updated.clone(),
                    });
                }
                Self {
                    lasting,
                    switching: Switching::Between(Box::new([enhanced(law, Offset::Held), updated])),
                    by_direction: law.update != OffsetUpdate::EveryTick,
                    loan_covers_n_m: Some((2.0 * law.mass.stiffness.0 * law.credit.0).sqrt()),
                    first_contact: Some(law.desired.0),
                    clamps: None,
                }
            }
        }
    }
}

/// Treatment of the law's offset (shift of the wall's surface) in a linear phase of enhanced successive force augmentation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Offset {
    /// The offset changes at every tick by the ideal step, equation (6) or (7) in `law.rs`.
    Updated,
    /// The offset is constant, but a state of the matrix.
    Held,
    /// The offset is constant and not in the matrix, because a constant offset only moves the point of rest.
    Frozen,
}

/// Matrices of the enhanced law, equations (6) to (11) of the module. The states are position and displacement of the virtual mass,
/// the offset, and the last force (`f` or `p`). With a frozen offset only position and displacement remain.
#[must_use]
pub fn enhanced(law: &EnhancedSfa<f64>, offset: Offset) -> LinearLaw {
    let share = if offset == Offset::Updated {
        law.augmentation.of_ideal.0
    } else {
        0.0
    };
    let mass = &law.mass;
    let order = if offset == Offset::Frozen { 2 } else { 4 };
    LinearLaw::of(order, |state, e, moved| {
        let (mut at, mut d) = (state[0], state[1]);
        let mut o = 0.0;
        if let [_, _, held, before] = *state {
            let missing = match law.regulate {
                Regulate::Hip => law.target.0 * e - before,
                Regulate::Mass | Regulate::MassCompensated => law.target.0 * at - before,
            };
            o = held + share * missing;
        }
        let wall = law.soft.0 * (at + o);
        let drive = mass.inertia.0 * d + mass.stiffness.0 * (e - at) + mass.damping.0 * moved;
        d = (drive - wall) / mass.total.0;
        at += d;
        let force = mass.stiffness.0 * (e - at) + mass.damping.0 * (moved - d);
        state[0] = at;
        state[1] = d;
        if let [_, _, held, before] = state {
            *held = o;
            *before = match law.regulate {
                Regulate::Hip => force,
                Regulate::Mass | Regulate::MassCompensated => wall,
            };
        }
        force
    })
}

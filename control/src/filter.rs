//! The virtual mass of the enhanced law as a filter (thesis §3.5), discretised by backward Euler.
//!
//! A spring `k_f` and a damper `c_f` couple a virtual mass `m` to the hand's point (HIP), and a damper `c_env` connects the mass to
//! ground. The positions of HIP and mass are `x` and `x_f`, the control period is `T`, the wall's force on the mass `f_p`. The mass
//! moves by `d = T v_f` in a tick. All coefficients are in N·m/rad: `M = m/T²`, `C = c_f/T`, `G = c_env/T`, and the sum
//! `D = M + k_f + C + G`. One tick is
//!
//! ```text
//! N0 = M d + k_f (x - x_f) + C Δx        drives the mass, without the wall's force f_p
//! d' = (N0 - f_p) / D   towards zero     x_f' = x_f + d'
//! F  = k_f (x - x_f') + C (Δx - d')      force on the HIP
//! ```
//!
//! Backward Euler is passive at the HIP's discrete port for every `M, k_f, C, G >= 0`. The force `F` is passive at the physical
//! port if the device's damping is at least `k_f T/2 + c_f`. `d'` is one quotient of exact sums, rounded towards zero. The
//! remainder of that rounding, `r = N0 - f_p - D d'`, has the sign of `d'`. So it acts like dry friction and can only dissipate
//! energy. `f_p` is calculated from the mass' position *before* the update. This can inject energy unless `c_env` is at least `T/2`
//! times the wall's soft stiffness `k_v`.

use crate::{Divisor, Energy, Force, Number, Position, Stiffness, Tension};

/// Coefficients of the virtual mass, all in N·m/rad: dampings are divided by the control period, the inertia by its square.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VirtualMass<N: Number> {
    /// Inertia of the mass over the control period squared: `m/T²`.
    pub inertia: Stiffness<N>,
    /// Stiffness `k_f` of the spring between hand's point (HIP) and mass.
    pub stiffness: Stiffness<N>,
    /// Damping between hand's point (HIP) and mass, over the control period: `c_f/T`.
    pub damping: Stiffness<N>,
    /// Divisor of the update, the sum of inertia, coupling stiffness, coupling damping and ground damping per tick: `m/T² + k_f +
    /// c_f/T + c_env/T`. Never zero.
    pub total: Stiffness<N>,
    /// The sum `total` prepared as a divisor, for fast division.
    pub by_total: Divisor<N>,
}

/// State of the virtual mass, measured from the wall's surface.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MassState<N: Number> {
    /// Penetration of the mass into the wall (its position less the surface's).
    pub position: Position<N>,
    /// Displacement of the mass in the last tick (its velocity times the control period).
    pub moved: Position<N>,
}

impl<N: Number> MassState<N> {
    /// The state of the mass after this displacement.
    #[inline(always)]
    #[must_use]
    pub fn moved_by(self, step: Position<N>) -> Self {
        Self {
            position: self.position + step,
            moved: step,
        }
    }
}

impl<N: Number> VirtualMass<N> {
    /// The force that drives the mass, without the wall's force: the sum of inertia, coupling spring and coupling damper. `e` is
    /// the penetration of the hand's point, `moved` its displacement in this tick.
    ///
    /// The sum cannot overflow: it is at most `total · 2^(BITS-1)`. Settings are refused if `total` is more than half of the
    /// largest stiffness of the number format.
    #[inline(always)]
    pub fn drive(&self, mass: &MassState<N>, e: Position<N>, moved: Position<N>) -> Tension<N> {
        (self.inertia * mass.moved)
            .plus_fitting(self.stiffness * (e - mass.position))
            .plus_fitting(self.damping * moved)
    }

    /// The driving force while the mass is not coupled to the hand's point (HIP): only the inertia term of the mass' own motion.
    #[inline(always)]
    pub fn coast(&self, mass: &MassState<N>) -> Tension<N> {
        self.inertia * mass.moved
    }

    /// Displacement of the mass in this tick, under the driving force and the wall's force. The displacement is rounded towards
    /// zero and kept within the range of positions, because the energy observer must count exactly the displacement that the mass
    /// makes.
    #[inline(always)]
    pub fn displacement(
        &self,
        from: Position<N>,
        drive: Tension<N>,
        force: Force<N>,
    ) -> Position<N> {
        // The sum is at most an eighth of the double word; the force is a word that is shifted up by less than half of its bits.
        let step = drive.minus_fitting(force.lift()).per(&self.by_total);
        from + step - from
    }

    /// The wall's force under which the mass moves outward by exactly `out`. The force is rounded up, so that the mass never
    /// moves further than `out`, and is 0 if the wall would have to pull.
    #[inline(always)]
    pub fn force_for_retreat(&self, drive: Tension<N>, out: Position<N>) -> Force<N> {
        drive.plus_fitting(self.total * out).outward_up()
    }

    /// Force on the hand's point (HIP) by the spring and damper between it and the mass, after the mass has moved.
    #[inline(always)]
    pub fn coupling(&self, mass: &MassState<N>, e: Position<N>, moved: Position<N>) -> Force<N> {
        (self.stiffness * (e - mass.position))
            .plus_fitting(self.damping * (moved - mass.moved))
            .towards_zero()
    }

    /// Position at which the mass rests while the hand's point (HIP) is held at `e` and the wall is a spring `k` without offset: `e
    /// k_f / (k_f + k)`, where `k_f` is the coupling stiffness and `stiffness_sum` is `k_f + k`.
    #[inline(always)]
    pub fn rest(&self, e: Position<N>, stiffness_sum: &Divisor<N>) -> Position<N> {
        (self.stiffness * e).per(stiffness_sum)
    }

    /// Energy in the coupling spring at this stretch, rounded up. `None` if the spring's force is outside the number format: a
    /// saturated force would give too small an energy.
    #[inline(always)]
    pub fn stored(&self, stretch: Position<N>) -> Option<Energy<N>> {
        let tension = self.stiffness * stretch.modulus();
        let force = tension.outward_up();
        let doubled = force * stretch.modulus();
        (force.lift() >= tension).then_some(Energy(N::half_energy_up(doubled.0)))
    }
}

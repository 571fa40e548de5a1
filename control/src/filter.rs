//! The virtual mass of the enhanced law as a filter (thesis §3.5), discretised by backward Euler.
//!
//! A virtual mass hangs on the hand's point (HIP) by a spring `k_f` and a damper `c_f`, and is damped to ground by `c_env`. With
//! `d = T v_f`, everything in N·m/rad (`M = m/T²`, `C = c_f/T`, `G = c_env/T`) and `D = M + k_f + C + G`, one tick is
//!
//! ```text
//! N0 = M d + k_f (x - x_f) + C Δx        drives the mass, without the wall's force f_p
//! d' = (N0 - f_p) / D   towards zero     x_f' = x_f + d'
//! F  = k_f (x - x_f') + C (Δx - d')      force on the HIP
//! ```
//!
//! Backward Euler is passive at the HIP's discrete port for every `M, k_f, C, G >= 0`. The force `F` is passive at the physical
//! port if the device's damping is at least `k_f T/2 + c_f`. `d'` is one quotient of exact sums rounded towards zero. The remainder
//! of that rounding, `r = N0 - f_p - D d'`, has the sign of `d'`, so it acts like dry friction and can only dissipate energy. `f_p`
//! is chosen from the mass' position *before* the update, which can inject energy unless `c_env >= k_v T/2`.

use crate::{Divisor, Energy, Force, Number, Position, Stiffness, Tension};

/// Coefficients of the virtual mass, damping and inertia per tick, all in N·m/rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VirtualMass<N: Number> {
    /// Inertia of the mass per tick squared: `m/T²`.
    pub inertia: Stiffness<N>,
    /// Stiffness `k_f` of the spring between HIP and mass.
    pub stiffness: Stiffness<N>,
    /// Damping per tick between HIP and mass: `c_f/T`.
    pub damping: Stiffness<N>,
    /// Sum `D` of the coefficients: `m/T² + k_f + c_f/T + c_env/T`, never zero.
    pub total: Stiffness<N>,
    /// The sum `total`, prepared as a divisor.
    pub by_total: Divisor<N>,
}

/// State of the virtual mass, measured from the wall's surface.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MassState<N: Number> {
    /// Penetration of the mass into the wall, `x_f - x_s`.
    pub position: Position<N>,
    /// Displacement of the mass in the last tick, `T v_f`.
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
    /// The sum that drives the mass, without the wall's force: `M d + k_f (e - e_f) + C Δe`.
    ///
    /// The sum cannot overflow: it is at most `total · 2^(BITS-1)`, and `validate` keeps `total` to at most a quarter of the word.
    #[inline(always)]
    pub fn drive(&self, mass: &MassState<N>, e: Position<N>, moved: Position<N>) -> Tension<N> {
        (self.inertia * mass.moved)
            .plus_fitting(self.stiffness * (e - mass.position))
            .plus_fitting(self.damping * moved)
    }

    /// The sum that drives the mass while it is not coupled to the HIP: the inertia term of its own motion alone.
    #[inline(always)]
    pub fn coast(&self, mass: &MassState<N>) -> Tension<N> {
        self.inertia * mass.moved
    }

    /// Displacement of the mass under the driving sum and the wall's force. It is rounded towards zero and kept within the range of
    /// positions, because the energy observer must count exactly the displacement that the mass makes.
    #[inline(always)]
    pub fn displacement(
        &self,
        from: Position<N>,
        drive: Tension<N>,
        force: Force<N>,
    ) -> Position<N> {
        // An eighth of the double word at most, and a word shifted up by less than half of its bits.
        let step = drive.minus_fitting(force.lift()).per(&self.by_total);
        from + step - from
    }

    /// The wall's force under which the mass moves outward by exactly `out`. It is rounded up, so that the mass never moves further
    /// than its forces say, and is 0 where the wall would have to pull.
    #[inline(always)]
    pub fn force_for_retreat(&self, drive: Tension<N>, out: Position<N>) -> Force<N> {
        drive.plus_fitting(self.total * out).outward_up()
    }

    /// Force of spring and damper on the HIP after the mass has moved.
    #[inline(always)]
    pub fn coupling(&self, mass: &MassState<N>, e: Position<N>, moved: Position<N>) -> Force<N> {
        (self.stiffness * (e - mass.position))
            .plus_fitting(self.damping * (moved - mass.moved))
            .towards_zero()
    }

    /// Position at which the mass rests with the HIP at `e`, if the wall is a spring `k` without offset: `e k_f / (k_f + k)`.
    #[inline(always)]
    pub fn rest(&self, e: Position<N>, stiffness_sum: &Divisor<N>) -> Position<N> {
        (self.stiffness * e).per(stiffness_sum)
    }

    /// Energy in the coupling spring at this stretch, rounded up. `None` if the spring's force is beyond the format: a saturated
    /// force would give too small an energy.
    #[inline(always)]
    pub fn stored(&self, stretch: Position<N>) -> Option<Energy<N>> {
        let tension = self.stiffness * stretch.modulus();
        let force = tension.outward_up();
        let doubled = force * stretch.modulus();
        (force.lift() >= tension).then_some(Energy(N::half_energy_up(doubled.0)))
    }
}

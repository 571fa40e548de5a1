//! Runs a cell of the comparison tick by tick in two halves: the wall ([`CellWall`]), and the device in the hand ([`CellPlant`]).

use super::texture::Textured;
use super::tuned_wall::TunedWall;
use super::{
    Approach, Cell, Crossed, Deviation, HeldMechanism, N, ProbingMotion, RATE_HZ, Stopped, place,
    pressed, settings_for,
};
use touchstone_control::space::{
    Bounding, Leaving, LengthUnit, Magnitude, PerAxis, Rule, Shape, Shell, SpaceWall, SurfacePoint,
};
use touchstone_control::{AnyLaw, Force, Reported as _, SettingsError};
use touchstone_world::plant::FIRM_TRANSLATION;

/// The wall of a cell: the object with its control law, and the energy guard if the cell has the shipped wall.
#[derive(Debug, Clone)]
pub struct CellWall {
    wall: SpaceWall<N, Textured<Shape<N>>, AnyLaw<N>>,
    is_too_fast: bool,
}

impl CellWall {
    /// The wall before the first touch.
    ///
    /// # Errors
    /// The control law does not accept its settings; it accepts those of [`super::settings`].
    pub fn new(cell: &Cell) -> Result<Self, SettingsError> {
        Ok(Self {
            wall: wall(cell)?,
            is_too_fast: false,
        })
    }

    /// Runs one tick (control period): takes the measured position in m, returns the force on the hand in N. The force is 0 above
    /// the guard's over-speed limit.
    pub fn tick(&mut self, measured_m: [f64; 3]) -> [f64; 3] {
        let force = self.wall.tick(place(measured_m.map(|x| x * 1e3)));
        self.is_too_fast = force.is_err();
        let force = force.unwrap_or_default();
        force.0.map(|f| N::signal_to_f64(f.0))
    }

    /// Whether the last tick was above the guard's over-speed limit.
    #[must_use]
    pub fn is_too_fast(&self) -> bool {
        self.is_too_fast
    }

    /// Energy in the guard's account, J; `None` for a wall without a guard.
    #[must_use]
    pub fn account_j(&self) -> Option<f64> {
        let (_, state) = self.wall.guard.as_ref()?;
        // The wall's unit of length is a centimetre.
        Some(N::energy_to_f64(state.account.0) / 100.0)
    }
}

/// Device and hand of a cell, without the wall. With the forces of [`CellWall`] they move exactly as in [`super::run`].
#[derive(Debug, Clone)]
pub struct CellPlant {
    held: HeldMechanism,
    motion: ProbingMotion,
    next: u32,
}

/// Control period, s.
const INTERVAL_S: f64 = 1.0 / RATE_HZ as f64;

impl CellPlant {
    /// Creates device and hand at rest where the hand's motion begins.
    ///
    /// # Errors
    /// [`Stopped`]: the mechanism cannot reach that position.
    pub fn new(cell: &Cell) -> Result<Self, Stopped> {
        let mechanism = cell.mechanism;
        let motion = ProbingMotion::of(cell.object)
            .at_speed(mechanism.slide_mm_per_s())
            .with_push(mechanism.push_n());
        let rest_m = motion.rest_mm(0.0).map(|x| x * 1e-3);
        let held = HeldMechanism::new(
            mechanism,
            &Deviation::NONE,
            &FIRM_TRANSLATION,
            INTERVAL_S,
            rest_m,
        )?;
        Ok(Self {
            held,
            motion,
            next: 0,
        })
    }

    /// The device in the hand.
    #[must_use]
    pub fn held(&self) -> &HeldMechanism {
        &self.held
    }

    /// The motion of the hand.
    #[must_use]
    pub fn motion(&self) -> &ProbingMotion {
        &self.motion
    }

    /// Time since the start, s.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        f64::from(self.next) * INTERVAL_S
    }

    /// Rest point of the hand in the coming tick (control period), m: the position to which the hand's spring pulls.
    #[must_use]
    pub fn rest_m(&self) -> [f64; 3] {
        self.motion.rest_mm(self.time_s()).map(|x| x * 1e-3)
    }

    /// Position that the encoders measure, m.
    ///
    /// # Errors
    /// [`Stopped`]: the counts belong to no position of the mechanism.
    pub fn measured_m(&mut self) -> Result<[f64; 3], Stopped> {
        self.held.measured_m()
    }

    /// Simulates one tick (control period) under a force on the hand, N. `offset_m` is added to the rest point of the hand.
    ///
    /// # Errors
    /// [`Stopped`]: the mechanism cannot reach the position.
    pub fn step(&mut self, force_n: [f64; 3], offset_m: [f64; 3]) -> Result<Crossed, Stopped> {
        let rest_m = self.rest_m();
        let rest_m = std::array::from_fn(|axis| rest_m[axis] + offset_m[axis]);
        let crossed = self.held.step(force_n, rest_m)?;
        self.next += 1;
        Ok(crossed)
    }
}

/// The wall of a cell: an object with its texture, behind its control law.
pub type CellSpaceWall = SpaceWall<N, Textured<Shape<N>>, AnyLaw<N>>;

/// Makes the wall of a cell: its object with its control law, and the energy guard if the cell has the shipped wall.
///
/// # Errors
/// The control law does not accept its settings; it accepts those of [`super::settings`].
pub fn wall(cell: &Cell) -> Result<CellSpaceWall, SettingsError> {
    let mechanism = cell.mechanism;
    let surface = Textured {
        smooth: cell.object.shape(),
        texture: cell.feel.texture,
    };
    if cell.approach == Approach::Shipped {
        let tuned = TunedWall::of(mechanism, RATE_HZ);
        let mut law = tuned.settings(RATE_HZ, mechanism.force_n());
        if let Some(impact) = cell.feel.impact {
            impact.validate(RATE_HZ)?;
            law.impact = impact;
        }
        let estimator = Some(tuned.estimator());
        return pressed::guarded(surface, &law, estimator.as_ref(), mechanism);
    }
    let unit = LengthUnit::Centimetre;
    let law = unit.law::<N>(&settings_for(
        mechanism,
        cell.approach.law(),
        cell.k_desired_n_per_mm,
    ))?;
    let shell = match (cell.approach, law) {
        (Approach::Bounding, AnyLaw::Fba(law, _)) => Shell::Bounding(Bounding::new(law)),
        (Approach::PerAxis, law) => Shell::PerAxis(PerAxis::new([law; 3], Leaving::Projection)),
        (_, law) => Shell::Magnitude(Magnitude::new(law)),
    };
    let limit = Force(N::signal_from_f64(mechanism.force_n()));
    Ok(SpaceWall::new(
        surface,
        SurfacePoint::new(Rule::Closest),
        shell,
        limit,
    ))
}

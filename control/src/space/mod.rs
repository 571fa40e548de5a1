//! Three degrees of freedom: laws of one degree of freedom, wrapped so that they give a force vector.
//!
//! ```text
//! HIP -> states -> object -> surface point -> shell (law along the normal, or one per axis) + friction -> saturation -> guard -> force
//! ```
//!
//! HIP is the hand's point. `docs/three-axes.md` has the foundations and the choices that were made. The number formats are those
//! of one degree of freedom; lengths are in a unit that is chosen for the device, [`LengthUnit`]. Forces are vectors on the HIP:
//! they push it out of the object.

pub mod bounding;
pub mod environment;
pub mod friction;
pub mod guard;
pub mod magnitude;
pub mod number;
pub mod per_axis;
pub mod place_estimator;
pub mod root;
pub mod scalar;
pub mod surface_point;
pub mod touch;
pub mod unit;
pub mod vector;
pub mod wall;

pub use bounding::Bounding;
pub use environment::{Nearest, Shape, Surface};
pub use friction::{Friction, FrictionError, FrictionSettings, FrictionState};
pub use guard::{VectorGuard, VectorGuardState};
pub use magnitude::Magnitude;
pub use number::{Axes, Spatial};
pub use per_axis::{Leaving, PerAxis};
pub use place_estimator::{PlaceAhead, PlaceEstimator};
pub use scalar::{Along, Held};
pub use surface_point::{Rule, SurfacePoint};
pub use touch::{Touch, Track};
pub use unit::LengthUnit;
pub use vector::{Direction, Turn, Vector};
pub use wall::{Shell, SpaceWall};

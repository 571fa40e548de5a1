//! Triangle meshes as virtual objects, for the desktop.
//!
//! [`Mesh`] is the object, from vertices or an STL file; [`Proxy`] is a point that stays on its surface while the hand goes in (the
//! god-object of Zilles and Salisbury, IROS 1995); [`MeshSurface`] shows the two to [`touchstone_control::space`] as any other object.

mod mesh;
mod proxy;
mod surface;

pub use mesh::{Mesh, MeshError};
pub use proxy::Proxy;
pub use surface::MeshSurface;

pub use parry3d_f64::math::Vector;

//! Triangle meshes as virtual objects for haptic devices, on the desktop.
//!
//! [`Mesh`] is the object, made from vertices or read from an STL, OBJ or PLY file. `Proxy` is a point that stays on the mesh's
//! surface while the hand's point is inside (the god-object of Zilles and Salisbury, IROS 1995). [`MeshSurface`] joins mesh and
//! proxy to an object for [`touchstone_control::space`].
//!
//! The crate needs the feature `geometry`. Without it no mesh can be made, and an error says how to build the program with the
//! feature.

#[cfg(any(not(feature = "geometry"), test))]
// Tests use only one function of this module, so the rest would count as dead code.
#[cfg_attr(test, allow(dead_code))]
mod absent;
#[cfg(feature = "geometry")]
mod face;
#[cfg(feature = "geometry")]
mod file;
#[cfg(feature = "geometry")]
mod mesh;
#[cfg(feature = "geometry")]
mod obj;
#[cfg(feature = "geometry")]
mod odd;
#[cfg(feature = "geometry")]
mod ply;
#[cfg(feature = "geometry")]
mod proxy;
#[cfg(feature = "geometry")]
mod stl;
#[cfg(feature = "geometry")]
mod surface;
#[cfg(feature = "geometry")]
mod tree;
#[cfg(feature = "geometry")]
mod triangles;
#[cfg(feature = "geometry")]
mod words;

#[cfg(not(feature = "geometry"))]
pub use absent::{Mesh, MeshSurface};
#[cfg(feature = "geometry")]
pub use mesh::{Mesh, MeshError};
#[cfg(feature = "geometry")]
pub use odd::Edges;
#[cfg(feature = "geometry")]
pub use parry3d_f64::math::Vector;
#[cfg(feature = "geometry")]
pub use proxy::Proxy;
#[cfg(feature = "geometry")]
pub use surface::MeshSurface;
#[cfg(feature = "geometry")]
pub use triangles::MOST_TRIANGLES;

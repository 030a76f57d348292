//! Steering what is looked at, apart from any window: a camera over the land, the land under a cursor, the pose of a deformed
//! map. Drags, wheels and keys of a desktop window and of a browser come in as pixels and seconds.

mod camera;
mod ground;
mod pose;

pub use camera::{Drive, Mode, Rig};
pub use ground::{Ground, ray_through};
pub use pose::Pose;

//! Tests of the hand's motions and of reading recorded motions.

mod recordings;
mod recordings_as_people_have_them;
mod resampling;
mod shapes;

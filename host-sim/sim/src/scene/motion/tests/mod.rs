//! Tests of the hand's motions and of recordings.

mod recordings;
mod resampling;
mod shapes;

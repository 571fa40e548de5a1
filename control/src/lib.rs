//! Stiff virtual walls in fixed point.
#![no_std]

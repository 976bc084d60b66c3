//! Robots written by hand, generic over the scalar; their Jacobians by dual numbers.
#![allow(dead_code, unreachable_pub)] // Each test file uses its own part.

pub mod arms;
pub mod dual;
pub mod robots;

//! One program: controller and robots are compiled once for all of these tests.

mod closed_loop;
mod common;
mod estimator;
mod faults;
mod payload;

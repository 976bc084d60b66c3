//! One program: the planner is compiled once for all of these tests.

mod arms;
mod common;
mod examined_motions;
mod files;
mod floor;
mod gain_plans;
mod gains;
mod motions;
mod reference_plans;
mod refined;
mod tasks;

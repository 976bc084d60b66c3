//! What the rooms say and do together. One program: generic code is compiled once for all of these tests.

mod closed_forms;
mod closed_loop;
mod closed_loop_estimator;
mod closed_loop_random;
mod closed_loop_regulator;
mod emission;
mod equations;
mod handwritten;
mod parameters;
mod planning;
mod refined_arms;
mod refined_robots;
mod refusals;
mod robots;

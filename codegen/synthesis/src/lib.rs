//! Gains of a balancing robot's controller from its derived equations.
#![forbid(unsafe_code)]

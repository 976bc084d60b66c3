//! One module per command.

pub(crate) mod check;
pub(crate) mod deploy;
pub(crate) mod derive;
pub(crate) mod drive;
pub(crate) mod emit;
pub(crate) mod eval;
pub(crate) mod experiments;
pub(crate) mod explain;
pub(crate) mod inspect;
pub(crate) mod operator;
pub(crate) mod plan;
pub(crate) mod robots;
pub(crate) mod robustness;
pub(crate) mod run;
pub(crate) mod simulate;
pub(crate) mod table;

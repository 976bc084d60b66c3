//! `shapebot`: from the model of a balancing robot to equations, code, plans and numbers.
//!
//! A command-line tool; [`main`] is all that there is to call.
#![forbid(unsafe_code)]

mod args;
mod commands;
mod drive;
mod failure;
mod output;
mod plot;
mod robot;

use args::{Cli, Command};
use clap::Parser;
use failure::Outcome;
use std::process::ExitCode;

/// Does what the command line says; the exit code is the program's.
#[must_use]
pub fn main() -> ExitCode {
    match run(&Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

fn run(cli: &Cli) -> Outcome {
    match &cli.command {
        None => commands::experiments::everything(&cli.output),
        Some(Command::Table(args)) => commands::table::run(&args.output).map(|_| ()),
        Some(Command::Simulate(args)) => commands::simulate::run(args),
        Some(Command::Experiments(args)) => commands::experiments::run(&args.output),
        Some(Command::Robustness(args)) => commands::robustness::run(args),
        Some(Command::Run(args)) => commands::run::run(args),
        Some(Command::DriveSim(args)) => commands::run::drive_sim(args),
        Some(Command::Drive(args)) => commands::drive::run(args),
        Some(Command::Monitor(args)) => commands::operator::monitor(args),
        Some(Command::Order(args)) => commands::operator::command(args),
        Some(Command::Robots) => commands::robots::run(),
        Some(Command::Check(args)) => commands::check::run(args),
        Some(Command::Derive(args)) => commands::derive::run(args),
        Some(Command::Emit(args)) => commands::emit::run(args),
        Some(Command::Plan(args)) => commands::plan::run(args),
        Some(Command::Inspect(args)) => commands::inspect::run(args),
        Some(Command::Deploy(args)) => commands::deploy::run(args),
        Some(Command::Eval(args)) => commands::eval::run(args),
        Some(Command::Explain(args)) => commands::explain::run(args),
    }
}

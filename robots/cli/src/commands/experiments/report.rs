//! The report: robots with their equations and proofs, runs with plots and animations.

use crate::failure::{Failure, Outcome};
use crate::robot::{Dynamics, Source, prove};
use shapebot_codegen::equations::to_latex;
use shapebot_experiments::{Experiment, run_page};
use shapebot_report::{Control, Report, RobotPage, Table};
use shapebot_tasks::simulation::Paper;
use std::path::Path;

const SUMMARY: &str = "\
Plans of shape-accelerated balancing robots, each followed by its controller on the simulated robot. The \
plan is read from the bytes of its file, as a robot would read it.";

/// A report in the making.
#[derive(Default)]
pub(crate) struct Pages {
    report: Report,
}

impl Pages {
    pub(crate) fn add_table(&mut self, table: Table) {
        self.report.tables.push(table);
    }

    pub(crate) fn has_robot(&self, name: &str) -> bool {
        self.report.robots.iter().any(|robot| robot.name == name)
    }

    /// Equations, proof, parameters and controller.
    pub(crate) fn add_robot(&mut self, source: &Source, robot: &dyn Dynamics) -> Outcome {
        let description = robot.description();
        let (model, equations, certificate) = prove(&source.text()?)?;
        let mut page = RobotPage::from_description(description);
        page.equations = to_latex((&model, &equations, &certificate));
        page.certificate = certificate.to_text();
        let (design, poles) = (robot.control()?, robot.robot()?.poles()?);
        page.control = Some(Control::from_design(description, design, &poles));
        self.report.robots.push(page);
        Ok(())
    }

    pub(crate) fn add_run(&mut self, experiment: &Experiment, paper: &Paper) {
        self.report.runs.push(run_page(experiment, paper));
    }

    pub(crate) fn write(mut self, path: &Path) -> Outcome {
        self.report.title = match self.report.runs.as_slice() {
            [run] => run.title.clone(),
            _ => "Balancing by shape".to_owned(),
        };
        self.report.summary = SUMMARY.to_owned();
        if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder).map_err(|e| Failure::file("create", folder, &e))?;
        }
        self.report.write(path).map_err(Failure::usage)
    }
}

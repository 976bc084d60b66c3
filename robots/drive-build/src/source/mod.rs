//! A description as it is written, before it is checked against a model.

mod nodes;
mod robot;

use crate::error::{Complaints, Errors, Said, Spot};
use crate::reader::{Context, Table};
pub(crate) use nodes::{Motor, NodeSource, ObjectSource, PdoSource, TypeSource, Unit};
pub(crate) use robot::{
    AxisSource, BusSource, OperatorSource, Ratio, SafetySource, SharedSource, TimingSource,
    YawSource,
};
use toml::de::DeTable;

/// A description as it is written.
#[derive(Clone, Debug)]
pub struct Source {
    pub(crate) file: String,
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) robot: Said<String>,
    pub(crate) timing: TimingSource,
    pub(crate) buses: Vec<BusSource>,
    pub(crate) types: Vec<TypeSource>,
    pub(crate) nodes: Vec<NodeSource>,
    pub(crate) axes: Vec<AxisSource>,
    pub(crate) shared: Vec<SharedSource>,
    pub(crate) yaw: Option<YawSource>,
    pub(crate) safety: SafetySource,
    pub(crate) operator: OperatorSource,
}

const KEYS: [&str; 11] = [
    "title", "robot", "timing", "bus", "type", "node", "axis", "shared", "yaw", "safety",
    "operator",
];

impl Source {
    /// Reads a description; `file` is its name, for messages.
    ///
    /// # Errors
    ///
    /// All that is wrong with its form, with line and key.
    pub fn parse(file: &str, text: &str) -> Result<Self, Errors> {
        let complaints = Complaints::new(file);
        let context = Context { text, complaints: &complaints };
        let document = match DeTable::parse(text) {
            Ok(document) => document,
            Err(error) => {
                let at = error.span().map_or(0, |span| span.start);
                complaints.add(&context.spot(at, ""), error.message());
                return Err(complaints.into_errors());
            }
        };
        let read = read(file, &Table::root(context, &document));
        match read {
            Some(source) if complaints.is_empty() => Ok(source),
            _ => Err(complaints.into_errors()),
        }
    }

    /// Name of the model that the description is for.
    #[must_use]
    pub fn robot(&self) -> &str {
        &self.robot.value
    }

    /// Title, for people.
    #[must_use]
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Where the robot is named.
    #[must_use]
    pub fn robot_spot(&self) -> &Spot {
        &self.robot.spot
    }
}

/// The whole file; every part is read before the first missing one ends it.
fn read(file: &str, root: &Table<'_>) -> Option<Source> {
    root.only(&KEYS);
    let title = root.require("title").and_then(|title| title.name());
    let robot = root.require("robot").and_then(|robot| robot.name());
    let part = |key| root.require(key).and_then(|value| value.table());
    let timing = part("timing").and_then(|table| robot::timing(&table));
    let safety = part("safety").and_then(|table| robot::safety(&table));
    let operator = part("operator").and_then(|table| robot::operator(&table));
    let _ = (root.require("bus"), root.require("type"), root.require("node"), root.require("axis"));
    let buses = each(root, "bus", robot::bus);
    let types = each(root, "type", nodes::node_type);
    let nodes = each(root, "node", nodes::node);
    let axes = each(root, "axis", robot::axis);
    let shared = root.get("shared").and_then(|value| value.list()).unwrap_or_default();
    let shared: Vec<_> = shared.iter().filter_map(|entry| robot::shared(&entry.table()?)).collect();
    let yaw = root.get("yaw").map(|value| value.table().and_then(|table| robot::yaw(&table)));
    let yaw = match yaw {
        Some(yaw) => Some(yaw?),
        None => None,
    };
    let stem = file.rsplit(['/', '\\']).next().unwrap_or(file);
    Some(Source {
        file: file.to_owned(),
        name: stem.strip_suffix(".toml").unwrap_or(stem).to_owned(),
        title: title?.value,
        robot: robot?,
        timing: timing?,
        buses,
        types,
        nodes,
        axes,
        shared,
        yaw,
        safety: safety?,
        operator: operator?,
    })
}

/// The named tables of a key.
fn each<T>(
    root: &Table<'_>,
    key: &str,
    read: impl Fn(Said<String>, &Table<'_>) -> Option<T>,
) -> Vec<T> {
    root.tables(key).into_iter().filter_map(|(name, table)| read(name, &table)).collect()
}

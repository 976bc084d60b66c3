//! Figures and set-up as text.

use crate::check::figure;
use crate::description::{DriveDescription, Node};
use crate::message::role_name;
use shapebot_drive::{DataType, SdoStep};
use std::fmt::Write as _;

impl DriveDescription {
    /// Bus loads, timing and resolutions as text.
    #[must_use]
    pub fn report(&self) -> String {
        // Writing to a String cannot fail.
        let mut text = format!("{}\n{} for {}\n\n", self.title, self.name, self.robot);
        for load in &self.loads {
            text.push_str(&load.report());
            text.push('\n');
        }
        text.push_str("one count is worth\n");
        for resolution in &self.resolutions {
            let (step, range) = (figure(resolution.step), figure(resolution.range));
            let _ = write!(
                text,
                "  {:<24} {step} {}, the object holds {range}",
                resolution.what, resolution.unit
            );
            if let Some(wanted) = resolution.wanted {
                let _ = write!(text, ", wanted at most {}", figure(wanted));
            }
            text.push('\n');
        }
        text
    }

    /// The SDO set-up of all nodes as text: index, sub-index, type and value.
    #[must_use]
    pub fn setup_text(&self) -> String {
        self.nodes.iter().map(|node| self.node_setup(node)).collect()
    }

    fn node_setup(&self, node: &Node) -> String {
        let (name, role, id) = (&node.name, role_name(node.role), node.id.raw());
        let bus = &self.buses[usize::from(node.bus)].name;
        let mut text = format!("{name}: {role}, node-ID {id} on bus {bus}\n");
        for step in &node.setup {
            let (way, object, kind, value) = match *step {
                SdoStep::Write { object, kind, value } => ("write ", object, kind, value),
                SdoStep::Expect { object, kind, value, .. } => ("expect", object, kind, value),
            };
            let _ = writeln!(
                text,
                "  {way} 0x{:04X}:{:02X} {:<3} {}",
                object.index,
                object.sub,
                format!("{kind:?}").to_lowercase(),
                value_text(kind, value)
            );
        }
        text.push('\n');
        text
    }
}

fn value_text(kind: DataType, value: u32) -> String {
    let signed = kind.decode(&value.to_le_bytes());
    if (-9..=9).contains(&signed) { signed.to_string() } else { format!("0x{value:X} ({signed})") }
}

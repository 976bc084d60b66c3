//! The frames of a bus as a DBC file.

use crate::description::DriveDescription;
use crate::message::Message;
use shapebot_drive::DataType;
use std::fmt::Write as _;

const TEMPLATE: &str = include_str!("bus.dbc.tera");

/// Name of the master in DBC files.
const MASTER: &str = "master";

impl DriveDescription {
    /// The PDOs, heartbeats and emergency messages of a bus as a DBC file; `None` if there is no such bus.
    #[must_use]
    pub fn dbc(&self, bus: usize) -> Option<String> {
        let own = self.buses.get(bus)?;
        let mut messages: Vec<Message> =
            self.messages().into_iter().filter(|message| message.bus == bus).collect();
        let nodes: Vec<_> = self.nodes.iter().filter(|node| usize::from(node.bus) == bus).collect();
        for node in &nodes {
            messages.push(emergency(&node.name, bus, node.id.emergency()));
            messages.push(heartbeat(Some(&node.name), bus, node.id.heartbeat()));
        }
        messages.push(heartbeat(None, bus, self.operator.master.heartbeat()));
        messages.sort_by_key(|message| message.cob_id);
        let mut context = tera::Context::new();
        context.insert("title", &escaped(&self.title));
        context.insert("bus", &escaped(&own.name));
        let names: Vec<&str> = nodes.iter().map(|node| node.name.as_str()).collect();
        context.insert("nodes", &format!("{MASTER} {}", names.join(" ")).trim_end());
        let text: String = messages.iter().map(message_text).collect();
        context.insert("messages", &text);
        // The template is ours; a mistake in it shows as text that no reader takes for a DBC file.
        Some(tera::Tera::one_off(TEMPLATE, &context, false).unwrap_or_else(|e| e.to_string()))
    }
}

fn escaped(text: &str) -> String {
    text.replace(['"', '\\'], "'")
}

fn signal(name: &str, byte: usize, kind: DataType) -> crate::message::MessageSignal {
    crate::message::MessageSignal { name: name.into(), byte, kind, scale: 1.0, unit: String::new() }
}

fn emergency(node: &str, bus: usize, cob_id: u16) -> Message {
    let signals = vec![
        signal("error_code", 0, DataType::U16),
        signal("error_register", 2, DataType::U8),
        signal("manufacturer", 3, DataType::U32),
    ];
    let (name, sender) = (format!("{node}_emergency"), Some(node.to_owned()));
    Message { name, bus, cob_id, bytes: 8, sender, signals }
}

fn heartbeat(node: Option<&str>, bus: usize, cob_id: u16) -> Message {
    let name = format!("{}_heartbeat", node.unwrap_or(MASTER));
    let signals = vec![signal("nmt_state", 0, DataType::U8)];
    Message { name, bus, cob_id, bytes: 1, sender: node.map(str::to_owned), signals }
}

/// `BO_` with its `SG_` lines: start bit, length, little-endian, sign, scale, range, unit.
fn message_text(message: &Message) -> String {
    let sender = message.sender.as_deref().unwrap_or(MASTER);
    // Writing to a String cannot fail.
    let mut text = String::new();
    let Message { name, cob_id, bytes, .. } = message;
    let _ = writeln!(text, "BO_ {cob_id} {name}: {bytes} {sender}");
    for signal in &message.signals {
        let (low, high) = signal.kind.range();
        let (first, second) = (low as f64 * signal.scale, high as f64 * signal.scale);
        let (least, most) = (first.min(second), first.max(second));
        let _ = writeln!(
            text,
            " SG_ {} : {}|{}@1{} ({},0) [{least}|{most}] \"{}\" {}",
            signal.name,
            8 * signal.byte,
            8 * signal.kind.bytes(),
            if signal.kind.is_signed() { '-' } else { '+' },
            signal.scale,
            signal.unit,
            if message.sender.is_some() { MASTER } else { "Vector__XXX" },
        );
    }
    text.push('\n');
    text
}

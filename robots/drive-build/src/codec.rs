//! Codecs: a struct for each frame, and the straight-line code by which the master reads or fills it.

use crate::description::{Command, DriveDescription};
use crate::emit::{camel, constant, hex16, ident, kind_tokens};
use crate::message::{Message, MessageSignal};
use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};
use shapebot_drive::{DataType, Entry, Field, Pdo, Signal, Source};

impl DriveDescription {
    /// What the master calls of each frame, in the order of [`Self::messages`].
    pub(crate) fn straight_lines(&self) -> Vec<TokenStream> {
        let sent = self.nodes.iter().flat_map(|node| &node.transmit);
        let commands = self.commands.iter().map(|command| self.writer_tokens(command));
        sent.map(reader_tokens).chain(commands).collect()
    }

    /// A [`Writer`](shapebot_drive::Writer).
    fn writer_tokens(&self, command: &Command) -> TokenStream {
        let mut at = 0;
        let mut written = Vec::new();
        let mut fields = Vec::new();
        for Field { kind, source } in &command.fields {
            let value = self.value_tokens(*source);
            let bytes: Vec<_> = (at..at + kind.bytes()).map(|at| format_ident!("b{at}")).collect();
            at += kind.bytes();
            let Some(value) = value else {
                written.extend(bytes.iter().map(|_| quote!(0)));
                continue;
            };
            let (kind, rest) = (kind_tokens(*kind), (bytes.len() < 4).then(|| quote!(, ..)));
            fields.push(quote!(let [#(#bytes),* #rest] = #kind.low_bytes(#value);));
            written.extend(bytes.iter().map(|name| quote!(#name)));
        }
        written.resize(8, quote!(0));
        let from = if fields.is_empty() { quote!(_) } else { quote!(from) };
        quote! {
            /// Its bytes from what the master sends.
            #[must_use]
            pub fn write(#from: &Outputs<'_>) -> [u8; 8] {
                #(#fields)*
                [#(#written),*]
            }
        }
    }

    /// What a field holds; `None` is zero.
    fn value_tokens(&self, source: Source) -> Option<TokenStream> {
        let index = |index: u8| Literal::u8_unsuffixed(index);
        match source {
            Source::Zero => None,
            Source::Controlword { node } => {
                let node = index(node);
                Some(quote!(from.controlword(#node).into()))
            }
            Source::Mode { node } => {
                let motor = self.nodes.get(usize::from(node))?.motor?;
                let mode = Literal::i8_unsuffixed(motor.mode);
                Some(quote!(#mode))
            }
            Source::Torque { axis, sign } => {
                let (axis, negative) = (index(axis), (sign < 0).then(|| quote!(.saturating_neg())));
                Some(quote!(from.torque(#axis) #negative))
            }
            Source::Legs => Some(quote!(from.legs_command().into())),
        }
    }
}

/// A [`Reader`](shapebot_drive::Reader).
fn reader_tokens(pdo: &Pdo) -> TokenStream {
    let mut at = 0;
    let mut used = [false; 8];
    let mut calls = Vec::new();
    for entry in pdo.entries() {
        let range = at..at + entry.kind.bytes();
        at = range.end;
        let Some(call) = call_tokens(entry, range.clone()) else { continue };
        calls.push(call);
        used.get_mut(range).into_iter().flatten().for_each(|used| *used = true);
    }
    let bytes = used.iter().enumerate().map(|(at, used)| {
        let name = format_ident!("b{at}");
        if *used { quote!(#name) } else { quote!(_) }
    });
    let to = if calls.is_empty() { quote!(_) } else { quote!(to) };
    quote! {
        /// Its numbers to the master.
        pub fn read(data: &[u8; 8], #to: &mut Readings<'_>) {
            let [#(#bytes),*] = *data;
            #(#calls)*
        }
    }
}

/// The call for a number; `None` for what the master does not read.
fn call_tokens(entry: &Entry, range: core::ops::Range<usize>) -> Option<TokenStream> {
    let (kind, bytes) = (rust_type(entry.kind), range.map(|at| format_ident!("b{at}")));
    let (count, scale) = (quote!(#kind::from_le_bytes([#(#bytes),*])), entry.scale);
    let scaled = |name: &str| {
        let name = ident(name);
        Some(quote!(to.#name(#count, #scale);))
    };
    let bare = |name: &str| {
        let name = ident(name);
        Some(quote!(to.#name(#count);))
    };
    let indexed = |name: &str, index: u8| {
        let (name, index) = (ident(name), Literal::u8_unsuffixed(index));
        Some(quote!(to.#name(#index, #count, #scale);))
    };
    match entry.signal {
        Signal::Statusword => bare("statusword"),
        Signal::ModeDisplay => bare("mode_display"),
        Signal::ErrorRegister => bare("error_register"),
        Signal::Health => bare("health"),
        Signal::LegsState => bare("legs_state"),
        Signal::Sequence => bare("sequence"),
        Signal::Position => scaled("position"),
        Signal::Velocity => scaled("velocity"),
        Signal::ActualTorque => scaled("actual_torque"),
        Signal::Heading => scaled("heading"),
        Signal::HeadingRate => scaled("heading_rate"),
        Signal::Yaw => scaled("yaw"),
        Signal::Coordinate(index) => indexed("coordinate", index),
        Signal::Rate(index) => indexed("rate", index),
        Signal::Gap | Signal::Controlword | Signal::Mode | Signal::Torque | Signal::LegsCommand => {
            None
        }
    }
}

/// A struct for a frame, with `decode`, `encode` and what the master calls.
pub(crate) fn frame_tokens(message: &Message, straight_line: &TokenStream) -> TokenStream {
    let name = ident(&camel(&message.name));
    let from = message.sender.as_deref().map_or("the master".into(), |node| format!("`{node}`"));
    let doc = format!(" From {from}: COB-ID 0x{:03X}, {} bytes.", message.cob_id, message.bytes);
    let (id, bytes) = (hex16(message.cob_id), message.bytes);
    let fields = message.signals.iter().map(|signal| {
        let (field, kind) = (ident(&signal.name), rust_type(signal.kind));
        let doc = signal_doc(signal);
        quote!(#[doc = #doc] pub #field: #kind)
    });
    let scales = message.signals.iter().filter(|signal| !signal.unit.is_empty()).map(|signal| {
        let scale_name = constant(&signal.name, "_SCALE");
        let (scale, doc) =
            (signal.scale as f32, format!(" One count of `{}`, {}.", signal.name, signal.unit));
        quote!(#[doc = #doc] pub const #scale_name: f32 = #scale;)
    });
    let bindings = (0..bytes).map(|index| byte_name(index, message));
    let reads = message.signals.iter().map(|signal| {
        let (field, kind) = (ident(&signal.name), rust_type(signal.kind));
        let parts =
            (signal.byte..signal.byte + signal.kind.bytes()).map(|at| format_ident!("b{at}"));
        quote!(#field: #kind::from_le_bytes([#(#parts),*]))
    });
    let splits = message.signals.iter().map(|signal| {
        let field = ident(&signal.name);
        let parts =
            (signal.byte..signal.byte + signal.kind.bytes()).map(|at| format_ident!("b{at}"));
        quote!(let [#(#parts),*] = self.#field.to_le_bytes();)
    });
    let written = (0..bytes).map(|index| {
        if is_used(index, message) {
            let name = format_ident!("b{index}");
            quote!(#name)
        } else {
            quote!(0)
        }
    });
    quote! {
        #[doc = #doc]
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct #name { #(#fields),* }
        impl #name {
            /// Identifier.
            pub const COB_ID: u16 = #id;
            #(#scales)*
            /// The numbers of a frame, `None` unless identifier and length are those of this PDO.
            #[must_use]
            pub fn decode(frame: &Frame) -> Option<Self> {
                if frame.standard_id() != Some(Self::COB_ID) {
                    return None;
                }
                let [#(#bindings),*] = frame.exactly::<#bytes>()?;
                Some(Self { #(#reads),* })
            }
            /// The frame with these numbers.
            #[must_use]
            pub fn encode(self) -> Frame {
                #(#splits)*
                Frame::new(Self::COB_ID, &[#(#written),*])
            }
            #straight_line
        }
    }
}

fn is_used(index: usize, message: &Message) -> bool {
    let inside =
        |signal: &MessageSignal| (signal.byte..signal.byte + signal.kind.bytes()).contains(&index);
    message.signals.iter().any(inside)
}

fn byte_name(index: usize, message: &Message) -> TokenStream {
    let name = format_ident!("b{index}");
    if is_used(index, message) { quote!(#name) } else { quote!(_) }
}

fn signal_doc(signal: &MessageSignal) -> String {
    let name = signal.name.replace('_', " ");
    match signal.unit.as_str() {
        "" => format!(" {name}."),
        unit => format!(" {name}, counts of {} {unit}.", signal.scale),
    }
}

fn rust_type(kind: DataType) -> Ident {
    ident(&format!("{kind:?}").to_lowercase())
}

//! Rust source of a description: tables and codecs.

use crate::codec::frame_tokens;
use crate::description::{Axis, Command, DriveDescription, Node};
use crate::message::{Message, role_name};
use proc_macro2::{Group, Ident, Literal, Span, TokenStream, TokenTree};
use quote::quote;
use shapebot_drive::{DataType, Entry, Field, Object, Pdo, Role, SdoStep, Signal, Source};

impl DriveDescription {
    /// One public module with [`DriveTable`](shapebot_drive::DriveTable) `DRIVE`, and the codecs of all
    /// PDOs in `frames`. The text is a pure function of the description.
    #[must_use]
    pub fn rust(&self) -> String {
        let tokens = unsuffixed(self.tokens());
        // What we emit parses; if not, the compiler of the output says so at the place.
        match syn::parse2::<syn::File>(tokens.clone()) {
            Ok(file) => prettyplease::unparse(&file),
            Err(_) => tokens.to_string(),
        }
    }

    fn tokens(&self) -> TokenStream {
        let module = ident(&self.name);
        let doc = format!(" {} (model `{}`).", self.title, self.robot);
        let table = self.table_tokens();
        let buses = self.bus_tokens();
        let messages = self.messages();
        let codec = |bus: u8, cob_id: u16| {
            let same =
                |message: &&Message| message.bus == usize::from(bus) && message.cob_id == cob_id;
            messages.iter().find(same).map(|message| ident(&camel(&message.name)))
        };
        let nodes = self.nodes.iter().map(|node| node_tokens(node, &codec));
        let node_list = self.nodes.iter().map(|node| constant(&node.name, ""));
        let axes = self.axes.iter().map(axis_tokens);
        let commands = self.commands.iter().map(|command| command_tokens(command, &codec));
        let (node_count, axis_count) = (self.nodes.len(), self.axes.len());
        let command_count = self.commands.len();
        let yaw_table = self.yaw.map(|_| quote!(YawTable,));
        let frames = messages.iter().zip(self.straight_lines());
        let frames = frames.map(|(message, code)| frame_tokens(message, &code));
        quote! {
            #[doc = #doc]
            #[rustfmt::skip]
            #[allow(clippy::approx_constant, reason = "numbers of a description")]
            pub mod #module {
                use ::shapebot_drive::{
                    AxisTable, BusTable, CommandTable, DataType, DriveTable, Entry, Field, MotorTable,
                    NodeId, NodeTable, OperatorTable, Pdo, Role, SafetyTable, SdoStep, Signal, Source,
                    Timing, #yaw_table object,
                };
                #table
                #buses
                #(#nodes)*
                const NODES: [NodeTable<'static>; #node_count] = [#(#node_list),*];
                const AXES: [AxisTable<'static>; #axis_count] = [#(#axes),*];
                const COMMANDS: [CommandTable<'static>; #command_count] = [#(#commands),*];
                /// Codecs of all PDOs.
                pub mod frames {
                    use ::shapebot_drive::{DataType, Frame, Outputs, Readings};
                    #(#frames)*
                }
            }
        }
    }

    fn table_tokens(&self) -> TokenStream {
        let (name, robot, fingerprint) = (&self.name, &self.robot, hex32(self.fingerprint));
        let coordinates = self.coordinates.len() as u8;
        let (timing, safety) = (self.timing_tokens(), self.safety_tokens());
        let yaw = match &self.yaw {
            None => quote!(None),
            Some(yaw) => {
                let axis = option(yaw.axis.map(|axis| quote!(#axis)));
                let [x, y] = yaw.plane;
                let (stiffness, damping, rate) = (yaw.stiffness, yaw.damping, yaw.rate_limit);
                quote!(Some(YawTable {
                    axis: #axis,
                    plane: [#x, #y],
                    stiffness: #stiffness,
                    damping: #damping,
                    rate_limit: #rate,
                }))
            }
        };
        let (bus, master) = (self.operator.bus, self.operator.master.raw());
        let (command, telemetry) = (hex16(self.operator.command), hex16(self.operator.telemetry));
        quote! {
            /// What the master is given.
            pub const DRIVE: DriveTable<'static> = DriveTable {
                name: #name,
                robot: #robot,
                fingerprint: #fingerprint,
                coordinates: #coordinates,
                timing: #timing,
                buses: &BUSES,
                nodes: &NODES,
                axes: &AXES,
                commands: &COMMANDS,
                yaw: #yaw,
                safety: #safety,
                operator: OperatorTable {
                    bus: #bus,
                    command: #command,
                    telemetry: #telemetry,
                    master: NodeId::clamped(#master),
                },
            };
        }
    }

    fn timing_tokens(&self) -> TokenStream {
        let t = &self.timing;
        let names = [
            ("period_us", t.period_us),
            ("input_window_us", t.input_window_us),
            ("jitter_limit_us", t.jitter_limit_us),
            ("heartbeat_us", t.heartbeat_us),
            ("boot_timeout_us", t.boot_timeout_us),
            ("sdo_timeout_us", t.sdo_timeout_us),
            ("sdo_retries", t.sdo_retries.into()),
            ("enable_timeout_us", t.enable_timeout_us),
            ("missed_warning", t.missed_warning.into()),
            ("missed_fault", t.missed_fault.into()),
        ];
        let fields = names.map(|(name, value)| number_field(name, value));
        quote!(Timing { #(#fields),* })
    }

    fn safety_tokens(&self) -> TokenStream {
        let (s, lean) = (&self.safety.limits, &self.safety.lean);
        let (start, limit, rate) = (s.lean_start, s.lean_limit, s.lean_rate_start);
        let names = [
            ("stale_fault", s.stale_fault.into()),
            ("silent_fault", s.silent_fault.into()),
            ("rise_timeout_us", s.rise_timeout_us),
            ("lower_timeout_us", s.lower_timeout_us),
            ("fault_deadline_us", s.fault_deadline_us),
        ];
        let fields = names.map(|(name, value)| number_field(name, value));
        quote!(SafetyTable {
            lean: &[#(#lean),*],
            lean_start: #start,
            lean_limit: #limit,
            lean_rate_start: #rate,
            #(#fields),*
        })
    }

    fn bus_tokens(&self) -> TokenStream {
        let count = self.buses.len();
        let buses = self.buses.iter().map(|bus| {
            let (name, rate) = (&bus.name, Literal::u32_unsuffixed(bus.bit_rate));
            quote!(BusTable { name: #name, bit_rate: #rate })
        });
        quote!(const BUSES: [BusTable<'static>; #count] = [#(#buses),*];)
    }
}

/// The same tokens with `4` for `4u8` and `40.0` for `40f32`: the tables have types.
fn unsuffixed(tokens: TokenStream) -> TokenStream {
    let each = |token| match token {
        TokenTree::Group(group) => {
            TokenTree::Group(Group::new(group.delimiter(), unsuffixed(group.stream())))
        }
        TokenTree::Literal(literal) => TokenTree::Literal(plain(&literal).unwrap_or(literal)),
        other => other,
    };
    tokens.into_iter().map(each).collect()
}

/// A number without its suffix.
fn plain(literal: &Literal) -> Option<Literal> {
    let text = literal.to_string();
    if !text.starts_with(|c: char| c.is_ascii_digit()) || text.starts_with("0x") {
        return None;
    }
    if let Some(number) = text.strip_suffix("f32") {
        let whole = !number.contains(['.', 'e']);
        return format!("{number}{}", if whole { ".0" } else { "" }).parse().ok();
    }
    let suffixes = ["u8", "i8", "i32", "u32", "usize"];
    suffixes.iter().find_map(|suffix| text.strip_suffix(suffix))?.parse().ok()
}

fn number_field(name: &str, value: u32) -> TokenStream {
    let (name, value) = (ident(name), Literal::u32_unsuffixed(value));
    quote!(#name: #value)
}

/// The codec of a frame, by bus and identifier.
type Codec<'c> = &'c dyn Fn(u8, u16) -> Option<Ident>;

fn node_tokens(node: &Node, codec: Codec<'_>) -> TokenStream {
    let (setup, table) = (constant(&node.name, "_SETUP"), constant(&node.name, ""));
    let setup_doc = format!(" Set-up of `{}`.", node.name);
    let doc = format!(" Node `{}`: {}.", node.name, role_name(node.role));
    let steps = node.setup.iter().map(step_tokens);
    let count = node.setup.len();
    let (name, bus, id) = (&node.name, node.bus, node.id.raw());
    let role = ident(match node.role {
        Role::Drive => "Drive",
        Role::Imu => "Imu",
        Role::Encoder => "Encoder",
        Role::Legs => "Legs",
    });
    let heartbeat = Literal::u16_unsuffixed(node.heartbeat_ms);
    let timeout = Literal::u32_unsuffixed(node.heartbeat_timeout_us);
    let receive = node.receive.iter().map(pdo_tokens);
    let transmit = node.transmit.iter().map(|pdo| {
        let reader =
            codec(node.bus, pdo.cob_id).map(|codec| quote!(.read_by(frames::#codec::read)));
        let pdo = pdo_tokens(pdo);
        quote!(#pdo #reader)
    });
    let motor = option(node.motor.map(|motor| {
        let (axis, sign, mode) = (motor.axis, motor.sign, motor.mode);
        let (in_drive, each, ratio) = (motor.sign_in_drive, motor.torque_per_count, motor.ratio);
        let (limit, counts) = (motor.torque_limit, motor.counts_per_revolution);
        quote!(MotorTable {
            axis: #axis,
            sign: #sign,
            sign_in_drive: #in_drive,
            torque_per_count: #each,
            torque_limit: #limit,
            counts_per_revolution: #counts,
            ratio: #ratio,
            mode: #mode,
        })
    }));
    quote! {
        #[doc = #setup_doc]
        const #setup: [SdoStep; #count] = [#(#steps),*];
        #[doc = #doc]
        const #table: NodeTable<'static> = NodeTable {
            name: #name,
            bus: #bus,
            id: NodeId::clamped(#id),
            role: Role::#role,
            heartbeat_ms: #heartbeat,
            heartbeat_timeout_us: #timeout,
            setup: &#setup,
            receive: &[#(#receive),*],
            transmit: &[#(#transmit),*],
            motor: #motor,
        };
    }
}

fn step_tokens(step: &SdoStep) -> TokenStream {
    match *step {
        SdoStep::Write { object, kind, value } => {
            let (object, kind, value) = (object_tokens(object), kind_tokens(kind), hex32(value));
            quote!(SdoStep::write(#object, #kind, #value))
        }
        SdoStep::Expect { object, kind, mask, value } => {
            let (object, kind) = (object_tokens(object), kind_tokens(kind));
            let (mask, value) = (hex32(mask), hex32(value));
            quote!(SdoStep::expect(#object, #kind, #mask, #value))
        }
    }
}

fn pdo_tokens(pdo: &Pdo) -> TokenStream {
    let (id, number, transmission) = (hex16(pdo.cob_id), pdo.number, pdo.transmission);
    let entries = pdo.entries().iter().map(entry_tokens);
    quote!(Pdo::new(#id, #number, #transmission, &[#(#entries),*]))
}

fn entry_tokens(entry: &Entry) -> TokenStream {
    let (object, kind) = (object_tokens(entry.object), kind_tokens(entry.kind));
    if entry.signal == Signal::Gap {
        return quote!(Entry::gap(#kind));
    }
    let signal = match entry.signal {
        Signal::Coordinate(index) => quote!(Signal::Coordinate(#index)),
        Signal::Rate(index) => quote!(Signal::Rate(#index)),
        signal => {
            let name = ident(&format!("{signal:?}"));
            quote!(Signal::#name)
        }
    };
    let scale = entry.scale;
    quote!(Entry::new(#object, #kind, #signal, #scale))
}

fn axis_tokens(axis: &Axis) -> TokenStream {
    let (name, drives, balances) = (&axis.name, &axis.drives, axis.balances);
    let coordinate = option(axis.coordinate.map(|index| quote!(#index)));
    let force = option(axis.force.map(|index| quote!(#index)));
    let per_force = axis.counts_per_force as f32;
    let (limit, slew) = (axis.limit as f32, axis.slew as f32);
    let tolerance = axis.pair_tolerance as f32;
    let tolerance = if tolerance.is_finite() { quote!(#tolerance) } else { quote!(f32::INFINITY) };
    quote!(AxisTable {
        name: #name,
        coordinate: #coordinate,
        force: #force,
        drives: &[#(#drives),*],
        balances: #balances,
        counts_per_force: #per_force,
        limit: #limit,
        slew: #slew,
        pair_tolerance: #tolerance,
    })
}

fn command_tokens(command: &Command, codec: Codec<'_>) -> TokenStream {
    let (bus, id, cyclic) = (command.bus, hex16(command.cob_id), command.cyclic);
    let fields = command.fields.iter().map(|field: &Field| {
        let kind = kind_tokens(field.kind);
        let source = match field.source {
            Source::Zero => quote!(Source::Zero),
            Source::Controlword { node } => quote!(Source::Controlword { node: #node }),
            Source::Mode { node } => quote!(Source::Mode { node: #node }),
            Source::Torque { axis, sign } => quote!(Source::Torque { axis: #axis, sign: #sign }),
            Source::Legs => quote!(Source::Legs),
        };
        quote!(Field { kind: #kind, source: #source })
    });
    let writer =
        option(codec(command.bus, command.cob_id).map(|codec| quote!(frames::#codec::write)));
    quote!(CommandTable {
        bus: #bus,
        cob_id: #id,
        cyclic: #cyclic,
        fields: &[#(#fields),*],
        writer: #writer,
    })
}

pub(crate) fn kind_tokens(kind: DataType) -> TokenStream {
    let name = ident(&format!("{kind:?}"));
    quote!(DataType::#name)
}

fn object_tokens(object: Object) -> TokenStream {
    let (index, sub) = (hex16(object.index), object.sub);
    quote!(object(#index, #sub))
}

fn option(value: Option<TokenStream>) -> TokenStream {
    value.map_or_else(|| quote!(None), |value| quote!(Some(#value)))
}

/// An identifier; names that are keywords get an underscore.
pub(crate) fn ident(name: &str) -> Ident {
    let letters = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let clean: String = name.chars().map(letters).collect();
    let begins = clean.starts_with(|c: char| c.is_ascii_digit()) || clean.is_empty();
    let clean = if begins { format!("_{clean}") } else { clean };
    syn::parse_str(&clean).unwrap_or_else(|_| Ident::new(&format!("{clean}_"), Span::call_site()))
}

pub(crate) fn constant(name: &str, suffix: &str) -> Ident {
    ident(&format!("{}{suffix}", name.to_uppercase()))
}

pub(crate) fn camel(name: &str) -> String {
    let words = name.split('_').map(|word| {
        let mut letters = word.chars();
        let first = letters.next().map(|c| c.to_ascii_uppercase());
        first.into_iter().chain(letters).collect::<String>()
    });
    words.collect()
}

pub(crate) fn hex16(value: u16) -> Literal {
    hex(&format!("0x{value:03X}"), value.into())
}

fn hex32(value: u32) -> Literal {
    hex(&if value < 10 { value.to_string() } else { format!("0x{value:X}") }, value)
}

fn hex(text: &str, value: u32) -> Literal {
    text.parse().unwrap_or_else(|_| Literal::u32_unsuffixed(value))
}

//! The model language of shapebot: text to a checked, dimension-correct mechanical model.
//!
//! A model file says what is on paper: parameters with units, coordinates, energies or rigid bodies,
//! motors. [`parse`] turns it into a [`model::Model`] in which every name is resolved and every
//! dimension checked, or into [`Diagnostic`]s that name the place, the physics and what to do, all of a
//! file at once. No input makes it panic, hang or overflow the stack.
//!
//! # Example
//!
//! A cart-pole: a cart on a track, a pole with a mass at its end.
//!
//! ```
//! let text = "
//! robot CartPole {
//!     params {
//!         /// Cart mass.
//!         m_c: kg = 1 in 0.2..10;
//!         /// Mass at the end of the pole.
//!         m_p: kg = 0.1;
//!         /// Length of the pole.
//!         l: m = 0.5 in 0.1..2;
//!         g: m/s^2 = 9.81;
//!     }
//!     position x: m;                            // q_x: where the task is
//!     shape phi: rad in -60deg..60deg;          // q_s: what accelerates it
//!
//!     frame pole = world * rot_y(phi);
//!     rigid cart { mass: m_c, com: [x, 0, 0] }
//!     rigid bob { mass: m_p, frame: pole, com: [x, 0, 0] + pole*[0, 0, l] }
//!     gravity g along -world.z;
//!
//!     actuator force on d/dt(x) limit 20*N;     // actuation is derived from this, never asserted
//!     output x: m;
//!     require shape_accelerated;                // proved by the generator, not here
//! }";
//! let parsed = shapebot_model_dsl::parse("cart_pole.robot", text);
//! let model = parsed.model.expect("the model is correct");
//! assert_eq!(model.coordinates[1].name, "phi");
//! assert_eq!(model.bodies.len(), 2);
//! ```
//!
//! A term that is no energy is refused, with the physics:
//!
//! ```
//! # use shapebot_model_dsl::{parse, render, codes};
//! let text = "robot Cart { params { m: kg = 1; } position x: m; kinetic 1/2*m*d/dt(x); }";
//! let parsed = parse("cart.robot", text);
//! assert_eq!(parsed.diagnostics[0].code, codes::E0307);
//! let shown = render(&parsed.diagnostics, "cart.robot", text, false);
//! assert!(shown.contains("expected energy: kg·m²/s², found momentum: kg·m/s"));
//! ```
//!
//! # From text to model
//!
//! 1. A scan of the raw text reports characters that no lexer takes (`q'`, `m²`, `80°`) and brackets
//!    that do not match or nest too deeply. Nothing recursive has run until then.
//! 2. proc-macro2 says what the tokens are; they are flattened to a list with byte spans.
//! 3. A parser of its own reads statements and expressions (`^` binds strongest and to the right) and
//!    goes on behind a broken statement.
//! 4. The resolver expands components and repetitions, resolves names, checks kinds and dimensions, and
//!    builds the arenas of the model. What was refused is silent from then on.
//!
//! The language is described in `LANGUAGE.md` beside this crate; every code has a page, see [`explain`].
#![forbid(unsafe_code)]

mod ast;
pub mod codes;
mod diagnostic;
mod lex;
pub mod model;
mod parse;
mod render;
mod resolve;
mod suggest;
mod units;

pub use diagnostic::{Code, Diagnostic, Severity};
pub use render::render;

use diagnostic::Sink;
use model::Model;

/// A half-open range of byte offsets into the model's text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// A span from byte offsets.
    #[must_use]
    pub fn new(start: usize, end: usize) -> Self {
        let offset = |n| u32::try_from(n).unwrap_or(u32::MAX);
        Self { start: offset(start), end: offset(end) }
    }

    /// As a range for indexing.
    #[must_use]
    pub fn range(self) -> std::ops::Range<usize> {
        self.start as usize..self.end as usize
    }

    /// From the start of this to the end of another.
    #[must_use]
    pub fn to(self, other: Self) -> Self {
        Self { start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// Largest file in bytes.
pub const MAX_BYTES: usize = 4 << 20;

/// What came out of a file.
#[derive(Clone, Debug)]
pub struct Parsed {
    /// The model; `None` if there are errors.
    pub model: Option<Model>,
    /// Errors and warnings, in the order of the text.
    pub diagnostics: Vec<Diagnostic>,
}

/// Reads a model. All errors of the file are reported at once.
#[must_use]
pub fn parse(source_name: &str, text: &str) -> Parsed {
    if text.len() > MAX_BYTES {
        return refuse(too_large(text.len()));
    }
    // A thread of its own: the lexer's table of spans dies with it instead of growing for ever, and the
    // depth of brackets that is allowed fits its stack whatever stack the caller has.
    let run = || parse_here(source_name, text);
    let spawned = std::thread::scope(|scope| {
        let builder =
            std::thread::Builder::new().name("shapebot-parse".to_owned()).stack_size(STACK);
        builder.spawn_scoped(scope, run).map(|handle| handle.join())
    });
    match spawned {
        Ok(Ok(parsed)) => parsed,
        Ok(Err(_)) => refuse(internal()),
        // No threads on this system.
        Err(_) => parse_here(source_name, text),
    }
}

const STACK: usize = 32 << 20;

/// Reads a model from bytes, which may turn out not to be text.
#[must_use]
pub fn parse_bytes(source_name: &str, bytes: &[u8]) -> Parsed {
    if bytes.len() > MAX_BYTES {
        return refuse(too_large(bytes.len()));
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => parse(source_name, text),
        Err(error) => {
            let at = error.valid_up_to();
            let line = bytes[..at].iter().filter(|b| **b == b'\n').count() + 1;
            refuse(
                Diagnostic::error(codes::E0001, Span::new(at, at), "the file is not UTF-8 text")
                    .label("the first bytes that are no text")
                    .note(format!("byte {at}, line {line}"))
                    .help("save the file as UTF-8; a model is plain text"),
            )
        }
    }
}

fn refuse(diagnostic: Diagnostic) -> Parsed {
    Parsed { model: None, diagnostics: vec![diagnostic] }
}

fn too_large(bytes: usize) -> Diagnostic {
    Diagnostic::error(
        codes::E0002,
        Span::default(),
        format!("the file is too large: {bytes} bytes"),
    )
    .note(format!("a model has at most {MAX_BYTES} bytes"))
    .help("a robot with many like parts is written with `component` and `repeat`")
}

fn internal() -> Diagnostic {
    Diagnostic::error(codes::E0010, Span::default(), "shapebot failed while reading this file")
        .help("this is an error of shapebot; please report it together with the file")
}

fn parse_here(source_name: &str, text: &str) -> Parsed {
    let mut sink = Sink::default();
    let scan = lex::scan::scan(text, &mut sink);
    let model = scan
        .balanced
        .then(|| lex::lex(&scan.text, &mut sink))
        .flatten()
        .and_then(|tokens| parse::parse(&scan.text, tokens, &mut sink))
        .map(|robot| resolve::resolve(&robot, source_name, text, &mut sink));
    let model = model.filter(|_| !sink.has_errors());
    Parsed { model, diagnostics: sink.finish() }
}

/// The page of a code, in Markdown; the case of letters does not matter.
#[must_use]
pub fn explain(code: &str) -> Option<&'static str> {
    codes::entry(code.trim()).map(|e| e.page)
}

/// All codes with their titles.
pub fn codes() -> impl Iterator<Item = (Code, &'static str)> {
    codes::TABLE.iter().map(|e| (e.code, e.title))
}

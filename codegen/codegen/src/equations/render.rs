//! Formulas as text in the model's own notation, and as LaTeX.

use super::forms::{Atom, Forms};
use super::layout::{Function, Term, Tree};
use super::names::{latex_accented, latex_name};
use num_rational::BigRational;
use num_traits::Zero;
use shapebot_model_dsl::model::Model;
use shapebot_symbolic::{Symbol, Unary};

/// Plain text or LaTeX.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Notation {
    Text,
    Latex,
}

/// Turns formulas into text.
pub(super) struct Printer {
    notation: Notation,
    /// How an atom is called, or the function that it is.
    atoms: Vec<Result<String, Tree>>,
}

/// How tightly a formula holds together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Bond {
    Sum,
    Product,
    Factor,
}

impl Printer {
    pub(super) fn new(model: &Model, forms: &mut Forms, notation: Notation) -> Self {
        let mut atoms = Vec::new();
        for i in 0..forms.atoms.len() {
            let name = match forms.atoms[i] {
                Atom::Symbol(symbol) => Ok(symbol_name(model, symbol, notation)),
                Atom::Pi if notation == Notation::Latex => Ok("\\pi".to_owned()),
                Atom::Pi => Ok("pi".to_owned()),
                _ => forms.expand_atom(i).map_or_else(|| Ok("?".to_owned()), Err),
            };
            atoms.push(name);
        }
        Self { notation, atoms }
    }

    /// A formula with its sign.
    pub(super) fn term(&self, term: &Term) -> String {
        let body = self.tree(&term.tree, if term.negative { Bond::Product } else { Bond::Sum });
        if term.negative { format!("-{body}") } else { body }
    }

    /// The pieces of a formula between which a line may end: before a sign that is in no braces.
    pub(super) fn pieces(&self, term: &Term) -> Vec<String> {
        let text = self.term(term);
        let (mut pieces, mut depth, mut start) = (Vec::new(), 0_i32, 0);
        let bytes = text.as_bytes();
        for (at, &byte) in bytes.iter().enumerate() {
            match byte {
                b'{' => depth += 1,
                b'}' => depth -= 1,
                b'+' | b'-'
                    if depth == 0
                        && at > 0
                        && bytes[at - 1] == b' '
                        && bytes.get(at + 1) == Some(&b' ') =>
                {
                    pieces.push(text[start..at - 1].to_owned());
                    start = at;
                }
                _ => {}
            }
        }
        pieces.push(text[start..].to_owned());
        pieces
    }

    fn sum_pieces(&self, terms: &[Term]) -> Vec<String> {
        let mut pieces = Vec::new();
        for (k, term) in terms.iter().enumerate() {
            let body = self.tree(&term.tree, Bond::Product);
            pieces.push(match (k, term.negative) {
                (0, false) => body,
                (0, true) => format!("-{body}"),
                (_, false) => format!("+ {body}"),
                (_, true) => format!("- {body}"),
            });
        }
        pieces
    }

    fn tree(&self, tree: &Tree, bond: Bond) -> String {
        match tree {
            Tree::Number(value) => self.number(value, bond),
            Tree::Atom(i) => match &self.atoms[*i] {
                Ok(name) => name.clone(),
                Err(function) => self.tree(function, Bond::Factor),
            },
            Tree::Shared(k) => self.shared(*k),
            Tree::Power(base, exponent) => self.power(base, *exponent),
            Tree::Sum(terms) => bracketed(&self.sum_pieces(terms).join(" "), bond > Bond::Sum),
            Tree::Product(factors) => bracketed(
                &self.joined(factors),
                bond > Bond::Product && self.notation == Notation::Text,
            ),
            Tree::Quotient(top, bottom) => match self.notation {
                Notation::Latex => {
                    format!(
                        "\\frac{{{}}}{{{}}}",
                        self.tree(top, Bond::Sum),
                        self.tree(bottom, Bond::Sum)
                    )
                }
                Notation::Text => {
                    let text = format!(
                        "{}/{}",
                        self.tree(top, Bond::Product),
                        self.tree(bottom, Bond::Factor)
                    );
                    bracketed(&text, bond > Bond::Product)
                }
            },
            Tree::Apply(function, arguments) => self.apply(*function, arguments, None),
        }
    }

    fn joined(&self, factors: &[Tree]) -> String {
        let mut out = String::new();
        for (k, factor) in factors.iter().enumerate() {
            if k > 0 {
                out.push_str(self.gap(&factors[k - 1]));
            }
            // A quotient or fraction may open a product: 1/2*m*l.
            out.push_str(&self.tree(factor, if k == 0 { Bond::Product } else { Bond::Factor }));
        }
        out
    }

    /// What stands between a factor and the next: in LaTeX a thin space keeps the argument of a
    /// function from what follows it.
    fn gap(&self, factor: &Tree) -> &'static str {
        match self.notation {
            Notation::Text => "*",
            Notation::Latex if self.is_function(factor) => " \\, ",
            Notation::Latex => " ",
        }
    }

    fn is_function(&self, tree: &Tree) -> bool {
        match tree {
            Tree::Atom(i) => self.atoms[*i].is_err(),
            Tree::Power(base, _) => self.is_function(base),
            Tree::Apply(..) => true,
            _ => false,
        }
    }

    /// The name of a shared value.
    pub(super) fn shared(&self, k: usize) -> String {
        match self.notation {
            Notation::Text => format!("a_{}", k + 1),
            Notation::Latex => format!("a_{{{}}}", k + 1),
        }
    }

    fn number(&self, value: &BigRational, bond: Bond) -> String {
        if value.is_integer() {
            return value.numer().to_string();
        }
        match self.notation {
            Notation::Text => bracketed(&value.to_string(), bond > Bond::Product),
            Notation::Latex => format!("\\frac{{{}}}{{{}}}", value.numer(), value.denom()),
        }
    }

    fn power(&self, base: &Tree, exponent: u8) -> String {
        let function = match base {
            Tree::Atom(i) => self.atoms[*i].as_ref().err(),
            other => Some(other),
        };
        if self.notation == Notation::Latex
            && let Some(Tree::Apply(function, arguments)) = function
        {
            return self.apply(*function, arguments, Some(exponent));
        }
        let inner = match base {
            Tree::Quotient(..) | Tree::Product(_) | Tree::Power(..) => {
                bracketed(&self.tree(base, Bond::Sum), true)
            }
            _ => self.tree(base, Bond::Factor),
        };
        match self.notation {
            Notation::Text => format!("{inner}^{exponent}"),
            Notation::Latex if inner.starts_with("\\dot") || inner.starts_with("\\ddot") => {
                // \dot{\phi}_x^2 is well formed: accent, subscript, superscript.
                format!("{inner}^{{{exponent}}}")
            }
            Notation::Latex => format!("{inner}^{exponent}"),
        }
    }

    fn apply(&self, function: Function, arguments: &[Term], exponent: Option<u8>) -> String {
        let list = arguments.iter().map(|a| self.term(a)).collect::<Vec<_>>().join(", ");
        let head = match function {
            Function::Of(f) => unary_name(f),
            Function::Atan2 => "atan2",
        };
        if self.notation == Notation::Text {
            return format!("{head}({list})");
        }
        let raised = exponent.map(|e| format!("^{e}")).unwrap_or_default();
        match (function, arguments) {
            (Function::Of(Unary::Sqrt), _) => format!("\\sqrt{{{list}}}{raised}"),
            (Function::Atan2, _) => format!("\\operatorname{{atan2}}{raised}({list})"),
            (_, [Term { negative: false, tree: Tree::Atom(_) }]) => {
                format!("\\{}{raised} {list}", latex_function(head))
            }
            _ => format!("\\{}{raised}({list})", latex_function(head)),
        }
    }
}

fn unary_name(function: Unary) -> &'static str {
    match function {
        Unary::Sqrt => "sqrt",
        Unary::Sin => "sin",
        Unary::Cos => "cos",
        Unary::Exp => "exp",
        Unary::Ln => "ln",
        Unary::Asin => "asin",
        Unary::Acos => "acos",
        Unary::Atan => "atan",
    }
}

fn latex_function(name: &str) -> &str {
    match name {
        "asin" => "arcsin",
        "acos" => "arccos",
        "atan" => "arctan",
        other => other,
    }
}

fn bracketed(text: &str, wanted: bool) -> String {
    if wanted { format!("({text})") } else { text.to_owned() }
}

fn symbol_name(model: &Model, symbol: Symbol, notation: Notation) -> String {
    let coordinate = |i: u32| model.coordinates.get(i as usize);
    let path = |i: u32| coordinate(i).map_or_else(|| format!("q_{i}"), |c| c.path.clone());
    let latex = notation == Notation::Latex;
    match symbol {
        Symbol::Parameter(i) => {
            let path = model
                .parameters
                .get(i as usize)
                .map_or_else(|| format!("p_{i}"), |p| p.path.clone());
            if latex { latex_name(&path) } else { path }
        }
        Symbol::Coordinate(i) if latex => latex_name(&path(i)),
        Symbol::Coordinate(i) => path(i),
        Symbol::Rate(i) if latex => latex_accented("\\dot", &path(i)),
        Symbol::Rate(i) => format!("{}'", path(i)),
        Symbol::Acceleration(i) if latex => latex_accented("\\ddot", &path(i)),
        Symbol::Acceleration(i) => format!("{}''", path(i)),
        Symbol::Force(i) => format!("f_{i}"),
        Symbol::Auxiliary(i) => format!("z_{i}"),
    }
}

/// Whether a formula is zero.
pub(super) fn is_zero(term: &Term) -> bool {
    matches!(&term.tree, Tree::Number(value) if value.is_zero())
}

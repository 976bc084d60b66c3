//! The parameters, the robot's type and its constructors.

use super::body::{Request, body};
use super::docs;
use super::hoist::Hoisted;
use super::names::SymbolNames;
use super::plan::Root;
use super::robot::{field_pattern, helper};
use super::syntax::{self, ident};
use proc_macro2::{Ident, TokenStream};
use quote::quote;
use shapebot_model_dsl::model::{
    Comparison, Expr, ExprId, Function, Model, Parameter, ParameterId, Range, Requirement,
};
use shapebot_symbolic::{Graph, Id, Symbol, Unary};
use syn::{Item, Stmt};

/// `struct Params` with its constructor and validation.
pub(super) fn params(model: &Model, symbols: &SymbolNames) -> Vec<Item> {
    let fields: Vec<Ident> = symbols.fields.iter().map(|name| ident(name)).collect();
    let field_docs =
        model.parameters.iter().map(|parameter| docs::attributes(&parameter_docs(parameter)));
    let declared = field_docs.zip(&fields).map(|(docs, name)| quote!(#(#docs)* pub #name: T));
    let values = model.parameters.iter().map(|p| signed_number(p.value_f64));
    let bundle = if fields.is_empty() {
        quote!(marker: ::core::marker::PhantomData<T>)
    } else {
        quote!(#(#declared),*)
    };
    let made = if fields.is_empty() {
        quote!(Self { marker: ::core::marker::PhantomData })
    } else {
        quote!(let c = T::from_f64; Self { #(#fields: c(#values)),* })
    };
    let names = symbols.fields.iter();
    let setter = quote! {
        match name {
            #(#names => self.#fields = value,)*
            _ => { let _ = value; return false; }
        }
    };
    let structure: Item = syn::parse_quote! {
        /// Parameters, in SI units.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Params<T> { #bundle }
    };
    let constructor: Item = syn::parse_quote! {
        impl<T: Real> Params<T> {
            /// The model's own values.
            #[must_use]
            pub fn model() -> Self { #made }

            /// Sets the parameter of that name; false if there is none. What comes of it is judged
            /// by [`Params::validate`].
            pub fn set(&mut self, name: &str, value: T) -> bool {
                #setter
                true
            }
        }
    };
    let default: Item = syn::parse_quote! {
        impl<T: Real> Default for Params<T> {
            fn default() -> Self { Self::model() }
        }
    };
    vec![structure, constructor, default, validation(model, symbols)]
}

fn parameter_docs(parameter: &Parameter) -> String {
    let meaning = docs::paragraph(&parameter.docs);
    let range = parameter
        .range
        .map_or(String::new(), |range| format!(", {}", shown_range(range, &parameter.unit.text)));
    let facts = format!(
        "`{}`, {}{range}; the model has {}.",
        parameter.path,
        unit(&parameter.unit.text),
        parameter.value_f64
    );
    if meaning.is_empty() { facts } else { format!("{meaning}\n\n{facts}") }
}

/// A unit for a reader: `kg·m²`.
pub(super) fn unit(text: &str) -> String {
    if text == "1" {
        return "no unit".to_owned();
    }
    text.replace('*', "·").replace("^2", "²").replace("^3", "³")
}

/// A range for a reader; angles in degrees where that is shorter.
pub(super) fn shown_range(Range { lower, upper }: Range, unit: &str) -> String {
    let degrees = |value: f64| {
        let rounded = (value.to_degrees() * 1000.0).round() / 1000.0;
        (unit == "rad" && (rounded - value.to_degrees()).abs() < 1e-9).then_some(rounded)
    };
    match (degrees(lower), degrees(upper)) {
        (Some(lower), Some(upper)) => format!("{lower}° to {upper}°"),
        _ => format!("{lower} to {upper}"),
    }
}

/// `validate`: finite, in range, and what the model requires of its parameters.
fn validation(model: &Model, symbols: &SymbolNames) -> Item {
    let fields: Vec<Ident> = symbols.fields.iter().map(|name| ident(name)).collect();
    let requirements: Vec<Stmt> = requirements(model, symbols);
    let ranges = (!fields.is_empty()).then(|| {
        quote! {
            for (parameter, value) in DESCRIPTION.parameters.iter().zip([#(self.#fields),*]) {
                parameter.check(value)?;
            }
        }
    });
    syn::parse_quote! {
        impl<T: ::shapebot_dynamics::Ordered> Params<T> {
            /// Whether every value is finite, in its range, and as the model requires.
            ///
            /// # Errors
            ///
            /// The first parameter or requirement that fails.
            pub fn validate(&self) -> Result<(), ::shapebot_dynamics::ParameterError> {
                #ranges
                #(#requirements)*
                Ok(())
            }
        }
    }
}

/// `if !(left < right) { return Err(…); }`, so that a NaN fails as well.
fn requirements(model: &Model, symbols: &SymbolNames) -> Vec<Stmt> {
    let mut graph = Graph::new();
    let mut found = Vec::new();
    for required in &model.requirements {
        if let Requirement::Compare(left, comparison, right) = required.requirement
            && let (Some(left), Some(right)) =
                (lower(model, &mut graph, left), lower(model, &mut graph, right))
        {
            let text = docs::one_line(model.text(required.span));
            let text = text.trim_start_matches("require ").trim_end_matches(';').to_owned();
            found.push((left, comparison, right, text));
        }
    }
    if found.is_empty() {
        return Vec::new();
    }
    let root = |id| Root { id, name: "side".to_owned(), block: 0 };
    let roots: Vec<Root> =
        found.iter().flat_map(|&(left, _, right, _)| [root(left), root(right)]).collect();
    let body = plain_body(&graph, &roots, symbols, false);
    let mut statements: Vec<Stmt> = Vec::new();
    if body.constants > 0 {
        statements.push(helper());
    }
    let patterns = used_parameters(&body.used, symbols);
    if !patterns.is_empty() {
        statements.push(syn::parse_quote!(let Self { #(#patterns,)* .. } = *self;));
    }
    statements.extend(body.statements);
    for (sides, (_, comparison, _, text)) in body.results.chunks(2).zip(&found) {
        let [left, right] = sides else { continue };
        let operator = match comparison {
            Comparison::Less => quote!(<),
            Comparison::LessOrEqual => quote!(<=),
            Comparison::Greater => quote!(>),
            Comparison::GreaterOrEqual => quote!(>=),
        };
        statements.push(syn::parse_quote! {
            if !(#left #operator #right) {
                return Err(::shapebot_dynamics::ParameterError::Requirement { text: #text });
            }
        });
    }
    statements
}

fn used_parameters(
    used: &std::collections::BTreeSet<Symbol>,
    symbols: &SymbolNames,
) -> Vec<TokenStream> {
    let parameters = used.iter().filter_map(|symbol| match symbol {
        Symbol::Parameter(i) => Some(field_pattern(symbols, *i as usize)),
        _ => None,
    });
    parameters.collect()
}

fn plain_body(
    graph: &Graph,
    roots: &[Root],
    symbols: &SymbolNames,
    named: bool,
) -> super::body::Body {
    let blocks = ["shared".to_owned()];
    body(&Request { graph, roots, blocks: &blocks, given: &[], symbols, named, source: &|_| None })
}

/// An expression of parameters alone; `None` if it is more than that.
fn lower(model: &Model, graph: &mut Graph, id: ExprId) -> Option<Id> {
    let mut binary = |a, b, operation: fn(&mut Graph, Id, Id) -> Id| {
        let (a, b) = (lower(model, graph, a)?, lower(model, graph, b)?);
        Some(operation(graph, a, b))
    };
    match model.expr(id) {
        &Expr::Add(a, b) => binary(a, b, Graph::add),
        &Expr::Sub(a, b) => binary(a, b, Graph::sub),
        &Expr::Mul(a, b) => binary(a, b, Graph::mul),
        &Expr::Div(a, b) => binary(a, b, Graph::div),
        Expr::Number(value) => Some(graph.constant(value.clone())),
        Expr::Pi => Some(graph.pi()),
        Expr::Parameter(ParameterId(i)) => Some(graph.symbol(Symbol::Parameter(*i))),
        &Expr::Neg(a) => {
            let a = lower(model, graph, a)?;
            Some(graph.neg(a))
        }
        Expr::Power(base, exponent) => {
            let base = lower(model, graph, *base)?;
            Some(graph.pow(base, exponent))
        }
        Expr::Call(function, arguments) => {
            let arguments: Option<Vec<Id>> =
                arguments.iter().map(|&a| lower(model, graph, a)).collect();
            apply(graph, *function, &arguments?)
        }
        _ => None,
    }
}

fn apply(graph: &mut Graph, function: Function, arguments: &[Id]) -> Option<Id> {
    let x = *arguments.first()?;
    let plain = match function {
        Function::Sin => Unary::Sin,
        Function::Cos => Unary::Cos,
        Function::Asin => Unary::Asin,
        Function::Acos => Unary::Acos,
        Function::Atan => Unary::Atan,
        Function::Sqrt => Unary::Sqrt,
        Function::Exp => Unary::Exp,
        Function::Ln => Unary::Ln,
        Function::Atan2 => return Some(graph.atan2(x, *arguments.get(1)?)),
        Function::Tan => {
            let (sin, cos) = (graph.sin(x), graph.cos(x));
            return Some(graph.div(sin, cos));
        }
        Function::Sinh | Function::Cosh | Function::Tanh => {
            let up = graph.unary(Unary::Exp, x);
            let one = graph.one();
            let down = graph.div(one, up);
            let (sum, difference) = (graph.add(up, down), graph.sub(up, down));
            let half = graph.fraction(1, 2);
            return Some(match function {
                Function::Sinh => graph.mul(half, difference),
                Function::Cosh => graph.mul(half, sum),
                _ => graph.div(difference, sum),
            });
        }
    };
    Some(graph.unary(plain, x))
}

/// A number with its sign, as an expression of type f64.
pub(super) fn signed_number(value: f64) -> syn::Expr {
    let magnitude = syntax::number(value.abs());
    if value < 0.0 { syntax::negative(magnitude) } else { magnitude }
}

/// The robot's type: parameters and what depends on them alone, computed once.
pub(super) fn robot(
    type_name: &str,
    model: &Model,
    symbols: &SymbolNames,
    hoisted: &Hoisted,
) -> Vec<Item> {
    let name = ident(type_name);
    let fields: Vec<Ident> = hoisted.fields.iter().map(|root| ident(&root.name)).collect();
    let body = plain_body(&hoisted.graph, &hoisted.fields, symbols, true);
    let constant = (body.constants > 0).then(helper);
    let patterns = used_parameters(&body.used, symbols);
    let rest = (patterns.len() < symbols.fields.len()).then(|| quote!(..));
    let taken: Option<Stmt> = (!patterns.is_empty())
        .then(|| syn::parse_quote!(let Params { #(#patterns,)* #rest } = params;));
    let statements = &body.statements;
    let results = fields.iter().zip(&body.results).map(|(field, value)| match value {
        syn::Expr::Path(variable) if variable.path.is_ident(field) => quote!(#field),
        value => quote!(#field: #value),
    });
    let summary = docs::attributes(&format!(
        "{}: parameters at run time.\n\nHolds the parameters and every value that depends on them alone.",
        docs::cell(&model.name)
    ));
    let structure: Item = syn::parse_quote! {
        #(#summary)*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct #name<T> { params: Params<T>, #(#fields: T),* }
    };
    let constructors: Item = syn::parse_quote! {
        impl<T: Real> #name<T> {
            /// With parameters that are taken as they are; see [`Params::validate`].
            #[must_use]
            pub fn new(params: Params<T>) -> Self {
                #constant
                #taken
                #(#statements)*
                Self { params, #(#results),* }
            }

            /// With the model's own parameter values.
            #[must_use]
            pub fn from_model() -> Self {
                Self::new(Params::model())
            }

            /// The parameters.
            #[must_use]
            pub const fn params(&self) -> &Params<T> {
                &self.params
            }
        }
    };
    let checked: Item = syn::parse_quote! {
        impl<T: ::shapebot_dynamics::Ordered> #name<T> {
            /// With parameters that pass [`Params::validate`].
            ///
            /// # Errors
            ///
            /// What is wrong with the first parameter that does not.
            pub fn try_new(params: Params<T>) -> Result<Self, ::shapebot_dynamics::ParameterError> {
                params.validate()?;
                Ok(Self::new(params))
            }
        }
    };
    let default: Item = syn::parse_quote! {
        impl<T: Real> Default for #name<T> {
            fn default() -> Self { Self::from_model() }
        }
    };
    vec![structure, constructors, checked, default]
}

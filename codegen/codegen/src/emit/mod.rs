//! From derived functions to readable Rust.
//!
//! One outer-documented module per model, fit for `include!`: parameters, the robot's type, the traits'
//! implementations as straight-line code, and the same with the model's own values folded in. Bodies
//! are syntax trees built from the graph (`plan` decides what gets a name, `body` writes it), frames
//! and tables come from templates.

mod body;
mod constants;
mod content;
mod description;
mod docs;
mod hoist;
mod methods;
mod names;
mod parameters;
mod plan;
mod robot;
mod syntax;
#[cfg(test)]
mod tests;

pub use docs::Documentation;

use crate::derive::{Function, Quantity};
use names::SymbolNames;
use quote::quote;
use robot::Variant;
use shapebot_model_dsl::model::Model;
use std::collections::BTreeMap;
use syn::Item;

/// What a module is emitted from.
#[derive(Clone, Copy, Debug)]
pub struct Emission<'a> {
    /// The model file's stem: name of the module and of the robot.
    pub stem: &'a str,
    /// The model.
    pub model: &'a Model,
    /// Functions with parameters as symbols.
    pub functions: &'a BTreeMap<Quantity, Function>,
    /// Functions with parameters folded in, if a baked type is wanted.
    pub baked: Option<&'a BTreeMap<Quantity, Function>>,
    /// Equations and certificate for the module's page.
    pub documentation: &'a Documentation,
    /// Texts of further items.
    pub additional: &'a [String],
}

/// Names under which a module and its types are found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EmittedNames {
    /// The module.
    pub module: String,
    /// The type with parameters at run time, generic over the scalar.
    pub robot: String,
    /// The type with parameters folded in.
    pub baked: String,
}

/// Names that [`emit`] uses for a model.
#[must_use]
pub fn emitted_names(stem: &str, model: &Model) -> EmittedNames {
    let robot = names::type_name(&model.name);
    EmittedNames { module: names::identifier(stem), baked: format!("{robot}Baked"), robot }
}

/// A file that includes modules and lists them in macros.
pub(crate) fn collection(modules: &[crate::build::Module]) -> String {
    let row = |module: &crate::build::Module| {
        let EmittedNames { module: name, robot, baked } = module.names.clone();
        let [n, nx, ns] = module.dimensions.map(|size| size.to_string());
        let stem = module.stem.clone();
        BTreeMap::from([
            ("stem", stem),
            ("module", name),
            ("robot", robot),
            ("baked", baked),
            ("n", n),
            ("nx", nx),
            ("ns", ns),
        ])
    };
    let mut context = tera::Context::new();
    let robots: Vec<_> =
        modules.iter().filter(|module| module.shape_accelerated).map(row).collect();
    context.insert("version", env!("CARGO_PKG_VERSION"));
    context.insert("modules", &modules.iter().map(row).collect::<Vec<_>>());
    context.insert("robots", &robots);
    render("collection.rs", include_str!("../../templates/collection.rs.tera"), &context)
}

/// The text of a module. The same input gives the same bytes.
#[must_use]
pub fn emit(emission: &Emission<'_>) -> String {
    let model = emission.model;
    let file = file_name(emission);
    let coordinates: Vec<&str> = model.coordinates.iter().map(|c| c.name.as_str()).collect();
    let parameters: Vec<&str> = model.parameters.iter().map(|p| p.name.as_str()).collect();
    let symbols = SymbolNames::new(&coordinates, &parameters);
    let places = places(model, &file);
    let source = |label: &str| place(&places, label);
    let items = items(emission, &symbols, &source);
    let module = module(emission, &symbols, items);
    let code = prettyplease::unparse(&syn::File {
        shebang: None,
        frontmatter: None,
        attrs: Vec::new(),
        items: vec![Item::Mod(module)],
    });
    let mut context = tera::Context::new();
    context.insert("version", env!("CARGO_PKG_VERSION"));
    context.insert("source", &docs::one_line(&file));
    context.insert("code", with_comments(&code).trim_end());
    render("file.rs", include_str!("../../templates/file.rs.tera"), &context)
}

fn items(
    emission: &Emission<'_>,
    symbols: &SymbolNames,
    source: &dyn Fn(&str) -> Option<String>,
) -> Vec<Item> {
    let Emission { model, functions, baked, .. } = *emission;
    let names = emitted_names(emission.stem, model);
    let hoisted = hoist::hoist(functions, symbols, &methods::stem);
    let mut items: Vec<Item> = vec![
        syn::parse_quote!(
            use ::shapebot_dynamics::Real;
        ),
        syn::parse_quote!(
            use ::shapebot_dynamics::nalgebra::{ArrayStorage, SMatrix, SVector};
        ),
        description::description(emission, symbols),
    ];
    items.extend(emission.additional.iter().flat_map(|text| additional(text)));
    items.extend(parameters::params(model, symbols));
    items.extend(parameters::robot(&names.robot, model, symbols, &hoisted));
    let robot = syntax::ident(&names.robot);
    let runtime = Variant {
        model,
        symbols,
        functions,
        given: hoisted.given,
        other: baked,
        runtime: true,
        self_type: quote!(#robot<T>),
        source,
    };
    items.extend(runtime.items());
    if let Some(functions) = baked {
        let name = syntax::ident(&names.baked);
        items.push(syn::parse_quote! {
            /// The robot with the model's own parameter values folded into its equations.
            #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
            pub struct #name;
        });
        let given = functions
            .iter()
            .map(|(&quantity, function)| (quantity, hoist::baked(function)))
            .collect();
        let variant = Variant {
            model,
            symbols,
            functions,
            given,
            other: Some(emission.functions),
            runtime: false,
            self_type: quote!(#name),
            source,
        };
        items.extend(variant.items());
    }
    items.extend(helpers());
    items
}

/// Items from their text, or an item that says why it is none.
fn additional(text: &str) -> Vec<Item> {
    match syn::parse_str::<syn::File>(text) {
        Ok(file) => file.items,
        Err(error) => {
            let message = format!("an extension of the generator wrote no Rust: {error}");
            vec![syn::parse_quote!(compile_error!(#message);)]
        }
    }
}

/// Between arrays and matrices or vectors.
fn helpers() -> [Item; 3] {
    [
        syn::parse_quote! {
            /// A matrix from its columns.
            #[inline(always)]
            #[allow(dead_code, reason = "not every model needs it")]
            fn columns<T, const R: usize, const C: usize>(columns: [[T; R]; C]) -> SMatrix<T, R, C> {
                SMatrix::from_array_storage(ArrayStorage(columns))
            }
        },
        syn::parse_quote! {
            /// A vector from its entries.
            #[inline(always)]
            #[allow(dead_code, reason = "not every model needs it")]
            fn vector<T, const R: usize>(entries: [T; R]) -> SVector<T, R> {
                SMatrix::from_array_storage(ArrayStorage([entries]))
            }
        },
        syn::parse_quote! {
            /// The entries of a vector.
            #[inline(always)]
            #[allow(dead_code, reason = "not every model needs it")]
            fn entries<T: Copy, const R: usize>(vector: &SVector<T, R>) -> [T; R] {
                let [entries] = vector.data.0;
                entries
            }
        },
    ]
}

fn module(emission: &Emission<'_>, symbols: &SymbolNames, items: Vec<Item>) -> syn::ItemMod {
    let name = syntax::ident(&emitted_names(emission.stem, emission.model).module);
    let docs = docs::attributes(&description::page(emission, symbols));
    let mut module: syn::ItemMod = syn::parse_quote! {
        #(#docs)*
        #[allow(
            non_snake_case,
            clippy::approx_constant,
            clippy::doc_lazy_continuation,
            clippy::doc_overindented_list_items,
            clippy::inline_always,
            clippy::neg_cmp_op_on_partial_ord,
            clippy::too_many_lines,
            clippy::type_complexity,
            reason = "names, numbers and texts are the model's; bodies are as long as its equations"
        )]
        pub mod #name {}
    };
    module.content = Some((Default::default(), items));
    module
}

/// Name of the model file for messages: no folders, so that the output is the same everywhere.
fn file_name(emission: &Emission<'_>) -> String {
    let name = emission.model.source_name.rsplit(['/', '\\']).next().unwrap_or("");
    if name.contains('.') { name.to_owned() } else { format!("{}.robot", emission.stem) }
}

/// What labels may speak of: bodies and frames, with the text of a comment.
fn places(model: &Model, file: &str) -> Vec<(String, String)> {
    let bodies = model.bodies.iter().map(|b| ("rigid body", &b.name, b.span));
    let frames = model.frames.iter().skip(1).map(|f| ("frame", &f.name, f.span));
    let entry = |(kind, name, span): (&str, &String, _)| {
        let (line, _) = model.line_column(span);
        let text = docs::one_line(&format!("{kind} `{name}`, {file}:{line}"));
        (names::identifier(name), text)
    };
    frames.chain(bodies).map(entry).collect()
}

/// The longest name that stands between underscores in a label.
fn place(places: &[(String, String)], label: &str) -> Option<String> {
    let framed = format!("_{label}_");
    let found = places.iter().filter(|(name, _)| framed.contains(&format!("_{name}_")));
    found.max_by_key(|(name, _)| name.len()).map(|(_, text)| text.clone())
}

/// Replaces the statements that stand for comments, and sets items apart by empty lines.
fn with_comments(code: &str) -> String {
    let mut out = String::with_capacity(code.len());
    let mut last = "";
    for line in code.lines() {
        let statement = line.trim_start();
        let closes = last == "}" || last == "};" || last.starts_with("use ");
        let opens = ["///", "#[", "fn ", "pub ", "impl", "static ", "const "];
        if closes && opens.iter().any(|start| statement.starts_with(start)) {
            out.push('\n');
        }
        last = statement;
        match comment_text(statement) {
            Some(text) => {
                out.push_str(&line[..line.len() - statement.len()]);
                out.push_str("// ");
                out.push_str(&text);
            }
            None => out.push_str(line),
        }
        out.push('\n');
    }
    out
}

/// The text of a statement that stands for a comment.
fn comment_text(statement: &str) -> Option<String> {
    let literal =
        statement.strip_prefix(syntax::COMMENT)?.strip_prefix("!(")?.strip_suffix(");")?;
    syn::parse_str::<syn::LitStr>(literal).ok().map(|text| text.value())
}

/// Fills one of our own templates; a mistake in one shows as text in the output, which then does not
/// compile.
fn render(name: &'static str, template: &str, context: &tera::Context) -> String {
    let mut engine = tera::Tera::default();
    let rendered =
        engine.add_raw_template(name, template).and_then(|()| engine.render(name, context));
    rendered.unwrap_or_else(|error| format!("compile_error!({:?});", error.to_string()))
}

//! Implementations of the traits for one variant of a robot: parameters as fields, or folded in.

use super::body::{Body, Request, body};
use super::docs;
use super::methods::{EntryNames, INDEXED, Indexed, Input, LAGRANGIAN, Method, SHAPE};
use super::names::SymbolNames;
use super::plan::{Given, Root};
use super::syntax::{self, ident};
use crate::derive::{Block, Function, Quantity};
use proc_macro2::{Literal, TokenStream};
use quote::quote;
use shapebot_model_dsl::model::Model;
use shapebot_symbolic::{Operations, Symbol};
use std::collections::BTreeMap;
use syn::{Expr, ImplItem, ImplItemFn, Item, ItemImpl, Stmt};

/// One variant of a robot.
pub(super) struct Variant<'a> {
    pub(super) model: &'a Model,
    pub(super) symbols: &'a SymbolNames,
    pub(super) functions: &'a BTreeMap<Quantity, Function>,
    /// Ready values per function.
    pub(super) given: BTreeMap<Quantity, Vec<Option<Given>>>,
    /// Operations of the other variant, for the docs.
    pub(super) other: Option<&'a BTreeMap<Quantity, Function>>,
    /// Whether parameters are fields.
    pub(super) runtime: bool,
    /// The type that implements the traits, with its generics.
    pub(super) self_type: TokenStream,
    pub(super) source: &'a dyn Fn(&str) -> Option<String>,
}

impl Variant<'_> {
    /// The implementations.
    pub(super) fn items(&self) -> Vec<Item> {
        let [n, nx, ns] = self.sizes();
        let this = &self.self_type;
        let mut lagrangian: ItemImpl = syn::parse_quote! {
            impl<T: Real> ::shapebot_dynamics::LagrangianSystem<T, #n> for #this {
                fn description(&self) -> &::shapebot_dynamics::Description {
                    &DESCRIPTION
                }
            }
        };
        lagrangian.items.extend(LAGRANGIAN.iter().filter_map(|method| self.method(method)));
        lagrangian.items.extend(INDEXED.iter().map(|method| self.indexed(method)));
        let mut items = vec![Item::Impl(lagrangian)];
        if self.functions.contains_key(&Quantity::Gamma) {
            let mut shape: ItemImpl = syn::parse_quote! {
                impl<T: Real> ::shapebot_dynamics::ShapeAccelerated<T, #nx, #ns> for #this {
                    fn shape_description(&self) -> &::shapebot_dynamics::Description {
                        &DESCRIPTION
                    }
                }
            };
            shape.items.extend(SHAPE.iter().filter_map(|method| self.method(method)));
            items.push(Item::Impl(shape));
            items.push(syn::parse_quote! {
                impl<T: Real> ::shapebot_dynamics::Robot<T, #n, #nx, #ns> for #this {}
            });
        }
        items
    }

    /// n, n_x and n_s as literals.
    fn sizes(&self) -> [Literal; 3] {
        let (n, nx) = (self.model.coordinates.len(), self.model.position_count());
        [n, nx, n - nx].map(Literal::usize_unsuffixed)
    }

    fn method(&self, method: &Method) -> Option<ImplItem> {
        let function = self.functions.get(&method.quantity)?;
        let scalar = matches!(function.blocks.as_slice(), [block] if block.extents.is_empty());
        let body = self.body(function, !scalar);
        let (statements, used) = self.block(function, body, method.inputs);
        let arguments =
            method.inputs.iter().map(|&input| self.argument(input, used.contains(&input)));
        let (name, output) = (ident(method.name), self.output_type(function));
        let mut item: ImplItemFn =
            syn::parse_quote!(fn #name(&self, #(#arguments),*) -> #output {});
        item.attrs = docs::attributes(&self.method_docs(method.docs, function));
        item.block.stmts = statements;
        Some(ImplItem::Fn(item))
    }

    /// `match index { 0 => { … } … }`, one straight-line block per index.
    fn indexed(&self, method: &Indexed) -> ImplItem {
        let [n, ..] = self.sizes();
        let output = match method.name {
            "input_column" => quote!(SVector<T, #n>),
            "frame_rotation" => quote!(SMatrix<T, 3, 3>),
            "point_position" => quote!(SVector<T, 3>),
            _ => quote!(SMatrix<T, 3, #n>),
        };
        let mut arms = Vec::new();
        let mut reads = false;
        let functions = (0..).map_while(|index| self.functions.get(&(method.quantity)(index)));
        for (index, function) in functions.enumerate() {
            let (statements, used) = self.block(function, self.body(function, true), &[Input::Q]);
            reads |= !used.is_empty();
            let block = syn::Block { brace_token: Default::default(), stmts: statements };
            let index = Literal::usize_unsuffixed(index);
            let arm: syn::Arm = syn::parse_quote!(#index => {});
            let body = Expr::Block(syn::ExprBlock { attrs: Vec::new(), label: None, block });
            arms.push(syn::Arm { body: body.into(), ..arm });
        }
        let (name, otherwise) = (ident(method.name), ident(method.otherwise));
        let index = ident(&if arms.is_empty() {
            format!("_{}", method.index)
        } else {
            method.index.to_owned()
        });
        let argument = self.argument(Input::Q, reads);
        let mut item: ImplItemFn = syn::parse_quote! {
            fn #name(&self, #argument, #index: usize) -> #output { SMatrix::#otherwise() }
        };
        item.attrs = docs::attributes(method.docs);
        if !arms.is_empty() {
            arms.push(syn::parse_quote!(_ => SMatrix::#otherwise()));
            let mut choice: syn::ExprMatch = syn::parse_quote!(match #index {});
            choice.arms = arms;
            item.block.stmts = vec![Stmt::Expr(Expr::Match(choice), None)];
        }
        ImplItem::Fn(item)
    }

    fn argument(&self, input: Input, used: bool) -> TokenStream {
        let size = input.symbols(self.model.coordinates.len(), self.model.position_count()).len();
        let name = if used { ident(input.name()) } else { ident(&format!("_{}", input.name())) };
        let size = Literal::usize_unsuffixed(size);
        quote!(#name: &SVector<T, #size>)
    }

    fn body(&self, function: &Function, named: bool) -> Body {
        let names = EntryNames { model: self.model, symbols: self.symbols };
        let mut roots = Vec::new();
        for (number, block) in function.blocks.iter().enumerate() {
            for (k, &id) in block.entries.iter().enumerate() {
                let name = names.entry(function.quantity, block.name, &position(block, k));
                roots.push(Root { id, name, block: number });
            }
        }
        let stem = super::methods::stem(function.quantity);
        let several = function.blocks.len() > 1;
        let block_name = |block: &Block| if several { block.name.to_owned() } else { stem.clone() };
        let blocks: Vec<String> = function.blocks.iter().map(block_name).collect();
        body(&Request {
            graph: &function.graph,
            roots: &roots,
            blocks: &blocks,
            given: self.given.get(&function.quantity).map_or(&[], Vec::as_slice),
            symbols: self.symbols,
            named,
            source: self.source,
        })
    }

    /// A body with its inputs taken apart before it and its results put together after it; also the
    /// inputs that it reads.
    fn block(&self, function: &Function, body: Body, inputs: &[Input]) -> (Vec<Stmt>, Vec<Input>) {
        let mut statements = Vec::new();
        let (result, zeros) = self.result(function, body.results.clone());
        if body.constants > zeros {
            statements.push(helper());
        }
        if self.runtime {
            statements.extend(self.parameters(&body));
        }
        let mut read = Vec::new();
        for &input in inputs {
            let symbols = input.symbols(self.model.coordinates.len(), self.model.position_count());
            if let Some(statement) = self.taken_apart(input, &symbols, &body) {
                statements.push(statement);
                read.push(input);
            }
        }
        statements.extend(body.statements);
        statements.push(Stmt::Expr(result, None));
        (statements, read)
    }

    /// `let Params { r_w, g, .. } = self.params;`
    fn parameters(&self, body: &Body) -> Option<Stmt> {
        let used = body.used.iter().filter_map(|symbol| match symbol {
            Symbol::Parameter(i) => Some(*i as usize),
            _ => None,
        });
        let patterns: Vec<TokenStream> = used.map(|i| field_pattern(self.symbols, i)).collect();
        let rest = (patterns.len() < self.symbols.fields.len()).then(|| quote!(..));
        (!patterns.is_empty())
            .then(|| syn::parse_quote!(let Params { #(#patterns,)* #rest } = self.params;))
    }

    /// `let [_, phi_x] = entries(q);`
    fn taken_apart(&self, input: Input, symbols: &[Symbol], body: &Body) -> Option<Stmt> {
        let name = |symbol: &Symbol| body.used.contains(symbol).then(|| self.symbols.of(*symbol));
        let names: Vec<Option<&str>> = symbols.iter().map(name).collect();
        if names.iter().all(Option::is_none) {
            return None;
        }
        let entries = syntax::slice_pattern(names.into_iter().map(syntax::pattern));
        let argument = syntax::variable(input.name());
        Some(syntax::binding(entries, syntax::call("entries", argument)))
    }

    /// The result, and how many zeros of it went into `zeros()`.
    fn result(&self, function: &Function, results: Vec<Expr>) -> (Expr, usize) {
        let mut results = results.into_iter();
        let mut zeros = 0;
        let mut assemble = |block: &Block| {
            let entries = results.by_ref().take(block.entries.len());
            let entry = |(value, &id)| (!function.graph.is_zero(id)).then_some(value);
            let entries: Vec<Option<Expr>> = entries.zip(&block.entries).map(entry).collect();
            (block.name, assembled(&block.extents, entries, &mut zeros))
        };
        if let [block] = function.blocks.as_slice() {
            let (_, value) = assemble(block);
            return (value, zeros);
        }
        let values: Vec<(&str, Expr)> = function.blocks.iter().map(assemble).collect();
        let bundle = match function.quantity {
            Quantity::Response => quote!(::shapebot_dynamics::Response),
            _ => quote!(::shapebot_dynamics::Motion),
        };
        let (names, values): (Vec<syn::Ident>, Vec<Expr>) =
            values.into_iter().map(|(name, value)| (ident(name), value)).unzip();
        let mut literal: syn::ExprStruct = syn::parse_quote!(#bundle { #(#names: x),* });
        for (field, value) in literal.fields.iter_mut().zip(values) {
            field.expr = value;
        }
        (Expr::Struct(literal), zeros)
    }

    fn output_type(&self, function: &Function) -> TokenStream {
        let [n, nx, ns] = self.sizes();
        let size = Literal::usize_unsuffixed;
        match (function.quantity, function.blocks.as_slice()) {
            (Quantity::Response, _) => quote!(::shapebot_dynamics::Response<T, #nx, #ns>),
            (Quantity::Motion, _) => quote!(::shapebot_dynamics::Motion<T, #n>),
            (_, [block]) => match *block.extents.as_slice() {
                [] => quote!(T),
                [rows] => {
                    let rows = size(rows);
                    quote!(SVector<T, #rows>)
                }
                [rows, columns] => {
                    let (rows, columns) = (size(rows), size(columns));
                    quote!(SMatrix<T, #rows, #columns>)
                }
                [layers, rows, columns, ..] => {
                    let (layers, rows, columns) = (size(layers), size(rows), size(columns));
                    quote!([SMatrix<T, #rows, #columns>; #layers])
                }
            },
            _ => quote!(T),
        }
    }

    fn method_docs(&self, text: &str, function: &Function) -> String {
        let other = self.other.and_then(|functions| functions.get(&function.quantity));
        let (runtime, baked) =
            if self.runtime { (Some(function), other) } else { (other, Some(function)) };
        let mut lines =
            vec![text.to_owned(), String::new(), format!("Derived by: {}.", function.method)];
        let count = |title: &str, function: &Function| {
            format!("\n{title}: {}.", operations(&function.operations))
        };
        lines.extend(runtime.map(|function| count("Operations, parameters at run time", function)));
        lines.extend(baked.map(|function| count("Operations, parameters baked", function)));
        lines.join("\n")
    }
}

/// `let c = T::from_f64;`
pub(super) fn helper() -> Stmt {
    syn::parse_quote!(let c = T::from_f64;)
}

/// `r_w`, or `type_2: type_` where the local name differs from the field's.
pub(super) fn field_pattern(symbols: &SymbolNames, index: usize) -> TokenStream {
    let (field, local) = (ident(&symbols.fields[index]), ident(&symbols.parameters[index]));
    if field == local { quote!(#field) } else { quote!(#field: #local) }
}

/// `12 additions, 20 multiplications, 1 division, 2 angles`.
fn operations(count: &Operations) -> String {
    let parts = [
        (count.additions, "addition", true),
        (count.multiplications, "multiplication", true),
        (count.divisions, "division", false),
        (count.angles, "angle", false),
        (count.functions, "other function", false),
    ];
    let shown = parts.into_iter().filter(|&(number, _, always)| always || number > 0);
    let texts: Vec<String> = shown
        .map(|(number, name, _)| format!("{number} {name}{}", if number == 1 { "" } else { "s" }))
        .collect();
    texts.join(", ")
}

/// Index of the k-th entry, last index fastest.
fn position(block: &Block, mut k: usize) -> Vec<usize> {
    let mut index = vec![0; block.extents.len()];
    for (slot, &extent) in index.iter_mut().zip(&block.extents).rev() {
        *slot = k % extent.max(1);
        k /= extent.max(1);
    }
    index
}

/// Entries, last index fastest, `None` where zero, as a scalar, vector, matrix or list of matrices.
/// Counts the zeros that are not written one by one.
fn assembled(extents: &[usize], entries: Vec<Option<Expr>>, zeros: &mut usize) -> Expr {
    let zero = || syntax::call("c", syntax::number(0.0));
    if matches!(extents, [_] | [_, _]) && entries.iter().all(Option::is_none) {
        *zeros += entries.len();
        return syn::parse_quote!(SMatrix::zeros());
    }
    match *extents {
        [] => entries.into_iter().flatten().next().unwrap_or_else(zero),
        [_] => syntax::call(
            "vector",
            syntax::array(entries.into_iter().map(|entry| entry.unwrap_or_else(zero))),
        ),
        [rows, columns] => {
            // nalgebra stores columns.
            let mut entries = entries;
            let mut entry = |row, column| {
                entries.get_mut(row * columns + column).and_then(Option::take).unwrap_or_else(zero)
            };
            let mut list = |j| syntax::array((0..rows).map(|i| entry(i, j)).collect::<Vec<_>>());
            syntax::call("columns", syntax::array((0..columns).map(&mut list).collect::<Vec<_>>()))
        }
        [layers, ref matrix @ ..] => {
            let size = matrix.iter().product();
            let mut entries = entries.into_iter();
            let layer = |_| assembled(matrix, entries.by_ref().take(size).collect(), zeros);
            syntax::array((0..layers).map(layer).collect::<Vec<_>>())
        }
    }
}

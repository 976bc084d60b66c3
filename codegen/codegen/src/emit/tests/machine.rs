//! Executes and counts straight-line Rust of the shape that the emitter writes.

use std::collections::BTreeMap;
use syn::{BinOp, Block, Expr, File, ImplItem, Item, Member, Pat, Stmt, UnOp};

/// Operations in a text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Count {
    pub(super) additions: usize,
    pub(super) multiplications: usize,
    pub(super) divisions: usize,
    pub(super) angles: usize,
    pub(super) functions: usize,
}

/// Counts the operators and functions of a block.
pub(super) fn count(block: &Block) -> Count {
    let mut total = Count::default();
    for statement in &block.stmts {
        match statement {
            Stmt::Local(local) => total.expr(&local.init.as_ref().expect("a value").expr),
            Stmt::Expr(expr, _) => total.expr(expr),
            _ => {}
        }
    }
    total
}

impl Count {
    fn expr(&mut self, expr: &Expr) {
        match expr {
            Expr::Binary(e) => {
                match e.op {
                    BinOp::Add(_) | BinOp::Sub(_) => self.additions += 1,
                    BinOp::Mul(_) => self.multiplications += 1,
                    BinOp::Div(_) => self.divisions += 1,
                    _ => panic!("unknown operator"),
                }
                self.expr(&e.left);
                self.expr(&e.right);
            }
            Expr::Unary(e) => self.expr(&e.expr),
            Expr::Paren(e) => self.expr(&e.expr),
            Expr::MethodCall(e) => {
                if e.method == "sin_cos" {
                    self.angles += 1;
                } else {
                    self.functions += 1;
                }
                self.expr(&e.receiver);
                e.args.iter().for_each(|argument| self.expr(argument));
            }
            Expr::Call(e) => e.args.iter().for_each(|argument| self.expr(argument)),
            Expr::Array(e) => e.elems.iter().for_each(|element| self.expr(element)),
            Expr::Struct(e) => e.fields.iter().for_each(|field| self.expr(&field.expr)),
            Expr::Field(_) | Expr::Path(_) | Expr::Lit(_) => {}
            _ => panic!("not straight-line: {}", quote::quote!(#expr)),
        }
    }
}

/// Values of variables, vectors and fields.
#[derive(Clone, Debug, Default)]
pub(super) struct Machine {
    variables: BTreeMap<String, f64>,
    vectors: BTreeMap<String, Vec<f64>>,
    parameters: BTreeMap<String, f64>,
    fields: BTreeMap<String, f64>,
}

impl Machine {
    pub(super) fn new<'a>(
        vectors: impl IntoIterator<Item = (&'a str, Vec<f64>)>,
        parameters: impl IntoIterator<Item = (String, f64)>,
    ) -> Self {
        Self {
            vectors: vectors.into_iter().map(|(name, values)| (name.to_owned(), values)).collect(),
            parameters: parameters.into_iter().collect(),
            ..Self::default()
        }
    }

    pub(super) fn with_variables<'a>(variables: impl IntoIterator<Item = (&'a str, f64)>) -> Self {
        let variables =
            variables.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
        Self { variables, ..Self::default() }
    }

    /// Runs a constructor and keeps the fields.
    pub(super) fn construct(&mut self, block: &Block) {
        let mut inner = self.clone();
        let Some(Expr::Struct(result)) = inner.statements(block) else {
            panic!("no struct at the end")
        };
        for field in &result.fields {
            let Member::Named(name) = &field.member else { continue };
            if name != "params" {
                self.fields.insert(name.to_string(), inner.value(&field.expr));
            }
        }
    }

    /// Runs a body; the entries of its result in the order of the text. `sizes` are those of the
    /// blocks of the result.
    pub(super) fn run(&self, block: &Block, sizes: &[usize]) -> Vec<f64> {
        let mut inner = self.clone();
        let result = inner.statements(block).expect("a result");
        let mut out = Vec::new();
        match (&result, sizes) {
            (Expr::Struct(bundle), sizes) => {
                for (field, &size) in bundle.fields.iter().zip(sizes) {
                    inner.flatten(&field.expr, size, &mut out);
                }
            }
            (result, [size]) => inner.flatten(result, *size, &mut out),
            _ => panic!("several blocks"),
        }
        assert_eq!(out.len(), sizes.iter().sum::<usize>(), "entries");
        out
    }

    fn statements(&mut self, block: &Block) -> Option<Expr> {
        for statement in &block.stmts {
            match statement {
                Stmt::Local(local) => {
                    let value = &local.init.as_ref().expect("a value").expr;
                    self.bind(&local.pat, value);
                }
                Stmt::Expr(expr, None) => return Some(expr.clone()),
                _ => {}
            }
        }
        None
    }

    fn bind(&mut self, pattern: &Pat, value: &Expr) {
        match pattern {
            Pat::Ident(name) if name.ident == "c" => {}
            Pat::Ident(name) => {
                let value = self.value(value);
                let fresh = self.variables.insert(name.ident.to_string(), value).is_none();
                assert!(fresh, "{} is bound twice", name.ident);
            }
            Pat::Tuple(pair) => {
                let Expr::MethodCall(call) = value else { panic!("not sin_cos") };
                let (sin, cos) = self.value(&call.receiver).sin_cos();
                self.bind_all(pair.elems.iter(), &[sin, cos]);
            }
            Pat::Slice(list) => {
                let Expr::Call(call) = value else { panic!("not entries") };
                let Some(Expr::Path(vector)) = call.args.first() else { panic!("no argument") };
                let name = vector.path.require_ident().expect("a name").to_string();
                let values = self.vectors[&name].clone();
                self.bind_all(list.elems.iter(), &values);
            }
            Pat::Struct(fields) => {
                for field in &fields.fields {
                    let Member::Named(name) = &field.member else { panic!("no name") };
                    let value = self.parameters[&name.to_string()];
                    self.bind_all(std::iter::once(&*field.pat), &[value]);
                }
            }
            _ => panic!("unknown pattern"),
        }
    }

    fn bind_all<'p>(&mut self, patterns: impl ExactSizeIterator<Item = &'p Pat>, values: &[f64]) {
        assert_eq!(patterns.len(), values.len());
        for (pattern, &value) in patterns.zip(values) {
            if let Pat::Ident(name) = pattern {
                self.variables.insert(name.ident.to_string(), value);
            }
        }
    }

    fn flatten(&self, expr: &Expr, size: usize, out: &mut Vec<f64>) {
        match expr {
            Expr::Array(list) => {
                let share = size / list.elems.len().max(1);
                list.elems.iter().for_each(|element| self.flatten(element, share, out));
            }
            Expr::Call(call) if is_path(&call.func, "zeros") => out.extend(vec![0.0; size]),
            Expr::Call(call) if is_path(&call.func, "columns") || is_path(&call.func, "vector") => {
                call.args.iter().for_each(|argument| self.flatten(argument, size, out));
            }
            other => out.push(self.value(other)),
        }
    }

    fn value(&self, expr: &Expr) -> f64 {
        match expr {
            Expr::Binary(e) => {
                let (a, b) = (self.value(&e.left), self.value(&e.right));
                match e.op {
                    BinOp::Add(_) => a + b,
                    BinOp::Sub(_) => a - b,
                    BinOp::Mul(_) => a * b,
                    BinOp::Div(_) => a / b,
                    _ => panic!("unknown operator"),
                }
            }
            Expr::Unary(e) => {
                assert!(matches!(e.op, UnOp::Neg(_)));
                -self.value(&e.expr)
            }
            Expr::Paren(e) => self.value(&e.expr),
            Expr::MethodCall(e) => self.method(e),
            Expr::Call(e) if is_path(&e.func, "c") => self.value(e.args.first().expect("a number")),
            Expr::Field(e) => {
                let Member::Named(name) = &e.member else { panic!("no name") };
                self.fields[&name.to_string()]
            }
            Expr::Path(e) if e.path.segments.last().is_some_and(|s| s.ident == "PI") => {
                std::f64::consts::PI
            }
            Expr::Path(e) => {
                let name = e.path.require_ident().expect("a variable").to_string();
                *self.variables.get(&name).unwrap_or_else(|| panic!("{name} is not bound"))
            }
            Expr::Lit(e) => {
                let syn::Lit::Float(number) = &e.lit else { panic!("not a float") };
                number.base10_parse().expect("a number")
            }
            _ => panic!("not straight-line: {}", quote::quote!(#expr)),
        }
    }

    fn method(&self, call: &syn::ExprMethodCall) -> f64 {
        let x = self.value(&call.receiver);
        match call.method.to_string().as_str() {
            "sqrt" => x.sqrt(),
            "exp" => x.exp(),
            "ln" => x.ln(),
            "asin" => x.asin(),
            "acos" => x.acos(),
            "atan" => x.atan(),
            "atan2" => x.atan2(self.value(call.args.first().expect("two arguments"))),
            other => panic!("unknown method {other}"),
        }
    }
}

fn is_path(expr: &Expr, name: &str) -> bool {
    matches!(expr, Expr::Path(path) if path.path.segments.last().is_some_and(|s| s.ident == name))
}

fn implementations<'f>(
    file: &'f File,
    type_name: &'f str,
) -> impl Iterator<Item = &'f syn::ItemImpl> {
    let module = file.items.iter().find_map(|item| match item {
        Item::Mod(module) => module.content.as_ref().map(|(_, items)| items),
        _ => None,
    });
    let named = move |item: &'f Item| match item {
        Item::Impl(block) => match &*block.self_ty {
            syn::Type::Path(path)
                if path.path.segments.last().is_some_and(|s| s.ident == type_name) =>
            {
                Some(block)
            }
            _ => None,
        },
        _ => None,
    };
    module.expect("a module").iter().filter_map(named)
}

fn find(file: &File, type_name: &str, name: &str) -> Block {
    let functions = implementations(file, type_name).flat_map(|block| &block.items);
    let found = functions.filter_map(|item| match item {
        ImplItem::Fn(function) if function.sig.ident == name => Some(function.block.clone()),
        _ => None,
    });
    found.last().unwrap_or_else(|| panic!("{type_name} has no {name}"))
}

/// The body of `new`.
pub(super) fn constructor(file: &File, type_name: &str) -> Block {
    find(file, type_name, "new")
}

/// The body of a method, or of one arm of its match.
pub(super) fn method(file: &File, type_name: &str, name: &str, index: Option<usize>) -> Block {
    let block = find(file, type_name, name);
    let Some(index) = index else { return block };
    let Some(Stmt::Expr(Expr::Match(choice), None)) = block.stmts.first() else {
        panic!("no match in {name}")
    };
    match &*choice.arms[index].body {
        Expr::Block(arm) => arm.block.clone(),
        other => {
            Block { brace_token: Default::default(), stmts: vec![Stmt::Expr(other.clone(), None)] }
        }
    }
}

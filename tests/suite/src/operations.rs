//! Operation counts of emitted code, taken from its text as any user would read it: the generator's own
//! count has no part in it.
//!
//! Only straight-line code can be counted, so everything else is refused: no branch but the choice of an
//! index, no loop, no macro, and no call that could allocate or panic.

use std::collections::BTreeMap;
use std::fmt;
use syn::{BinOp, Block, Expr, ImplItem, Item, Pat, Stmt, UnOp};

/// Operations that appear in a piece of straight-line code.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// `+` and `-` between two values.
    pub additions: usize,
    /// `*`
    pub multiplications: usize,
    /// `/`
    pub divisions: usize,
    /// Calls of `sin_cos`.
    pub angles: usize,
    /// Calls of other functions of a number.
    pub functions: usize,
}

impl Operations {
    /// Additions, multiplications and divisions together.
    #[must_use]
    pub const fn flops(&self) -> usize {
        self.additions + self.multiplications + self.divisions
    }
}

impl fmt::Display for Operations {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { additions, multiplications, divisions, angles, functions } = self;
        let flops = self.flops();
        write!(
            f,
            "{flops:>6} {additions:>6} {multiplications:>6} {divisions:>6} {angles:>6} {functions:>6}"
        )
    }
}

/// Counts of one type's methods by name.
pub type Methods = BTreeMap<String, Operations>;

/// Counts of the trait methods of an emitted module: type, then method. Of a method that chooses by an
/// index, all choices together.
///
/// # Panics
///
/// If the text is no Rust, or a method is no straight-line code.
#[must_use]
pub fn count(emitted: &str) -> BTreeMap<String, Methods> {
    let file = syn::parse_file(emitted).expect("emitted text is Rust");
    let items: Vec<&Item> = file.items.iter().flat_map(contents).collect();
    let helpers = helpers(&items);
    let mut counts: BTreeMap<String, Methods> = BTreeMap::new();
    for item in items {
        let Item::Impl(block) = item else { continue };
        let Some((path, _)) = &block.trait_ else { continue };
        let ours = path.segments.first().is_some_and(|first| first.ident == "shapebot_dynamics");
        if !ours {
            continue;
        }
        let methods = counts.entry(type_name(&block.self_ty)).or_default();
        for method in &block.items {
            if let ImplItem::Fn(method) = method {
                let name = method.sig.ident.to_string();
                methods.insert(name.clone(), counted(&name, &method.block, &helpers));
            }
        }
    }
    counts
}

/// Names of the module's own functions, which only arrange numbers.
fn helpers(items: &[&Item]) -> Vec<String> {
    let mut names = Vec::new();
    for item in items {
        if let Item::Fn(function) = item {
            let name = function.sig.ident.to_string();
            let operations = counted(&name, &function.block, &[]);
            assert_eq!(operations, Operations::default(), "{name} computes");
            names.push(name);
        }
    }
    names
}

fn counted(name: &str, block: &Block, helpers: &[String]) -> Operations {
    let mut counter = Counter { operations: Operations::default(), helpers };
    let counted = counter.block(block);
    counted.unwrap_or_else(|what| panic!("{name} is no straight-line code: {what}"));
    counter.operations
}

fn contents(item: &Item) -> Vec<&Item> {
    match item {
        Item::Mod(module) => module.content.iter().flat_map(|(_, items)| items).collect(),
        other => vec![other],
    }
}

fn type_name(ty: &syn::Type) -> String {
    match ty {
        syn::Type::Path(path) => {
            path.path.segments.last().map(|segment| segment.ident.to_string()).unwrap_or_default()
        }
        _ => String::new(),
    }
}

struct Counter<'a> {
    operations: Operations,
    /// Functions that may be called.
    helpers: &'a [String],
}

/// Or what is no straight-line code.
type Counted = Result<(), String>;

impl Counter<'_> {
    fn block(&mut self, block: &Block) -> Counted {
        block.stmts.iter().try_for_each(|statement| match statement {
            Stmt::Local(local) => match &local.init {
                Some(init) if init.diverge.is_none() => self.expr(&init.expr),
                _ => Err("a binding without a value".to_owned()),
            },
            Stmt::Expr(expr, _) => self.expr(expr),
            Stmt::Item(_) => Err("an item".to_owned()),
            Stmt::Macro(_) => Err("a macro".to_owned()),
        })
    }

    fn all<'a>(&mut self, list: impl IntoIterator<Item = &'a Expr>) -> Counted {
        list.into_iter().try_for_each(|expr| self.expr(expr))
    }

    fn expr(&mut self, expr: &Expr) -> Counted {
        match expr {
            Expr::Lit(_) | Expr::Path(_) => Ok(()),
            Expr::Binary(binary) => {
                self.operator(&binary.op)?;
                self.all([&*binary.left, &*binary.right])
            }
            Expr::Unary(unary) if matches!(unary.op, UnOp::Neg(_) | UnOp::Deref(_)) => {
                self.expr(&unary.expr)
            }
            Expr::Paren(inner) => self.expr(&inner.expr),
            Expr::Group(inner) => self.expr(&inner.expr),
            Expr::Reference(inner) => self.expr(&inner.expr),
            Expr::Field(field) => self.expr(&field.base),
            Expr::Array(array) => self.all(&array.elems),
            Expr::Tuple(tuple) => self.all(&tuple.elems),
            Expr::Struct(made) => self.all(made.fields.iter().map(|field| &field.expr)),
            Expr::Index(index) if matches!(*index.index, Expr::Lit(_) | Expr::Tuple(_)) => {
                self.all([&*index.expr, &*index.index])
            }
            Expr::Block(block) => self.block(&block.block),
            Expr::MethodCall(call) => {
                self.function(&call.method.to_string())?;
                self.expr(&call.receiver)?;
                self.all(&call.args)
            }
            Expr::Call(call) => self.call(call),
            Expr::Match(choice) if is_index(choice) => {
                self.all(choice.arms.iter().map(|arm| &*arm.body))
            }
            other => Err(format!("{:?}", std::mem::discriminant(other))),
        }
    }

    fn operator(&mut self, operator: &BinOp) -> Counted {
        match operator {
            BinOp::Add(_) | BinOp::Sub(_) => self.operations.additions += 1,
            BinOp::Mul(_) => self.operations.multiplications += 1,
            BinOp::Div(_) => self.operations.divisions += 1,
            _ => return Err("an operator".to_owned()),
        }
        Ok(())
    }

    fn call(&mut self, call: &syn::ExprCall) -> Counted {
        let Expr::Path(path) = &*call.func else { return Err("a call".to_owned()) };
        let name = path.path.segments.last().map(|segment| segment.ident.to_string());
        self.function(&name.unwrap_or_default())?;
        self.all(&call.args)
    }

    /// A function of numbers, or one that only arranges them.
    fn function(&mut self, name: &str) -> Counted {
        match name {
            "sin_cos" => self.operations.angles += 1,
            "sqrt" | "exp" | "ln" | "asin" | "acos" | "atan" | "atan2" => {
                self.operations.functions += 1
            }
            "c" | "from_f64" | "zeros" | "identity" | "zero" | "one" => {}
            "from_array_storage" | "ArrayStorage" => {}
            helper if self.helpers.iter().any(|name| name == helper) => {}
            other => return Err(format!("a call of `{other}`")),
        }
        Ok(())
    }
}

/// `match index { 0 => …, _ => … }` with an argument of the method.
fn is_index(choice: &syn::ExprMatch) -> bool {
    matches!(&*choice.expr, Expr::Path(_))
        && choice.arms.iter().all(|arm| matches!(arm.pat, Pat::Lit(_) | Pat::Wild(_)))
}

#[cfg(test)]
mod tests {
    use super::{Operations, count};

    #[test]
    fn operators_of_bodies_are_counted_and_signs_are_not() {
        let text = "
            pub mod robot {
                impl<T: Real> ::shapebot_dynamics::Lagrangian<T, 2> for Robot<T> {
                    fn gravity(&self, q: &V<T>) -> V<T> {
                        let c = T::from_f64;
                        let (sin, cos) = q[0].sin_cos();
                        let x = -(sin * c(2.0)) + cos / self.k - cos.sqrt();
                        vector([x * x, -x])
                    }
                }
                impl<T> Robot<T> { fn new() -> T { a + b } }
                fn vector<T>(entries: [T; 2]) -> V<T> {
                    SMatrix::from_array_storage(ArrayStorage([entries]))
                }
            }";
        let expected =
            Operations { additions: 2, multiplications: 2, divisions: 1, angles: 1, functions: 1 };
        let counts = count(text);
        assert_eq!(counts.len(), 1);
        assert_eq!(counts["Robot"]["gravity"], expected);
        assert_eq!(expected.flops(), 5);
    }

    #[test]
    fn branches_loops_and_foreign_calls_are_refused() {
        for body in
            ["if q { a } else { b }", "loop {}", "panic!()", "q.unwrap()", "v[i]", "a.to_vec()"]
        {
            let text =
                format!("impl ::shapebot_dynamics::A for R {{ fn f(&self) -> T {{ {body} }} }}");
            assert!(std::panic::catch_unwind(|| count(&text)).is_err(), "{body}");
        }
    }
}

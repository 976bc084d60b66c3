//! Short constructors for syntax trees. Bodies are built as trees and never parsed: parsing what was
//! just built costs more than the rest of the emission.

use proc_macro2::Span;
use syn::punctuated::Punctuated;
use syn::{
    BinOp, Expr, ExprArray, ExprBinary, ExprCall, ExprField, ExprLit, ExprMethodCall, ExprUnary,
    Ident, Lit, LitFloat, Local, LocalInit, Member, Pat, PatIdent, PatSlice, PatTuple, PatWild,
    Stmt, UnOp,
};

/// Name of the macro that stands for a comment until the text is formatted.
pub(super) const COMMENT: &str = "shapebot_comment";

/// An identifier; names have passed [`super::names::identifier`].
pub(super) fn ident(name: &str) -> Ident {
    Ident::new(name, Span::call_site())
}

/// A variable or a plain path.
pub(super) fn variable(name: &str) -> Expr {
    path(ident(name).into())
}

pub(super) fn path(path: syn::Path) -> Expr {
    Expr::Path(syn::ExprPath { attrs: Vec::new(), qself: None, path })
}

pub(super) fn binary(left: Expr, op: BinOp, right: Expr) -> Expr {
    Expr::Binary(ExprBinary { attrs: Vec::new(), left: Box::new(left), op, right: Box::new(right) })
}

pub(super) fn add() -> BinOp {
    BinOp::Add(Default::default())
}

pub(super) fn sub() -> BinOp {
    BinOp::Sub(Default::default())
}

pub(super) fn mul() -> BinOp {
    BinOp::Mul(Default::default())
}

pub(super) fn div() -> BinOp {
    BinOp::Div(Default::default())
}

/// −x; a difference is turned round instead.
pub(super) fn negative(x: Expr) -> Expr {
    match x {
        Expr::Binary(ExprBinary { left, op: op @ BinOp::Sub(_), right, attrs }) => {
            Expr::Binary(ExprBinary { attrs, left: right, op, right: left })
        }
        x => Expr::Unary(ExprUnary {
            attrs: Vec::new(),
            op: UnOp::Neg(Default::default()),
            expr: Box::new(x),
        }),
    }
}

pub(super) fn method(
    receiver: Expr,
    name: &str,
    arguments: impl IntoIterator<Item = Expr>,
) -> Expr {
    Expr::MethodCall(ExprMethodCall {
        attrs: Vec::new(),
        receiver: Box::new(receiver),
        dot_token: Default::default(),
        method: ident(name),
        turbofish: None,
        paren_token: Default::default(),
        args: arguments.into_iter().collect(),
    })
}

pub(super) fn call(function: &str, argument: Expr) -> Expr {
    Expr::Call(ExprCall {
        attrs: Vec::new(),
        func: Box::new(variable(function)),
        paren_token: Default::default(),
        args: std::iter::once(argument).collect(),
    })
}

pub(super) fn field(base: Expr, name: &str) -> Expr {
    Expr::Field(ExprField {
        attrs: Vec::new(),
        base: Box::new(base),
        dot_token: Default::default(),
        member: Member::Named(ident(name)),
    })
}

/// The shortest decimal that reads back as the same double, which must be finite and not negative.
pub(super) fn literal(value: f64) -> Expr {
    let text = format!("{value:?}");
    Expr::Lit(ExprLit {
        attrs: Vec::new(),
        lit: Lit::Float(LitFloat::new(&text, Span::call_site())),
    })
}

pub(super) fn array(elements: impl IntoIterator<Item = Expr>) -> Expr {
    Expr::Array(ExprArray {
        attrs: Vec::new(),
        bracket_token: Default::default(),
        elems: elements.into_iter().collect(),
    })
}

/// A name to bind, or `_`.
pub(super) fn pattern(name: Option<&str>) -> Pat {
    match name {
        Some(name) => Pat::Ident(PatIdent {
            attrs: Vec::new(),
            by_ref: None,
            mutability: None,
            ident: ident(name),
            subpat: None,
        }),
        None => Pat::Wild(PatWild { attrs: Vec::new(), underscore_token: Default::default() }),
    }
}

pub(super) fn slice_pattern(elements: impl IntoIterator<Item = Pat>) -> Pat {
    Pat::Slice(PatSlice {
        attrs: Vec::new(),
        bracket_token: Default::default(),
        elems: elements.into_iter().collect::<Punctuated<_, _>>(),
    })
}

pub(super) fn tuple_pattern(elements: impl IntoIterator<Item = Pat>) -> Pat {
    Pat::Tuple(PatTuple {
        attrs: Vec::new(),
        paren_token: Default::default(),
        elems: elements.into_iter().collect::<Punctuated<_, _>>(),
    })
}

/// `let pattern = value;`
pub(super) fn binding(pat: Pat, value: Expr) -> Stmt {
    Stmt::Local(Local {
        attrs: Vec::new(),
        let_token: Default::default(),
        modifiers: Default::default(),
        pat,
        init: Some(LocalInit {
            eq_token: Default::default(),
            expr: Box::new(value),
            diverge: None,
        }),
        semi_token: Default::default(),
    })
}

/// A statement that becomes the comment `// text`.
pub(super) fn comment(text: &str) -> Stmt {
    let name = ident(COMMENT);
    syn::parse_quote!(#name!(#text);)
}

/// A number that is not negative, as an expression of type f64.
pub(super) fn number(value: f64) -> Expr {
    if value.is_finite() {
        literal(value)
    } else if value.is_nan() {
        path(syn::parse_quote!(::core::f64::NAN))
    } else {
        path(syn::parse_quote!(::core::f64::INFINITY))
    }
}

/// π as an expression of type f64.
pub(super) fn pi() -> Expr {
    path(syn::parse_quote!(::core::f64::consts::PI))
}

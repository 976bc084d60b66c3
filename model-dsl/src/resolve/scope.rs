//! Names and where they are known.

use super::Resolver;
use super::value::Value;
use crate::ast::{IndexedName, Name};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::suggest::closest;
use crate::{Span, units};
use std::collections::BTreeMap;

/// A name with its index, if it has one.
pub(crate) type Key = (String, Option<i64>);

pub(crate) struct Binding<'a> {
    pub(crate) value: Value<'a>,
    pub(crate) span: Span,
}

/// What a scope belongs to.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Level {
    Robot,
    Component,
    Repetition,
}

pub(crate) struct Scope<'a> {
    pub(crate) parent: Option<usize>,
    pub(crate) level: Level,
    /// `left.` within the instance `left`.
    pub(crate) prefix: String,
    pub(crate) names: BTreeMap<Key, Binding<'a>>,
}

/// Functions, constants and clause words.
pub(crate) const BUILTIN: &[&str] = &[
    "world", "pi", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh",
    "sqrt", "exp", "ln", "rot_x", "rot_y", "rot_z", "dot", "cross", "omega", "diag", "sym", "sum",
    "dt", "in", "on", "at", "along", "limit", "abs", "min", "max", "sign", "floor", "ceil",
    "round", "mod",
];

/// A name of the model becomes a name in Rust.
const RUST: &[&str] = &[
    "abstract", "as", "async", "await", "become", "box", "break", "continue", "crate", "do", "dyn",
    "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "loop", "macro",
    "match", "mod", "move", "mut", "override", "priv", "pub", "ref", "return", "self", "Self",
    "static", "struct", "super", "trait", "true", "try", "type", "typeof", "union", "unsafe",
    "unsized", "use", "virtual", "where", "while", "yield", "_",
];

impl<'a> Resolver<'a> {
    pub(crate) fn enter(&mut self, level: Level, parent: usize, prefix: String) -> usize {
        self.scopes.push(Scope { parent: Some(parent), level, prefix, names: BTreeMap::new() });
        self.scopes.len() - 1
    }

    /// The scope that declarations with an index go to.
    fn block_scope(&self) -> usize {
        let mut at = self.scope;
        while self.scopes[at].level == Level::Repetition {
            at = self.scopes[at].parent.unwrap_or(0);
        }
        at
    }

    /// Whether statements stand directly in the robot.
    pub(crate) fn level(&self) -> Level {
        self.scopes[self.scope].level
    }

    /// `left.arm[2]` as the file addresses it.
    pub(crate) fn path(&self, key: &Key) -> String {
        format!("{}{}", self.scopes[self.scope].prefix, plain_path(key))
    }

    /// Evaluates the index of a name.
    pub(crate) fn key(&mut self, name: &'a IndexedName) -> Option<Key> {
        let index = match &name.index {
            None => None,
            Some(expr) => Some(self.whole(expr, "an index")?),
        };
        Some((name.name.text.clone(), index))
    }

    /// A text for the model; repetitions must not multiply it without bounds.
    pub(crate) fn copy_of(&mut self, text: &str, span: Span) -> String {
        self.arena.charge(text.len() / 8, span);
        text.to_owned()
    }

    pub(crate) fn bind(&mut self, key: Key, value: Value<'a>, span: Span) {
        if let Value::Array(array) = &value {
            self.arena.charge(array.entries.len(), span);
        }
        if self.is_reserved(&key.0, span) {
            return;
        }
        let scope = if key.1.is_some() { self.block_scope() } else { self.scope };
        if let Some(first) = self.scopes[scope].names.get(&key) {
            let title = format!("`{}` is declared twice", plain_path(&key));
            let diagnostic = Diagnostic::error(codes::E0202, span, title)
                .label("declared again")
                .also(first.span, "first declared here")
                .help("rename one of the two");
            self.sink.push(diagnostic);
            return;
        }
        self.scopes[scope].names.insert(key, Binding { value, span });
    }

    /// Reports a name that means something already.
    pub(crate) fn is_reserved(&mut self, name: &str, span: Span) -> bool {
        let why = if RUST.contains(&name) {
            "a word of Rust, where the names end up"
        } else if BUILTIN.contains(&name) || is_statement(name) {
            "a word of the language"
        } else {
            return false;
        };
        self.sink.push(
            Diagnostic::error(codes::E0205, span, format!("`{name}` cannot be used as a name"))
                .label(why)
                .help(format!("add something to it, such as `{}_1`", name.trim_end_matches('_'))),
        );
        true
    }

    /// Finds a name in this scope or one around it.
    pub(crate) fn find(&self, key: &Key) -> Option<&Binding<'a>> {
        let mut at = Some(self.scope);
        while let Some(scope) = at.map(|i| &self.scopes[i]) {
            if let Some(binding) = scope.names.get(key) {
                return Some(binding);
            }
            at = scope.parent;
        }
        None
    }

    fn visible(&self) -> Vec<&str> {
        let mut list = Vec::new();
        let mut at = Some(self.scope);
        while let Some(scope) = at.map(|i| &self.scopes[i]) {
            list.extend(scope.names.keys().map(|k| k.0.as_str()));
            at = scope.parent;
        }
        list
    }

    /// Reports a name that nothing declares.
    pub(crate) fn unknown(&mut self, name: &Name, index: Option<i64>) {
        let shown = plain_path(&(name.text.clone(), index));
        if let Some(later) =
            self.declared.get(&name.text).copied().filter(|s| s.start > name.span.start)
        {
            let diagnostic = Diagnostic::error(
                codes::E0206,
                name.span,
                format!("`{shown}` is used before it is declared"),
            )
            .label("not known yet")
            .also(later, "declared here")
            .help("move the declaration up; a file is read from top to bottom");
            self.sink.push(diagnostic);
            return;
        }
        let mut diagnostic =
            Diagnostic::error(codes::E0201, name.span, format!("nothing is called `{shown}`"))
                .label("unknown name");
        if !self.sink.is_crowded() {
            diagnostic = diagnostic.maybe_help(self.similar(name, index));
        }
        self.sink.push(diagnostic);
    }

    fn similar(&self, name: &Name, index: Option<i64>) -> Option<String> {
        if index.is_some() {
            let known: Vec<String> = self.indices(&name.text);
            if !known.is_empty() {
                return Some(format!("`{}` is known with index {}", name.text, known.join(", ")));
            }
        } else if let Some(first) = self.indices(&name.text).first() {
            return Some(format!("it needs an index, such as `{}[{first}]`", name.text));
        }
        let names = self.visible();
        let candidates = names.iter().copied().chain(BUILTIN.iter().copied().take(23));
        closest(&name.text, candidates).map(|n| format!("did you mean `{n}`?"))
    }

    fn indices(&self, name: &str) -> Vec<String> {
        let scope = &self.scopes[self.block_scope()];
        let range = (name.to_owned(), Some(i64::MIN))..=(name.to_owned(), Some(i64::MAX));
        scope.names.range(range).filter_map(|(k, _)| k.1).map(|i| i.to_string()).take(12).collect()
    }

    /// Checks that an emitted name is used once, across parameters, coordinates and actuators or
    /// across the named things of one family.
    pub(crate) fn claim(&mut self, family: &'static str, name: &str, span: Span) {
        if let Some(first) = self.claimed.insert((family, name.to_owned()), span) {
            self.claimed.insert((family, name.to_owned()), first);
            if first == span && self.level() != Level::Repetition {
                return;
            }
            let mut diagnostic =
                Diagnostic::error(codes::E0203, span, format!("two {family} are called `{name}`"))
                    .label("second use of the name")
                    .note("generated code writes `theta.x` and `theta_x` alike as `theta_x`");
            if first == span {
                diagnostic = diagnostic.help("within `repeat`, give it the index: `name[i]`");
            } else {
                diagnostic = diagnostic.also(first, "first use").help("rename one of the two");
            }
            self.sink.push(diagnostic);
        }
    }
}

fn is_statement(name: &str) -> bool {
    crate::parse::KEYWORDS.contains(&name)
}

/// `name` or `name[2]`.
pub(crate) fn plain_path(key: &Key) -> String {
    key.1.map_or_else(|| key.0.clone(), |i| format!("{}[{i}]", key.0))
}

/// The identifier for a path: `left.arm[2]` is `left_arm_2`.
pub(crate) fn identifier(path: &str) -> String {
    path.replace(['.', '['], "_").replace(']', "")
}

/// Whether a number's unit suffix is also a declared name.
pub(crate) fn is_ambiguous(resolver: &Resolver<'_>, suffix: &str) -> bool {
    !matches!(suffix, "deg" | "rad")
        && units::find(suffix).is_some()
        && resolver.find(&(suffix.to_owned(), None)).is_some()
}

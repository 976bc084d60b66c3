//! Declarations of coordinates, and labels of vectors in general.

use super::scope::{Key, identifier, plain_path};
use super::value::{Array, Scalar, Value};
use super::{Draft, Resolver};
use crate::Span;
use crate::ast::{Coordinates, Declarator, ExprKind, Labels};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::model::{Coordinate, CoordinateId, CoordinateSet, Expr, Range, Role, Unit};
use std::rc::Rc;

/// A declared name with the labels of its entries, if it is a vector.
pub(super) struct Declared {
    pub(super) key: Key,
    pub(super) labels: Option<Rc<[String]>>,
}

/// Most entries of one declared vector.
const MAX_LABELS: i64 = 1000;

impl<'a> Resolver<'a> {
    pub(super) fn coordinates(&mut self, coordinates: &'a Coordinates, docs: &str) {
        let unit = self.unit(&coordinates.unit);
        let range = match (&coordinates.range, &unit) {
            (Some(bounds), Some(unit)) => self.bounds(bounds, unit),
            _ => None,
        };
        self.coordinates_broken |= unit.is_none();
        let role = if coordinates.position { Role::Position } else { Role::Shape };
        for declarator in &coordinates.names {
            let Some(declared) = self.declarator(declarator) else {
                self.coordinates_broken = true;
                self.bind(
                    (declarator.name.text.clone(), None),
                    Value::Poison,
                    declarator.name.span,
                );
                continue;
            };
            let value = match &unit {
                Some(unit) => self.set(&declared, role, unit, range, docs, declarator.span),
                None => Value::Poison,
            };
            self.bind(declared.key, value, declarator.name.span);
        }
    }

    fn set(
        &mut self,
        declared: &Declared,
        role: Role,
        unit: &Unit,
        range: Option<Range>,
        docs: &str,
        span: Span,
    ) -> Value<'a> {
        let path = self.path(&declared.key);
        let set = self.sets.len();
        self.claim("coordinate vectors", &identifier(&path), span);
        let docs = self.copy_of(docs, span);
        self.sets.push(CoordinateSet {
            name: identifier(&path),
            role,
            coordinates: Vec::new(),
            docs,
            span,
        });
        let add = |resolver: &mut Self, path: String| {
            let name = identifier(&path);
            resolver.claim("quantities", &name, span);
            let id = CoordinateId(u32::try_from(resolver.drafts.len()).unwrap_or(u32::MAX));
            let coordinate = Coordinate { name, path, role, set, unit: unit.clone(), range, span };
            resolver.drafts.push(Draft { coordinate, set });
            let id = resolver.arena.push(Expr::Coordinate(id), span);
            Scalar { id, dimension: Some(unit.dimension) }
        };
        match &declared.labels {
            None => Value::Scalar(add(self, path)),
            Some(labels) => {
                let entry = |l: &String| {
                    if is_number(l) { format!("{path}[{l}]") } else { format!("{path}.{l}") }
                };
                let entries = labels.iter().map(|l| add(self, entry(l))).collect();
                Value::Array(Array::new(entries, labels.clone()))
            }
        }
    }

    /// Splits `name[i][x, y]` into a key and labels.
    pub(super) fn declarator(&mut self, declarator: &'a Declarator) -> Option<Declared> {
        let name = declarator.name.text.clone();
        let mut brackets = declarator.brackets.iter();
        let mut index = None;
        let mut next = brackets.next();
        if let Some(Labels::List(list)) = next
            && let [single] = list.as_slice()
            && self.is_index(&single.kind)
        {
            index = Some(self.whole(single, "an index")?);
            next = brackets.next();
        }
        let labels = match next {
            None => None,
            Some(labels) => Some(self.labels(labels)?),
        };
        if let Some(extra) = brackets.next() {
            let span = match extra {
                Labels::List(list) => list.first().map_or(declarator.span, |e| e.span),
                Labels::Range { from, .. } => from.span,
            };
            self.sink.push(
                Diagnostic::error(
                    codes::E0101,
                    span,
                    format!("`{}` has too many brackets", plain_path(&(name, index))),
                )
                .help("an index and then labels are possible: `phi[i][x, y]`"),
            );
            return None;
        }
        Some(Declared { key: (name, index), labels })
    }

    /// Whether a single entry in brackets is an index and no label.
    fn is_index(&self, kind: &ExprKind) -> bool {
        match kind {
            ExprKind::Name(name) => match self.find(&(name.text.clone(), None)).map(|b| &b.value) {
                Some(Value::Scalar(s)) => self.arena.as_number(s.id).is_some(),
                _ => false,
            },
            _ => true,
        }
    }

    pub(super) fn labels(&mut self, labels: &'a Labels) -> Option<Rc<[String]>> {
        match labels {
            Labels::Range { from, to, inclusive } => {
                let range = self.range(from, to, *inclusive)?;
                let count = range.end().saturating_sub(*range.start());
                if count >= MAX_LABELS || range.is_empty() || *range.start() < 0 {
                    self.sink.push(
                        Diagnostic::error(
                            codes::E0512,
                            from.span.to(to.span),
                            "this is no range of labels",
                        )
                        .help(format!(
                            "a vector has 1 to {MAX_LABELS} entries, numbered from 0 or more"
                        )),
                    );
                    return None;
                }
                Some(range.map(|i| i.to_string()).collect())
            }
            Labels::List(list) => {
                let mut out: Vec<String> = Vec::with_capacity(list.len());
                for expr in list {
                    let ExprKind::Name(name) = &expr.kind else {
                        self.sink.push(
                            Diagnostic::error(codes::E0101, expr.span, "a label is a name").help(
                                "write labels as in `theta[x, y]`, or a range as in `phi[1..=4]`",
                            ),
                        );
                        return None;
                    };
                    if out.contains(&name.text) {
                        self.sink.push(Diagnostic::error(
                            codes::E0202,
                            name.span,
                            format!("the label `{}` occurs twice", name.text),
                        ));
                        return None;
                    }
                    out.push(name.text.clone());
                }
                Some(out.into())
            }
        }
    }
}

fn is_number(label: &str) -> bool {
    label.bytes().all(|b| b.is_ascii_digit())
}

//! Components, repetitions, requirements.

use super::Resolver;
use super::scope::Level;
use super::value::{Array, Instance, Scalar, Value};
use crate::Span;
use crate::ast::{
    self, Argument, ArgumentType, Expr as AstExpr, IndexedName, Loop, Name, Requirement, Statement,
};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::model::{self, Comparison, CoordinateId, Dimension, Required};
use crate::suggest::closest;
use crate::units::ratio;
use std::ops::RangeInclusive;
use std::rc::Rc;

impl<'a> Resolver<'a> {
    pub(super) fn instance(
        &mut self,
        name: &'a IndexedName,
        component: &'a Name,
        arguments: &'a [AstExpr],
        span: Span,
    ) {
        let Some(key) = self.key(name) else { return };
        let value = match self.component_named(component) {
            Some((definition, home)) => {
                let path = self.path(&key);
                self.instantiate(definition, home, path, component, arguments, span)
            }
            None => Value::Poison,
        };
        self.bind(key, value, name.name.span);
    }

    fn component_named(&mut self, name: &Name) -> Option<(&'a ast::Component, usize)> {
        match self.find(&(name.text.clone(), None)).map(|b| b.value.clone()) {
            Some(Value::Component(definition, home)) => Some((definition, home)),
            Some(Value::Poison) => None,
            Some(other) => {
                self.sink.push(
                    Diagnostic::error(
                        codes::E0208,
                        name.span,
                        format!("`{}` is no component", name.text),
                    )
                    .label(format!("this is {}", other.kind()))
                    .help("write `let name = …;` to name a value"),
                );
                None
            }
            None => {
                let all = self.scopes[0]
                    .names
                    .iter()
                    .filter(|(_, b)| matches!(b.value, Value::Component(..)));
                let close = closest(&name.text, all.map(|(k, _)| k.0.as_str())).map(str::to_owned);
                self.sink.push(
                    Diagnostic::error(
                        codes::E0201,
                        name.span,
                        format!("there is no component `{}`", name.text),
                    )
                    .label("unknown component")
                    .maybe_help(close.map(|c| format!("did you mean `{c}`?"))),
                );
                None
            }
        }
    }

    fn instantiate(
        &mut self,
        definition: &'a ast::Component,
        home: usize,
        path: String,
        called: &'a Name,
        arguments: &'a [AstExpr],
        span: Span,
    ) -> Value<'a> {
        if self.expanding.contains(&definition.name.text.as_str()) {
            self.sink.push(
                Diagnostic::error(
                    codes::E0510,
                    called.span,
                    format!("`{}` contains itself", called.text),
                )
                .also(definition.name.span, "the component")
                .help("a chain of parts is written with `repeat`"),
            );
            return Value::Poison;
        }
        if arguments.len() != definition.arguments.len() {
            self.wrong_count(definition, called, arguments.len(), span);
            return Value::Poison;
        }
        if !self.expand(span) {
            return Value::Poison;
        }
        let mut values = Vec::with_capacity(arguments.len());
        for (argument, expr) in definition.arguments.iter().zip(arguments) {
            let value = self.eval(expr);
            values.push((argument, self.argument(argument, value, expr.span)));
        }
        let scope = self.enter(Level::Component, home, format!("{path}."));
        let outer = std::mem::replace(&mut self.scope, scope);
        for (argument, value) in values {
            self.bind((argument.name.text.clone(), None), value, argument.name.span);
        }
        self.expanding.push(&definition.name.text);
        self.statements(&definition.body);
        self.expanding.pop();
        self.scope = outer;
        Value::Instance(Rc::new(Instance { path, scope, component: definition }))
    }

    fn wrong_count(
        &mut self,
        definition: &ast::Component,
        called: &Name,
        given: usize,
        span: Span,
    ) {
        let wanted: Vec<&str> = definition.arguments.iter().map(|a| a.name.text.as_str()).collect();
        self.sink.push(
            Diagnostic::error(
                codes::E0407,
                span,
                format!("`{}` takes {} arguments", called.text, wanted.len()),
            )
            .label(format!("{given} given"))
            .also(definition.name.span, "the component")
            .help(format!("write `{}({})`", called.text, wanted.join(", "))),
        );
    }

    /// Checks a value against the declared type of an argument.
    fn argument(&mut self, argument: &'a Argument, value: Value<'a>, span: Span) -> Value<'a> {
        if matches!(value, Value::Poison) {
            return value;
        }
        let what = format!("the argument `{}`", argument.name.text);
        match &argument.kind {
            ArgumentType::Frame => match value {
                Value::Turned(parent, turns) => {
                    Value::Frame(self.unnamed_frame(parent, &turns, span))
                }
                Value::Frame(_) => value,
                other => self.wrong_argument(&what, "a frame", &other, span),
            },
            ArgumentType::Point => match self.position(&value, span, &what) {
                Some((_, vector)) => Value::Vector(vector),
                None => Value::Poison,
            },
            ArgumentType::Scalar(unit) => {
                let Some(unit) = self.unit(unit) else { return Value::Poison };
                match self.as_scalar(&value, span, &what) {
                    Some(scalar) if self.demand(scalar, unit.dimension, span, &what) => {
                        Value::Scalar(scalar)
                    }
                    _ => Value::Poison,
                }
            }
            ArgumentType::Array(unit, labels) => {
                let Some(unit) = self.unit(unit) else { return Value::Poison };
                match self.argument_labels(labels) {
                    Some(labels) => {
                        self.array_argument(&what, value, &labels, unit.dimension, span)
                    }
                    None => Value::Poison,
                }
            }
        }
    }

    /// Labels of an array argument: `[x, y]`, `[1..=n]`, or a bare count as in `m[3]`.
    fn argument_labels(&mut self, labels: &'a ast::Labels) -> Option<Rc<[String]>> {
        match labels {
            ast::Labels::List(list)
                if list.len() == 1 && !matches!(list[0].kind, ast::ExprKind::Name(_)) =>
            {
                let count = self.whole(&list[0], "a length")?.clamp(0, 1000);
                Some(super::value::default_labels(usize::try_from(count).ok()?))
            }
            _ => self.labels(labels),
        }
    }

    fn array_argument(
        &mut self,
        what: &str,
        value: Value<'a>,
        labels: &Rc<[String]>,
        wanted: Dimension,
        span: Span,
    ) -> Value<'a> {
        match value {
            Value::Vector(v) if labels.len() == 3 => {
                if self.demand_dimension(v.dimension, wanted, None, span, what) {
                    Value::Vector(v)
                } else {
                    Value::Poison
                }
            }
            Value::Array(a) if a.entries.len() == labels.len() => {
                if !a.entries.iter().all(|s| self.demand(*s, wanted, span, what)) {
                    return Value::Poison;
                }
                Value::Array(Array::new(a.entries, labels.clone()))
            }
            other => {
                self.wrong_argument(what, &format!("an array of {}", labels.len()), &other, span)
            }
        }
    }

    fn wrong_argument(
        &mut self,
        what: &str,
        wanted: &str,
        found: &Value<'a>,
        span: Span,
    ) -> Value<'a> {
        self.sink.push(
            Diagnostic::error(codes::E0401, span, format!("{what} is {wanted}"))
                .label(format!("this is {}", found.kind())),
        );
        Value::Poison
    }

    /// Ends of a range known while the file is read.
    pub(super) fn range(
        &mut self,
        from: &'a AstExpr,
        to: &'a AstExpr,
        inclusive: bool,
    ) -> Option<RangeInclusive<i64>> {
        let (a, b) =
            (self.whole(from, "the start of a range"), self.whole(to, "the end of a range"));
        let (a, b) = (a?, b?);
        Some(a..=if inclusive { b } else { b - 1 })
    }

    pub(super) fn bind_index(&mut self, variable: &'a Name, i: i64) {
        let id = self.arena.number(ratio(i, 1), variable.span);
        let dimension = (i != 0).then_some(Dimension::NONE);
        self.bind(
            (variable.text.clone(), None),
            Value::Scalar(Scalar { id, dimension }),
            variable.span,
        );
    }

    pub(super) fn repeat(&mut self, repeat: &'a Loop<Vec<Statement>>) {
        let Some(range) = self.range(&repeat.from, &repeat.to, repeat.inclusive) else { return };
        let outer = self.scope;
        for i in range {
            if self.is_stopped() || !self.expand(repeat.variable.span) {
                break;
            }
            let prefix = self.scopes[outer].prefix.clone();
            self.scope = self.enter(Level::Repetition, outer, prefix);
            self.bind_index(&repeat.variable, i);
            self.statements(&repeat.body);
            self.scope = outer;
        }
    }

    pub(super) fn require(&mut self, requirement: &'a Requirement, span: Span) {
        let requirement = match requirement {
            Requirement::ShapeAccelerated => Some(model::Requirement::ShapeAccelerated),
            Requirement::Mirror(a, b) => self.mirror(a, b),
            Requirement::Compare(a, comparison, b) => self.compare(a, *comparison, b, span),
        };
        if let Some(requirement) = requirement {
            self.requirements.push(Required { requirement, span });
        }
    }

    fn compare(
        &mut self,
        a: &'a AstExpr,
        comparison: Comparison,
        b: &'a AstExpr,
        span: Span,
    ) -> Option<model::Requirement> {
        let left = self.scalar(a, "a side of a comparison");
        let right = self.scalar(b, "a side of a comparison");
        let (left, right) = (left?, right?);
        if let (Some(x), Some(y)) = (left.dimension, right.dimension)
            && x != y
        {
            self.sink.push(
                Diagnostic::error(codes::E0309, b.span, "unlike quantities cannot be compared")
                    .label(y.describe())
                    .also(a.span, x.describe()),
            );
            return None;
        }
        for (scalar, expr) in [(left, a), (right, b)] {
            if !self.arena.depends(scalar.id).is_constant() {
                self.sink.push(
                    Diagnostic::error(
                        codes::E0507,
                        expr.span,
                        "`require` compares constants of the robot",
                    )
                    .label("this changes while the robot moves")
                    .help("limits of a coordinate are declared with `in a..b`"),
                );
                return None;
            }
        }
        let (x, y) = (self.number(left.id)?, self.number(right.id)?);
        let (holds, sign) = match comparison {
            Comparison::Less => (x < y, "<"),
            Comparison::LessOrEqual => (x <= y, "<="),
            Comparison::Greater => (x > y, ">"),
            Comparison::GreaterOrEqual => (x >= y, ">="),
        };
        if !holds {
            self.sink.push(
                Diagnostic::error(
                    codes::E0513,
                    span,
                    "the model's own values break this requirement",
                )
                .label(format!("{x} {sign} {y} does not hold (in SI units)"))
                .help("correct a parameter, or the requirement"),
            );
            return None;
        }
        Some(model::Requirement::Compare(left.id, comparison, right.id))
    }

    fn mirror(&mut self, a: &'a AstExpr, b: &'a AstExpr) -> Option<model::Requirement> {
        let (left, right) = (self.instance_value(a), self.instance_value(b));
        let (left, right) = (left?, right?);
        if !std::ptr::eq(left.component, right.component) || left.scope == right.scope {
            self.sink.push(
                Diagnostic::error(
                    codes::E0511,
                    b.span,
                    "`mirror` exchanges two instances of one component",
                )
                .label(format!("made from `{}`", right.component.name.text))
                .also(a.span, format!("made from `{}`", left.component.name.text)),
            );
            return None;
        }
        let exchanged =
            self.own(&left).into_iter().zip(self.own(&right)).filter(|(x, y)| x != y).collect();
        Some(model::Requirement::Mirror {
            instances: (left.path.clone(), right.path.clone()),
            exchanged,
        })
    }

    fn instance_value(&mut self, expr: &'a AstExpr) -> Option<Rc<Instance<'a>>> {
        match self.eval(expr) {
            Value::Instance(instance) => Some(instance),
            Value::Poison => None,
            other => {
                self.sink.push(
                    Diagnostic::error(
                        codes::E0511,
                        expr.span,
                        "`mirror` exchanges two instances of one component",
                    )
                    .label(format!("this is {}", other.kind())),
                );
                None
            }
        }
    }

    /// Coordinates passed to an instance, in the order of the arguments, then those it declares.
    fn own(&self, instance: &Instance<'a>) -> Vec<CoordinateId> {
        let names = &self.scopes[instance.scope].names;
        let mut list: Vec<CoordinateId> = Vec::new();
        for argument in &instance.component.arguments {
            let binding = names.get(&(argument.name.text.clone(), None));
            list.extend(binding.and_then(|b| b.value.coordinates(&self.arena)).unwrap_or_default());
        }
        let prefix = format!("{}.", instance.path);
        let declared =
            self.drafts.iter().enumerate().filter(|(_, d)| d.coordinate.path.starts_with(&prefix));
        list.extend(declared.filter_map(|(i, _)| u32::try_from(i).ok().map(CoordinateId)));
        list
    }
}

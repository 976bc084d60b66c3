//! The whole: what a model must have, and coordinates in their order.

use super::Resolver;
use crate::ast;
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::model::{CoordinateId, Expr, Model, Requirement, Role};

impl<'a> Resolver<'a> {
    /// Checks the whole and puts it together.
    pub(super) fn finish(mut self, robot: &ast::Robot, source_name: &str, text: &str) -> Model {
        self.is_stopped();
        self.name_is_type(robot);
        self.whole_model(robot);
        self.unused_parameters();
        let order = self.order();
        self.renumber(&order);
        let mut drafts: Vec<_> = std::mem::take(&mut self.drafts).into_iter().map(Some).collect();
        let coordinates: Vec<_> = order
            .iter()
            .filter_map(|i| drafts.get_mut(*i).and_then(Option::take))
            .map(|d| d.coordinate)
            .collect();
        let docs = [&robot.docs]
            .iter()
            .filter(|d| !d.is_empty())
            .map(|d| d.as_str())
            .collect::<Vec<_>>()
            .join("\n");
        Model {
            name: robot.name.text.clone(),
            docs,
            source_name: source_name.to_owned(),
            source: text.to_owned(),
            parameters: self.parameters,
            coordinates,
            sets: self.sets,
            expressions: self.arena.expressions,
            vectors: self.arena.vectors,
            frames: self.frames,
            bodies: self.bodies,
            kinetic: self.kinetic,
            potential: self.potential,
            lagrangian: self.lagrangian,
            gravity: self.gravity,
            actuators: self.actuators,
            dissipation: self.dissipation,
            friction: self.friction,
            output: self.output,
            points: self.points,
            geometry: self.geometry,
            requirements: self.requirements,
        }
    }

    /// The robot's name becomes a Rust type.
    fn name_is_type(&mut self, robot: &ast::Robot) {
        let name = &robot.name.text;
        if name.starts_with(|c: char| c.is_ascii_uppercase()) && name != "Self" {
            return;
        }
        let camel: String = name
            .split('_')
            .map(|part| {
                let mut chars = part.chars();
                chars
                    .next()
                    .map_or(String::new(), |c| c.to_ascii_uppercase().to_string() + chars.as_str())
            })
            .collect();
        let mut diagnostic = Diagnostic::error(
            codes::E0205,
            robot.name.span,
            "a robot's name begins with a capital letter",
        )
        .label("this becomes the name of a Rust type");
        if camel.starts_with(|c: char| c.is_ascii_uppercase()) && camel != "Self" {
            diagnostic = diagnostic.help(format!("write `{camel}`"));
        }
        self.sink.push(diagnostic);
    }

    /// Missing parts; silent if something was refused, since it may be the missing part.
    fn whole_model(&mut self, robot: &ast::Robot) {
        if self.coordinates_broken || self.stopped {
            return;
        }
        self.output_count();
        if self.sink.has_errors() {
            return;
        }
        if self.drafts.is_empty() {
            self.sink.push(
                Diagnostic::error(codes::E0502, robot.span, "the robot has no coordinates")
                    .label("nothing here can move")
                    .help("declare them: `position x: m;` and `shape phi: rad;`"),
            );
            return;
        }
        if self.kinetic.is_empty() && self.lagrangian.is_empty() && self.bodies.is_empty() {
            self.sink.push(
                Diagnostic::error(codes::E0501, robot.span, "the robot has no kinetic energy")
                    .label("no `kinetic`, no `rigid`, no `lagrangian`")
                    .note("the mass matrix is the second derivative of the kinetic energy by the rates")
                    .help("add `rigid` bodies, or write the energy: `kinetic 1/2*m*d/dt(x)^2;`"),
            );
        }
    }

    fn output_count(&mut self) {
        let wanted = self.drafts.iter().filter(|d| d.coordinate.role == Role::Position).count();
        let Some(output) = self.output.as_ref().filter(|o| o.entries.len() != wanted) else {
            return;
        };
        let diagnostic = Diagnostic::error(
            codes::E0503,
            output.span,
            "the output has one entry per position coordinate",
        )
        .label(format!("{} entries for {wanted} position coordinates", output.entries.len()))
        .note(
            "the Jacobian of the output by the position coordinates is inverted: it must be square",
        )
        .help("declare the task in as many coordinates as the robot has positions");
        self.sink.push(diagnostic);
    }

    fn unused_parameters(&mut self) {
        if self.sink.has_errors() {
            return;
        }
        let used = |p: &crate::model::Parameter, i: u32, r: &Self| {
            let family = p.path.split('.').next().unwrap_or("");
            let siblings = r
                .parameters
                .iter()
                .zip(0_u32..)
                .filter(|(q, _)| q.path.split('.').next() == Some(family));
            r.used_parameters.contains(&i)
                || siblings.into_iter().any(|(_, j)| r.used_parameters.contains(&j))
        };
        let unused: Vec<_> = self
            .parameters
            .iter()
            .zip(0_u32..)
            .filter(|(p, i)| !used(p, *i, self))
            .map(|(p, _)| (p.span, p.path.clone()))
            .collect();
        for (span, path) in unused {
            self.sink.push(
                Diagnostic::warning(
                    codes::W0501,
                    span,
                    format!("the parameter `{path}` is never used"),
                )
                .label("no energy, motor or solid depends on it")
                .help("remove it, or use it"),
            );
        }
    }

    /// Draft numbers in final order: positions, then shapes.
    fn order(&self) -> Vec<usize> {
        let of = |role| {
            self.drafts
                .iter()
                .enumerate()
                .filter(move |(_, d)| d.coordinate.role == role)
                .map(|(i, _)| i)
        };
        of(Role::Position).chain(of(Role::Shape)).collect()
    }

    /// Applies the final order wherever a coordinate is mentioned.
    fn renumber(&mut self, order: &[usize]) {
        let mut place = vec![0_u32; order.len()];
        for (new, old) in (0_u32..).zip(order) {
            place[*old] = new;
        }
        let moved =
            |id: CoordinateId| CoordinateId(place.get(id.0 as usize).copied().unwrap_or(id.0));
        for (expr, _) in &mut self.arena.expressions {
            if let Expr::Coordinate(id) = expr {
                *id = moved(*id);
            }
        }
        for required in &mut self.requirements {
            if let Requirement::Mirror { exchanged, .. } = &mut required.requirement {
                exchanged.iter_mut().for_each(|(a, b)| (*a, *b) = (moved(*a), moved(*b)));
            }
        }
        let mut rank: Vec<usize> = (0..self.sets.len()).collect();
        rank.sort_by_key(|s| (self.sets[*s].role == Role::Shape, *s));
        let mut new_set = vec![0; rank.len()];
        rank.iter().enumerate().for_each(|(new, old)| new_set[*old] = new);
        for (i, draft) in self.drafts.iter_mut().enumerate() {
            self.sets[draft.set]
                .coordinates
                .push(moved(CoordinateId(u32::try_from(i).unwrap_or(u32::MAX))));
            draft.coordinate.set = new_set[draft.set];
        }
        let mut sets: Vec<_> = std::mem::take(&mut self.sets).into_iter().map(Some).collect();
        self.sets = rank.iter().filter_map(|s| sets[*s].take()).collect();
    }
}

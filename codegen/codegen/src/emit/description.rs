//! The robot's description and the page of its module.

use super::constants;
use super::docs;
use super::names::{SymbolNames, identifier};
use super::parameters::{shown_range, signed_number, unit};
use super::{Documentation, Emission};
use crate::derive::{Function, Quantity};
use proc_macro2::{Literal, TokenStream};
use quote::quote;
use shapebot_model_dsl::model::{Model, Range, Role, Solid};
use std::collections::BTreeMap;
use syn::{Expr, Item};

/// `const DESCRIPTION`.
pub(super) fn description(emission: &Emission<'_>, symbols: &SymbolNames) -> Item {
    let model = emission.model;
    let name = emission.stem;
    let summary = docs::one_line(model.docs.lines().next().unwrap_or(""));
    let position_count = Literal::usize_unsuffixed(model.position_count());
    let coordinates = coordinates(model, symbols, &actuated(model, emission.functions));
    let sets = shape_sets(model, &actuated(model, emission.functions));
    let (actuators, parameters) = (actuators(model), parameters(model, symbols));
    let (outputs, output_unit) = output(model, symbols);
    let frames = model.frames.iter().map(|frame| frame.name.as_str());
    let points: Vec<String> =
        crate::derive::points(model).into_iter().map(|(name, _)| name).collect();
    let (geometry, friction) = (geometry(model, points.len()), friction(model));
    syn::parse_quote! {
        /// Names, units, ranges, actuators, shape sets, points and geometry.
        pub const DESCRIPTION: ::shapebot_dynamics::Description = ::shapebot_dynamics::Description {
            name: #name,
            summary: #summary,
            coordinates: &[#(#coordinates),*],
            position_count: #position_count,
            shape_sets: &[#(#sets),*],
            actuators: &[#(#actuators),*],
            parameters: &[#(#parameters),*],
            outputs: &[#(#outputs),*],
            output_unit: #output_unit,
            frames: &[#(#frames),*],
            points: &[#(#points),*],
            geometry: &[#(#geometry),*],
            friction: &[#(#friction),*],
        };
    }
}

/// Which coordinates an actuator works on: the rows of B that are not zero.
pub(super) fn actuated(model: &Model, functions: &BTreeMap<Quantity, Function>) -> Vec<bool> {
    let mut list = vec![false; model.coordinates.len()];
    let columns =
        (0..model.actuators.len()).filter_map(|k| functions.get(&Quantity::InputColumn(k)));
    for function in columns {
        for (flag, id) in list.iter_mut().zip(function.results()) {
            *flag |= !function.graph.is_zero(id);
        }
    }
    list
}

fn bound(value: Option<f64>, absent: &TokenStream) -> TokenStream {
    match value {
        Some(value) if value.is_finite() => {
            let value = signed_number(value);
            quote!(#value)
        }
        _ => absent.clone(),
    }
}

fn bounds(range: Option<Range>) -> [TokenStream; 2] {
    [
        bound(range.map(|r| r.lower), &quote!(f64::NEG_INFINITY)),
        bound(range.map(|r| r.upper), &quote!(f64::INFINITY)),
    ]
}

fn coordinates(model: &Model, symbols: &SymbolNames, actuated: &[bool]) -> Vec<TokenStream> {
    let entry = |(i, coordinate): (usize, &shapebot_model_dsl::model::Coordinate)| {
        let (name, unit) = (&symbols.coordinates[i], &coordinate.unit.text);
        let role = match coordinate.role {
            Role::Position => quote!(Position),
            Role::Shape => quote!(Shape),
        };
        let [lower, upper] = bounds(coordinate.range);
        let actuated = actuated[i];
        quote!(::shapebot_dynamics::Coordinate {
            name: #name, unit: #unit, role: ::shapebot_dynamics::Role::#role, actuated: #actuated,
            lower: #lower, upper: #upper
        })
    };
    model.coordinates.iter().enumerate().map(entry).collect()
}

fn shape_sets(model: &Model, actuated: &[bool]) -> Vec<TokenStream> {
    let positions = model.position_count();
    let shape = model.sets.iter().filter(|set| set.role == Role::Shape);
    let entry = |set: &shapebot_model_dsl::model::CoordinateSet| {
        let members: Vec<usize> = set.coordinates.iter().map(|id| id.0 as usize).collect();
        let first = members.first().map_or(0, |&i| i.saturating_sub(positions));
        let name = identifier(&set.name);
        let [first, len] = [first, members.len()].map(Literal::usize_unsuffixed);
        let all = members.iter().all(|&i| actuated.get(i).copied().unwrap_or(false));
        quote!(::shapebot_dynamics::ShapeSet { name: #name, first: #first, len: #len, actuated: #all })
    };
    shape.map(entry).collect()
}

fn actuators(model: &Model) -> Vec<TokenStream> {
    let entry = |actuator: &shapebot_model_dsl::model::Actuator| {
        let (name, unit) = (identifier(&actuator.name), &actuator.unit.text);
        let limit =
            bound(actuator.limit.map(|id| constants::value(model, id)), &quote!(f64::INFINITY));
        quote!(::shapebot_dynamics::Actuator { name: #name, unit: #unit, limit: #limit })
    };
    model.actuators.iter().map(entry).collect()
}

fn parameters(model: &Model, symbols: &SymbolNames) -> Vec<TokenStream> {
    let entry = |(i, parameter): (usize, &shapebot_model_dsl::model::Parameter)| {
        let (name, unit) = (&symbols.fields[i], &parameter.unit.text);
        let value = signed_number(parameter.value_f64);
        let [lower, upper] = bounds(parameter.range);
        let text = docs::one_line(&parameter.docs);
        quote!(::shapebot_dynamics::Parameter {
            name: #name, unit: #unit, value: #value, lower: #lower, upper: #upper, docs: #text
        })
    };
    model.parameters.iter().enumerate().map(entry).collect()
}

fn output(model: &Model, symbols: &SymbolNames) -> (Vec<String>, String) {
    match &model.output {
        Some(output) => (output.names.clone(), output.unit.text.clone()),
        None => {
            let positions = model.coordinates.iter().filter(|c| c.role == Role::Position);
            let unit = positions.clone().next().map_or("1", |c| c.unit.text.as_str());
            (symbols.coordinates.iter().take(positions.count()).cloned().collect(), unit.to_owned())
        }
    }
}

/// Centres of geometry are the last points.
fn geometry(model: &Model, points: usize) -> Vec<TokenStream> {
    let first = points.saturating_sub(model.geometry.len());
    let number = |id| signed_number(constants::value(model, id));
    let entry = |(i, geometry): (usize, &shapebot_model_dsl::model::Geometry)| {
        let name = &geometry.name;
        let [frame, center] = [geometry.frame.0 as usize, first + i].map(Literal::usize_unsuffixed);
        let solid = match &geometry.solid {
            &Solid::Sphere(radius) => {
                let radius = number(radius);
                quote!(Sphere(#radius))
            }
            Solid::Box(edges) => {
                let edges: [Expr; 3] = edges.map(number);
                quote!(Box([#(#edges),*]))
            }
            &Solid::Capsule(radius, length) => {
                let (radius, length) = (number(radius), number(length));
                quote!(Capsule(#radius, #length))
            }
            &Solid::Cylinder(radius, length) => {
                let (radius, length) = (number(radius), number(length));
                quote!(Cylinder(#radius, #length))
            }
        };
        quote!(::shapebot_dynamics::Geometry {
            name: #name, solid: ::shapebot_dynamics::Solid::#solid, frame: #frame, center: #center
        })
    };
    model.geometry.iter().enumerate().map(entry).collect()
}

fn friction(model: &Model) -> Vec<TokenStream> {
    let entry = |friction: &shapebot_model_dsl::model::CoulombFriction| {
        let level = signed_number(constants::value(model, friction.level));
        let weights =
            constants::slopes(model, friction.displacement).into_iter().map(signed_number);
        quote!(::shapebot_dynamics::CoulombFriction { level: #level, weights: &[#(#weights),*] })
    };
    model.friction.iter().map(entry).collect()
}

type Row = BTreeMap<&'static str, String>;

/// The documentation of the module.
pub(super) fn page(emission: &Emission<'_>, symbols: &SymbolNames) -> String {
    let Emission { model, functions, baked, documentation, .. } = *emission;
    let Documentation { equations, certificate } = documentation;
    let positions = model.position_count();
    let actuated = actuated(model, functions);
    let mut context = tera::Context::new();
    let docs_text = docs::paragraph(&model.docs);
    context.insert("docs", if docs_text.is_empty() { emission.stem } else { docs_text.as_str() });
    context.insert("position_count", &positions);
    context.insert("shape_count", &(model.coordinates.len() - positions));
    context.insert("coordinates", &coordinate_rows(model, symbols, &actuated));
    context.insert("parameters", &parameter_rows(model, symbols));
    context.insert("actuators", &actuator_rows(model));
    let (outputs, output_unit) = output(model, symbols);
    let names: Vec<String> = outputs.iter().map(|name| format!("`{name}`")).collect();
    context.insert("output", &format!("{}, {}.", names.join(", "), unit(&output_unit)));
    context.insert("equations", &docs::fenced(equations));
    context.insert("certificate", &docs::fenced(certificate));
    context.insert("baked", &baked.is_some());
    context.insert("functions", &function_rows(functions, baked));
    super::render("module.md", include_str!("../../templates/module.md.tera"), &context)
}

fn range_cell(range: Option<Range>, unit: &str) -> String {
    range.map_or_else(|| "—".to_owned(), |range| shown_range(range, unit))
}

fn coordinate_rows(model: &Model, symbols: &SymbolNames, actuated: &[bool]) -> Vec<Row> {
    let row = |(i, c): (usize, &shapebot_model_dsl::model::Coordinate)| {
        let role = if c.role == Role::Position { "position" } else { "shape" };
        let actuated = if actuated[i] { "yes" } else { "no" };
        Row::from([
            ("name", symbols.coordinates[i].clone()),
            ("role", role.to_owned()),
            ("unit", unit(&c.unit.text)),
            ("range", range_cell(c.range, &c.unit.text)),
            ("actuated", actuated.to_owned()),
        ])
    };
    model.coordinates.iter().enumerate().map(row).collect()
}

fn parameter_rows(model: &Model, symbols: &SymbolNames) -> Vec<Row> {
    let row = |(i, p): (usize, &shapebot_model_dsl::model::Parameter)| {
        Row::from([
            ("name", symbols.fields[i].clone()),
            ("unit", unit(&p.unit.text)),
            ("value", format!("{}", p.value_f64)),
            ("range", range_cell(p.range, &p.unit.text)),
            ("docs", docs::cell(&p.docs)),
        ])
    };
    model.parameters.iter().enumerate().map(row).collect()
}

fn actuator_rows(model: &Model) -> Vec<Row> {
    let row = |a: &shapebot_model_dsl::model::Actuator| {
        let limit =
            a.limit.map_or_else(|| "—".to_owned(), |id| format!("{}", constants::value(model, id)));
        Row::from([
            ("name", identifier(&a.name)),
            ("unit", unit(&a.unit.text)),
            ("limit", limit),
            ("docs", docs::cell(&a.docs)),
        ])
    };
    model.actuators.iter().map(row).collect()
}

fn function_rows(
    functions: &BTreeMap<Quantity, Function>,
    baked: Option<&BTreeMap<Quantity, Function>>,
) -> Vec<Row> {
    let listed = super::methods::LAGRANGIAN.iter().chain(super::methods::SHAPE);
    let row = |method: &super::methods::Method| {
        let function = functions.get(&method.quantity)?;
        let count = function.operations;
        let other = baked.and_then(|baked| baked.get(&method.quantity)).map(|f| f.operations);
        let other = other.map_or(String::new(), |o| {
            format!("{} | {} | {} | ", o.additions, o.multiplications, o.divisions)
        });
        Some(Row::from([
            ("name", method.name.to_owned()),
            ("method", docs::cell(function.method)),
            ("additions", count.additions.to_string()),
            ("multiplications", count.multiplications.to_string()),
            ("divisions", count.divisions.to_string()),
            ("angles", count.angles.to_string()),
            ("functions", count.functions.to_string()),
            ("baked", other),
        ]))
    };
    listed.filter_map(row).collect()
}

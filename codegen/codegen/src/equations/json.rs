//! Equations and certificate as JSON.

use super::Subject;
use super::layout::Term;
use super::render::{Notation, Printer};
use super::sheet::{Factored, Sheet};
use crate::proof::{Certificate, Class, Linearisation, RangeClaim, Root, ShapeMap};
use std::fmt::Write as _;

/// A JSON value, as text.
type Json = String;

pub(super) fn print(subject: Subject<'_>) -> String {
    let Subject { model, equations, certificate } = subject;
    let mut sheet = Sheet::new(model, equations, certificate);
    let printers = [Notation::Text, Notation::Latex]
        .map(|notation| Printer::new(model, &mut sheet.forms, notation));
    let [text, latex] = printers.map(|printer| formulas(&printer, &sheet));
    let parameters = model.parameters.iter().map(|p| {
        object(&[
            ("name", string(&p.name)),
            ("path", string(&p.path)),
            ("unit", string(&p.unit.text)),
            ("value", number(p.value_f64)),
        ])
    });
    let coordinates = model.coordinates.iter().map(|c| {
        object(&[
            ("name", string(&c.name)),
            ("path", string(&c.path)),
            ("unit", string(&c.unit.text)),
        ])
    });
    let mut out = object(&[
        ("robot", string(&model.name)),
        ("coordinates", array(coordinates)),
        ("parameters", array(parameters)),
        ("certificate", certificate_json(certificate)),
        ("equations", text),
        ("latex", latex),
    ]);
    out.push('\n');
    out
}

fn formulas(printer: &Printer, sheet: &Sheet) -> Json {
    let term = |t: &Term| string(&printer.term(t));
    let vector = |terms: &[Term]| array(terms.iter().map(term));
    let matrix = |rows: &[Vec<Term>]| array(rows.iter().map(|row| vector(row)));
    let factored = |gain: &Option<Factored>| match gain {
        Some(gain) => object(&[("factor", term(&gain.factor)), ("matrix", matrix(&gain.rows))]),
        None => "null".to_owned(),
    };
    let shared =
        sheet.shared.iter().enumerate().map(|(k, value)| {
            object(&[("name", string(&printer.shared(k))), ("value", term(value))])
        });
    object(&[
        ("kinetic_energy", sheet.kinetic.as_ref().map_or("null".to_owned(), term)),
        ("potential_energy", term(&sheet.potential)),
        ("mass_matrix", matrix(&sheet.mass)),
        ("coriolis_vector", vector(&sheet.bias)),
        ("gravity", vector(&sheet.gravity)),
        ("input_matrix", matrix(&sheet.input)),
        ("gamma_prime", vector(&sheet.static_map)),
        ("shape_gain", factored(&sheet.gain)),
        ("inverse_shape_gain", factored(&sheet.inverse_gain)),
        ("shared", array(shared)),
    ])
}

fn certificate_json(certificate: &Certificate) -> Json {
    let name = |i: usize| string(&certificate.coordinates[i]);
    let reasons = match &certificate.class {
        Class::ShapeAccelerated => Vec::new(),
        Class::NotShapeAccelerated { reasons } => reasons.clone(),
    };
    let reasons = reasons.iter().map(|r| {
        object(&[
            ("code", string(r.code.as_str())),
            ("condition", string(&r.condition.to_string())),
            ("text", string(&r.text)),
            ("line", r.line.to_string()),
            ("help", r.help.as_ref().map_or("null".to_owned(), |h| string(h))),
        ])
    });
    let conditions = certificate.conditions.iter().map(|c| {
        object(&[
            ("letter", string(&c.letter.to_string())),
            ("statement", string(&c.statement)),
            ("evidence", string(c.evidence.as_str())),
        ])
    });
    let actuated = certificate
        .actuated
        .iter()
        .map(|(i, actuator)| object(&[("coordinate", name(*i)), ("actuator", string(actuator))]));
    let positions = certificate.positions.iter().map(|p| {
        object(&[
            ("coordinate", string(&p.coordinate)),
            ("actuated", p.actuated.to_string()),
            ("cyclic", p.cyclic.to_string()),
            ("momentum_observer", p.momentum_observer.to_string()),
        ])
    });
    let rows = certificate.integrability.rows.iter().map(|r| {
        object(&[
            ("coordinate", string(&r.coordinate)),
            ("gravity_constant", r.gravity_constant.to_string()),
            ("inertia_free", r.inertia_free.to_string()),
            ("partially_integrable", r.partially_integrable().to_string()),
        ])
    });
    object(&[
        ("verdict", string(&certificate.verdict())),
        ("shape_accelerated", certificate.is_shape_accelerated().to_string()),
        ("strict_class", certificate.strict.holds.to_string()),
        ("departures", array(certificate.strict.departures.iter().map(|d| string(d)))),
        ("reasons", array(reasons)),
        ("n", certificate.len().to_string()),
        ("n_x", certificate.position_count.to_string()),
        ("n_s", certificate.shape_count().to_string()),
        ("k", certificate.shape_sets().map_or("null".to_owned(), |k| k.to_string())),
        ("actuated", array(actuated)),
        ("unactuated", array(certificate.unactuated.iter().map(|&i| name(i)))),
        ("conditions", array(conditions)),
        ("positions", array(positions)),
        ("shape_map", certificate.shape_map.as_ref().map_or("null".to_owned(), map_json)),
        ("integrability", array(rows)),
        (
            "linearisation",
            certificate.linearisation.as_ref().map_or("null".to_owned(), linear_json),
        ),
        (
            "warnings",
            array(certificate.warnings.iter().map(|w| string(&format!("{}: {}", w.code, w.title)))),
        ),
    ])
}

fn map_json(map: &ShapeMap) -> Json {
    let claim = |claim: &RangeClaim| {
        let kind = match claim {
            RangeClaim::Proved { .. } => "proved",
            RangeClaim::SampledOnly { .. } => "sampled only",
            RangeClaim::Undecided { .. } => "undecided",
            RangeClaim::Fails { .. } => "fails",
            RangeClaim::NoRange { .. } => "no range",
            RangeClaim::NothingVaries => "nothing varies",
        };
        object(&[("kind", string(kind)), ("text", string(&claim.describe()))])
    };
    let sets = map
        .sets
        .iter()
        .map(|s| object(&[("name", string(&s.name)), ("nonsingular", s.nonsingular.to_string())]));
    object(&[
        ("determinant", number(map.determinant)),
        ("over_coordinates", claim(&map.over_coordinates)),
        ("over_parameters", claim(&map.over_parameters)),
        ("gain", numbers(&map.gain)),
        ("sets", array(sets)),
        ("invertible", map.invertible.to_string()),
    ])
}

fn linear_json(linear: &Linearisation) -> Json {
    let roots = |list: &[Root]| {
        array(list.iter().map(|r| object(&[("re", number(r.re)), ("im", number(r.im))])))
    };
    object(&[
        ("poles", roots(&linear.poles)),
        ("locked_poles", roots(&linear.locked_poles)),
        ("through", array(linear.through.iter().map(|n| string(n)))),
        ("time_constants", numbers(&linear.time_constants)),
        ("zeros", roots(&linear.zeros)),
        ("output_time_constants", numbers(&linear.output_time_constants)),
        ("output_zeros", roots(&linear.output_zeros)),
    ])
}

fn numbers(rows: &[Vec<f64>]) -> Json {
    array(rows.iter().map(|row| array(row.iter().map(|&v| number(v)))))
}

fn object(members: &[(&str, Json)]) -> Json {
    let member = |(name, value): &(&str, Json)| format!("{}: {value}", string(name));
    format!("{{{}}}", members.iter().map(member).collect::<Vec<_>>().join(", "))
}

fn array(values: impl IntoIterator<Item = Json>) -> Json {
    format!("[{}]", values.into_iter().collect::<Vec<_>>().join(", "))
}

/// The shortest digits that give the same double; what is no number is null.
fn number(value: f64) -> Json {
    if value.is_finite() { format!("{value:?}") } else { "null".to_owned() }
}

fn string(text: &str) -> Json {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            c if c < ' ' => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

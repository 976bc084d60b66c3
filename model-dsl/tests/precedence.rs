//! Operators, literals and units against values computed by hand.
#![allow(missing_docs)]

use shapebot_model_dsl::model::{Expr, Model};
use shapebot_model_dsl::{parse, render};

fn model_with(unit: &str, value: &str) -> Model {
    let text = format!(
        "robot Cart {{\n    params {{ v: {unit} = {value}; }}\n    position x: m;\n    kinetic 1*J*v/v*d/dt(x)^2/(1*m/s)^2;\n}}"
    );
    let parsed = parse("value.robot", &text);
    parsed
        .model
        .unwrap_or_else(|| panic!("{}", render(&parsed.diagnostics, "value.robot", &text, false)))
}

fn value(text: &str) -> f64 {
    model_with("1", text).parameters[0].value_f64
}

#[test]
fn operators_group_as_on_paper() {
    let table: &[(&str, f64)] = &[
        ("1 + 2*3", 7.0),
        ("(1 + 2)*3", 9.0),
        ("2 - 3 - 4", -5.0),
        ("16/4/2", 2.0),
        ("1/2*8", 4.0),
        ("1/(2*8)", 0.0625),
        ("2*3^2", 18.0),
        ("-3^2", -9.0),
        ("(-3)^2", 9.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("2^-1*4", 2.0),
        ("-2*-3", 6.0),
        ("--2", 2.0),
        ("+2 - +1", 1.0),
        ("1 - 2*3 + 4", -1.0),
        ("8^(1/3)*1", 2.0),
        ("4/2^2", 1.0),
        ("sqrt(16)^2", 16.0),
        ("|[3, 4]|", 5.0),
        ("|[3, 4]|^2", 25.0),
        ("2*|[3, 4]| + 1", 11.0),
        ("dot([1, 2, 3], [4, 5, 6])", 32.0),
        ("sum(i in 1..=4, i^2)", 30.0),
        ("sum(i in 1..4, i)", 6.0),
        ("[1, 2, 3].y", 2.0),
        ("(2*[1, 2, 3] - [0, 1, 0]).y", 3.0),
        ("cos(0)", 1.0),
        ("ln(exp(2))", 2.0),
    ];
    for (text, expected) in table {
        assert!(
            (value(text) - expected).abs() < 1e-12,
            "{text} = {} and not {expected}",
            value(text)
        );
    }
}

#[test]
fn fractions_are_exact() {
    let model = model_with("1", "1/3 + 1/3 + 1/3 - 0.1*10");
    let Expr::Number(number) = model.expr(model.parameters[0].value) else { panic!("not folded") };
    assert_eq!(number.to_string(), "0");
    let model = model_with("m", "0.1058");
    assert!(
        matches!(model.expr(model.parameters[0].value), Expr::Number(n) if n.to_string() == "529/5000")
    );
}

#[test]
fn units_convert_exactly() {
    assert_eq!(model_with("mm", "12.5").parameters[0].value_f64, 0.0125);
    assert_eq!(model_with("m", "12.5mm").parameters[0].value_f64, 0.0125);
    assert_eq!(model_with("m", "12.5*mm").parameters[0].value_f64, 0.0125);
    assert_eq!(model_with("N*m", "12*N*m").parameters[0].value_f64, 12.0);
    assert_eq!(model_with("kg*m^2/s^2", "3*J").parameters[0].value_f64, 3.0);
    assert_eq!(model_with("rad", "180deg").parameters[0].value_f64, std::f64::consts::PI);
    assert_eq!(model_with("rad", "-90deg").parameters[0].value_f64, -std::f64::consts::FRAC_PI_2);
    assert_eq!(model_with("m^(1/2)", "2").parameters[0].unit.text, "m^(1/2)");
}

#[test]
fn decimal_literals_round_to_the_nearest_double() {
    for text in ["0.1058", "0.18415", "9.81", "70.3", "0.0010", "6.02214076e23", "1e-7"] {
        assert_eq!(value(text).to_bits(), text.parse::<f64>().unwrap().to_bits(), "{text}");
    }
}

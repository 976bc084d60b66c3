//! What the statements of the language mean.
#![allow(missing_docs)]

use shapebot_model_dsl::model::{Axis, Dimension, Expr, FrameId, Model, Role, Solid};
use shapebot_model_dsl::{parse, render};

fn model(text: &str) -> Model {
    let parsed = parse("test.robot", text);
    let messages = render(&parsed.diagnostics, "test.robot", text, false);
    parsed.model.unwrap_or_else(|| panic!("{messages}"))
}

fn codes(text: &str) -> Vec<&'static str> {
    parse("test.robot", text).diagnostics.iter().map(|d| d.code.as_str()).collect()
}

fn cart(statements: &str) -> String {
    format!(
        "robot Cart {{\n    params {{ m: kg = 1; l: m = 2; }}\n    position x: m;\n    shape phi: rad;\n    kinetic 1/2*m*d/dt(x)^2;\n    potential 0*l*m*(1*m/s^2);\n    {statements}\n}}"
    )
}

#[test]
fn every_statement_once() {
    let model = model(include_str!("inputs/everything.robot"));
    assert_eq!(model.docs, "Every statement of the language, once.\nAnd the robot's own line.");
    let names: Vec<&str> = model.coordinates.iter().map(|c| c.name.as_str()).collect();
    let expected = [
        "theta_x",
        "theta_y",
        "z",
        "phi_1",
        "phi_2",
        "phi_3",
        "psi_1_a",
        "psi_1_b",
        "psi_2_a",
        "psi_2_b",
        "psi_3_a",
        "psi_3_b",
        "left_beta",
        "right_beta",
    ];
    assert_eq!(names, expected);
    let paths: Vec<&str> = model.coordinates.iter().map(|c| c.path.as_str()).collect();
    assert_eq!(paths[3..8], ["phi[1]", "phi[2]", "phi[3]", "psi[1].a", "psi[1].b"]);
    assert_eq!(paths[12], "left.beta");
    let sets: Vec<&str> = model.sets.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(sets, ["theta", "z", "phi", "psi_1", "psi_2", "psi_3", "left_beta", "right_beta"]);
    let bodies: Vec<&str> = model.bodies.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(bodies, ["rod[1]", "rod[2]", "rod[3]", "top", "left.weight", "right.weight"]);
    let actuators: Vec<&str> = model.actuators.iter().map(|a| a.name.as_str()).collect();
    assert_eq!(
        actuators,
        ["tau_1", "tau_2", "tau_3", "left_drive", "right_drive", "tau_ball_x", "tau_ball_y"]
    );
    let parameters: Vec<&str> = model.parameters.iter().map(|p| p.path.as_str()).collect();
    assert!(
        parameters.contains(&"I.zz")
            && parameters.contains(&"J_full.yz")
            && parameters.contains(&"offset.y")
    );
    assert!(parameters.contains(&"mu"), "a Greek name is spelled out");
    assert_eq!(
        model.output.as_ref().map(|o| o.names.clone()),
        Some(vec!["x".into(), "y".into(), "z".into()])
    );
    assert_eq!(model.gravity.as_ref().map(|g| (g.axis, g.sign)), Some((Axis::Z, -1)));
    assert_eq!(model.friction.len(), 2);
    assert_eq!(model.geometry.len(), 5);
}

#[test]
fn positions_come_first_whatever_the_order_of_the_file() {
    let text = "robot Mixed { shape phi: rad; position x: m; kinetic d/dt(x + phi*(1*m))^2*(1*kg); output x: m; }";
    let model = model(text);
    assert_eq!(
        model.coordinates.iter().map(|c| c.role).collect::<Vec<_>>(),
        [Role::Position, Role::Shape]
    );
    let output = model.output.as_ref().map(|o| o.entries[0]).unwrap();
    let Expr::Coordinate(id) = model.expr(output) else { panic!("not a coordinate") };
    assert_eq!(model.coordinates[id.0 as usize].name, "x");
}

#[test]
fn a_let_is_one_shared_node() {
    let model = model(&cart("let a = sin(phi);\n    potential (a + a)*(1*J);"));
    assert!(matches!(model.expr(model.potential[1].expr), Expr::Add(a, b) if a == b));
}

#[test]
fn a_position_merges_terms_of_one_frame() {
    let text = cart(
        "frame pole = world * rot_y(phi);\n    point p = pole*[0, 0, l] + [x, 0, 0] + 2*(pole*[l, 0, l]) - [0, l, 0];",
    );
    let model = model(&text);
    let terms = &model.points[0].position.terms;
    assert_eq!(terms.iter().map(|t| t.frame).collect::<Vec<_>>(), [FrameId::WORLD, FrameId(1)]);
    assert!(matches!(model.expr(terms[0].entries[0]), Expr::Coordinate(_)));
    assert!(matches!(model.expr(terms[1].entries[2]), Expr::Add(..)));
}

#[test]
fn frames_keep_the_order_of_rotations() {
    let model = model(&cart(
        "frame body = world * rot_y(phi) * rot_x(2*phi);\n    frame same = body;\n    frame arm = same * rot_z(phi);",
    ));
    assert_eq!(
        model.frames.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(),
        ["world", "body", "arm"]
    );
    assert_eq!(
        model.frames[1].rotations.iter().map(|r| r.0).collect::<Vec<_>>(),
        [Axis::Y, Axis::X]
    );
    assert_eq!(model.frames[2].parent, Some(FrameId(1)));
}

#[test]
fn the_force_of_a_motor_has_the_unit_of_virtual_work() {
    let model = model(&cart("actuator f on d/dt(x) limit 3*N;\n    actuator tau on d/dt(phi - x/l) limit 12*N*m/m*l/l*(1*m);").replace("m/m*l/l*(1*m)", "(1*l)"));
    assert_eq!(model.actuators[0].unit.text, "N");
    assert_eq!(model.actuators[1].unit.text, "N*m");
    assert_eq!(model.actuators[1].unit.dimension, Dimension::ENERGY);
}

#[test]
fn members_of_instances_may_carry_an_index() {
    let text = cart(
        "component Chain(n: 1, root: point) {\n        let p[0] = root;\n        repeat i in 1..=n { point p_[i] = p[i-1] + [0, 0, l]; let p[i] = p_[i]; }\n    }\n    chain = Chain(3, [x, 0, 0]);\n    point end = chain.p[3];",
    );
    assert_eq!(model(&text).points.last().map(|p| p.name.clone()), Some("end".to_owned()));
    assert_eq!(codes(&text.replace("chain.p[3]", "chain.p[4]")), ["E0204"]);
}

#[test]
fn solids_are_placed() {
    let model = model(&cart(
        "shape box(l, l, 2*l) at [x, 0, 0];\n    shape box(l, l, l) at [x, 0, 0];\n    shape tip = sphere(l) at [x, 0, 0];",
    ));
    assert_eq!(
        model.geometry.iter().map(|g| g.name.as_str()).collect::<Vec<_>>(),
        ["box_1", "box_2", "tip"]
    );
    assert!(matches!(model.geometry[0].solid, Solid::Box(_)));
}

#[test]
fn degrees_ranges_and_suffixes() {
    let model = model(
        "robot R { position x: mm in -500..500; shape a, b: rad in 90deg..180deg; kinetic 1*kg*d/dt(x + a*b*2mm)^2; }",
    );
    let range = model.coordinates[0].range.unwrap();
    assert_eq!((range.lower, range.upper), (-0.5, 0.5));
    let range = model.coordinates[2].range.unwrap();
    assert_eq!((range.lower, range.upper), (std::f64::consts::FRAC_PI_2, std::f64::consts::PI));
}

#[test]
fn refused_things_are_silent_afterwards() {
    assert_eq!(
        codes(&cart(
            "let a = unknown*2;\n    let b = a + x;\n    kinetic b;\n    point p = [b, a, 0];"
        )),
        ["E0201"]
    );
    assert_eq!(
        codes(&cart("frame f = world*phi;\n    rigid r { mass: m, frame: f, com: f*[0, 0, l] }")),
        ["E0402"]
    );
    assert_eq!(codes(&cart("let y = (x + ;\n    let z = y;")), ["E0006"]);
    assert_eq!(codes(&cart("let y = x + ;\n    let z = y;")), ["E0101"]);
}

#[test]
fn a_missing_semicolon_costs_one_message() {
    assert_eq!(codes(&cart("let y = x\n    let z = y;")), ["E0101"]);
    assert_eq!(codes(&cart("let y = x\n")), ["E0101"]);
    assert_eq!(
        codes(
            "robot A { params { m: kg = 1\n l: m = 2; }\n position x: m; kinetic m*l*d/dt(x)^2/l; }"
        ),
        ["E0101"]
    );
}

#[test]
fn suggestions_name_what_was_meant() {
    for (text, help) in [
        ("let a = sinn(phi);", "did you mean `sin`?"),
        ("let a = log(phi);", "write `ln`"),
        ("let speed = d/dt(x); let a = sped;", "did you mean `speed`?"),
        ("let a = x(1);", "write every product out: `x*(…)`"),
        ("postion y: m;", "did you mean `position`?"),
        ("let p[1] = x; let a = p;", "it needs an index, such as `p[1]`"),
        ("let a = x**2;", "a power is written `x^2`"),
        ("let a == x;", "a definition is written with one `=`"),
    ] {
        let parsed = parse("help.robot", &cart(text));
        let helps: Vec<&str> =
            parsed.diagnostics.iter().filter_map(|d| d.help.as_deref()).collect();
        assert!(helps.contains(&help), "{text}: {helps:?}");
    }
}

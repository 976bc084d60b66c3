//! The certificate as plain text, for the tool's output and generated documentation.

use super::certificate::{
    Certificate, Class, Integrability, Linearisation, RangeClaim, Root, ShapeMap,
};
use std::fmt::Write as _;

impl Certificate {
    /// The certificate as plain text, lines of at most about a hundred characters.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut out = String::new();
        self.heading(&mut out);
        self.roles(&mut out);
        self.condition_list(&mut out);
        if let Some(map) = &self.shape_map {
            map_text(map, &mut out);
        }
        self.facts(&mut out);
        integrability_text(&self.integrability, &mut out);
        if let Some(linear) = &self.linearisation {
            linear_text(linear, &mut out);
        }
        for warning in &self.warnings {
            line(&mut out, &format!("warning {}: {}", warning.code, warning.title));
        }
        out
    }

    /// One line: the class and why.
    #[must_use]
    pub fn verdict(&self) -> String {
        match &self.class {
            Class::ShapeAccelerated if self.strict.holds => {
                "shape-accelerated, strict class (Eqs. 3-5)".to_owned()
            }
            Class::ShapeAccelerated => {
                "shape-accelerated, wider class (the planner's conditions hold)".to_owned()
            }
            Class::NotShapeAccelerated { .. } => "not shape-accelerated".to_owned(),
        }
    }

    fn heading(&self, out: &mut String) {
        line(out, &format!("{}: {}", self.robot, self.verdict()));
        let (n, n_x, n_s) = (self.len(), self.position_count, self.shape_count());
        let sets = self.shape_sets().map(|k| format!(", k = {k}")).unwrap_or_default();
        line(out, &format!("  n = {n}, n_x = {n_x}, n_s = {n_s}{sets}"));
        if let Class::NotShapeAccelerated { reasons } = &self.class {
            for reason in reasons {
                let (code, text, at) = (reason.code, &reason.text, reason.line);
                line(out, &format!("  {code} ({}) line {at}: {text}", reason.condition));
                if let Some(help) = &reason.help {
                    line(out, &format!("        help: {help}"));
                }
            }
        }
    }

    fn roles(&self, out: &mut String) {
        let name = |i: &usize| self.coordinates[*i].clone();
        let driven: Vec<String> = self
            .actuated
            .iter()
            .map(|(i, actuator)| format!("{} by {actuator}", name(i)))
            .collect();
        let free: Vec<String> = self.unactuated.iter().map(name).collect();
        line(out, &format!("  actuated:   {}", or_none(&driven.join(", "))));
        line(out, &format!("  unactuated: {}", or_none(&free.join(", "))));
    }

    fn condition_list(&self, out: &mut String) {
        line(out, "Conditions");
        for condition in &self.conditions {
            line(out, &format!("  ({}) {}", condition.letter, condition.statement));
            line(out, &format!("      {}", condition.evidence.as_str()));
        }
    }

    fn facts(&self, out: &mut String) {
        line(out, "Structure");
        if self.strict.holds {
            line(out, "  M, C and G of all rows are free of q_x and q_x', and G_x = 0 (Eqs. 3-5)");
        } else if !self.strict.departures.is_empty() {
            line(out, &format!("  outside Eqs. 3-5: {}", self.strict.departures.join("; ")));
        }
        for position in &self.positions {
            let yes =
                |flag: bool, word: &str| if flag { word.to_owned() } else { format!("not {word}") };
            let observer = if position.momentum_observer {
                ": dp/dt = torque + disturbance, a momentum observer needs no accelerations"
            } else {
                ""
            };
            line(
                out,
                &format!(
                    "  {}: {}, {}{observer}",
                    position.coordinate,
                    yes(position.actuated, "actuated"),
                    yes(position.cyclic, "cyclic"),
                ),
            );
        }
        let (least, greatest) = self.mass.eigenvalues;
        line(
            out,
            &format!(
                "  M positive definite: eigenvalues {} to {} at the origin; sampled only at {} points of the ranges",
                number(least),
                number(greatest),
                self.mass.samples
            ),
        );
        for mirror in &self.mirrors {
            let images: Vec<String> = mirror
                .images
                .iter()
                .enumerate()
                .map(|(i, (to, flip))| {
                    let sign = if *flip { "-" } else { "" };
                    format!("{} -> {sign}{}", self.coordinates[i], self.coordinates[*to])
                })
                .collect();
            let (left, right) = &mirror.instances;
            line(out, &format!("  mirror({left}, {right}) proved: {}", images.join(", ")));
        }
    }
}

impl RangeClaim {
    /// As a half sentence.
    #[must_use]
    pub fn describe(&self) -> String {
        let point = |at: &[(String, f64)]| {
            at.iter()
                .map(|(name, value)| format!("{name} = {}", number(*value)))
                .collect::<Vec<_>>()
                .join(", ")
        };
        match self {
            Self::Proved { boxes } => format!("proved by interval subdivision, {boxes} box(es)"),
            Self::SampledOnly { samples } => {
                format!(
                    "sampled only: holds at {samples} points, the budget of the subdivision ran out"
                )
            }
            Self::Undecided { at } => format!("undecided; nearest to failing at {}", point(at)),
            Self::Fails { at } => format!("fails at {}", point(at)),
            Self::NoRange { coordinates } => {
                format!("not examined: no range is declared for {}", coordinates.join(", "))
            }
            Self::NothingVaries => "nothing it depends on varies".to_owned(),
        }
    }
}

fn map_text(map: &ShapeMap, out: &mut String) {
    line(out, "Shape to acceleration (at the model's parameter values)");
    line(out, &format!("  det M_{{u,x}}(0) = {}", number(map.determinant)));
    line(out, &format!("  over the coordinates' ranges: {}", map.over_coordinates.describe()));
    line(out, &format!("  over the parameters' as well:  {}", map.over_parameters.describe()));
    for (i, row) in map.gain.iter().enumerate() {
        let entries: Vec<String> = row.iter().map(|v| format!("{:>10}", number(*v))).collect();
        let head = if i == 0 { "K0_qs =" } else { "" };
        line(out, &format!("  {head:<7} [{} ]", entries.join(" ")));
    }
    for set in &map.sets {
        let verdict = if set.nonsingular { "nonsingular" } else { "singular or not square" };
        line(out, &format!("  block of shape set {}: {verdict}", set.name));
    }
    let theorem = if map.invertible {
        "n_s = n_x: Gamma' and K0_qs are invertible near the origin"
    } else {
        "n_s > n_x: Gamma' and K0_qs are not invertible; weights choose among the shapes (Eq. 24)"
    };
    line(out, &format!("  Theorem 2: {theorem}"));
}

fn integrability_text(integrability: &Integrability, out: &mut String) {
    if integrability.rows.is_empty() {
        return;
    }
    line(out, "Dynamic constraint (Oriolo and Nakamura 1991, equation by equation)");
    for row in &integrability.rows {
        let name = &row.coordinate;
        if row.partially_integrable() {
            line(
                out,
                &format!("  {name}: partially integrable: constant gravity term, M free of {name}"),
            );
            continue;
        }
        let mut why = Vec::new();
        if !row.gravity_constant {
            why.push("its gravity term is not constant".to_owned());
        }
        if !row.inertia_free {
            why.push(format!("M depends on {name}"));
        }
        line(out, &format!("  {name}: not even partially integrable: {}", why.join(", ")));
    }
    match integrability.involutive {
        Some(true) => {
            line(out, "  all are, and the distribution is involutive: completely integrable")
        }
        Some(false) => {
            line(out, "  all are, but the distribution is not involutive: first-order nonholonomic")
        }
        None => {}
    }
}

fn linear_text(linear: &Linearisation, out: &mut String) {
    line(out, "Linearised at the origin (1/s, without friction)");
    line(out, &format!("  poles, constant torque:            {}", roots(&linear.poles)));
    line(out, &format!("  poles, position variables locked: {}", roots(&linear.locked_poles)));
    if linear.time_constants.is_empty() {
        return;
    }
    let matrix = |rows: &[Vec<f64>]| {
        let row = |row: &Vec<f64>| row.iter().map(|v| number(*v)).collect::<Vec<_>>().join(", ");
        rows.iter().map(row).collect::<Vec<_>>().join("; ")
    };
    let through = linear.through.join(", ");
    line(out, &format!("  q_s = K0_qx u through {through}, equal weights:"));
    let (own, output) = (&linear.time_constants, &linear.output_time_constants);
    line(
        out,
        &format!(
            "  q_x'' = u - T u'', T = [{}] s^2, zeros {}",
            matrix(own),
            or_none(&roots(&linear.zeros))
        ),
    );
    line(
        out,
        &format!(
            "  output the same with T = [{}] s^2, zeros {}",
            matrix(output),
            or_none(&roots(&linear.output_zeros))
        ),
    );
}

/// Roots, equal ones counted: `±2.75`, `0 (twice)`.
fn roots(list: &[Root]) -> String {
    let mut shown: Vec<(String, usize)> = Vec::new();
    for root in list {
        let text = match (root.re == 0.0, root.im == 0.0) {
            (_, true) => number(root.re),
            (true, false) => format!("{}i", number(root.im)),
            _ => format!(
                "{}{}{}i",
                number(root.re),
                if root.im < 0.0 { "" } else { "+" },
                number(root.im)
            ),
        };
        match shown.iter_mut().find(|(known, _)| *known == text) {
            Some((_, count)) => *count += 1,
            None => shown.push((text, 1)),
        }
    }
    let counted = |(text, count): &(String, usize)| {
        if *count > 1 { format!("{text} ({count} times)") } else { text.clone() }
    };
    shown.iter().map(counted).collect::<Vec<_>>().join(", ")
}

/// Five significant digits.
fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = value.abs();
    if !(1e-4..1e6).contains(&magnitude) {
        return format!("{value:.4e}");
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let decimals = (4.0 - magnitude.log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

fn or_none(text: &str) -> &str {
    if text.is_empty() { "none" } else { text }
}

fn line(out: &mut String, text: &str) {
    let _ = writeln!(out, "{}", text.trim_end());
}

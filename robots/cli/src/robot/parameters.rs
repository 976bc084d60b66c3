//! Parameter values from the command line.

use crate::failure::{Failure, Outcome};
use shapebot_dynamics::Parameter;

/// Values of all parameters: those set by name, the model's own for the rest.
pub(crate) fn values(parameters: &[Parameter], set: &[(String, f64)]) -> Outcome<Vec<f64>> {
    let mut values: Vec<f64> = parameters.iter().map(|parameter| parameter.value).collect();
    let mut given = vec![false; values.len()];
    for (name, value) in set {
        let Some(i) = parameters.iter().position(|parameter| parameter.name == name) else {
            return Err(Failure::unknown("parameter", name, parameters.iter().map(|p| p.name)));
        };
        if std::mem::replace(&mut given[i], true) {
            return Err(Failure::usage(format!("parameter `{name}` is set twice")));
        }
        check_range(&parameters[i], *value)?;
        values[i] = *value;
    }
    Ok(values)
}

fn check_range(parameter: &Parameter, value: f64) -> Outcome {
    let Parameter { name, unit, lower, upper, .. } = *parameter;
    if (lower..=upper).contains(&value) {
        return Ok(());
    }
    let message = format!("`{name}` = {value} {unit} is outside of its range {lower} to {upper} {unit}");
    Err(Failure::usage(message))
}

#[cfg(test)]
mod tests {
    use super::values;
    use shapebot_dynamics::Parameter;

    const fn parameter(name: &'static str, value: f64) -> Parameter {
        Parameter { name, unit: "m", value, lower: 0.0, upper: 2.0, docs: "" }
    }

    #[test]
    fn parameters_are_set_by_name_within_their_range() {
        let list = [parameter("r_w", 0.1), parameter("l_b", 0.9)];
        let set = |name: &str, value| vec![(name.to_owned(), value)];
        assert_eq!(values(&list, &set("l_b", 1.0)).unwrap(), [0.1, 1.0]);
        assert_eq!(values(&list, &[]).unwrap(), [0.1, 0.9]);
        assert!(values(&list, &set("l_b", 3.0)).is_err());
        assert!(values(&list, &set("l", 1.0)).is_err());
        assert!(values(&list, &[set("l_b", 1.0), set("l_b", 1.0)].concat()).is_err());
    }
}

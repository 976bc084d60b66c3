//! The fields of the output, in the layouts of the reference data.

use crate::failure::{Failure, Outcome};

/// Numbers of coordinates. For a robot that is not shape-accelerated, `shape` and `position` are those
/// of its declaration, without Γ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sizes {
    /// n.
    pub(crate) all: usize,
    /// n_x.
    pub(crate) position: usize,
    /// n_s.
    pub(crate) shape: usize,
}

macro_rules! fields {
    ($($field:ident = $name:literal),* $(,)?) => {
        /// One field of an output line.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum Field {
            $($field),*
        }

        impl Field {
            /// All fields, in the order of the reference data.
            pub(crate) const ALL: [Self; [$($name),*].len()] = [$(Self::$field),*];

            /// Key in the output.
            pub(crate) const fn name(self) -> &'static str {
                match self {
                    $(Self::$field => $name),*
                }
            }
        }
    };
}

fields! {
    MassMatrix = "M",
    CoriolisMatrix = "C",
    CoriolisVector = "Cqd",
    Gravity = "G",
    Gamma = "Gamma",
    GammaPrime = "GammaP",
    MassMatrixJacobian = "dM_dq",
    CoriolisVectorJacobianQ = "dCqd_dq",
    CoriolisVectorJacobianQd = "dCqd_dqd",
    GravityJacobian = "dG_dq",
    GammaJacobianQs = "dGamma_dqs",
    GammaJacobianQsd = "dGamma_dqsd",
    GammaJacobianQsdd = "dGamma_dqsdd",
    GammaPrimeJacobian = "dGammaP_dqs",
    Kinetic = "kinetic",
    Potential = "potential",
    ForwardDynamics = "qdd_fd",
    ShapeGain = "K0_qs",
}

impl Field {
    /// Whether it exists for shape-accelerated robots alone.
    pub(crate) const fn needs_shape(self) -> bool {
        matches!(
            self,
            Self::Gamma
                | Self::GammaPrime
                | Self::GammaJacobianQs
                | Self::GammaJacobianQsd
                | Self::GammaJacobianQsdd
                | Self::GammaPrimeJacobian
                | Self::ShapeGain
        )
    }

    /// Whether it is a function of accelerations.
    pub(crate) const fn reads_accelerations(self) -> bool {
        matches!(
            self,
            Self::Gamma | Self::GammaJacobianQs | Self::GammaJacobianQsd | Self::GammaJacobianQsdd
        )
    }

    /// Whether it is a function of rates.
    pub(crate) const fn reads_rates(self) -> bool {
        let of_motion = matches!(
            self,
            Self::CoriolisMatrix
                | Self::CoriolisVector
                | Self::CoriolisVectorJacobianQ
                | Self::CoriolisVectorJacobianQd
                | Self::Kinetic
                | Self::ForwardDynamics
        );
        of_motion || self.reads_accelerations()
    }

    /// Layout: `[]` a scalar, `[n]` a list, `[rows, columns]` a list of rows and so on.
    pub(crate) fn extents(self, sizes: Sizes) -> Vec<usize> {
        let Sizes { all: n, position: nx, shape: ns } = sizes;
        match self {
            Self::Kinetic | Self::Potential => vec![],
            Self::CoriolisVector | Self::Gravity | Self::ForwardDynamics => vec![n],
            Self::Gamma | Self::GammaPrime => vec![nx],
            Self::MassMatrix
            | Self::CoriolisMatrix
            | Self::CoriolisVectorJacobianQ
            | Self::CoriolisVectorJacobianQd
            | Self::GravityJacobian => vec![n, n],
            Self::MassMatrixJacobian => vec![n, n, n],
            Self::GammaJacobianQs
            | Self::GammaJacobianQsd
            | Self::GammaJacobianQsdd
            | Self::GammaPrimeJacobian
            | Self::ShapeGain => vec![nx, ns],
        }
    }
}

/// The requested fields, in the order in which they are printed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Selection {
    fields: Vec<Field>,
}

impl Selection {
    /// Reads a list of names; an empty list is everything that the robot has.
    pub(crate) fn parse(names: &[String], shape_accelerated: bool) -> Outcome<Self> {
        let has = |field: &Field| shape_accelerated || !field.needs_shape();
        if names.is_empty() {
            return Ok(Self { fields: Field::ALL.into_iter().filter(has).collect() });
        }
        let mut fields = Vec::new();
        for name in names {
            let field = find(name.trim())?;
            if !has(&field) {
                let message =
                    format!("no field `{}`: the robot is not shape-accelerated", field.name());
                return Err(Failure::usage(message));
            }
            if fields.contains(&field) {
                return Err(Failure::usage(format!("field `{}` is requested twice", field.name())));
            }
            fields.push(field);
        }
        Ok(Self { fields })
    }

    /// In the order of the output.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Field> + '_ {
        self.fields.iter().copied()
    }

    pub(crate) fn contains(&self, field: Field) -> bool {
        self.fields.contains(&field)
    }

    /// Whether at least two of some fields are requested, so that they are better computed together.
    pub(crate) fn several(&self, of: &[Field]) -> bool {
        of.iter().filter(|field| self.contains(**field)).count() > 1
    }
}

fn find(name: &str) -> Outcome<Field> {
    let found = Field::ALL.into_iter().find(|field| field.name() == name);
    found.ok_or_else(|| Failure::unknown("field", name, Field::ALL.map(Field::name)))
}

/// Values of the fields at one state, each row-major; the memory is used again for the next state.
#[derive(Debug, Default)]
pub(crate) struct Results {
    values: [Vec<f64>; Field::ALL.len()],
}

impl Results {
    /// The memory of a field, emptied.
    pub(crate) fn clear(&mut self, field: Field) -> &mut Vec<f64> {
        let values = &mut self.values[field as usize];
        values.clear();
        values
    }

    pub(crate) fn get(&self, field: Field) -> &[f64] {
        &self.values[field as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::{Field, Selection};

    #[test]
    fn every_field_is_requested_by_default() {
        let selection = Selection::parse(&[], true).unwrap();
        assert_eq!(selection.iter().count(), Field::ALL.len());
        let lagrangian = Selection::parse(&[], false).unwrap();
        assert!(lagrangian.iter().all(|field| !field.needs_shape()));
    }

    #[test]
    fn unknown_and_repeated_fields_are_refused() {
        let names = |list: &[&str]| list.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
        assert!(Selection::parse(&names(&["M", "H"]), true).is_err());
        assert!(Selection::parse(&names(&["M", "M"]), true).is_err());
        assert!(Selection::parse(&names(&["Gamma"]), false).is_err());
        let selection = Selection::parse(&names(&["G", " M"]), true).unwrap();
        assert_eq!(selection.iter().map(Field::name).collect::<Vec<_>>(), ["G", "M"]);
    }
}

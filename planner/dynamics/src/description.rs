//! What a robot says about itself: plain data, usable in `const`.

/// Role of a coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// One of q_x.
    Position,
    /// One of q_s.
    Shape,
}

/// A generalised coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordinate {
    /// Identifier: `phi_x`.
    pub name: &'static str,
    /// SI unit: `rad`, `m`.
    pub unit: &'static str,
    /// Position or shape.
    pub role: Role,
    /// Whether the derived input matrix B acts on its equation.
    pub actuated: bool,
    /// Smallest declared value, −∞ if none.
    pub lower: f64,
    /// Largest declared value, +∞ if none.
    pub upper: f64,
}

/// Shape coordinates that were declared as one vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeSet {
    /// Identifier: `alpha_l`.
    pub name: &'static str,
    /// Index of its first coordinate in q_s.
    pub first: usize,
    /// Number of coordinates: n_x for a shape set in the paper's sense.
    pub len: usize,
    /// Whether its coordinates are actuated.
    pub actuated: bool,
}

/// A motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Actuator {
    /// Identifier: `tau_ball_x`.
    pub name: &'static str,
    /// SI unit of its force.
    pub unit: &'static str,
    /// Largest magnitude, +∞ if none is declared.
    pub limit: f64,
}

/// A parameter with the model's own value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Identifier: `r_w`.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// The model's own value.
    pub value: f64,
    /// Smallest allowed value, −∞ if none.
    pub lower: f64,
    /// Largest allowed value, +∞ if none.
    pub upper: f64,
    /// Doc comment.
    pub docs: &'static str,
}

/// Form of a body. Lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solid {
    /// Radius.
    Sphere(f64),
    /// Full edge lengths along x, y, z.
    Box([f64; 3]),
    /// Radius, length between the centres of the caps, along z.
    Capsule(f64, f64),
    /// Radius, length, along z.
    Cylinder(f64, f64),
}

/// A solid for animation: its centre is a point, its axes are a frame of the description.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// Name.
    pub name: &'static str,
    /// Its form, at the model's own parameter values.
    pub solid: Solid,
    /// Index into [`Description::frames`].
    pub frame: usize,
    /// Index into [`Description::points`] of its centre.
    pub center: usize,
}

/// Dry friction: level in SI units against the rate of a displacement on which actuator-like virtual
/// work is done; `column` indexes nothing at run time, the plant reads `row` weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoulombFriction {
    /// Magnitude of the force.
    pub level: f64,
    /// ∂(displacement)/∂q at the origin, one weight per coordinate.
    pub weights: &'static [f64],
}

/// Everything about a robot that is not mathematics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Description {
    /// Model file's stem: `ballbot3d_arms`.
    pub name: &'static str,
    /// One-line summary.
    pub summary: &'static str,
    /// Coordinates, q = [q_x, q_s].
    pub coordinates: &'static [Coordinate],
    /// Number of position coordinates.
    pub position_count: usize,
    /// Shape sets, in the order of q_s.
    pub shape_sets: &'static [ShapeSet],
    /// Motors.
    pub actuators: &'static [Actuator],
    /// Parameters.
    pub parameters: &'static [Parameter],
    /// Names of the output's entries.
    pub outputs: &'static [&'static str],
    /// SI unit of the output.
    pub output_unit: &'static str,
    /// Frame names; the first is `world`.
    pub frames: &'static [&'static str],
    /// Point names: declared points, then centres of mass and of geometry.
    pub points: &'static [&'static str],
    /// Geometry for animation.
    pub geometry: &'static [Geometry],
    /// Dry friction.
    pub friction: &'static [CoulombFriction],
}

impl Description {
    /// The coordinates of q_x.
    pub fn position_coordinates(&self) -> &[Coordinate] {
        self.coordinates.get(..self.position_count).unwrap_or(self.coordinates)
    }

    /// The coordinates of q_s.
    pub fn shape_coordinates(&self) -> &[Coordinate] {
        self.coordinates.get(self.position_count..).unwrap_or(&[])
    }

    /// Index in q_s of the shape coordinates without an actuator.
    pub fn unactuated_shape(&self) -> impl Iterator<Item = usize> + '_ {
        self.shape_coordinates().iter().enumerate().filter(|(_, c)| !c.actuated).map(|(i, _)| i)
    }
}

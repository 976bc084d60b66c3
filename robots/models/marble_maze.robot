//! A marble that rolls on a plate tilted about two axes.
//!
//! The marble's position `x`, `y` on the plate, measured along the plate from its centre, is not
//! actuated; the plate's angles `beta` are. The plate is turned by `R_y(beta.y) R_x(beta.x)`, so the
//! marble runs towards +x for positive `beta.y` and towards -y for positive `beta.x`.
//!
//! This is the textbook model for slow tilting: the marble's kinetic energy is that of rolling on a plate
//! at rest, `1/2 (m + I/r^2) |v|^2` with v relative to the plate. Dropped are, of order tilt rate times
//! speed or tilt rate squared, the Coriolis and centrifugal terms of the plate's motion on the marble;
//! the push of the plate's angular acceleration on the marble off the centre; the marble's share of the
//! plate's inertia, `m (x^2 + y^2)`; the turning of the marble along with the plate; and the height of the
//! marble's centre above the plate's axes, `r`. Its potential energy is exact for that last assumption.
//! The equations of the marble are then free of x, y and their rates. The plate's are not: the marble's
//! weight is a torque on the plate that grows with x and y, so the strict class of the paper (no
//! dependence on position variables anywhere) is not met.
//!
//! Parameters are our choice: a steel ball of 12.7 mm diameter (7850 kg/m^3) on a plate the size of the
//! wooden labyrinth toy.
robot MarbleMaze {
    params {
        /// Marble mass.
        m: kg = 0.0084 in 0.001..0.1;
        /// Marble radius.
        r: m = 0.00635 in 0.002..0.03;
        /// Plate mass.
        m_p: kg = 0.5 in 0.1..5;
        /// Edge of the plate along x.
        a: m = 0.28 in 0.1..1;
        /// Edge of the plate along y.
        b: m = 0.24 in 0.1..1;
        /// Thickness of the plate.
        h: m = 0.006 in 0.001..0.05;
        /// Gravity.
        g: m/s^2 = 9.81 in 1..15;
        /// Rolling resistance as viscous friction.
        c_r: N*s/m = 0.001 in 0..0.1;
        /// Largest torque of each tilt drive.
        tau_max: N*m = 0.3 in 0.05..5;
    }

    /// Position of the marble on the plate.
    position x, y: m in -0.12..0.12;
    /// Tilt of the plate about the x and the y axis.
    shape beta[x, y]: rad in -15deg..15deg;

    frame plate = world * rot_y(beta.y) * rot_x(beta.x);
    let I = 2/5*m*r^2;
    let marble = plate*[x, y, 0];

    /// The marble rolls, as on a plate at rest.
    kinetic 1/2*(m + I/r^2) * |d/dt([x, y])|^2;
    /// Weight of the marble.
    potential m*g*marble.z;
    rigid board {
        mass: m_p,
        inertia: diag(m_p*(b^2 + h^2)/12, m_p*(a^2 + h^2)/12, m_p*(a^2 + b^2)/12),
        frame: plate,
        com: [0, 0, 0],
    }
    gravity g along -world.z;

    /// Tilt drives.
    actuator tau_tilt[x, y] on d/dt(beta) limit tau_max;
    dissipation 1/2*c_r*|d/dt([x, y])|^2;

    output [x, y]: m;

    point ball = marble;
    point corner = plate*[a/2, b/2, 0];
    shape sheet = box(a, b, h) on plate at plate*[0, 0, -h/2];
    shape sphere(r) at plate*[x, y, r];

    require r < a/2;
    require shape_accelerated;
}

//! A marble that rolls on a plate tilted about two axes, without the simplifications of `marble_maze`.
//!
//! Same coordinates, parameters and drives: the plant that a controller made from the textbook model can
//! be tried on. The marble is a solid sphere whose centre is r above the plate. It rolls without
//! slipping, and without turning relative to the plate about the plate's normal; in plate axes its
//! angular velocity is that of the plate plus `[-d/dt(y)/r, d/dt(x)/r, 0]`. Position variables enter
//! through the plate's motion, so this is no shape-accelerated robot.
robot MarbleMazeFull {
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
    let marble = plate*[x, y, r];

    rigid marble_mass { mass: m, com: marble }
    /// The marble turns with the plate and rolls on it.
    kinetic 1/2*I*(
        (d/dt(beta.x) - d/dt(y)/r)^2
        + (d/dt(beta.y)*cos(beta.x) + d/dt(x)/r)^2
        + (d/dt(beta.y)*sin(beta.x))^2
    );
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
    shape sphere(r) at marble;

    require r < a/2;
}

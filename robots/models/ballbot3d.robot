//! Ballbot in space (Nagarajan & Hollis, Table I).
//!
//! A body balances on a ball that rolls without slipping. The body is turned by `R_y(phi.y) R_x(phi.x)`;
//! there is no yaw. The ball's centre is `(r_w (theta.x + phi.y), r_w (theta.y - phi.x))`: this choice of
//! `theta` removes the input coupling.
robot Ballbot3d {
    params {
        /// Ball radius.
        r_w: m = 0.1058 in 0.05..0.3;
        /// Ball mass.
        m_w: kg = 2.44 in 0.5..10;
        /// Ball's moment of inertia.
        I_w: kg*m^2 = 0.0174 in 0.001..0.1;
        /// Body mass.
        m_b: kg = 70.3 in 40..100;
        /// Height of the body's centre of mass above the ball's centre.
        l_b: m = 0.87 in 0.4..1.2;
        /// Body's moment of inertia about its centre of mass, x axis.
        Ixx_b: kg*m^2 = 12.59 in 5..25;
        /// Body's moment of inertia about its centre of mass, y axis.
        Iyy_b: kg*m^2 = 12.48 in 5..25;
        /// Body's moment of inertia about its centre of mass, z axis.
        Izz_b: kg*m^2 = 0.66 in 0.1..5;
        /// Gravity.
        g: m/s^2 = 9.81 in 1..15;
        /// Viscous friction between ball and body, alike about both axes.
        b_w: N*m*s = 0.5 in 0..10;
        /// Largest torque of each ball drive.
        tau_max: N*m = 60 in 10..200;
    }

    /// Angle of the ball relative to the body, rolling along x and along y.
    position theta[x, y]: rad in -200..200;
    /// Lean of the body about the x and the y axis.
    shape phi[x, y]: rad in -30deg..30deg;

    /// No slip: the centre of the ball.
    let ball = [r_w*(theta.x + phi.y), r_w*(theta.y - phi.x), 0];
    frame body = world * rot_y(phi.y) * rot_x(phi.x);

    /// The ball rolls.
    kinetic 1/2*(m_w + I_w/r_w^2) * |d/dt(ball)|^2;
    rigid trunk { mass: m_b, inertia: diag(Ixx_b, Iyy_b, Izz_b), frame: body, com: ball + body*[0, 0, l_b] }
    gravity g along -world.z;

    /// Ball drive.
    actuator tau_ball[x, y] on d/dt(theta) limit tau_max;
    dissipation 1/2*b_w*|d/dt(theta)|^2;

    output [ball.x, ball.y]: m;

    point center = ball;
    point head = ball + body*[0, 0, 2*l_b];
    shape wheel = sphere(r_w) at ball;
    shape trunk_hull = cylinder(r_w, 2*l_b - 12/5*r_w) on body at ball + body*[0, 0, l_b];

    require shape_accelerated;
}

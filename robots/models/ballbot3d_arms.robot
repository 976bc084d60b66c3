//! Ballbot with a pair of arms of two degrees of freedom each (Nagarajan & Hollis, Sec. III-C, Table I).
//!
//! The body is turned by `R_y(phi.y) R_x(phi.x)`; there is no yaw. The ball's centre is
//! `(r_w (theta.x + phi.y), r_w (theta.y - phi.x))`: this choice of `theta` removes the input coupling.
//! The left arm is on the +y side. Arms hang down at zero and are turned relative to the body by
//! `R_y(alpha.y) R_x(alpha.x)`, with their mass at the end.
robot Ballbot3dArms {
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
        /// Mass at the end of an arm.
        m_a: kg = 1 in 0.1..5;
        /// Length of an arm.
        l_a: m = 0.55 in 0.2..0.9;
        /// Distance of the shoulders from the middle plane.
        d_y: m = 0.18415 in 0.1..0.4;
        /// Height of the shoulders above the ball's centre.
        d_z: m = 1.3 in 0.9..1.6;
        /// Arm's moment of inertia about its centre of mass, x axis.
        Ixx_a: kg*m^2 = 0.0016 in 0..0.1;
        /// Arm's moment of inertia about its centre of mass, y axis.
        Iyy_a: kg*m^2 = 0.0016 in 0..0.1;
        /// Arm's moment of inertia about its centre of mass, z axis.
        Izz_a: kg*m^2 = 0.0010 in 0..0.1;
        /// Gravity.
        g: m/s^2 = 9.81 in 1..15;
        /// Viscous friction between ball and body, alike about both axes.
        b_w: N*m*s = 0.5 in 0..10;
        /// Viscous friction of each joint of an arm.
        b_a: N*m*s = 0.05 in 0..2;
        /// Largest torque of each ball drive.
        tau_max: N*m = 60 in 10..200;
        /// Largest torque of each arm drive.
        tau_arm_max: N*m = 15 in 2..60;
    }

    /// Angle of the ball relative to the body, rolling along x and along y.
    position theta[x, y]: rad in -200..200;
    /// Angles of the left and the right arm relative to the body.
    shape alpha_l[x, y], alpha_r[x, y]: rad in -90deg..90deg;
    /// Lean of the body about the x and the y axis.
    shape phi[x, y]: rad in -30deg..30deg;

    /// No slip: the centre of the ball.
    let ball = [r_w*(theta.x + phi.y), r_w*(theta.y - phi.x), 0];
    frame body = world * rot_y(phi.y) * rot_x(phi.x);

    /// The ball rolls.
    kinetic 1/2*(m_w + I_w/r_w^2) * |d/dt(ball)|^2;
    rigid trunk { mass: m_b, inertia: diag(Ixx_b, Iyy_b, Izz_b), frame: body, com: ball + body*[0, 0, l_b] }

    component Arm(alpha: rad[x, y], side: 1) {
        frame arm = body * rot_y(alpha.y) * rot_x(alpha.x);
        point shoulder = ball + body*[0, side*d_y, d_z];
        rigid weight {
            mass: m_a, inertia: diag(Ixx_a, Iyy_a, Izz_a), frame: arm,
            com: shoulder + arm*[0, 0, -l_a],
        }
        point hand = weight.com;
        dissipation 1/2*b_a*|d/dt(alpha)|^2;
        shape limb = capsule(l_a/15, l_a) on arm at shoulder + arm*[0, 0, -l_a/2];
        shape fist = sphere(l_a/10) at hand;
    }
    left = Arm(alpha_l, +1);
    right = Arm(alpha_r, -1);
    gravity g along -world.z;

    /// Ball drive.
    actuator tau_ball[x, y] on d/dt(theta) limit tau_max;
    /// Drives of the left arm.
    actuator tau_l[x, y] on d/dt(alpha_l) limit tau_arm_max;
    /// Drives of the right arm.
    actuator tau_r[x, y] on d/dt(alpha_r) limit tau_arm_max;
    dissipation 1/2*b_w*|d/dt(theta)|^2;

    output [ball.x, ball.y]: m;

    point center = ball;
    point head = ball + body*[0, 0, 2*l_b];
    shape wheel = sphere(r_w) at ball;
    shape trunk_hull = cylinder(r_w, 2*l_b - 12/5*r_w) on body at ball + body*[0, 0, l_b];

    require l_a < d_z;
    require mirror(left, right);
    require shape_accelerated;
}

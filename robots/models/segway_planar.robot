//! Two-wheeled inverted pendulum (Segway) driving straight: a pair of wheels and the body's pitch.
//!
//! `phi` is the pitch of the body, positive towards +x. `theta` is the angle of the wheels *relative to
//! the body*, as in the ballbot: the motors sit between body and wheels and work on its rate alone. With
//! the absolute wheel angle as coordinate the motor torque would appear in both equations (input
//! coupling). The wheels' absolute angle is `theta + phi`.
//!
//! Parameters: NXTway-GS, the two-wheeled Lego robot of Yorihisa Yamamoto ("NXTway-GS Model-Based Design:
//! Control of self-balancing two-wheeled robot built with LEGO Mindstorms NXT", 2008), whose model also
//! has J_w = m R^2/2, L = H/2 and J_psi = M L^2/3 about the centre of mass. The torque limit is what its
//! two motors give at standstill: 2 K_t U/R_m with K_t = 0.317 N m/A, R_m = 6.69 ohm and U = 8 V of its
//! battery.
robot SegwayPlanar {
    params {
        /// Wheel radius.
        r_w: m = 0.04 in 0.02..0.3;
        /// Mass of one wheel.
        m_w: kg = 0.03 in 0.01..5;
        /// Moment of inertia of one wheel about the axle: m R^2/2.
        I_w: kg*m^2 = 0.000024 in 0.000005..0.1;
        /// Moment of inertia of the rotors of both motors, at the wheel: n^2 J_m each with n = 1.
        I_m: kg*m^2 = 2*0.00001 in 0.000002..0.1;
        /// Body mass.
        m_b: kg = 0.6 in 0.2..100;
        /// Height of the body's centre of mass above the axle: H/2.
        l_b: m = 0.072 in 0.03..1.2;
        /// Body's moment of inertia about its centre of mass, pitch axis: M L^2/3.
        I_b: kg*m^2 = 0.6*0.072^2/3 in 0.0001..25;
        /// Gravity.
        g: m/s^2 = 9.81 in 1..15;
        /// Viscous friction between body and wheels, both motors.
        b_w: N*m*s = 2*0.0022 in 0..1;
        /// Largest torque of both motors together.
        tau_max: N*m = 2*0.317*8/6.69 in 0.1..100;
    }

    /// Angle of the wheels relative to the body.
    position theta: rad in -500..500;
    /// Pitch of the body.
    shape phi: rad in -45deg..45deg;

    /// No slip: the middle of the axle.
    let axle = [r_w*(theta + phi), 0, 0];
    frame body = world * rot_y(phi);
    /// Turns with the wheels; its z axis is the axle.
    frame hub = world * rot_y(theta + phi) * rot_x(90deg);

    /// Two wheels roll.
    kinetic (m_w + I_w/r_w^2) * |d/dt(axle)|^2;
    /// The rotors turn with the wheels, relative to the body; only the motors' axis counts.
    kinetic 1/2*I_m*d/dt(theta)^2;
    rigid trunk { mass: m_b, inertia: diag(0, I_b, 0), frame: body, com: axle + body*[0, 0, l_b] }
    gravity g along -world.z;

    /// Both motors.
    actuator tau_wheels on d/dt(theta) limit tau_max;
    dissipation 1/2*b_w*d/dt(theta)^2;

    output axle.x: m;

    point center = axle;
    point head = axle + body*[0, 0, 2*l_b];
    shape wheel_left = cylinder(r_w, 0.6*r_w) on hub at axle + [0, 0.97*l_b, 0];
    shape wheel_right = cylinder(r_w, 0.6*r_w) on hub at axle - [0, 0.97*l_b, 0];
    shape trunk_hull = box(0.55*l_b, 1.3*l_b, 2*l_b) on body at axle + body*[0, 0, l_b];

    require shape_accelerated;
}

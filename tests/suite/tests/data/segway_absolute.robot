//! A Segway in the absolute angle of its wheels: the motor's torque appears in both equations.
robot SegwayAbsolute {
    params {
        r_w: m = 0.2;
        m_w: kg = 5;
        I_w: kg*m^2 = 0.1;
        m_b: kg = 50;
        l_b: m = 0.8;
        I_b: kg*m^2 = 12;
        g: m/s^2 = 9.81;
    }
    position theta: rad;
    shape phi: rad in -45deg..45deg;

    let axle = [r_w*theta, 0, 0];
    frame body = world * rot_y(phi);

    kinetic 1/2*(m_w + I_w/r_w^2) * |d/dt(axle)|^2;
    rigid trunk { mass: m_b, inertia: diag(0, I_b, 0), frame: body, com: axle + body*[0, 0, l_b] }
    gravity g along -world.z;

    actuator tau on d/dt(theta - phi);
    output axle.x: m;
    require shape_accelerated;
}

//! A pole on a cart, by its Lagrangian.
robot MyRobot {
    params {
        /// Mass of the cart.
        m_c: kg = 1.5 in 0.1..10;
        /// Mass at the end of the pole.
        m_p: kg = 0.2 in 0.01..2;
        /// Length of the pole.
        l: m = 0.4 in 0.1..2;
        g: m/s^2 = 9.81 in 1..15;
    }

    position x: m;
    shape phi: rad in -60deg..60deg;

    lagrangian 1/2*(m_c + m_p)*d/dt(x)^2 + m_p*l*cos(phi)*d/dt(x)*d/dt(phi) + 1/2*m_p*l^2*d/dt(phi)^2
        - m_p*g*l*cos(phi);

    actuator f on d/dt(x);
    output x: m;
    require shape_accelerated;
}

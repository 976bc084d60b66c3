//! Cart-pole in space: a cart that moves in the plane with an inverted spherical pendulum.
//!
//! The pole is massless with a point mass at its end, at `R_y(phi_y) R_x(phi_x) [0, 0, l]` from the
//! cart. `phi = 0` is upright; positive `phi.y` leans towards +x, positive `phi.x` towards -y. The cart
//! is driven in both directions; the pole is passive.
//!
//! The paper gives no parameters of its cart-pole: 1 kg, 0.1 kg and 0.5 m are our choice.
robot Cartpole3d {
    params {
        /// Cart mass.
        m_c: kg = 1 in 0.2..10;
        /// Mass at the end of the pole.
        m_p: kg = 0.1 in 0.02..2;
        /// Length of the pole.
        l: m = 0.5 in 0.1..2;
        /// Gravity.
        g: m/s^2 = 9.81 in 1..15;
        /// Viscous friction of the table, alike in both directions.
        b_x: N*s/m = 0.1 in 0..5;
        /// Largest force of each drive.
        f_max: N = 20 in 1..200;
    }

    /// Position of the cart.
    position x, y: m in -10..10;
    /// Lean of the pole about the x and the y axis.
    shape phi[x, y]: rad in -60deg..60deg;

    let base = [x, y, 0];
    frame pole = world * rot_y(phi.y) * rot_x(phi.x);

    rigid cart { mass: m_c, com: base }
    rigid bob { mass: m_p, frame: pole, com: base + pole*[0, 0, l] }
    gravity g along -world.z;

    /// Drive of the cart along x.
    actuator f_x on d/dt(x) limit f_max;
    /// Drive of the cart along y.
    actuator f_y on d/dt(y) limit f_max;
    dissipation 1/2*b_x*|d/dt([x, y])|^2;

    output [x, y]: m;

    point pivot = base;
    point head = bob.com;
    shape cart_box = box(3/10*l, 3/10*l, 1/5*l) at base;
    shape rod = capsule(l/50, l) on pole at base + pole*[0, 0, l/2];
    shape ball = sphere(l/15) at head;

    require shape_accelerated;
}

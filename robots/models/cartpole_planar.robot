//! Cart-pole in the plane: a cart on a straight track with an inverted pendulum.
//!
//! The pole is massless with a point mass at its end. `phi = 0` is upright, positive `phi` leans
//! towards +x: the point mass is at `[x + l sin(phi), l cos(phi)]`. The motor drives the cart; the
//! pole is passive.
//!
//! The paper gives no parameters of its cart-pole: 1 kg, 0.1 kg and 0.5 m are our choice. Only the
//! length enters the constraint.
robot CartpolePlanar {
    params {
        /// Cart mass.
        m_c: kg = 1 in 0.2..10;
        /// Mass at the end of the pole.
        m_p: kg = 0.1 in 0.02..2;
        /// Length of the pole.
        l: m = 0.5 in 0.1..2;
        /// Gravity.
        g: m/s^2 = 9.81 in 1..15;
        /// Viscous friction of the track.
        b_x: N*s/m = 0.1 in 0..5;
        /// Largest force of the drive.
        f_max: N = 20 in 1..200;
    }

    /// Position of the cart along the track.
    position x: m in -10..10;
    /// Lean of the pole.
    shape phi: rad in -60deg..60deg;

    let track = [x, 0, 0];
    frame pole = world * rot_y(phi);

    rigid cart { mass: m_c, com: track }
    rigid bob { mass: m_p, frame: pole, com: track + pole*[0, 0, l] }
    gravity g along -world.z;

    /// Drive of the cart.
    actuator f_x on d/dt(x) limit f_max;
    dissipation 1/2*b_x*d/dt(x)^2;

    output x: m;

    point pivot = track;
    point head = bob.com;
    shape cart_box = box(3/10*l, 1/5*l, 1/5*l) at track;
    shape rod = capsule(l/50, l) on pole at track + pole*[0, 0, l/2];
    shape ball = sphere(l/15) at head;

    require shape_accelerated;
}

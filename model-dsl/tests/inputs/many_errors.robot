//! Every line of this file has something wrong with it.
robot ManyErrors {
    params {
        m: kg = 2 in 5..3;
        l: meter = 0.5;
        g: m/s² = 9.81;
        k: N/m 40;
        eps: m = 1mm
        half: 1 = 1/2;
    }
    position x: m
    shape phi: rad in -30deg..30deg;
    let speed = d/dt(x) + phi;
    let lean = sin(x);
    let again = spede*2;
    frame pole = world * rot_q(phi);
    kinetic 1/2 m*d/dt(x)^2;
    kinetic 1/2*m*d/dt(x);
    potential m*g*l*cos(phi);
    potential abs(phi)*1*J;
    rigid bob { mass: l, com: [x, 0, phi] }
    gravity g along -world.z;
    actuator f on x;
    output [x, x]: m;
    required shape_accelerated;
}

//! Every statement of the language, once.
/// And the robot's own line.
robot Everything {
    params {
        /// A length.
        l: m = 0.5 in 0.1..2;
        m_1: kg = 1;
        I: kg*m^2 = diag(0.1, 0.2, 0.3);
        J_full: kg*m^2 = sym(1, 1, 1, 0.1, 0.2, 0.3);
        offset: mm = [10, 20, 30] in 0..100;
        g: m/s^2 = 9.81;
        k: N*m/rad = 3;
        μ: N*m*s = 0.1;
        tau_c: N*m = 0.2;
    }
    const n = 3;
    position θ[x, y]: rad in -200..200;
    position z: m;
    shape phi[1..=n]: rad in -30deg..30deg;
    repeat i in 1..=n { shape psi[i][a, b]: rad; }

    let base = [l*theta.x, l*theta.y, z];
    frame link[0] = world;
    let p[0] = base;
    repeat i in 1..=n {
        frame link[i] = link[i-1] * rot_y(phi[i]) * rot_z(psi[i].a);
        let p[i] = p[i-1] + link[i]*[0, 0, l];
        /// One of the chain.
        rigid rod[i] { mass: m_1, inertia: I, frame: link[i], com: (p[i-1] + p[i])/2 }
        actuator tau[i] on d/dt(phi[i]) limit 12*N*m;
    }
    rigid top { mass: 2*m_1, com: p[n] + offset };
    kinetic 1/2*m_1*|d/dt(base)|^2 + 1/2*I.xx*dot(omega(link[n]), omega(link[n]));
    kinetic sum(i in 1..=n, 1/2*I.zz*|d/dt(psi[i])|^2) + 1/2*J_full.xy*d/dt(phi[1])^2;
    potential 1/2*k*sum(i in 1..=n, phi[i]^2) + m_1*g*(link[1]*[0, 0, l]).z;
    lagrangian m_1*dot(cross(d/dt(p[1]), d/dt(p[2])), world*[0, 0, 1])*1;
    gravity g along -world.z;

    component Arm(alpha: rad[x, y], side: 1, base: frame, place: m[3], q: point) {
        frame arm = base * rot_x(alpha.x);
        shape beta: rad in -1..1;
        rigid weight { mass: m_1, frame: arm, com: q + arm*[0, side*l, 0] }
        point hand = weight.com;
        shape capsule(l/10, l) on arm at place + q;
        actuator drive on d/dt(beta);
    }
    left = Arm(θ, +1, link[1], base, p[1]);
    right = Arm(θ, -1, world * rot_x(phi[1]), base, p[2]);
    point hand_copy = left.hand;

    actuator tau_ball[x, y] on d/dt(theta) limit 5 * N*m;
    dissipation 1/2*mu*|d/dt(theta)|^2;
    friction tau_c on d/dt(theta);
    output [base.x, base.y, z]: m;
    shape tip = sphere(l/5) at p[n];
    shape hull = box(l, l, 2*l) on link[1] at p[0];
    shape cylinder(l, l) at left.arm*[0, 0, l] + base;
    require mirror(left, right);
    require l < 3*m;
    require shape_accelerated;
}

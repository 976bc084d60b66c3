"""The systems of Table II, written down again: Lagrangians in CasADi, nothing from shapebot."""

from dataclasses import dataclass

import casadi as ca

GRAVITY = 9.81
# Table I.
R_W, M_W, I_W = 0.1058, 2.44, 0.0174
M_B, L_B, I_B = 70.3, 0.87, (12.59, 12.48, 0.66)
M_A, L_A, I_A = 1.0, 0.55, (0.0016, 0.0016, 0.0010)
D_Y, D_Z = 0.18415, 1.3
# The paper gives no cart-pole: cart 1 kg, point mass 0.1 kg at 0.5 m.
M_CART, M_POLE, L_POLE = 1.0, 0.1, 0.5


@dataclass
class System:
    """Coordinates [q_x, q_s] with the names of the plan files' columns."""

    position: list
    shape: list
    outputs: list
    unactuated: list  # rows of the equations of motion without an actuator
    q: ca.SX
    qd: ca.SX
    kinetic: ca.SX
    potential: ca.SX
    output: ca.SX

    def residual(self):
        """f(q, qd, qdd): the unactuated rows of M qdd + C qd + G, zero along any motion."""
        q, qd = self.q, self.qd
        qdd = ca.SX.sym("qdd", q.numel())
        momentum = ca.gradient(self.kinetic, qd)
        rows = ca.jtimes(momentum, qd, qdd) + ca.jtimes(momentum, q, qd)
        rows -= ca.gradient(self.kinetic - self.potential, q)
        return ca.Function("residual", [q, qd, qdd], [rows[self.unactuated]])


def rot_x(a):
    c, s = ca.cos(a), ca.sin(a)
    return ca.vertcat(ca.horzcat(1, 0, 0), ca.horzcat(0, c, -s), ca.horzcat(0, s, c))


def rot_y(a):
    c, s = ca.cos(a), ca.sin(a)
    return ca.vertcat(ca.horzcat(c, 0, s), ca.horzcat(0, 1, 0), ca.horzcat(-s, 0, c))


class Bodies:
    """Sums up energies."""

    def __init__(self, count):
        self.q, self.qd = ca.SX.sym("q", count), ca.SX.sym("qd", count)
        self.kinetic, self.potential = ca.SX(0), ca.SX(0)

    def rate(self, expression):
        return ca.jtimes(expression, self.q, self.qd)

    def mass(self, mass, at):
        velocity = self.rate(at)
        self.kinetic += mass / 2 * ca.dot(velocity, velocity)
        self.potential += mass * GRAVITY * at[2]

    def body(self, mass, inertia, frame, at):
        self.mass(mass, at)
        spin = ca.mtimes(frame.T, ca.reshape(self.rate(ca.vec(frame)), 3, 3))
        omega = ca.vertcat(spin[2, 1], spin[0, 2], spin[1, 0])
        self.kinetic += ca.dot(omega, ca.DM(inertia) * omega) / 2

    def system(self, position, shape, outputs, unactuated, output):
        return System(position, shape, outputs, unactuated, self.q, self.qd, self.kinetic,
                      self.potential, output)


def cartpole():
    bodies = Bodies(2)
    x, phi = bodies.q[0], bodies.q[1]
    bodies.mass(M_CART, ca.vertcat(x, 0, 0))
    bodies.mass(M_POLE, ca.vertcat(x + L_POLE * ca.sin(phi), 0, L_POLE * ca.cos(phi)))
    return bodies.system(["x"], ["phi"], ["x"], [1], x)


def ballbot_planar():
    bodies = Bodies(2)
    theta, phi = bodies.q[0], bodies.q[1]
    ball = ca.vertcat(R_W * (theta + phi), 0, 0)
    bodies.mass(M_W + I_W / R_W**2, ball)
    frame = rot_y(phi)
    bodies.body(M_B, (0, I_B[1], 0), frame, ball + frame @ ca.DM([0, 0, L_B]))
    return bodies.system(["theta"], ["phi"], ["ball.x"], [1], ball[0])


def ballbot3d(arms=False):
    bodies = Bodies(8 if arms else 4)
    theta, phi = bodies.q[:2], bodies.q[-2:]
    ball = ca.vertcat(R_W * (theta[0] + phi[1]), R_W * (theta[1] - phi[0]), 0)
    bodies.mass(M_W + I_W / R_W**2, ball)
    frame = rot_y(phi[1]) @ rot_x(phi[0])
    bodies.body(M_B, I_B, frame, ball + frame @ ca.DM([0, 0, L_B]))
    shape = ["phi_x", "phi_y"]
    if arms:
        for alpha, side in ((bodies.q[2:4], 1), (bodies.q[4:6], -1)):
            arm = frame @ rot_y(alpha[1]) @ rot_x(alpha[0])
            shoulder = ball + frame @ ca.DM([0, side * D_Y, D_Z])
            bodies.body(M_A, I_A, arm, shoulder + arm @ ca.DM([0, 0, -L_A]))
        shape = ["alpha_l_x", "alpha_l_y", "alpha_r_x", "alpha_r_y"] + shape
    count = bodies.q.numel()
    return bodies.system(["theta_x", "theta_y"], shape, ["ball.x", "ball.y"],
                         [count - 2, count - 1], ball[:2])


SYSTEMS = {
    "cartpole": cartpole,
    "ballbot_planar": ballbot_planar,
    "ballbot3d": ballbot3d,
    "ballbot3d_arms": lambda: ballbot3d(arms=True),
}

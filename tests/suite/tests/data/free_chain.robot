//! A cart with two links on top of each other, of which only the cart is driven: one equation too few.
robot FreeChain {
    params {
        m: kg = 1;
        l: m = 0.5;
        g: m/s^2 = 9.81;
    }
    position x: m;
    shape first: rad;
    shape second: rad;

    let base = [x, 0, 0];
    frame lower = world * rot_y(first);
    frame upper = world * rot_y(second);
    rigid cart { mass: m, com: base }
    rigid elbow { mass: m, frame: lower, com: base + lower*[0, 0, l] }
    rigid tip { mass: m, frame: upper, com: base + lower*[0, 0, l] + upper*[0, 0, l] }
    gravity g along -world.z;

    actuator f on d/dt(x);
    output x: m;
}

//! Time per call of the functions of every bundled robot, in double and in single precision, with
//! parameters at run time and baked.

use divan::{Bencher, black_box};
use shapebot_dynamics::nalgebra::SVector;
use shapebot_dynamics::{LagrangianSystem as _, Real, Robot, ShapeAccelerated as _};
use shapebot_tests::states::states;

fn main() {
    divan::main();
}

fn cast<T: Real, const L: usize>(x: &SVector<f64, L>) -> SVector<T, L> {
    x.map(T::from_f64)
}

/// Benchmarks of one type; `robot::<T>()` makes it.
macro_rules! functions {
    ($description:expr, $n:literal, $nx:literal, $ns:literal) => {
        functions!(@each $description, $n, $nx, $ns;
            mass_matrix |r, q, qd, qdd, s| r.mass_matrix(q);
            coriolis_vector |r, q, qd, qdd, s| r.coriolis_vector(q, qd);
            gravity |r, q, qd, qdd, s| r.gravity(q);
            motion |r, q, qd, qdd, s| r.motion(q, qd);
            forward_dynamics |r, q, qd, qdd, s| r.forward_dynamics(q, qd, qdd);
            gamma |r, q, qd, qdd, s| r.gamma(&s[0], &s[1], &s[2]);
            response |r, q, qd, qdd, s| r.response(&s[0], &s[1], &s[2]);
        );
    };
    (@each $description:expr, $n:literal, $nx:literal, $ns:literal; $($name:ident
        |$r:ident, $q:ident, $qd:ident, $qdd:ident, $s:ident| $call:expr;)*) => {$(
        #[divan::bench(types = [f64, f32])]
        fn $name<T: Real>(bencher: Bencher<'_, '_>) {
            let robot = robot::<T>();
            let state = states::<$n>($description, 1)[0];
            let [q, qd, qdd] = [state.q, state.qd, state.qdd].map(|v| cast::<T, $n>(&v));
            let shape = [q, qd, qdd].map(|v| SVector::<T, $ns>::from_fn(|i, _| v[$nx + i]));
            bencher.bench_local(|| {
                let ($r, $q, $qd, $qdd, $s) = black_box((&robot, &q, &qd, &qdd, &shape));
                let _ = ($q, $qd, $qdd, $s);
                $call
            });
        }
    )*};
}

macro_rules! robots {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        $(mod $module {
            mod at_run_time {
                use crate::*;
                use shapebot_generated::$module::{$robot, DESCRIPTION};
                fn robot<T: Real>() -> $robot<T> {
                    $robot::from_model()
                }
                functions!(&DESCRIPTION, $n, $nx, $ns);
            }
            mod baked {
                use crate::*;
                use shapebot_generated::$module::{$baked, DESCRIPTION};
                fn robot<T: Real>() -> impl Robot<T, $n, $nx, $ns> {
                    $baked
                }
                functions!(&DESCRIPTION, $n, $nx, $ns);
            }
        })*
    };
}

shapebot_generated::for_each_robot!(robots);

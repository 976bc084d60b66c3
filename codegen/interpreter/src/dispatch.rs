//! From sizes that a model has to sizes that the compiler knows.

/// Runs an expression with a model behind the runtime traits at the model's own sizes.
///
/// `tapes` is a [`Tapes`](crate::Tapes); in the expression the name given between the bars is an
/// [`Interpreted`](crate::Interpreted) of matching sizes. The result is `Ok` of the expression's value,
/// or an [`Error`](crate::Error) if the model is not shape-accelerated or of sizes that are not
/// compiled in: 1 to 3 position variables and 1 to 4 shape sets.
///
/// ```
/// # fn f(tapes: shapebot_interpreter::Tapes) {
/// use shapebot_dynamics::ShapeAccelerated;
///
/// let entries = shapebot_interpreter::with_interpreted!(tapes, |robot| robot.shape_gain().len());
/// # let _: Result<usize, shapebot_interpreter::Error> = entries;
/// # }
/// ```
#[macro_export]
macro_rules! with_interpreted {
    ($tapes:expr, |$robot:ident| $body:expr) => {
        $crate::with_interpreted!(@sizes $tapes, |$robot| $body,
            (1, 1), (1, 2), (1, 3), (1, 4),
            (2, 2), (2, 4), (2, 6), (2, 8),
            (3, 3), (3, 6), (3, 9), (3, 12))
    };
    (@sizes $tapes:expr, |$robot:ident| $body:expr, $(($nx:literal, $ns:literal)),*) => {{
        let tapes: $crate::Tapes<_> = $tapes;
        match $crate::sizes(&tapes) {
            Err(error) => Err(error),
            $(Ok(($nx, $ns)) => {
                $crate::Interpreted::<{ $nx + $ns }, $nx, $ns, _>::from_tapes(tapes).map(|$robot| $body)
            })*
            Ok((positions, shapes)) => Err($crate::Error::UnsupportedDimensions { positions, shapes }),
        }
    }};
}

/// (n_x, n_s) of a model.
///
/// # Errors
///
/// [`Error::NotShapeAccelerated`](crate::Error::NotShapeAccelerated).
pub fn sizes<T: shapebot_dynamics::Real>(
    tapes: &crate::Tapes<T>,
) -> Result<(usize, usize), crate::Error> {
    let description = tapes.description();
    if !tapes.has(shapebot_codegen::derive::Quantity::Response) {
        return Err(crate::Error::NotShapeAccelerated { model: description.name.to_owned() });
    }
    let positions = description.position_count;
    Ok((positions, description.coordinates.len() - positions))
}

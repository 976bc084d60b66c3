//! K⁰ and how the shape sets share the work.

use crate::common::robots::{CartPole, LinearArms, Robot, Spatial, TABLE_I};
use nalgebra::{Matrix2, Matrix2x6, SMatrix};
use shapebot_planner::{Error, Weighting};

type Gain = SMatrix<f64, 6, 2>;

/// χ₁/χ₃ and χ₂/χ₃ of Eq. 26 for Table I with arms of 1 kg.
const ARM: f64 = 0.720_981_694_100_992_3;
const BODY: f64 = 82.140_788_971_022_32;

fn shape_gain() -> Matrix2x6<f64> {
    Matrix2x6::new(
        0.0, -ARM, 0.0, -ARM, 0.0, BODY, //
        ARM, 0.0, ARM, 0.0, -BODY, 0.0,
    )
}

fn arms() -> Robot<LinearArms> {
    Robot(LinearArms { shape_gain: shape_gain(), tau_squared: 0.1 })
}

fn contributions(ratios: [f64; 3]) -> Result<Gain, Error> {
    Weighting::Contributions(&ratios).gain(&arms())
}

/// W of Eqs. 27-30.
fn paper_weight(ratios: [f64; 3]) -> SMatrix<f64, 6, 6> {
    let weights = [1.0 / ARM, 1.0 / ARM, 1.0 / BODY];
    SMatrix::from_fn(|i, j| if i == j { weights[i / 2] * ratios[i / 2].sqrt() } else { 0.0 })
}

fn close<const R: usize, const C: usize>(
    a: SMatrix<f64, R, C>,
    b: SMatrix<f64, R, C>,
    tolerance: f64,
) {
    assert!((a - b).abs().max() <= tolerance * b.abs().max(), "{a} {b}");
}

#[test]
fn contributions_are_equations_28_to_30() {
    for ratios in [[0.2, 0.3, 0.5], [1.0 / 3.0; 3], [0.25, 0.25, 0.5], [1e-6, 1e-6, 1.0 - 2e-6]] {
        let general = Weighting::Matrix(paper_weight(ratios)).gain(&arms()).expect("a gain");
        close(contributions(ratios).expect("a gain"), general, 1e-14);
    }
}

/// K⁰ of the reference cases with arms: equal thirds, arms alone, body alone.
#[test]
fn contributions_give_the_reference_gains() {
    let column = |ratios| {
        let gain = contributions(ratios).expect("a gain");
        [gain[(1, 0)], gain[(3, 0)], gain[(5, 0)]]
    };
    let expect = |found: [f64; 3], expected: [f64; 3]| {
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() <= 1e-12 * b.abs(), "{found:?} {expected:?}");
        }
    };
    let third = 1.0 / 3.0;
    expect(
        column([third; 3]),
        [-0.462_332_589_108_207_46, -0.462_332_589_108_207_46, 0.004_058_073_187_620_915],
    );
    expect(column([0.5, 0.5, 0.0]), [-0.693_498_883_662_311_2, -0.693_498_883_662_311_2, 0.0]);
    expect(column([0.0, 0.0, 1.0]), [0.0, 0.0, 0.012_174_219_562_862_74]);
}

#[test]
fn sets_without_contribution_stay_exactly_at_rest() {
    let gain = contributions([0.0, 1.0, 0.0]).expect("a gain");
    for row in [0, 1, 4, 5] {
        assert_eq!((gain[(row, 0)], gain[(row, 1)]), (0.0, 0.0));
    }
}

#[test]
fn every_weighting_inverts_the_shape_gain() {
    let skewed =
        SMatrix::<f64, 6, 6>::from_fn(|i, j| if i == j { 2.0 } else { 0.3 / (1 + i + j) as f64 });
    let ratios = [0.1, 0.2, 0.7];
    for weighting in
        [Weighting::MinimumNorm, Weighting::Contributions(&ratios), Weighting::Matrix(skewed)]
    {
        let gain: Gain = weighting.gain(&arms()).expect("a gain");
        close(shape_gain() * gain, Matrix2::identity(), 1e-14);
    }
}

/// With as many shape as position variables there is nothing to weigh: Eqs. 19 and 23.
#[test]
fn a_square_gain_does_not_depend_on_the_weighting() {
    let robot = Robot(Spatial(TABLE_I));
    let expected = Matrix2::new(0.0, -0.012_170_980_107_132_223, 0.012_170_980_107_132_223, 0.0);
    for weighting in [
        Weighting::MinimumNorm,
        Weighting::Contributions(&[1.0]),
        Weighting::Matrix(Matrix2::new(3.0, 1.0, 1.0, 2.0)),
    ] {
        close(weighting.gain(&robot).expect("a gain"), expected, 1e-12);
    }
}

#[test]
fn the_minimum_norm_gain_is_equation_24_without_weights() {
    let unweighted = Weighting::Matrix(SMatrix::identity()).gain(&arms()).expect("a gain");
    close(Weighting::MinimumNorm.gain(&arms()).expect("a gain"), unweighted, 1e-15);
}

#[test]
fn senseless_weights_are_refused_by_name() {
    let text = |result: Result<Gain, Error>| result.expect_err("refused").to_string();
    assert_eq!(text(contributions([0.0; 3])), "sum of the contributions is 0, expected 1");
    assert_eq!(text(contributions([0.5, 0.5, 0.5])), "sum of the contributions is 1.5, expected 1");
    assert_eq!(
        text(contributions([1.5, -0.5, 0.0])),
        "entry 1 of the contributions is -0.5, expected a finite number that is not negative"
    );
    assert!(
        text(contributions([f64::NAN, 0.5, 0.5]))
            .starts_with("entry 0 of the contributions is NaN")
    );
    let short = Weighting::Contributions(&[1.0]).gain(&arms());
    assert_eq!(text(short), "the number of contributions is 1, expected 3");
    let matrix = |weight| text(Weighting::Matrix(weight).gain(&arms()));
    let mut weight = SMatrix::<f64, 6, 6>::identity();
    weight[(4, 1)] = 0.5;
    assert_eq!(matrix(weight), "the weight matrix is not symmetric: see row 4");
    weight[(1, 4)] = 0.5;
    weight[(2, 2)] = -1.0;
    assert_eq!(matrix(weight), "the weight matrix is not positive definite: see row 2");
    weight[(2, 2)] = f64::NAN;
    assert_eq!(matrix(weight), "the weight matrix is not finite");
}

#[test]
fn a_shape_that_cannot_accelerate_the_robot_is_refused() {
    let mut shape_gain = shape_gain();
    shape_gain.fixed_columns_mut::<2>(2).fill(0.0);
    let robot = Robot(LinearArms { shape_gain, tau_squared: 0.0 });
    let refusal = Weighting::Contributions(&[0.5, 0.5, 0.0]).gain(&robot);
    assert_eq!(refusal, Err(Error::UselessShapeSet { set: "alpha_r" }));
    assert!(Weighting::Contributions(&[0.5, 0.0, 0.5]).gain(&robot).is_ok());
    shape_gain.row_mut(1).fill(0.0);
    let robot = Robot(LinearArms { shape_gain, tau_squared: 0.0 });
    let refusal = Weighting::<f64, 6>::MinimumNorm.gain(&robot);
    assert_eq!(refusal, Err(Error::Singular { matrix: "weighted shape gain" }));
}

#[test]
fn single_precision_gains_agree_with_double() {
    let robot = Robot(CartPole { length: 0.5 });
    let double: SMatrix<f64, 1, 1> = Weighting::MinimumNorm.gain(&robot).expect("a gain");
    let single: SMatrix<f32, 1, 1> = Weighting::MinimumNorm.gain(&robot).expect("a gain");
    assert!((f64::from(single[0]) - double[0]).abs() < 1e-8);
    let single: SMatrix<f32, 6, 2> =
        Weighting::Contributions(&[0.2_f32, 0.3, 0.5]).gain(&arms()).expect("a gain");
    close(single.map(f64::from), contributions([0.2, 0.3, 0.5]).expect("a gain"), 1e-6);
}

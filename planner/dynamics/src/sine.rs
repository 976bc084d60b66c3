//! Sine and cosine in single precision alone.
//!
//! The `libm` crate computes them in double precision, which a Cortex-M4F has in software only: a call
//! takes well over a thousand instructions there, this one some sixty.

/// Angles up to which this is used, radians: 256 quarter turns.
const BOUND: f32 = 402.0;

/// π/2 in parts of sixteen bits, sixteen bits and the rest: multiples of the first two by up to 256 are
/// exact.
const QUARTER: [f32; 3] = [1.570_770_3, 2.606_306_2e-5, 6.077_100_6e-11];

/// (sin r − r)/r³ on |r| ≤ π/4, in powers of r².
const SINE: [f32; 3] = [-0.166_666_55, 0.008_332_161, -0.000_195_149_54];

/// (cos r − 1 + r²/2)/r⁴ on |r| ≤ π/4, in powers of r².
const COSINE: [f32; 3] = [0.041_666_646, -0.001_388_731_2, 0.000_024_432_78];

/// Adding and subtracting it rounds to an integer; the sum's last bits are that integer's.
const ROUND: f32 = 12_582_912.0;

/// Sine and cosine of an angle in radians, each within one unit in its last place up to
/// [`BOUND`]; beyond that by the `libm` crate.
pub(crate) fn sin_cos(x: f32) -> (f32, f32) {
    // Also false for NaN.
    if x.abs() <= BOUND { reduced(x) } else { libm::sincosf(x) }
}

/// Reduction by Cody and Waite to |a| ≤ π/4, with the remainder e that a lacks: x = k π/2 + a − e.
#[inline]
fn reduced(x: f32) -> (f32, f32) {
    let [first, second, third] = QUARTER;
    let sum = x * core::f32::consts::FRAC_2_PI + ROUND;
    let k = sum - ROUND;
    let near = x - k * first;
    let step = k * second;
    let a = near - step;
    let e = (step - (near - a)) + k * third;
    let (sine, cosine) = kernel(a, e);
    let quarters = sum.to_bits();
    let (s, c) = if quarters & 1 == 0 { (sine, cosine) } else { (cosine, sine) };
    (negate_if(quarters & 2, s), negate_if((quarters + 1) & 2, c))
}

/// Sine and cosine of a − e: minimax polynomials in z = a², relative errors 2⁻²⁷ and 2⁻³².
#[inline]
fn kernel(a: f32, e: f32) -> (f32, f32) {
    let z = a * a;
    let p = SINE[0] + z * (SINE[1] + z * SINE[2]);
    let sine = a - (e - a * z * p);
    let half = 0.5 * z;
    let w = 1.0 - half;
    let q = COSINE[0] + z * (COSINE[1] + z * COSINE[2]);
    let cosine = w + (((1.0 - w) - half) + (z * z * q + a * e));
    (sine, cosine)
}

/// Changes the sign if bit 1 of `flag` is set.
#[inline]
fn negate_if(flag: u32, value: f32) -> f32 {
    f32::from_bits(value.to_bits() ^ (flag << 30))
}

#[cfg(test)]
mod tests {
    use super::{BOUND, QUARTER, sin_cos};

    /// Distance in units of the last place of the nearest single.
    fn units(found: f32, exact: f64) -> f64 {
        let nearest = (exact as f32).abs().max(f32::MIN_POSITIVE);
        let unit = f32::from_bits(nearest.to_bits() + 1) - nearest;
        (f64::from(found) - exact).abs() / f64::from(unit)
    }

    /// The largest error among every `stride`-th angle from zero to the bound.
    fn largest_error(stride: usize) -> f64 {
        let angles = (0..=BOUND.to_bits()).step_by(stride).map(f32::from_bits);
        angles.fold(0.0, |largest, angle| {
            let (sine, cosine) = sin_cos(angle);
            let (exact_sine, exact_cosine) = libm::sincos(f64::from(angle));
            let mirrored = sin_cos(-angle);
            assert_eq!(mirrored.0.to_bits(), (-sine).to_bits(), "{angle}");
            assert_eq!(mirrored.1.to_bits(), cosine.to_bits(), "{angle}");
            largest.max(units(sine, exact_sine)).max(units(cosine, exact_cosine))
        })
    }

    #[test]
    fn sine_and_cosine_are_within_one_unit_in_the_last_place() {
        let error = largest_error(1009);
        assert!((0.5..1.0).contains(&error), "{error}");
    }

    #[test]
    #[ignore = "all 1.1 thousand million angles: minutes"]
    fn sine_and_cosine_are_within_one_unit_at_every_angle() {
        assert!(largest_error(1) < 1.0);
    }

    #[test]
    fn angles_beside_multiples_of_a_quarter_turn_keep_their_digits() {
        for k in 0..=255_u32 {
            let multiple = (f64::from(k) * core::f64::consts::FRAC_PI_2) as f32;
            for bits in multiple.to_bits().saturating_sub(2)..=multiple.to_bits() + 2 {
                let angle = f32::from_bits(bits);
                let (sine, cosine) = sin_cos(angle);
                let exact = libm::sincos(f64::from(angle));
                assert!(units(sine, exact.0) < 1.0 && units(cosine, exact.1) < 1.0, "{angle}");
            }
        }
    }

    #[test]
    fn multiples_of_the_parts_of_a_quarter_turn_are_exact() {
        for part in &QUARTER[..2] {
            assert_eq!(part.to_bits().trailing_zeros().min(8), 8, "sixteen bits: {part}");
        }
        let sum: f64 = QUARTER.iter().map(|part| f64::from(*part)).sum();
        assert_eq!(sum.to_bits(), core::f64::consts::FRAC_PI_2.to_bits());
    }

    #[test]
    fn beyond_the_bound_and_without_a_number_the_library_answers() {
        for angle in [402.1, -1.0e6, f32::MAX] {
            assert_eq!(sin_cos(angle), libm::sincosf(angle));
        }
        for angle in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
            assert!(sin_cos(angle).0.is_nan() && sin_cos(angle).1.is_nan());
        }
    }
}

//! A plan file from anywhere: opened, and evaluated if it opens.

use shapebot_planner::value::{HEADER_BYTES, PlanView, Stored};

/// Bytes ahead of the file: what to mend, which bit to flip, and when to evaluate.
const CHOICES: usize = 1 + 4 + 8;

/// Takes [`CHOICES`] and a file.
///
/// # Panics
///
/// If a file is accepted that should not be, or an evaluation contradicts the file.
pub fn check(bytes: &[u8]) {
    let Some((choices, file)) = bytes.split_first_chunk::<CHOICES>() else { return };
    let [mend, b0, b1, b2, b3, time @ ..] = *choices;
    let mut file = file.to_vec();
    // Arbitrary bytes hardly ever have the right checksum.
    if mend & 1 == 1 {
        mend_checksum(&mut file);
    }
    let flip = u32::from_le_bytes([b0, b1, b2, b3]) as usize;
    let time = f64::from_le_bytes(time);
    one::<f32, 1, 1, 1>(&mut file.clone(), flip, time as f32);
    one::<f32, 2, 2, 2>(&mut file.clone(), flip, time as f32);
    one::<f64, 2, 6, 6>(&mut file, flip, time);
}

fn one<T, const NX: usize, const NS: usize, const F: usize>(file: &mut [u8], flip: usize, time: T)
where
    T: Stored + Send,
{
    let Ok(plan) = PlanView::<T, NX, NS, F>::open_any(file) else { return };
    assert!(plan.nodes() >= 2);
    let state = plan.at(time);
    // Compared as text: NaN is a number that a file may hold, and equal to itself here.
    assert_eq!(format!("{state:?}"), format!("{:?}", plan.at(time)), "another evaluation");
    if time < plan.start_time() || time > plan.end_time() {
        let still = |rate: T| rate == T::zero() || rate != rate;
        assert!(state.position[1].iter().chain(state.shape[1].iter()).all(|rate| still(*rate)));
    }
    // The checksum finds every error of one bit.
    let bit = flip % (file.len() * 8);
    file[bit / 8] ^= 1 << (bit % 8);
    assert!(PlanView::<T, NX, NS, F>::open_any(file).is_err(), "bit {bit} may be flipped");
}

/// Writes the checksum that belongs to the bytes before it.
fn mend_checksum(file: &mut [u8]) {
    if file.len() < HEADER_BYTES + 4 {
        return;
    }
    let (content, checksum) = file.split_at_mut(file.len() - 4);
    let mut crc = u32::MAX;
    for byte in content {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xEDB8_8320 & 0_u32.wrapping_sub(crc & 1));
        }
    }
    checksum.copy_from_slice(&(!crc).to_le_bytes());
}

#[cfg(test)]
mod tests {
    use super::{CHOICES, check, mend_checksum};
    use shapebot_planner::value::{HEADER_BYTES, PlanView, VERSION};

    /// A plan of two nodes for one position, one shape variable and one force, all numbers one.
    fn plan() -> Vec<u8> {
        let mut file = vec![0; HEADER_BYTES];
        file[..4].copy_from_slice(b"SBPL");
        file[4..6].copy_from_slice(&VERSION.to_le_bytes());
        file[6..8].copy_from_slice(&[4, 0]);
        for at in [8, 10, 12] {
            file[at] = 1;
        }
        file[16] = 2;
        file[32..40].copy_from_slice(&0.5_f64.to_le_bytes());
        for _ in 0..2 * 8 {
            file.extend(1.0_f32.to_le_bytes());
        }
        file.extend([0; 4]);
        file
    }

    #[test]
    fn a_mended_file_opens_and_is_evaluated() {
        let mut file = plan();
        assert!(PlanView::<f32, 1, 1, 1>::open_any(&file).is_err());
        mend_checksum(&mut file);
        let opened = PlanView::<f32, 1, 1, 1>::open_any(&file).expect("a plan");
        assert_eq!((opened.nodes(), opened.end_time()), (2, 0.5));
        for time in [-1.0, 0.2, 0.5, 7.0, f64::NAN, f64::INFINITY] {
            let mut bytes = vec![1; CHOICES - 8];
            bytes.extend(time.to_le_bytes());
            bytes.extend(plan());
            check(&bytes);
        }
    }
}

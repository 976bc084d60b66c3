//! Where falls begin.

/// Up to where a robot stands, and from where on it falls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onset {
    /// The largest size that was borne.
    pub stands: f64,
    /// The smallest one that was not; none up to the limit.
    pub falls: Option<f64>,
}

/// Doubles a disturbance from `first` until the robot falls or `limit` is reached, then halves the gap
/// until its ends differ by `precision` (relative).
///
/// What is found is one place where falling begins; that nothing smaller makes it fall is assumed.
pub fn onset(first: f64, limit: f64, precision: f64, mut falls: impl FnMut(f64) -> bool) -> Onset {
    let (mut stands, mut size) = (0.0, first);
    let mut fallen = loop {
        if falls(size) {
            break size;
        }
        stands = size;
        if size >= limit {
            return Onset { stands, falls: None };
        }
        size = (2.0 * size).min(limit);
    };
    while fallen - stands > precision * fallen {
        let middle = 0.5 * (stands + fallen);
        if falls(middle) {
            fallen = middle;
        } else {
            stands = middle;
        }
    }
    Onset { stands, falls: Some(fallen) }
}

#[cfg(test)]
mod tests {
    use super::{Onset, onset};

    #[test]
    fn the_place_is_found_from_both_sides() {
        for edge in [0.3, 1.0, 7.7] {
            let found = onset(1.0, 16.0, 0.01, |size| size >= edge);
            let falls = found.falls.unwrap();
            assert!(found.stands < edge && edge <= falls, "{found:?}");
            assert!(falls - found.stands <= 0.01 * falls);
        }
    }

    #[test]
    fn what_never_falls_has_no_place() {
        assert_eq!(onset(1.0, 10.0, 0.01, |_| false), Onset { stands: 10.0, falls: None });
    }
}

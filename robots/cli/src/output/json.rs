//! Numbers and arrays as JSON text, without intermediate values.

/// A line of JSON under construction.
#[derive(Default)]
pub(crate) struct Json {
    text: String,
}

impl Json {
    /// Starts over, keeping the memory.
    pub(crate) fn clear(&mut self) {
        self.text.clear();
    }

    /// What was written.
    pub(crate) fn as_bytes(&self) -> &[u8] {
        self.text.as_bytes()
    }

    /// What was written.
    pub(crate) fn into_text(self) -> String {
        self.text
    }

    /// Appends text as it is.
    pub(crate) fn raw(&mut self, text: &str) {
        self.text.push_str(text);
    }

    /// The shortest text that reads back as the same double; `null` if it is not finite.
    pub(crate) fn number(&mut self, value: f64) {
        if value.to_bits() == 0 {
            // Most entries of sparse Jacobians.
            self.text.push('0');
        } else if value.is_finite() {
            let mut buffer = zmij::Buffer::new();
            self.text.push_str(buffer.format_finite(value));
        } else {
            self.raw("null");
        }
    }

    /// Nested lists of the given extents, last index fastest; a bare number without extents.
    pub(crate) fn array(&mut self, extents: &[usize], values: &[f64]) {
        let Some((&count, inner)) = extents.split_first() else {
            self.number(values.first().copied().unwrap_or(f64::NAN));
            return;
        };
        let size: usize = inner.iter().product();
        self.text.push('[');
        for i in 0..count {
            if i > 0 {
                self.text.push(',');
            }
            if inner.is_empty() {
                self.number(values.get(i).copied().unwrap_or(f64::NAN));
            } else {
                self.array(inner, values.get(i * size..(i + 1) * size).unwrap_or(&[]));
            }
        }
        self.text.push(']');
    }
}

#[cfg(test)]
mod tests {
    use super::Json;

    fn text(extents: &[usize], values: &[f64]) -> String {
        let mut json = Json::default();
        json.array(extents, values);
        json.into_text()
    }

    #[test]
    fn arrays_are_lists_of_rows() {
        assert_eq!(text(&[], &[1.5]), "1.5");
        assert_eq!(text(&[2], &[0.0, -2.5]), "[0,-2.5]");
        assert_eq!(text(&[2, 2], &[1.25, 2.5, 3.5, 4.5]), "[[1.25,2.5],[3.5,4.5]]");
        assert_eq!(text(&[1, 1, 2], &[0.5, f64::NAN]), "[[[0.5,null]]]");
        assert_eq!(text(&[2, 0], &[]), "[[],[]]");
    }

    #[test]
    fn numbers_read_back_as_the_same_double() {
        for value in [0.1, 1e300, -0.0, 5e-324, 1.0 / 3.0, 123_456_789.0, f64::MAX] {
            let back: f64 = serde_json::from_str(&text(&[], &[value])).unwrap();
            assert_eq!(back.to_bits(), value.to_bits());
        }
    }
}

//! Small dense linear algebra in doubles, by simple and robust methods: build scripts run unoptimised.

mod eigenvalues;
mod exponential;

pub(crate) use eigenvalues::eigenvalues;
pub(crate) use exponential::zero_order_hold;

/// A matrix, rows one after the other.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Matrix {
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    entries: Vec<f64>,
}

impl Matrix {
    pub(crate) fn zeros(rows: usize, columns: usize) -> Self {
        Self { rows, columns, entries: vec![0.0; rows * columns] }
    }

    pub(crate) fn identity(size: usize) -> Self {
        Self::from_fn(size, size, |i, j| if i == j { 1.0 } else { 0.0 })
    }

    pub(crate) fn from_fn(
        rows: usize,
        columns: usize,
        mut entry: impl FnMut(usize, usize) -> f64,
    ) -> Self {
        let mut matrix = Self::zeros(rows, columns);
        for i in 0..rows {
            for j in 0..columns {
                matrix[(i, j)] = entry(i, j);
            }
        }
        matrix
    }

    /// From its entries, row by row.
    pub(crate) fn from_rows(rows: usize, columns: usize, entries: &[f64]) -> Option<Self> {
        let complete = entries.len() == rows * columns && entries.iter().all(|x| x.is_finite());
        complete.then(|| Self { rows, columns, entries: entries.to_vec() })
    }

    pub(crate) fn row(&self, i: usize) -> &[f64] {
        &self.entries[i * self.columns..(i + 1) * self.columns]
    }

    pub(crate) fn set_column(&mut self, j: usize, column: &[f64]) {
        for (i, &entry) in column.iter().enumerate() {
            self[(i, j)] = entry;
        }
    }

    /// The rows and columns of these indices.
    pub(crate) fn pick(&self, rows: &[usize], columns: &[usize]) -> Self {
        Self::from_fn(rows.len(), columns.len(), |i, j| self[(rows[i], columns[j])])
    }

    pub(crate) fn transpose(&self) -> Self {
        Self::from_fn(self.columns, self.rows, |i, j| self[(j, i)])
    }

    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self { entries: self.entries.iter().map(|x| x * factor).collect(), ..self.clone() }
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        let entries = self.entries.iter().zip(&other.entries).map(|(a, b)| a + b).collect();
        Self { entries, ..*self }
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        let mut product = Self::zeros(self.rows, other.columns);
        for i in 0..self.rows {
            for k in 0..self.columns {
                let factor = self[(i, k)];
                if factor == 0.0 {
                    continue;
                }
                for j in 0..other.columns {
                    product[(i, j)] += factor * other[(k, j)];
                }
            }
        }
        product
    }

    /// Matrix times vector.
    pub(crate) fn apply(&self, vector: &[f64]) -> Vec<f64> {
        let dot = |i| self.row(i).iter().zip(vector).map(|(a, b)| a * b).sum();
        (0..self.rows).map(dot).collect()
    }

    /// Largest magnitude.
    pub(crate) fn largest(&self) -> f64 {
        self.entries.iter().fold(0.0, |m, x| m.max(x.abs()))
    }

    /// A⁻¹ B by elimination with row pivoting; `None` if A is singular to working precision.
    pub(crate) fn solve(&self, b: &Self) -> Option<Self> {
        let n = self.rows;
        let (mut a, mut x) = (self.clone(), b.clone());
        let scale = self.largest();
        for k in 0..n {
            let pivot = (k..n).max_by(|&i, &j| a[(i, k)].abs().total_cmp(&a[(j, k)].abs()))?;
            let usable = a[(pivot, k)].abs() > 1e-13 * scale;
            if !usable {
                return None;
            }
            a.swap_rows(pivot, k);
            x.swap_rows(pivot, k);
            for i in (0..n).filter(|&i| i != k) {
                let factor = a[(i, k)] / a[(k, k)];
                a.subtract_row(i, k, factor);
                x.subtract_row(i, k, factor);
            }
        }
        Some(Self::from_fn(n, b.columns, |i, j| x[(i, j)] / a[(i, i)]))
    }

    pub(crate) fn inverse(&self) -> Option<Self> {
        self.solve(&Self::identity(self.rows))
    }

    fn swap_rows(&mut self, i: usize, j: usize) {
        for k in 0..self.columns {
            self.entries.swap(i * self.columns + k, j * self.columns + k);
        }
    }

    fn subtract_row(&mut self, target: usize, source: usize, factor: f64) {
        if factor == 0.0 {
            return;
        }
        for k in 0..self.columns {
            let part = factor * self[(source, k)];
            self[(target, k)] -= part;
        }
    }
}

impl std::ops::Index<(usize, usize)> for Matrix {
    type Output = f64;

    fn index(&self, (i, j): (usize, usize)) -> &f64 {
        &self.entries[i * self.columns + j]
    }
}

impl std::ops::IndexMut<(usize, usize)> for Matrix {
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut f64 {
        &mut self.entries[i * self.columns + j]
    }
}

//! Moments of a column of numbers.

/// Count, extrema, mean and standard deviation of the numbers of a column; NaN is excluded.
///
/// ```text
///    m = m_a + (m_b − m_a) n_b / n        S = S_a + S_b + (m_b − m_a)² n_a n_b / n
/// ```
/// # Source
/// \[Chan\]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// How many numbers.
    pub count: u64,
    /// Least, ∞ without numbers.
    pub min: f64,
    /// Greatest, −∞ without numbers.
    pub max: f64,
    /// Mean m.
    pub mean: f64,
    /// Sum S of the squared distances from the mean.
    pub squares: f64,
}

impl Default for Moments {
    fn default() -> Self {
        let (min, max) = (f64::INFINITY, f64::NEG_INFINITY);
        Self { count: 0, min, max, mean: 0.0, squares: 0.0 }
    }
}

impl Moments {
    /// Of a column.
    #[must_use]
    pub fn of(column: &[f64]) -> Self {
        let numbers = || column.iter().copied().filter(|value| !value.is_nan());
        let count = numbers().count() as u64;
        if count == 0 {
            return Self::default();
        }
        let min = numbers().fold(f64::INFINITY, f64::min);
        let max = numbers().fold(f64::NEG_INFINITY, f64::max);
        // From a number among them, so that a mean of equal numbers is that number.
        let start = numbers().next().unwrap_or_default();
        let mean = start + numbers().map(|value| value - start).sum::<f64>() / count as f64;
        let squares = numbers().map(|value| (value - mean).powi(2)).sum();
        Self { count, min, max, mean, squares }
    }

    /// Of two columns, this one first.
    pub fn add(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        if self.count == 0 {
            *self = *other;
            return;
        }
        let (before, more) = (self.count as f64, other.count as f64);
        let (sum, apart) = (before + more, other.mean - self.mean);
        self.count += other.count;
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
        self.mean += apart * (more / sum);
        self.squares += other.squares + apart * apart * (before * more / sum);
    }

    /// Standard deviation of the numbers as a sample, √(S / (n − 1)); `None` for fewer than two.
    #[must_use]
    pub fn deviation(&self) -> Option<f64> {
        (self.count > 1).then(|| (self.squares / (self.count - 1) as f64).sqrt())
    }
}

//! States of instances, and their bytes.

use nalgebra::DVector;

use super::error::Error;
use super::solved::Solved;

/// Begins the bytes of a state.
const MARK: &[u8; 8] = b"JPFMU 1\0";

/// A copy of everything that changes in an instance.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    pub(super) token: String,
    pub(super) time: f64,
    pub(super) drives: Vec<f64>,
    pub(super) solved: Solved,
}

impl State {
    /// Number of the bytes of [`to_bytes`](Self::to_bytes).
    #[must_use]
    pub fn byte_count(&self) -> usize {
        let Solved { drives, coordinates, outputs } = &self.solved;
        let numbers = 1 + self.drives.len() + drives.len() + coordinates.len() + outputs.len();
        MARK.len() + self.token.len() + numbers * size_of::<f64>()
    }

    /// The state as bytes, for an instance of the same unit on any machine.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let Solved { drives, coordinates, outputs } = &self.solved;
        let numbers = std::iter::once(&self.time).chain(&self.drives).chain(drives);
        let numbers = numbers.chain(coordinates.iter()).chain(outputs);
        let mut bytes = Vec::with_capacity(self.byte_count());
        bytes.extend_from_slice(MARK);
        bytes.extend_from_slice(self.token.as_bytes());
        numbers.for_each(|number| bytes.extend_from_slice(&number.to_le_bytes()));
        bytes
    }

    /// # Arguments
    /// * `like` – any configuration of the unit, for the numbers of numbers
    pub(super) fn from_bytes(bytes: &[u8], token: &str, like: &Solved) -> Result<Self, Error> {
        let refused = |message: String| Error::State { message };
        let rest = bytes.strip_prefix(MARK).ok_or_else(|| refused("unknown bytes".to_owned()))?;
        let rest = rest.strip_prefix(token.as_bytes());
        let rest = rest.ok_or_else(|| refused("another token".to_owned()))?;
        let (drives, coordinates) = (like.drives.len(), like.coordinates.len());
        let count = 1 + 2 * drives + coordinates + like.outputs.len();
        let expected = count * size_of::<f64>();
        if rest.len() != expected {
            let message = format!("{} bytes of numbers, {expected} expected", rest.len());
            return Err(refused(message));
        }
        let (numbers, _) = rest.as_chunks::<8>();
        let numbers: Vec<f64> = numbers.iter().map(|&bytes| f64::from_le_bytes(bytes)).collect();
        if let Some(value) = numbers.iter().find(|value| !value.is_finite()) {
            return Err(refused(format!("the number {value}")));
        }
        let (set, numbers) = numbers[1..].split_at(drives);
        let (solved, numbers_left) = numbers.split_at(drives);
        let (coordinates, outputs) = numbers_left.split_at(coordinates);
        let time = f64::from_le_bytes(rest[..8].try_into().expect("eight bytes"));
        Ok(Self {
            token: token.to_owned(),
            time,
            drives: set.to_vec(),
            solved: Solved {
                drives: solved.to_vec(),
                coordinates: DVector::from_column_slice(coordinates),
                outputs: outputs.to_vec(),
            },
        })
    }

    /// Refuses a state of another unit.
    pub(super) fn check(&self, token: &str, like: &Solved) -> Result<(), Error> {
        let Solved { drives, coordinates, outputs } = &self.solved;
        let same = self.token == token
            && drives.len() == like.drives.len()
            && coordinates.len() == like.coordinates.len()
            && outputs.len() == like.outputs.len();
        if same { Ok(()) } else { Err(Error::State { message: "another token".to_owned() }) }
    }
}

//! Motions that commands leave undetermined.

use nalgebra::DVector;

/// Why there are no velocities: the commanded coordinates do not determine the motion.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "the commanded coordinates leave {motions} motion{} undetermined; the singular values of the loops with them held are {}; command more coordinates, remove the spin of a bar between two balls by a universal joint at one end, or choose a configuration that is not singular",
    if *motions == 1 { "" } else { "s" },
    listed(singular_values)
)]
pub struct Undetermined {
    /// Number of independent motions with the commanded coordinates held.
    pub motions: usize,
    /// Singular values of the equations of the loops, one for each other coordinate, in radians and characteristic lengths, largest first; zeros are freedoms that loops and commands leave.
    pub singular_values: DVector<f64>,
}

fn listed(values: &DVector<f64>) -> String {
    let listed: Vec<String> = values.iter().map(|value| format!("{value:.3e}")).collect();
    if listed.is_empty() { "none".to_owned() } else { listed.join(", ") }
}

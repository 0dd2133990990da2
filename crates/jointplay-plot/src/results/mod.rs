//! Figures of this project's own results, in millimetres, micrometres and degrees.

mod coincident;
mod comparison;
mod motion;
mod study;

pub use comparison::comparison;
pub use motion::{Follower, motion};
pub use study::{rods, sides, virtual_joints};

/// A series' name as a symbol: `phi2` → φ₂, `L12` → L₁₂.
fn symbol(name: &str) -> String {
    let greek = name.replace("phi", "φ");
    let subscript = |letter: char| match letter.to_digit(10) {
        Some(digit) => {
            char::from_u32(u32::from('₀') + digit).expect("ten subscript digits in a row")
        }
        None => letter,
    };
    greek.chars().map(subscript).collect()
}

#[cfg(test)]
mod tests {
    use super::symbol;

    #[test]
    fn symbols() {
        assert_eq!(["phi2", "dphi3", "L12", "q1"].map(symbol), ["φ₂", "dφ₃", "L₁₂", "q₁"]);
    }
}

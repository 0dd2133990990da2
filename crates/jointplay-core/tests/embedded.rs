//! The program for microcontrollers gives the same numbers with the standard library as QEMU's Cortex-M4 gives without it.

#[path = "../../../examples/embedded/src/poses.rs"]
mod poses;

/// Output of `examples/embedded` on mps2-an386, checked by `cargo xtask embedded`.
const ON_THE_BOARD: &str = include_str!("../../../examples/embedded/poses.txt");

/// Largest difference, of numbers above one relative to them.
///
/// With the standard library poses come from closed equations, without it from the general iteration: they differ by round-off, of which Jacobians of nearly level platforms have the most.
const BOUND: f64 = 1e-12;

#[test]
fn a_microcontroller_computes_the_same_numbers() {
    let mut here = String::new();
    poses::write_poses(&mut here).unwrap();
    let separators: &[char] = &[' ', ',', '[', ']', '\n', ';'];
    let words = |text: &str| -> Vec<String> {
        text.split(separators).filter(|word| !word.is_empty()).map(str::to_owned).collect()
    };
    let (here, there) = (words(&here), words(ON_THE_BOARD));
    assert_eq!(here.len(), there.len());
    let mut numbers = 0;
    for (here, there) in here.iter().zip(&there) {
        match (here.parse::<f64>(), there.parse::<f64>()) {
            (Ok(here), Ok(there)) => {
                let off = (here - there).abs() / here.abs().max(1.0);
                assert!(off <= BOUND, "{here:?} here, {there:?} on the board");
                numbers += 1;
            }
            _ => assert_eq!(here, there),
        }
    }
    assert!(numbers > 1000, "{numbers}");
    assert!(ON_THE_BOARD.contains("beyond the robot's limits"));
    assert!(ON_THE_BOARD.contains("did not converge"));
}

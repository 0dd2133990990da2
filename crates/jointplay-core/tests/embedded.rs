//! The program for microcontrollers gives the same digits with the standard library as QEMU's Cortex-M4 gives without it.

#[path = "../../../examples/embedded/src/poses.rs"]
mod poses;

/// Output of `examples/embedded` on mps2-an386, checked by `cargo xtask embedded`.
const ON_THE_BOARD: &str = include_str!("../../../examples/embedded/poses.txt");

#[test]
fn a_microcontroller_computes_the_same_digits() {
    let mut here = String::new();
    poses::write_poses(&mut here).unwrap();
    for (line, (here, there)) in here.lines().zip(ON_THE_BOARD.lines()).enumerate() {
        assert_eq!(here, there, "line {} of examples/embedded/poses.txt", line + 1);
    }
    assert_eq!(here.lines().count(), ON_THE_BOARD.lines().count());
    assert!(here.contains("beyond the robot's limits") && here.contains("did not converge"));
}

//! Mobility by counting.

/// Freedoms of a spatial mechanism by the Kutzbach–Grübler count.
///
/// ```text
///    h  =  6 (links − 1 − joints)  +  Σ f_j
/// ```
/// Knows nothing of dimensions: redundant constraints and special geometry make it too small, often negative.
///
/// # Arguments
/// * `links` – number of links, the base among them
/// * `joint_freedoms` – freedoms f_j of each joint
///
/// # Source
/// \[Gogu\]
#[must_use]
pub fn kutzbach_mobility(links: usize, joint_freedoms: &[usize]) -> i64 {
    let count = |n: usize| i64::try_from(n).unwrap_or(i64::MAX / 16);
    let freedoms: usize = joint_freedoms.iter().sum();
    6 * (count(links) - 1 - count(joint_freedoms.len())) + count(freedoms)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(links: usize, joint_freedoms: &[usize], expected: i64) {
        assert_eq!(kutzbach_mobility(links, joint_freedoms), expected);
    }

    #[test]
    fn counts_from_textbooks() {
        check(1, &[], 0);
        check(2, &[1], 1);
        // Three rods under a platform on ball joints.
        check(5, &[1, 1, 1, 3, 3, 3], 0);
        // The planar four-bar and Bennett's linkage count alike, and both move.
        check(4, &[1; 4], -2);
        check(6, &[1; 6], 0);
        check(7, &[1; 7], 1);
        // Stewart platform with universal, prismatic and ball joints.
        check(14, &[[2; 6], [1; 6], [3; 6]].concat(), 6);
        // Two links side by side without a joint.
        check(3, &[], 12);
    }
}

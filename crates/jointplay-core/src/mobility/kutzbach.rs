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
/// [Angeles], section 2.4
#[must_use]
pub fn kutzbach_mobility(links: usize, joint_freedoms: &[usize]) -> i64 {
    let count = |n: usize| i64::try_from(n).unwrap_or(i64::MAX / 16);
    let freedoms: usize = joint_freedoms.iter().sum();
    6 * (count(links) - 1 - count(joint_freedoms.len())) + count(freedoms)
}

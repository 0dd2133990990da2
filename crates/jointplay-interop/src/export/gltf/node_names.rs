//! Nodes of a file of parts by their names.

use std::collections::BTreeMap;

/// The outermost nodes of each name, so that parts of a part with its own name do not count.
pub(super) struct NodeNames {
    /// Nodes by their names.
    exact: BTreeMap<String, Vec<usize>>,
    /// Nodes by their names without regard to case, spaces and dashes.
    plain: BTreeMap<String, Vec<usize>>,
}

impl NodeNames {
    /// # Arguments
    /// * `names` – of the nodes that have one
    /// * `parents` – of each node, without a circle
    pub(super) fn new(names: &[Option<&str>], parents: &[Option<usize>]) -> Self {
        let exact: Vec<_> = names.iter().map(|name| name.map(str::to_owned)).collect();
        let plainly: Vec<_> = names.iter().map(|name| name.map(plain)).collect();
        Self { exact: outermost(&exact, parents), plain: outermost(&plainly, parents) }
    }

    /// The outermost nodes of a name; without one, those that differ from it in case, spaces and dashes only.
    pub(super) fn find(&self, name: &str) -> &[usize] {
        let exact = self.exact(name);
        if exact.is_empty() {
            self.plain.get(&plain(name)).map_or(&[], Vec::as_slice)
        } else {
            exact
        }
    }

    /// The outermost nodes of exactly this name.
    pub(super) fn exact(&self, name: &str) -> &[usize] {
        self.exact.get(name).map_or(&[], Vec::as_slice)
    }
}

/// A name without the differences that CAD programs make.
fn plain(name: &str) -> String {
    name.trim().to_lowercase().replace(['_', '-'], " ")
}

/// Nodes of each name, in the order of the file, without those that are within another one of the name.
fn outermost(names: &[Option<String>], parents: &[Option<usize>]) -> BTreeMap<String, Vec<usize>> {
    let mut children = vec![Vec::new(); names.len()];
    let mut roots = Vec::new();
    for (node, parent) in parents.iter().enumerate() {
        match parent {
            Some(parent) => children[*parent].push(node),
            None => roots.push(node),
        }
    }
    let mut found: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    // How many of the ancestors have a name.
    let mut above: BTreeMap<&str, usize> = BTreeMap::new();
    let mut open: Vec<(usize, bool)> = roots.into_iter().rev().map(|root| (root, false)).collect();
    while let Some((node, is_left)) = open.pop() {
        let name = names[node].as_deref();
        if is_left {
            if let Some(count) = name.and_then(|name| above.get_mut(name)) {
                *count -= 1;
            }
            continue;
        }
        if let Some(name) = name {
            let count = above.entry(name).or_default();
            if *count == 0 {
                found.entry(name.to_owned()).or_default().push(node);
            }
            *count += 1;
        }
        open.push((node, true));
        open.extend(children[node].iter().rev().map(|&child| (child, false)));
    }
    found.values_mut().for_each(|nodes| nodes.sort_unstable());
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The definition, node by node.
        #[test]
        fn outermost_nodes_are_those_without_an_ancestor_of_the_name(
            shape in prop::collection::vec((0..4_usize, any::<bool>(), 0.0..1.0_f64), 1..40),
        ) {
            let letters = ["Plate", "plate", "pl-ate", "pin"];
            let names: Vec<Option<&str>> =
                shape.iter().map(|&(name, has, _)| has.then_some(letters[name])).collect();
            let parents: Vec<Option<usize>> = shape
                .iter()
                .enumerate()
                .map(|(node, &(_, _, part))| (node > 0 && part < 0.8).then_some((part * node as f64) as usize))
                .collect();
            let found = NodeNames::new(&names, &parents);
            let expected = |is_name: &dyn Fn(&str) -> bool| -> Vec<usize> {
                let named = |node: usize| names[node].is_some_and(is_name);
                let ancestors = |node: usize| std::iter::successors(parents[node], |&node| parents[node]);
                (0..names.len()).filter(|&node| named(node) && !ancestors(node).any(named)).collect()
            };
            for name in letters.into_iter().chain(["PIN", "none"]) {
                let exact = expected(&|other| other == name);
                prop_assert_eq!(found.exact(name), &exact[..]);
                let plainly = expected(&|other| plain(other) == plain(name));
                prop_assert_eq!(found.find(name), if exact.is_empty() { &plainly[..] } else { &exact[..] });
            }
        }
    }
}

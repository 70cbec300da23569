//! Circles in a graph of files.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// Files, and for each the files that it imports from, by index into `files`.
pub(super) struct Graph {
    /// Paths below `src`.
    pub(super) files: Vec<String>,
    pub(super) arrows: Vec<BTreeSet<usize>>,
}

impl Graph {
    /// The folder that a file belongs to; `wind.rs` belongs to `wind/` when that folder has files.
    fn folder(&self, file: usize) -> &str {
        let path = &self.files[file];
        let stem = path.trim_end_matches(".rs");
        let has_children = self.files.iter().any(|other| other.strip_prefix(stem).is_some_and(|rest| rest.starts_with('/')));
        if has_children { stem } else { path.rsplit_once('/').map_or("", |(dir, _)| dir) }
    }

    /// The shortest path along arrows, both ends included; if `is_long`, not by the direct arrow.
    fn way(&self, from: usize, to: usize, is_long: bool) -> Option<Vec<usize>> {
        let mut before = BTreeMap::from([(from, from)]);
        let mut queue = VecDeque::from([from]);
        while let Some(at) = queue.pop_front() {
            for &next in self.arrows[at].iter().filter(|next| !(is_long && at == from && **next == to)) {
                if before.contains_key(&next) {
                    continue;
                }
                before.insert(next, at);
                if next == to {
                    let mut way: Vec<usize> = std::iter::successors(Some(to), |at| (*at != from).then(|| before[at])).collect();
                    way.reverse();
                    return Some(way);
                }
                queue.push_back(next);
            }
        }
        None
    }

    /// Length of the longest chain of files, circles counted as one.
    fn floors(&self) -> usize {
        let meets: Vec<BTreeSet<usize>> = (0..self.files.len()).map(|file| self.reached(file)).collect();
        let mut floors = vec![0; self.files.len()];
        let mut order: Vec<usize> = (0..self.files.len()).collect();
        order.sort_by_key(|file| meets[*file].len());
        for file in order {
            let below = meets[file].iter().filter(|other| !meets[**other].contains(&file)).map(|other| floors[*other]);
            floors[file] = below.max().unwrap_or(0) + 1;
        }
        floors.into_iter().max().unwrap_or(0)
    }

    /// All files reachable along arrows, directly or not.
    fn reached(&self, file: usize) -> BTreeSet<usize> {
        let mut reached = BTreeSet::new();
        let mut next = vec![file];
        while let Some(at) = next.pop() {
            next.extend(self.arrows[at].iter().filter(|to| reached.insert(**to)));
        }
        reached
    }

    /// Number of files, floors and arrows, in words.
    pub(super) fn figures(&self) -> String {
        let arrows = self.arrows.iter().map(BTreeSet::len).sum::<usize>();
        let returned = self.arrows.iter().enumerate().flat_map(|(from, to)| to.iter().map(move |to| (from, *to)));
        let returned = returned.filter(|(from, to)| self.way(*to, *from, false).is_some()).count();
        format!("{} files on {} floors, {arrows} imports, {returned} of them on circles", self.files.len(), self.floors())
    }
}

/// Circles between files of different folders, and those of more than two files within one: the shortest through each import, as file names, the first
/// repeated at the end.
pub(super) fn circles(graph: &Graph) -> Vec<Vec<String>> {
    let mut found = BTreeSet::new();
    for (from, arrows) in graph.arrows.iter().enumerate() {
        for &to in arrows {
            let is_one_folder = graph.folder(from) == graph.folder(to);
            let Some(mut circle) = graph.way(to, from, is_one_folder) else { continue };
            let first = (0..circle.len()).min_by_key(|n| &graph.files[circle[*n]]).unwrap_or(0);
            circle.rotate_left(first);
            circle.push(circle[0]);
            found.insert(circle);
        }
    }
    found.iter().map(|circle| circle.iter().map(|file| graph.files[*file].clone()).collect()).collect()
}

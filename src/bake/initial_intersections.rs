//! What crosses in the garment as it comes, told by part: the contact leaves it alone until it comes apart.

use crate::garment::Garment;
use crate::math::Vec3;
use crate::mesh::intersections::self_intersections;
use std::collections::BTreeMap;

/// Pairs of parts named in the warning at most; the rest are counted.
const MOST: usize = 6;

/// A warning, if anything crosses: which parts, how often, and around where.
pub(super) fn crossing_warning(garment: &Garment) -> Option<String> {
    let found = self_intersections(&garment.points, &garment.triangles);
    if found.is_empty() {
        return None;
    }
    let mut by_parts: BTreeMap<[u32; 2], (usize, Vec3)> = BTreeMap::new();
    for pair in &found {
        let [a, b] = pair.map(|f| garment.triangle_part[f as usize]);
        let corners = pair.iter().flat_map(|f| garment.triangles[*f as usize]);
        let middle = corners.map(|p| garment.points[p.at()]).sum::<Vec3>() / 6.0;
        let entry = by_parts.entry([a.min(b), a.max(b)]).or_insert((0, Vec3::zeros()));
        entry.0 += 1;
        entry.1 += middle;
    }
    let mut parts: Vec<_> = by_parts.into_iter().collect();
    parts.sort_by_key(|(_, (count, _))| std::cmp::Reverse(*count));
    let tell = |([a, b], (count, sum)): &([u32; 2], (usize, Vec3))| {
        let place = sum / *count as f64;
        let who = if a == b { format!("part {a} with itself") } else { format!("part {a} with part {b}") };
        format!("{who} {count} (around {:.3}, {:.3}, {:.3} m)", place.x, place.y, place.z)
    };
    let mut told: Vec<String> = parts.iter().take(MOST).map(tell).collect();
    if parts.len() > MOST {
        told.push(format!("{} more pairs of parts", parts.len() - MOST));
    }
    Some(format!(
        "{} pairs of triangles cross at the start: {}; they are left alone until they come apart, and do not become more",
        found.len(),
        told.join(", ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{ReadOptions, read_asset};

    fn garment(text: &str) -> Garment {
        let asset =
            read_asset("a.obj", text.as_bytes(), &ReadOptions::default(), &mut |_: &str| Ok(Vec::new()));
        Garment::from_asset(&asset.expect("is a mesh").0).expect("is a garment").0
    }

    #[test]
    fn what_crosses_is_told_by_part() {
        let apart = "v -1 0 -1\nv 1 0 -1\nv 0 0 1\nv 0 1 0\nv -1 2 0\nv 1 2 0\nf 1 2 3\nf 4 5 6\n";
        assert_eq!(crossing_warning(&garment(apart)), None);
        let told = crossing_warning(&garment(&apart.replace("v 0 1 0", "v 0 -1 0"))).expect("crosses");
        assert!(
            told.starts_with("1 pairs of triangles cross at the start: part 0 with part 1 1 (around "),
            "{told}"
        );
    }
}

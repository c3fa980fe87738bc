//! The warning on intersections of the garment with itself before the run, by part: contact ignores such pairs until they
//! come apart.

use crate::bake::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::intersections::self_intersections;
use crease_model::garment::Garment;
use std::collections::BTreeMap;

/// A warning if anything intersects: which parts, how many pairs of triangles, and near which position.
pub(in crate::bake) fn warning(garment: &Garment) -> Option<String> {
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
    let describe = |([a, b], (count, sum)): &([u32; 2], (usize, Vec3))| {
        let position = sum / *count as f64;
        let parts = if a == b { format!("part {a} with itself") } else { format!("part {a} with part {b}") };
        format!("{parts} {count} (around {:.3}, {:.3}, {:.3} m)", position.x, position.y, position.z)
    };
    let mut listed: Vec<String> = parts.iter().take(TUNING.warnings.max_part_pairs).map(describe).collect();
    if parts.len() > TUNING.warnings.max_part_pairs {
        listed.push(format!("{} more pairs of parts", parts.len() - TUNING.warnings.max_part_pairs));
    }
    Some(format!(
        "{} pairs of triangles cross at the start: {}; they are left alone until they come apart, and do not become more",
        found.len(),
        listed.join(", ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crease_io::{ReadOptions, read_asset};

    fn garment(text: &str) -> Garment {
        let asset =
            read_asset("a.obj", text.as_bytes(), &ReadOptions::default(), &mut |_: &str| Ok(Vec::new()));
        Garment::from_asset(&asset.expect("is a mesh").0).expect("is a garment").0
    }

    #[test]
    fn intersections_are_reported_by_part() {
        let apart = "v -1 0 -1\nv 1 0 -1\nv 0 0 1\nv 0 1 0\nv -1 2 0\nv 1 2 0\nf 1 2 3\nf 4 5 6\n";
        assert_eq!(warning(&garment(apart)), None);
        let reported = warning(&garment(&apart.replace("v 0 1 0", "v 0 -1 0"))).expect("crosses");
        assert!(
            reported.starts_with("1 pairs of triangles cross at the start: part 0 with part 1 1 (around "),
            "{reported}"
        );
    }
}

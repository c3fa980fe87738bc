//! Impact zones: points that hit one another on their way move on together.
//!
//! Step sizes of single points (`contact::step_bounds`) stop layers that move along with one another: where one point is cut short, its
//! neighbour in the other layer runs into it, and in a few rounds all of them stand still. A zone keeps the motion that its points have
//! in common and scales only what they move relative to it, by one factor: pairs within it move relative to each other as they would
//! have, but not so far. (Zones that move rigidly are those of Provot 1997 and of Bridson, Fedkiw and Anderson 2002, for velocities
//! after a collision.)

use crate::contact::broad_phase::PrimitivePair;
use crate::contact::step_bounds::{Hit, find_hits};
use crate::contact::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::Groups;

/// Returns the displacement \[m\] in which the points of `pairs` that would come to their minimum distance move as zones, one entry per
/// point; `None` where there are none, or zones still hit something after some rounds. `min_distances[k]` \[m\] belongs to `pairs[k]`. In a
/// zone with a `fixed` point, one flag per point, the common motion is zero; the displacement of fixed points must be zero.
pub fn zone_displacement(
    pairs: &[PrimitivePair],
    min_distances: &[f64],
    positions: &[Vec3],
    displacement: &[Vec3],
    fixed: &[bool],
) -> Option<Vec<Vec3>> {
    if displacement.iter().any(|d| !d.sum().is_finite()) {
        return None;
    }
    let mut tested: Vec<u32> = (0..pairs.len() as u32).collect();
    let mut zones = Zones::new(displacement);
    let mut motion = displacement.to_vec();
    for round in 0..TUNING.step.max_zone_rounds {
        let hits = find_hits(&tested, pairs, min_distances, positions, &motion);
        if hits.is_empty() {
            return (round > 0).then_some(motion);
        }
        for &Hit { pair, fraction } in &hits {
            let k = pair as usize;
            // What counts is the pair's own motion, not that of its zones.
            let own = match round {
                0 => fraction,
                _ => pairs[k].collision_free_step_size(positions, displacement, min_distances[k]),
            };
            zones.join(&pairs[k], own);
        }
        let moved = zones.move_points(fixed, &mut motion);
        // A pair whose points move as before is hit again.
        if hits.iter().any(|hit| !pairs[hit.pair as usize].points.iter().any(|p| moved[p.at()])) {
            return None;
        }
        let concerned = |k: &u32| pairs[*k as usize].points.iter().any(|p| moved[p.at()]);
        tested = (0..pairs.len() as u32).filter(concerned).collect();
    }
    None
}

/// Groups of points that move together.
struct Zones<'a> {
    displacement: &'a [Vec3],
    groups: Groups,
    /// Pairs within zones, by their first point, and the fractions of their own motion that keep them apart.
    fractions: Vec<(u32, f64)>,
}

impl<'a> Zones<'a> {
    /// No zones yet.
    fn new(displacement: &'a [Vec3]) -> Self {
        Self { displacement, groups: Groups::new(displacement.len()), fractions: Vec::new() }
    }

    /// Joins the zones of the points of a pair, which stays apart for a `fraction` of its motion.
    fn join(&mut self, pair: &PrimitivePair, fraction: f64) {
        let [first, others @ ..] = pair.points.map(|p| p.0);
        others.iter().for_each(|p| self.groups.join(first, *p));
        self.fractions.push((first, fraction));
    }

    /// Sets the motion of all points in zones \[m\]. Returns whether it has changed, one flag per point.
    fn move_points(&mut self, fixed: &[bool], motion: &mut [Vec3]) -> Vec<bool> {
        let count = self.displacement.len();
        let zone_of: Vec<usize> = (0..count as u32).map(|p| self.groups.find(p) as usize).collect();
        let mut zones = vec![Zone { points: 0, sum: Vec3::zeros(), fixed: false, fraction: 1.0 }; count];
        for (p, d) in self.displacement.iter().enumerate() {
            let zone = &mut zones[zone_of[p]];
            zone.points += 1;
            zone.sum += d;
            zone.fixed |= fixed.get(p).copied().unwrap_or(false);
        }
        for &(p, fraction) in &self.fractions {
            let zone = &mut zones[zone_of[p as usize]];
            zone.fraction = zone.fraction.min(fraction);
        }
        let mut moved = vec![false; count];
        for (p, motion) in motion.iter_mut().enumerate() {
            let zone = &zones[zone_of[p]];
            if zone.points > 1 {
                let common = if zone.fixed { Vec3::zeros() } else { zone.sum / zone.points as f64 };
                let before =
                    std::mem::replace(motion, common + (self.displacement[p] - common) * zone.fraction);
                moved[p] = before != *motion;
            }
        }
        moved
    }
}

/// A group of points that moves together.
#[derive(Clone, Copy)]
struct Zone {
    points: usize,
    /// Sum of the displacements \[m\].
    sum: Vec3,
    /// Whether one of its points is fixed.
    fixed: bool,
    /// Factor on the displacement relative to the mean \[-\].
    fraction: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::step_bounds::local_step_fractions;
    use crate::contact::step_bounds::tests::{assert_apart, pairs, pile, thrown};

    const MIN_DISTANCE: f64 = 1e-4;

    /// Two layers 0.5 mm apart that move on by 20 mm, while the upper one sinks by 1 mm in its middle.
    fn pressed_on_the_way() -> (Vec<Vec3>, Vec<PrimitivePair>, Vec<Vec3>) {
        let (points, triangles) = pile(2, 6, 5e-4);
        let middle = Vec3::new(0.024, 0.024, 5e-4);
        let sink = |x: &Vec3| if (x - middle).norm() < 0.015 { -1e-3 } else { 0.0 };
        let displacement: Vec<Vec3> = points
            .iter()
            .map(|x| Vec3::new(0.02, 0.0, 0.01 + if x.z > 0.0 { sink(x) } else { 0.0 }))
            .collect();
        let pairs = pairs(&points, &triangles, &displacement);
        (points, pairs, displacement)
    }

    #[test]
    fn layers_that_move_along_with_one_another_do_not_stop_each_other() {
        let (points, pairs, displacement) = pressed_on_the_way();
        let min_distances = vec![MIN_DISTANCE; pairs.len()];
        let single = local_step_fractions(&pairs, &min_distances, &points, &displacement);
        let stopped = single.fraction.iter().filter(|f| **f < 0.1).count();
        assert!(stopped > 5, "the case is one that single step sizes stop: {stopped}");
        let motion = zone_displacement(&pairs, &min_distances, &points, &displacement, &[]).expect("zones");
        assert_apart(&pairs, &min_distances, &points, &motion);
        let lost = motion.iter().zip(&displacement).map(|(m, d)| (m - d).norm()).fold(0.0, f64::max);
        assert!(lost < 1e-3, "{lost}");
        let free = motion.iter().zip(&displacement).filter(|(m, d)| m == d).count();
        assert!(free > points.len() / 2, "only what is hit moves otherwise: {free} of {}", points.len());
    }

    #[test]
    fn a_zone_with_a_fixed_point_is_not_carried() {
        let (points, pairs, mut displacement) = pressed_on_the_way();
        let count = points.len();
        // The lower layer lies fixed below the sinking one.
        let fixed: Vec<bool> = (0..count).map(|p| p < count / 2).collect();
        displacement[..count / 2].fill(Vec3::zeros());
        displacement[count / 2..].iter_mut().for_each(|d| *d = Vec3::new(0.0, 0.0, -1e-3));
        let min_distances = vec![MIN_DISTANCE; pairs.len()];
        let motion =
            zone_displacement(&pairs, &min_distances, &points, &displacement, &fixed).expect("zones");
        assert!(motion[..count / 2].iter().all(|d| *d == Vec3::zeros()));
        assert_apart(&pairs, &min_distances, &points, &motion);
        assert!(
            motion[count / 2..].iter().any(|d| d.z < -3e-4 && d.z > -4.1e-4),
            "down to the least distance"
        );
    }

    #[test]
    fn there_are_no_zones_where_nothing_is_hit_or_something_is_not_finite() {
        let (points, pairs, mut displacement) = pressed_on_the_way();
        let min_distances = vec![MIN_DISTANCE; pairs.len()];
        let still = vec![Vec3::zeros(); points.len()];
        assert_eq!(zone_displacement(&pairs, &min_distances, &points, &still, &[]), None);
        displacement[3].y = f64::NAN;
        assert_eq!(zone_displacement(&pairs, &min_distances, &points, &displacement, &[]), None);
    }

    /// Whatever comes out keeps the pairs apart, for any order of them.
    #[test]
    fn layers_thrown_through_each_other_stay_apart() {
        let mut found = 0;
        for layers in [2, 3, 5] {
            let (points, triangles, displacement) = thrown(layers);
            let mut pairs = pairs(&points, &triangles, &displacement);
            let min_distances = vec![2e-4; pairs.len()];
            let motion = zone_displacement(&pairs, &min_distances, &points, &displacement, &[]);
            if let Some(motion) = &motion {
                assert_apart(&pairs, &min_distances, &points, motion);
                found += 1;
            }
            pairs.reverse();
            assert_eq!(zone_displacement(&pairs, &min_distances, &points, &displacement, &[]), motion);
        }
        assert!(found > 0);
    }
}

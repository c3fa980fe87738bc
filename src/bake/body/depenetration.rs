//! Depenetration: a garment that starts a little inside its body is brought out before the script begins.
//!
//! A few equilibria of the cloth with its membrane, its bending and a weak tether to the positions of its file, in which the
//! contact planes of the body push it out and self-contact keeps layers apart: no point moves farther than it takes to come
//! out and to keep its neighbours in shape. Single points that lie too deep to know a way out are led towards their neighbours;
//! where that does not bring them out they stay, without contact. A garment of which many points lie so deep does not fit and
//! is refused with the depth. Does not do: fitting a garment to another body, size or pose.

use crate::bake::body::coupling::SteppedCloth;
use crate::bake::body::static_contact::StaticContact;
use crate::bake::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::intersections::intersections_between;
use crease_geometry::mesh::point_in_solid::Solid;
use crease_model::body::AnimatedBody;
use crease_model::error::{Error, Result};
use crease_model::garment::Garment;
use crease_solver::contact::BodyPlanes;
use crease_solver::energy::{EdgeContacts, Energy, PlaneContacts, TargetSpring, TargetSprings};
use crease_solver::sim::NewtonOptions;

/// Outcome of the depenetration.
#[derive(Default)]
pub(in crate::bake) struct DepenetrationReport {
    /// Points of the garment that lay inside.
    inside: usize,
    /// Largest depth of a point inside [m].
    max_depth: f64,
    /// Points that lay too deep, and the position of the deepest [m].
    deep: Vec<usize>,
    deepest_position: Vec3,
    /// Those of them that stay where they are.
    left: usize,
    /// Intersecting pairs of triangles of garment and body before.
    crossing_before: usize,
    /// The same after.
    pub crossing_after: usize,
    /// Largest displacement of a point [m].
    max_displacement: f64,
    /// Linear solves of global Newton iterations.
    pub solves: u64,
    /// Linear solves of local Newton iterations.
    pub local_solves: u64,
}

impl DepenetrationReport {
    /// Warnings, if anything lay inside.
    pub fn warnings(&self) -> Vec<String> {
        let mut all = Vec::new();
        if self.crossing_before > 0 || self.inside > 0 {
            all.push(format!(
                "depenetration: {} points of the garment lay up to {:.1} mm inside the body, {} pairs of triangles crossed it: pushed out by \
                 up to {:.1} mm",
                self.inside,
                1e3 * self.max_depth,
                self.crossing_before,
                1e3 * self.max_displacement
            ));
        }
        if !self.deep.is_empty() {
            let p = self.deepest_position;
            all.push(format!(
                "depenetration: {} points lay deeper than {:.0} mm, the deepest by {:.1} mm at ({:.3}, {:.3}, {:.3}) m: {} led out towards \
                 their neighbours, {} left where they are",
                self.deep.len(),
                1e3 * TUNING.body.max_fit_depth,
                1e3 * self.max_depth,
                p.x,
                p.y,
                p.z,
                self.deep.len() - self.left,
                self.left
            ));
        } else if self.max_depth > TUNING.body.max_usual_depth {
            all.push(format!(
                "depenetration: {:.1} mm is more than the {:.0} mm that it is made for: check the fit",
                1e3 * self.max_depth,
                1e3 * TUNING.body.max_usual_depth
            ));
        }
        if self.crossing_after > 0 {
            all.push(format!(
                "depenetration: {} pairs of triangles still cross the body; they are left alone until they come apart",
                self.crossing_after
            ));
        }
        all
    }
}

/// Depth of every point inside the body [m], 0 outside. Fails if the garment does not fit the body.
pub(in crate::bake) fn penetration_depths(
    garment_points: &[Vec3],
    animated: &AnimatedBody,
) -> Result<Vec<f64>> {
    let limit = TUNING.body.max_fit_depth;
    let depths = Solid::new(animated.rest_points(), animated.triangles())
        .depths(garment_points, TUNING.body.depth_search);
    let (deepest, at) =
        depths.iter().copied().zip(0..).fold((0.0, 0), |max, d| if d.0 > max.0 { d } else { max });
    let count = depths.iter().filter(|d| **d > limit).count();
    if count as f64 <= TUNING.body.max_deep_fraction * depths.len() as f64 {
        return Ok(depths);
    }
    let position = garment_points.get(at).copied().unwrap_or_else(Vec3::zeros);
    let what = format!(
        "the garment lies up to {:.0} mm inside it, at ({:.3}, {:.3}, {:.3}) m; {count} points are deeper than {:.0} mm",
        1e3 * deepest,
        position.x,
        position.y,
        position.z,
        1e3 * limit
    );
    Err(Error::input(
        &animated.file,
        "",
        what,
        "fit the garment to this body first, or check the unit of both",
    ))
}

/// Pushes the cloth, whose points lie `depths` [m] inside, out of `animated` by its contact `planes`.
pub(in crate::bake) fn depenetrate(
    planes: &mut BodyPlanes,
    cloth: SteppedCloth,
    animated: &AnimatedBody,
    depths: &[f64],
) -> DepenetrationReport {
    let SteppedCloth { garment, stepper, state, rest } = cloth;
    let count = |x: &[Vec3]| {
        intersections_between(x, &garment.triangles, animated.rest_points(), animated.triangles()).len()
    };
    let limit = TUNING.body.max_fit_depth;
    let deepest = (0..depths.len()).fold(0, |best, p| if depths[p] > depths[best] { p } else { best });
    let mut report = DepenetrationReport {
        inside: depths.iter().filter(|d| **d > 0.0).count(),
        max_depth: depths.iter().copied().fold(0.0, f64::max),
        deep: (0..depths.len()).filter(|p| depths[*p] > limit).collect(),
        deepest_position: garment.points.get(deepest).copied().unwrap_or_default(),
        crossing_before: count(&state.x),
        ..DepenetrationReport::default()
    };
    if report.crossing_before == 0 && report.inside == 0 {
        return report;
    }
    let before = state.x.clone();
    let left = lead_out(garment, animated, &report.deep, &mut state.x);
    report.left = left.len();
    let is_left = |p: u32| left.contains(&(p as usize));
    let tuning = &TUNING.body;
    let stiffness = stepper.contact.settings().stiffness * tuning.dressing_tether;
    let tether =
        |(p, (x, area)): (usize, (&Vec3, &f64))| TargetSpring::isotropic(p as u32, *x, stiffness * area);
    let springs: Vec<TargetSpring> = before.iter().zip(&stepper.cloth.area).enumerate().map(tether).collect();
    let newton = NewtonOptions {
        max_iterations: tuning.dressing_iterations,
        rel_decrement_tol: 0.0,
        ..stepper.options.newton
    };
    let (membrane, bending) = (stepper.cloth.membrane.clone(), stepper.cloth.bending.clone());
    let mut contact = StaticContact::new(planes, garment, animated);
    let none_fixed = vec![false; state.x.len()];
    for round in 0..tuning.max_dressing_rounds {
        if round > 0 && count(&state.x) == 0 {
            break;
        }
        let mut found = contact.find(&state.x);
        found.planes.retain(|c| !is_left(c.point));
        found.edges.retain(|c| !c.points.iter().any(|p| is_left(*p)));
        let angle = bending.angles(&state.x, &state.angle);
        let membrane = membrane.term(rest, &[], f64::INFINITY);
        let bending = bending.term(rest, &angle, f64::INFINITY);
        let (tethers, on_planes, on_edges) =
            (TargetSprings(&springs), PlaneContacts(&found.planes), EdgeContacts(&found.edges));
        let terms: [&dyn Energy; 5] = [&membrane, &bending, &tethers, &on_planes, &on_edges];
        let solved = stepper.equilibrium(&mut state.x, &none_fixed, &terms, &newton);
        report.solves += solved.global_iterations as u64;
        report.local_solves += solved.local_iterations as u64;
        contact.accept(&state.x, &found);
    }
    state.angle = stepper.cloth.bending.angles(&state.x, &state.angle);
    state.stop();
    report.crossing_after = count(&state.x);
    report.max_displacement = before.iter().zip(&state.x).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    report
}

/// Moves the points `deep` of the cloth at `x` [m] towards the mean of their neighbours until they are outside, or as near
/// to the surface as contact reaches. Returns those that stay.
fn lead_out(garment: &Garment, body: &AnimatedBody, deep: &[usize], x: &mut [Vec3]) -> Vec<usize> {
    let mut left: Vec<usize> = deep.to_vec();
    if left.is_empty() {
        return left;
    }
    let solid = Solid::new(body.rest_points(), body.triangles());
    let mut neighbours = vec![Vec::new(); x.len()];
    for [a, b] in garment.topology.edges.iter().map(|edge| edge.map(|p| p.at())) {
        neighbours[a].push(b);
        neighbours[b].push(a);
    }
    // From the outside in: a point that is out leads its neighbours.
    for _ in 0..TUNING.body.lead_out_rounds {
        let mut still = Vec::new();
        for &p in &left {
            let free: Vec<Vec3> = neighbours[p].iter().filter(|q| !left.contains(q)).map(|q| x[*q]).collect();
            let mean = free.iter().sum::<Vec3>() / free.len().max(1) as f64;
            let steps = TUNING.body.lead_out_steps;
            let towards: Vec<Vec3> =
                (1..=steps).map(|k| x[p] + (mean - x[p]) * (f64::from(k) / f64::from(steps))).collect();
            let depths = solid.depths(&towards, TUNING.body.depth_search);
            let reach = TUNING.body.max_fit_depth;
            let out = towards.iter().zip(&depths).find(|(_, depth)| **depth == 0.0);
            let near = towards.iter().zip(&depths).rfind(|(_, depth)| **depth < reach);
            match out.or(near).filter(|_| !free.is_empty()) {
                Some((at, _)) => x[p] = *at,
                None => still.push(p),
            }
        }
        let stuck = still.len() == left.len();
        left = still;
        if stuck {
            break;
        }
    }
    left
}

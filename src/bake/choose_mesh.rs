//! The mesh that is simulated: one of the garment's surface, made for the script.
//!
//! Fold lines are drawn through every layer that they pass ([`crate::wear::draw_fold_lines`]); edges are short along them, along
//! borders and along sides, and grow away from there. A fold then bends along edges and leaves an even crease, whatever the
//! triangles of the file are. Where a script may crease the cloth anywhere, triangles are bisected during the wear where they
//! bend ([`RefinementRule`]).

use crate::bake::body::creases::CreasedCloth;
use crate::bake::tuning::TUNING;
use crate::bake::{BakeOptions, ModelDecision};
use crate::wear::{DrawnLines, Foresight, LayoutQuality, WearScript, draw_fold_lines, is_row};
use crease_geometry::math::{Vec3, bounds};
use crease_geometry::mesh::distance::point_triangle;
use crease_geometry::mesh::intersections::self_intersecting_triangles;
use crease_geometry::mesh::triangle;
use crease_model::error::Message;
use crease_model::fabric::Fabric;
use crease_model::garment::Garment;
use crease_model::remesh::{Curve, Seed, SimulationMesh, SizeField, SurfaceMesh, improve};

/// The mesh that is simulated for a garment.
#[derive(Debug, Clone)]
pub struct MeshChoice {
    /// The mesh at the start.
    pub mesh: SimulationMesh,
    /// How the mesh is refined during the wear; `None` for one that stays as it is.
    pub refinement: Option<RefinementRule>,
    /// Whether the garment has to be laid once before lines can be drawn: the mesh is the one to lay it on.
    pub lays_first: bool,
    /// How good the layout in the plane is, of a garment that does not lie in its file.
    pub layout: Option<LayoutQuality>,
    /// The decision, with its reason.
    pub decision: ModelDecision,
}

/// How a mesh is refined during the wear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RefinementRule {
    /// Index of the first action, in the flattened script, during which it is.
    pub from_action: usize,
    /// Length down to which triangles are bisected [m].
    pub finest_edge: f64,
}

/// Edge lengths of a mesh [m].
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeLengths {
    /// Along fold lines.
    pub line: f64,
    /// Across creases: the distance of the rows beside fold lines.
    row: f64,
    /// Where fold lines cross one another or the rim of the laid garment: a corner of many layers is folded there.
    crossing: f64,
    /// Along borders, seams and sides.
    side: f64,
    /// At most.
    pub max: f64,
    /// At most, on a garment with excess cloth.
    pub max_of_crumpled: f64,
    /// Finest, where the cloth may crease anywhere.
    anywhere: f64,
}

impl MeshChoice {
    /// Chooses the mesh for a bake of `garment`. `laid` are its positions after it was laid, one per point [m], if that has been
    /// done already.
    pub fn new(
        garment: &Garment,
        fabric: &Fabric,
        script: &WearScript,
        laid: Option<&[Vec3]>,
        options: &BakeOptions,
    ) -> Self {
        let own = |why: Message| Self {
            mesh: SimulationMesh::of_source(garment),
            refinement: None,
            lays_first: false,
            layout: None,
            decision: ModelDecision { name: "simulation mesh", on: false, why },
        };
        if options.own_triangles || options.full_fidelity {
            return own("switched off".into());
        }
        let lengths = EdgeLengths::new(garment, options.finest_edge());
        if let Some(animated) = &options.body {
            let creased = CreasedCloth::new(garment, animated, &script.body_poses(animated));
            let coarsest = TUNING.simulation_mesh.max_factor_on_body * lengths.line;
            if creased.triangles.is_empty() && garment.mean_edge() >= coarsest {
                return own("the body bends none of it, and no mesh on a body is coarser".into());
            }
            return Self::on_body(garment, &creased, lengths);
        }
        let DrawnLines { mut mesh, foresight, layout } =
            draw_fold_lines(garment, script, laid, fabric.thickness(), lengths.row);
        let excess = layout.map(|layout| layout.excess).or_else(|| laid.map(|laid| excess_at(garment, laid)));
        let is_crumpled = excess.is_some_and(|excess| excess > TUNING.simulation_mesh.max_excess);
        let uniform = match foresight {
            Foresight::Whole if is_crumpled => lengths.max_of_crumpled,
            Foresight::Whole => lengths.max,
            Foresight::NeedsLaying => lengths.side,
            Foresight::Until(_) => TUNING.simulation_mesh.side_factor * lengths.anywhere,
        };
        make_mesh(&mut mesh, lengths, uniform);
        let mesh = mesh.finish();
        // A garment that is laid out is not simulated in the shape of its file.
        if layout.is_none() && crosses_elsewhere(&mesh.garment, garment) {
            return own("layers would cross on another mesh at the start".into());
        }
        let count = format!("{} points instead of {}", mesh.garment.points.len(), garment.points.len());
        let [line, row, crossing, side, max, anywhere] =
            [lengths.line, lengths.row, lengths.crossing, lengths.side, uniform, lengths.anywhere]
                .map(|l| 1e3 * l);
        let why = match foresight {
            Foresight::NeedsLaying => format!("{count}: edges of {max:.0} mm to lay the garment on"),
            Foresight::Whole => format!(
                "{count}: edges of {line:.0} mm along fold lines, {row:.0} mm across, {crossing:.0} mm where they cross, {side:.0} mm along sides, up to {max:.0} mm elsewhere"
            ),
            Foresight::Until(_) => format!(
                "{count}: edges of {max:.0} mm, bisected down to {anywhere:.0} mm where the cloth bends during the wear"
            ),
        };
        Self {
            mesh,
            refinement: match foresight {
                Foresight::Until(from_action) => {
                    Some(RefinementRule { from_action, finest_edge: lengths.anywhere })
                }
                _ => None,
            },
            lays_first: foresight == Foresight::NeedsLaying,
            layout,
            decision: ModelDecision { name: "simulation mesh", on: true, why: why.into() },
        }
    }
}

impl MeshChoice {
    /// Chooses the mesh for a `garment` on a body that will crease it where it is `creased`: fine there.
    fn on_body(garment: &Garment, creased: &CreasedCloth, lengths: EdgeLengths) -> Self {
        let tuning = &TUNING.simulation_mesh;
        let max = tuning.max_factor_on_body * lengths.line;
        let affordable = creased.edge_for(tuning.max_creased_points);
        let fine = (tuning.finest_factor_on_body * lengths.line).max(affordable).min(max);
        let mut mesh = SurfaceMesh::new(garment);
        improve(&mut mesh, &SizeField::new(&creased.seeds(fine), fine, tuning.edge_growth_on_body, max));
        let mesh = mesh.finish();
        let [fine_mm, max_mm] = [fine, max].map(|l| 1e3 * l);
        let why = format!(
            "{} points instead of {}: edges of {fine_mm:.0} mm where the body bends, up to {max_mm:.0} mm elsewhere, bisected where the cloth bends during the wear",
            mesh.garment.points.len(),
            garment.points.len()
        );
        Self {
            mesh,
            refinement: Some(RefinementRule { from_action: 0, finest_edge: fine }),
            lays_first: false,
            layout: None,
            decision: ModelDecision { name: "simulation mesh", on: true, why: why.into() },
        }
    }
}

impl EdgeLengths {
    /// Lengths for `garment` with edges of `finest` [m] along its fold lines; shorter on garments that are small against that.
    pub fn new(garment: &Garment, finest: f64) -> Self {
        let tuning = TUNING.simulation_mesh;
        let (low, high) = bounds(&garment.points);
        let extent = (high - low).max();
        let line = finest.min(tuning.max_extent_fraction * extent);
        Self {
            line,
            row: tuning.max_crease_edge.min(line),
            crossing: tuning.max_crease_edge.min(tuning.crossing_factor * line),
            side: tuning.side_factor * line,
            max: (tuning.max_factor * line).min(tuning.max_edge),
            max_of_crumpled: (tuning.max_factor_of_crumpled * line).min(tuning.max_edge),
            anywhere: line.max(tuning.anywhere_extent_fraction * extent),
        }
    }

    /// Lengths for a `garment` with creases that have rows at `row` [m] beside them: edges are as long where the creases cross.
    pub fn of_creases(garment: &Garment, row: f64) -> Self {
        Self::new(garment, row / TUNING.simulation_mesh.crossing_factor)
    }
}

/// Fraction of the cloth of `garment` that does not fit into the plane where it lies at `laid` [m] and will crumple in a stack.
fn excess_at(garment: &Garment, laid: &[Vec3]) -> f64 {
    let area_vectors =
        |x| garment.triangles.iter().map(move |t| triangle::area_vector(&triangle::corners(x, t)));
    let whole: f64 = area_vectors(&garment.points[..]).map(|a| a.norm()).sum();
    let lying: f64 = area_vectors(laid).map(|a| a.y.abs()).sum();
    1.0 - lying / whole.max(f64::MIN_POSITIVE)
}

/// Whether layers of `mesh`, another mesh of the surface of `garment`, cross where those of the garment do not. Where they do, finer triangles
/// cross in more pairs, and next to it, where triangles of the garment have a corner in common and do not count.
pub(crate) fn crosses_elsewhere(mesh: &Garment, garment: &Garment) -> bool {
    let crossing = |garment: &Garment| -> Vec<([Vec3; 3], f64)> {
        let corners = |f: u32| triangle::corners(&garment.points, &garment.triangles[f as usize]);
        let found = self_intersecting_triangles(&garment.points, &garment.triangles).into_iter();
        found.map(corners).map(|x| (x, triangle::longest_side(&x))).collect()
    };
    let own = crossing(garment);
    crossing(mesh).iter().any(|([a, b, c], size)| {
        let middle = (a + b + c) / 3.0;
        !own.iter().any(|([a, b, c], own)| point_triangle(&middle, a, b, c).distance <= size + own)
    })
}

/// Brings `mesh` to short edges along its curves and edges of `uniform` length [m] elsewhere.
pub(crate) fn make_mesh(mesh: &mut SurfaceMesh, lengths: EdgeLengths, uniform: f64) {
    let length = lengths.crossing;
    let mut seeds: Vec<Seed> =
        line_crossings(mesh).into_iter().map(|position| Seed { position, length }).collect();
    for [a, b] in mesh.edges() {
        let length = match mesh.curve(a, b) {
            Some(Curve::Border | Curve::Feature | Curve::Rim) => lengths.side,
            Some(Curve::Line(_)) => lengths.line,
            None => continue,
        };
        seeds.extend(Seed::along(mesh.x[a as usize], mesh.x[b as usize], length));
    }
    improve(mesh, &SizeField::new(&seeds, lengths.line, TUNING.simulation_mesh.edge_growth, uniform));
}

/// Positions [m] where fold lines cross one another or the rim of the laid garment.
fn line_crossings(mesh: &SurfaceMesh) -> Vec<Vec3> {
    let mut line = vec![None; mesh.x.len()];
    let mut found = Vec::new();
    for [a, b] in mesh.edges() {
        let curve = match mesh.curve(a, b) {
            Some(Curve::Line(number)) if is_row(number) => continue,
            Some(curve @ (Curve::Line(_) | Curve::Rim)) => curve,
            _ => continue,
        };
        for p in [a, b].map(|p| p as usize) {
            match line[p] {
                None => line[p] = Some(curve),
                Some(other) if other != curve => found.push(mesh.x[p]),
                Some(_) => {}
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::GarmentFile;

    #[test]
    fn edges_are_finest_where_fold_lines_cross() {
        let sheet = GarmentFile::sheet([0.6, 0.6], [30, 30]).expect("is a sheet").garment;
        let fabric = Fabric::preset("cotton-jersey").expect("is a preset");
        let text = r#"{"format": "crease-wear/1", "name": "", "actions": [{"lay": {}},
            {"fold": {"line": [[0.5, 0.0], [0.5, 1.0]], "side": "left"}},
            {"fold": {"line": [[0.0, 0.5], [1.0, 0.5]], "side": "lower"}}]}"#;
        let script = WearScript::parse("wear.json", text).expect("is a script");
        let options = BakeOptions::default();
        let mesh = MeshChoice::new(&sheet, &fabric, &script, None, &options).mesh.garment;
        let middle = bounds(&mesh.points).0 + Vec3::new(0.3, 0.0, 0.3);
        // Mean length of edges on the first line, by their distance from where the lines cross.
        let mean = |low: f64, high: f64| {
            let ends = mesh.topology.edges.iter().map(|edge| edge.map(|p| mesh.points[p.at()] - middle));
            let lengths: Vec<f64> = ends
                .filter(|[a, b]| a.x.abs().max(b.x.abs()) < 2e-3)
                .filter(|[a, b]| (low..high).contains(&a.z.abs().max(b.z.abs())))
                .map(|[a, b]| (a - b).norm())
                .collect();
            lengths.iter().sum::<f64>() / lengths.len() as f64
        };
        let [near, far] = [mean(2e-3, 0.02), mean(0.08, 0.3)];
        // The rows of the other line, at the length that is asked for there, divide a line where the two cross.
        assert!(
            near < 1.15 * TUNING.simulation_mesh.max_crease_edge && far > 1.1 * near,
            "{near} m, {far} m"
        );
    }

    #[test]
    fn cloth_that_a_body_creases_has_edges_of_two_thirds_of_those_along_lines_whatever_the_file_has() {
        let expected = 0.008;
        for cells in [100, 40, 12] {
            let sheet = GarmentFile::sheet([0.4, 0.4], [cells; 2]).expect("is a sheet").garment;
            let middle = sheet.points.iter().sum::<Vec3>() / sheet.points.len() as f64;
            let near = |x: &Vec3| (x - middle).norm() < 0.06;
            let all = sheet.triangles.iter().map(|t| triangle::corners(&sheet.points, t));
            let creased = CreasedCloth { triangles: all.filter(|x| x.iter().any(near)).collect() };
            let lengths = EdgeLengths::new(&sheet, BakeOptions::default().finest_edge());
            let mesh = MeshChoice::on_body(&sheet, &creased, lengths).mesh.garment;
            let ends = mesh.topology.edges.iter().map(|edge| edge.map(|p| mesh.points[p.at()]));
            let of_creased: Vec<f64> =
                ends.filter(|ends| ends.iter().all(near)).map(|[a, b]| (a - b).norm()).collect();
            let mean = of_creased.iter().sum::<f64>() / of_creased.len() as f64;
            assert!((0.8..1.25).contains(&(mean / expected)), "{mean} m, {expected} m");
            assert!(cells < 100 || mesh.points.len() < sheet.points.len() * 2 / 3, "coarser elsewhere");
        }
    }
}

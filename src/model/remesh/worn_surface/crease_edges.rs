//! Edges of the creases of a simulated mesh: the centre line of each, and the rows beside it, whose angle belongs to the crease.

use crate::remesh::GarmentSurface;
use crate::remesh::hinge_chains::HingeChain;
use crate::remesh::tuning::TUNING;
use crease_geometry::mesh::distance::along_edge;

/// Part of an edge in a crease.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    None,
    Centre,
    Row,
}

/// Edges of the creases of a mesh.
pub(super) struct CreaseEdges {
    /// Per hinge.
    part: Vec<Part>,
    /// Per hinge of a row: the hinge of a centre line that it belongs to.
    centre_of: Vec<Option<u32>>,
    /// Per triangle: whether it lies between a centre line and a row beside it.
    pub strip: Vec<bool>,
    /// Per centre line: its points, and the hinge between each two of them.
    pub lines: Vec<(Vec<u32>, Vec<u32>)>,
}

impl CreaseEdges {
    /// Finds the creases of `mesh` among its hinges, whose rest angles changed by `changes` [rad].
    pub fn find(mesh: &GarmentSurface, changes: &[f64]) -> Self {
        let strong = |h: usize| changes[h].abs() >= TUNING.min_crease_angle;
        let mut chains = HingeChain::all(&mesh.points, &mesh.topology, strong, TUNING.min_crease_cosine);
        chains.retain(|chain| chain.length >= TUNING.min_crease_length);
        let weight = |chain: &HingeChain| -> f64 {
            let each = chain.edges().map(|(ends, h)| {
                let [a, b] = [ends[0], ends[1]].map(|p| mesh.points[p as usize]);
                (a - b).norm() * changes[*h as usize].abs()
            });
            each.sum()
        };
        let mut ranked: Vec<(f64, HingeChain)> = chains.into_iter().map(|c| (weight(&c), c)).collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.points.cmp(&b.1.points)));
        let mut part = vec![Part::None; changes.len()];
        // Per point: the centre edges at it.
        let mut centre_at: Vec<Vec<u32>> = vec![Vec::new(); mesh.points.len()];
        for (_, chain) in &ranked {
            let beside: Vec<bool> = chain.hinges.iter().map(|h| is_row(mesh, &centre_at, *h)).collect();
            let rows = beside.iter().filter(|beside| **beside).count();
            let all_rows = 2 * rows > beside.len();
            for (h, beside) in chain.hinges.iter().zip(beside) {
                part[*h as usize] = if beside || all_rows { Part::Row } else { Part::Centre };
            }
            for h in chain.hinges.iter().filter(|h| part[**h as usize] == Part::Centre) {
                let ends = &mesh.topology.hinges[*h as usize].points[..2];
                ends.iter().for_each(|p| centre_at[p.at()].push(*h));
            }
        }
        let strip = strip_triangles(mesh, &part);
        let lines = ranked.iter().flat_map(|(_, chain)| centre_lines(chain, &part)).collect();
        Self { centre_of: centres_of_rows(mesh, &part), part, strip, lines }
    }

    /// Per hinge on a centre line: its change among `changes` [rad], with those of the rows beside it by their length; 0 for others.
    pub fn net_angles(&self, mesh: &GarmentSurface, changes: &[f64]) -> Vec<f64> {
        let length = |h: usize| {
            let [a, b, ..] = mesh.topology.hinges[h].points.map(|p| mesh.points[p.at()]);
            (b - a).norm()
        };
        let mut net = vec![0.0; changes.len()];
        self.centre_hinges().for_each(|h| net[h] = changes[h]);
        for (row, h) in self.rows() {
            net[h] += changes[row] * length(row) / length(h);
        }
        net
    }

    /// Every hinge of a row, with the hinge of a centre line that it belongs to.
    pub fn rows(&self) -> impl Iterator<Item = (usize, usize)> {
        let centre = |(row, centre): (usize, &Option<u32>)| centre.map(|h| (row, h as usize));
        self.centre_of.iter().enumerate().filter_map(centre)
    }

    /// Whether hinge `h` is on a centre line.
    pub fn is_centre(&self, h: usize) -> bool {
        self.part[h] == Part::Centre
    }

    /// The hinges on centre lines.
    pub fn centre_hinges(&self) -> impl Iterator<Item = usize> {
        (0..self.part.len()).filter(|h| self.is_centre(*h))
    }
}

/// The parts of `chain` that are on a centre line: points, and the hinges between them.
fn centre_lines(chain: &HingeChain, part: &[Part]) -> Vec<(Vec<u32>, Vec<u32>)> {
    let mut lines: Vec<(Vec<u32>, Vec<u32>)> = Vec::new();
    let mut goes_on = false;
    for (ends, h) in chain.edges() {
        let is_centre = part[*h as usize] == Part::Centre;
        if is_centre && !goes_on {
            lines.push((vec![ends[0]], Vec::new()));
        }
        if let Some((points, hinges)) = lines.last_mut().filter(|_| is_centre) {
            points.push(ends[1]);
            hinges.push(*h);
        }
        goes_on = is_centre;
    }
    lines
}

/// Whether hinge `h` runs beside a centre edge: a triangle at it touches one about parallel to it that does not go on from it.
fn is_row(mesh: &GarmentSurface, centre_at: &[Vec<u32>], h: u32) -> bool {
    let hinge = &mesh.topology.hinges[h as usize];
    let direction = |h: u32| {
        let [a, b, ..] = mesh.topology.hinges[h as usize].points.map(|p| mesh.points[p.at()]);
        (b - a).try_normalize(0.0)
    };
    let Some(own) = direction(h) else { return false };
    let [a, b, c, d] = hinge.points;
    let reach = |p| {
        let [x, y, z] = [a, b, p].map(|p| mesh.points[p.at()]);
        (y - x).cross(&(z - x)).norm() / (y - x).norm()
    };
    [c, d].into_iter().any(|p| {
        let parallel = |g: &u32| direction(*g).is_some_and(|g| g.dot(&own).abs() > TUNING.min_row_cosine);
        reach(p) < TUNING.max_row_distance && centre_at[p.at()].iter().any(parallel)
    })
}

/// Per hinge of a row: the closest hinge of a centre line, as far as it is within the reach of rows.
fn centres_of_rows(mesh: &GarmentSurface, part: &[Part]) -> Vec<Option<u32>> {
    let ends = |h: usize| mesh.topology.hinges[h].points.map(|p| mesh.points[p.at()]);
    let centre: Vec<usize> = (0..part.len()).filter(|h| part[*h] == Part::Centre).collect();
    let closest = |row: usize| {
        let [a, b, ..] = ends(row);
        let middle = 0.5 * (a + b);
        let squared = |h: &usize| {
            let [a, b, ..] = ends(*h);
            let part = along_edge(&middle, &a, &b);
            (middle - a - (b - a) * part).norm_squared()
        };
        let nearest = centre.iter().map(|h| (squared(h), *h as u32)).min_by(|x, y| x.0.total_cmp(&y.0));
        nearest.filter(|(d, _)| *d < TUNING.max_row_distance.powi(2)).map(|(_, h)| h)
    };
    let of = |(h, part): (usize, &Part)| if *part == Part::Row { closest(h) } else { None };
    part.iter().enumerate().map(of).collect()
}

/// Triangles between a centre line and a row beside it.
fn strip_triangles(mesh: &GarmentSurface, part: &[Part]) -> Vec<bool> {
    let mut on = vec![[false; 2]; mesh.points.len()];
    for (hinge, part) in mesh.topology.hinges.iter().zip(part) {
        let k = match part {
            Part::None => continue,
            Part::Centre => 0,
            Part::Row => 1,
        };
        hinge.points[..2].iter().for_each(|p| on[p.at()][k] = true);
    }
    let between = |t: &[crease_geometry::mesh::PointIndex; 3]| {
        let on = t.map(|p| on[p.at()]);
        on.iter().all(|[centre, row]| *centre || *row)
            && on.iter().any(|[centre, _]| *centre)
            && on.iter().any(|[centre, row]| *row && !*centre)
    };
    mesh.triangles.iter().map(between).collect()
}

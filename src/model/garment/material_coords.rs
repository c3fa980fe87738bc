//! Material coordinates: every triangle flattened at its true size, x along the warp, y along the weft.
//!
//! Warp is +u of the texture coordinates where they follow the panels, else the vertical (for a garment that lies:
//! the scene's z), as cloth is cut with the warp hanging down. u alone decides, because the weft is perpendicular to the
//! warp in the cloth even where an unwrapping shears it. The sense of the weft is chosen so that the flat triangle is
//! counter-clockwise: mirrored texture islands would give negative areas, and cloth is the same along +weft and -weft.
//!
//! The area of the flat triangle is that of the source shape, never of the texture.

use crate::garment::lying::is_lying_by_normals;
use crate::garment::tuning::TUNING;
use crate::garment::wedges::TriangleWedges;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::{Groups, Topology, triangle};

/// Flattened triangles.
pub(super) struct FlatTriangles {
    /// One per triangle: its corners [m].
    pub(super) material: Vec<[Vec2; 3]>,
    /// Whether texture coordinates gave the directions.
    pub(super) from_uv: bool,
    /// One per triangle: its panel, an island of the texture coordinates if they gave the directions, else its piece of the file.
    pub(super) panel: Vec<u32>,
    /// Reason for the choice, for the user.
    pub(super) reason: String,
}

/// Flattens all triangles.
///
/// `points` \[m\], `wedges` one per triangle, `uvs` and `pieces` (piece of the file) one per vertex, `part_count` connected parts of
/// the garment.
pub(super) fn flatten_triangles(
    points: &[Vec3],
    wedges: &[TriangleWedges],
    uvs: &[Option<Vec2>],
    pieces: &[u32],
    topology: &Topology,
    part_count: usize,
) -> FlatTriangles {
    let shapes: Vec<[Vec3; 3]> = wedges.iter().map(|w| w.points.map(|p| points[p.at()])).collect();
    let texture: Vec<Option<[Vec2; 3]>> = wedges.iter().map(|w| wedge_uvs(w, uvs)).collect();
    let from_texture: Vec<Option<Vec3>> =
        shapes.iter().zip(&texture).map(|(shape, uv)| u_direction(shape, uv.as_ref()?)).collect();
    let (islands, reason) = judge_texture(wedges, &texture, &from_texture, topology, part_count);
    let from_uv = islands.is_some();
    let piece = |w: &TriangleWedges| w.vertices.map_or(0, |vertices| pieces[vertices[0] as usize]);
    let panel = islands.unwrap_or_else(|| wedges.iter().map(piece).collect());
    let reference = shape_reference(&shapes);
    let material = (0..shapes.len())
        .map(|t| {
            let shape = &shapes[t];
            let own = from_texture[t].filter(|_| from_uv);
            let warp = own
                .or_else(|| from_uv.then(|| neighbour_direction(t, shape, &from_texture, topology)).flatten())
                .unwrap_or_else(|| shape_direction(shape, reference));
            flatten_triangle(shape, warp)
        })
        .collect();
    FlatTriangles { material, from_uv, panel, reason }
}

fn wedge_uvs(wedges: &TriangleWedges, uvs: &[Option<Vec2>]) -> Option<[Vec2; 3]> {
    let vertices = wedges.vertices?;
    let [a, b, c] = vertices.map(|v| uvs.get(v as usize).copied().flatten());
    Some([a?, b?, c?])
}

fn unit_normal(shape: &[Vec3; 3]) -> Vec3 {
    triangle::normal(shape).unwrap_or_else(Vec3::z)
}

/// Returns the unit direction in the triangle's plane in which u grows at constant v: dX/du of the map from texture to
/// space.
fn u_direction(shape: &[Vec3; 3], uv: &[Vec2; 3]) -> Option<Vec3> {
    let (e1, e2) = (shape[1] - shape[0], shape[2] - shape[0]);
    let (d1, d2) = (uv[1] - uv[0], uv[2] - uv[0]);
    let area = d1.x * d2.y - d2.x * d1.y;
    let longest = d1.norm_squared().max(d2.norm_squared()).max((d2 - d1).norm_squared());
    // Texture coordinates that are not numbers are not usable either.
    let usable = area.abs() > TUNING.min_uv_area_fraction * longest;
    if usable { ((e1 * d2.y - e2 * d1.y) / area).try_normalize(0.0) } else { None }
}

/// Returns the texture island of every triangle, `None` if the texture coordinates do not follow the panels, and the reason.
fn judge_texture(
    wedges: &[TriangleWedges],
    texture: &[Option<[Vec2; 3]>],
    directions: &[Option<Vec3>],
    topology: &Topology,
    part_count: usize,
) -> (Option<Vec<u32>>, String) {
    if texture.iter().all(Option::is_none) {
        return (None, "warp from the shape: there are no texture coordinates".into());
    }
    let good = directions.iter().filter(|direction| direction.is_some()).count();
    if (good as f64) < TUNING.min_directed_fraction * wedges.len() as f64 {
        let bad = wedges.len() - good;
        return (None, format!("warp from the shape: {bad} triangles have no usable texture coordinates"));
    }
    let (island, islands) = find_islands(wedges, texture, topology);
    let max_islands = part_count.max(wedges.len() / TUNING.min_island_triangles);
    if islands > max_islands {
        let count = format!("{islands} texture islands for {} triangles", wedges.len());
        return (None, format!("warp from the shape: {count}, too many to follow the panels"));
    }
    (Some(island), format!("warp along u of the texture coordinates ({islands} islands)"))
}

/// Returns the island of every triangle (texture continues across the common edges of its triangles), and their number.
fn find_islands(
    wedges: &[TriangleWedges],
    texture: &[Option<[Vec2; 3]>],
    topology: &Topology,
) -> (Vec<u32>, usize) {
    let mut groups = Groups::new(wedges.len());
    for (e, &[first, second]) in topology.edge_triangles.iter().enumerate() {
        if topology.edge_valence[e] < 2 {
            continue;
        }
        let continues = topology.edges[e].iter().all(|&point| {
            let uv = |t: u32| {
                let k = wedges[t as usize].points.iter().position(|&p| p == point)?;
                Some(texture[t as usize]?[k])
            };
            uv(first).zip(uv(second)).is_some_and(|(a, b)| (a - b).norm() <= TUNING.island_uv_tol)
        });
        if continues {
            groups.join(first, second);
        }
    }
    let (island, count) = groups.numbered();
    (island.iter().map(|island| island.0).collect(), count)
}

/// Returns the direction the warp follows without texture: the scene's y, or z for a garment that lies.
fn shape_reference(shapes: &[[Vec3; 3]]) -> Vec3 {
    let normals = shapes.iter().map(triangle::area_vector);
    if is_lying_by_normals(normals, TUNING.lying_min_slope) { Vec3::z() } else { Vec3::y() }
}

/// Projects `direction` into the triangle's plane and normalises it; `None` where too little of it is left.
pub fn project_to_plane(shape: &[Vec3; 3], direction: Vec3) -> Option<Vec3> {
    let normal = unit_normal(shape);
    (direction - normal * normal.dot(&direction)).try_normalize(TUNING.min_warp_sine)
}

/// Returns the warp from the shape: the direction in the plane closest to `reference`, else to another axis.
fn shape_direction(shape: &[Vec3; 3], reference: Vec3) -> Vec3 {
    [reference, Vec3::z(), Vec3::x()]
        .into_iter()
        .find_map(|direction| project_to_plane(shape, direction))
        .unwrap_or_else(|| (shape[1] - shape[0]).try_normalize(0.0).unwrap_or_else(Vec3::x))
}

/// Returns the mean warp of the neighbours, for a triangle whose own texture is damaged.
fn neighbour_direction(
    t: usize,
    shape: &[Vec3; 3],
    directions: &[Option<Vec3>],
    topology: &Topology,
) -> Option<Vec3> {
    let neighbours = topology.triangle_edges[t].iter().flat_map(|&e| topology.edge_triangles[e as usize]);
    let sum: Vec3 = neighbours
        .filter(|&other| other as usize != t)
        .filter_map(|other| directions.get(other as usize).copied().flatten())
        .sum();
    project_to_plane(shape, sum)
}

/// Returns the corners of the triangle in the plane of `warp` (x) and the weft (y), counter-clockwise \[m\].
pub fn flatten_triangle(shape: &[Vec3; 3], warp: Vec3) -> [Vec2; 3] {
    let weft = unit_normal(shape).cross(&warp);
    shape.map(|p| Vec2::new((p - shape[0]).dot(&warp), (p - shape[0]).dot(&weft)))
}

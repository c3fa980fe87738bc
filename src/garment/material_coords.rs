//! Directions of the cloth: every triangle laid flat at its true size, x along the warp, y along the weft.
//!
//! Warp is +u of the texture coordinates where they follow the panels, else the vertical (for a garment that lies:
//! the scene's z), as cloth is cut with the warp hanging down. From u alone, because the weft is square to the warp in
//! the cloth even where an unwrapping shears it. The weft's sense is chosen so that the flat triangle turns
//! counter-clockwise: mirrored texture islands would give negative areas, and cloth is the same along +weft and -weft.
//!
//! The area of the flat triangle is that of the source shape, never of the texture. Knows no stiffness.

use crate::garment::lying::is_lying_by_normals;
use crate::garment::repair::Corners;
use crate::math::{Vec2, Vec3};
use crate::mesh::{Groups, Topology};

/// A texture triangle lower than this part of its longest side gives no direction.
const FLAT_UV: f64 = 1e-4;
/// Part of the triangles that must have a direction.
const GOOD_PART: f64 = 0.9;
/// Triangles per texture island, at least, unless every part of the garment is one island. Automatic unwrappings that
/// cut a mesh to confetti have one or two, and turn every scrap as it fits.
const ISLAND_TRIANGLES: usize = 8;
/// Texture coordinates closer than this are the same: OBJ files round to five or six decimals.
const SAME_UV: f64 = 1e-5;
/// Mean steepness (|normal . y|, weighted by area) from which a garment counts as lying.
const LYING: f64 = 0.7;
/// A reference this close to the normal (sine of the angle) gives no direction.
const TOO_STEEP: f64 = 0.05;

/// Triangles laid flat.
pub(super) struct FlatTriangles {
    /// One per triangle: its corners [m].
    pub(super) material: Vec<[Vec2; 3]>,
    /// Whether texture coordinates gave the directions.
    pub(super) from_uv: bool,
    /// What decided, for the user.
    pub(super) why: String,
}

/// Lays the triangles flat.
pub(super) fn lay_flat(
    points: &[Vec3],
    corners: &[Corners],
    uvs: &[Option<Vec2>],
    topology: &Topology,
    part_count: usize,
) -> FlatTriangles {
    let shapes: Vec<[Vec3; 3]> = corners.iter().map(|c| c.points.map(|p| points[p.at()])).collect();
    let texture: Vec<Option<[Vec2; 3]>> = corners.iter().map(|c| corner_uvs(c, uvs)).collect();
    let from_texture: Vec<Option<Vec3>> =
        shapes.iter().zip(&texture).map(|(shape, uv)| u_direction(shape, uv.as_ref()?)).collect();
    let (from_uv, why) = judge_texture(corners, &texture, &from_texture, topology, part_count);
    let reference = shape_reference(&shapes);
    let material = (0..shapes.len())
        .map(|t| {
            let shape = &shapes[t];
            let own = from_texture[t].filter(|_| from_uv);
            let warp = own
                .or_else(|| from_uv.then(|| neighbour_direction(t, shape, &from_texture, topology)).flatten())
                .unwrap_or_else(|| shape_direction(shape, reference));
            flatten(shape, warp)
        })
        .collect();
    FlatTriangles { material, from_uv, why }
}

fn corner_uvs(c: &Corners, uvs: &[Option<Vec2>]) -> Option<[Vec2; 3]> {
    let vertices = c.vertices?;
    let [a, b, c] = vertices.map(|v| uvs.get(v as usize).copied().flatten());
    Some([a?, b?, c?])
}

fn unit_normal(shape: &[Vec3; 3]) -> Vec3 {
    let normal = (shape[1] - shape[0]).cross(&(shape[2] - shape[0]));
    normal.try_normalize(0.0).unwrap_or_else(Vec3::z)
}

/// Direction [unit, in the triangle's plane] in which u grows at constant v: dX/du of the map from texture to space.
fn u_direction(shape: &[Vec3; 3], uv: &[Vec2; 3]) -> Option<Vec3> {
    let (e1, e2) = (shape[1] - shape[0], shape[2] - shape[0]);
    let (d1, d2) = (uv[1] - uv[0], uv[2] - uv[0]);
    let area = d1.x * d2.y - d2.x * d1.y;
    let longest = d1.norm_squared().max(d2.norm_squared()).max((d2 - d1).norm_squared());
    // Texture coordinates that are not numbers are not usable either.
    let usable = area.abs() > FLAT_UV * longest;
    if usable { ((e1 * d2.y - e2 * d1.y) / area).try_normalize(0.0) } else { None }
}

/// Whether the texture coordinates follow the panels, and why (not).
fn judge_texture(
    corners: &[Corners],
    texture: &[Option<[Vec2; 3]>],
    directions: &[Option<Vec3>],
    topology: &Topology,
    part_count: usize,
) -> (bool, String) {
    if texture.iter().all(Option::is_none) {
        return (false, "warp from the shape: there are no texture coordinates".into());
    }
    let good = directions.iter().filter(|direction| direction.is_some()).count();
    if (good as f64) < GOOD_PART * corners.len() as f64 {
        let bad = corners.len() - good;
        return (false, format!("warp from the shape: {bad} triangles have no usable texture coordinates"));
    }
    let islands = count_islands(corners, texture, topology);
    let most = part_count.max(corners.len() / ISLAND_TRIANGLES);
    if islands > most {
        let what = format!("{islands} texture islands for {} triangles", corners.len());
        return (false, format!("warp from the shape: {what}, too many to follow the panels"));
    }
    (true, format!("warp along u of the texture coordinates ({islands} islands)"))
}

/// Groups of triangles whose texture continues across their common edges.
fn count_islands(corners: &[Corners], texture: &[Option<[Vec2; 3]>], topology: &Topology) -> usize {
    let mut groups = Groups::new(corners.len());
    for (e, &[first, second]) in topology.edge_triangles.iter().enumerate() {
        if topology.edge_valence[e] < 2 {
            continue;
        }
        let continues = topology.edges[e].iter().all(|&point| {
            let uv = |t: u32| {
                let k = corners[t as usize].points.iter().position(|&p| p == point)?;
                Some(texture[t as usize]?[k])
            };
            uv(first).zip(uv(second)).is_some_and(|(a, b)| (a - b).norm() <= SAME_UV)
        });
        if continues {
            groups.join(first, second);
        }
    }
    groups.numbered().1
}

/// The scene's y, or z for a garment that lies.
fn shape_reference(shapes: &[[Vec3; 3]]) -> Vec3 {
    let normals = shapes.iter().map(|shape| (shape[1] - shape[0]).cross(&(shape[2] - shape[0])));
    if is_lying_by_normals(normals, LYING) { Vec3::z() } else { Vec3::y() }
}

/// `direction` brought into the triangle's plane, if that leaves enough of it.
pub(super) fn in_plane(shape: &[Vec3; 3], direction: Vec3) -> Option<Vec3> {
    let normal = unit_normal(shape);
    (direction - normal * normal.dot(&direction)).try_normalize(TOO_STEEP)
}

/// Warp from the shape: the direction in the plane closest to `reference`, else to another axis.
fn shape_direction(shape: &[Vec3; 3], reference: Vec3) -> Vec3 {
    [reference, Vec3::z(), Vec3::x()]
        .into_iter()
        .find_map(|direction| in_plane(shape, direction))
        .unwrap_or_else(|| (shape[1] - shape[0]).try_normalize(0.0).unwrap_or_else(Vec3::x))
}

/// Mean warp of the neighbours, for a triangle whose own texture is damaged.
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
    in_plane(shape, sum)
}

/// The triangle in the plane of `warp` (x) and the weft (y), counter-clockwise.
pub(super) fn flatten(shape: &[Vec3; 3], warp: Vec3) -> [Vec2; 3] {
    let weft = unit_normal(shape).cross(&warp);
    shape.map(|p| Vec2::new((p - shape[0]).dot(&warp), (p - shape[0]).dot(&weft)))
}

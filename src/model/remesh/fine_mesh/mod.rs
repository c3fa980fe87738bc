//! Finer mesh of a garment for a worn shape that its own triangles cannot follow: `--fine`.
//!
//! Edges are split and nothing else: the points and vertices of the file stay as they are, and the new ones lie on its triangles. All
//! triangles at an edge are split in one place, and all vertices of the file at a point have one position after the wear: there is no
//! T-junction, and seams stay closed.
//!
//! ```text
//! triangles of the file -> edges halved beside creases and where the worn surface is curved (refine)
//!                       -> edges split along the middle and the borders of every crease (crease_rows)
//!                       -> positions of the worn surface, but for places where these would cross (crossings)
//! ```

mod crease_rows;
mod crossings;
mod refine;
mod split_mesh;

use crate::remesh::WornSurface;
use crate::remesh::tuning::TUNING;
use crate::remesh::worn_surface::CreaseDistances;
use crease_geometry::math::{Mat3, Vec3};
use split_mesh::SplitMesh;

/// Triangles of a file that are made finer.
#[derive(Debug, Clone, Copy)]
pub struct FileMesh<'a> {
    /// Source position per point [m].
    pub points: &'a [Vec3],
    /// Position after the wear per point [m], as far as the triangles of the file can show it.
    pub after: &'a [Vec3],
    /// Number of vertices.
    pub vertex_count: usize,
    /// Triangles between three points.
    pub triangles: &'a [FileTriangle],
}

/// Triangle of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileTriangle {
    /// Points at its corners, all of them different.
    pub points: [u32; 3],
    /// Vertices at its corners.
    pub vertices: [u32; 3],
    /// Triangle of the worn surface from which the search for a place of it begins; `None` for what the surface does not have, such as a
    /// trim, which is split only where its neighbours are.
    pub start: Option<u32>,
}

/// Finer mesh of a file with the positions of a worn surface.
#[derive(Debug, Clone)]
pub struct FineMesh {
    /// Per point, those of the file first: what the wear makes of it.
    pub points: Vec<FinePoint>,
    /// Per new vertex: the mean of vertices of the file that it is.
    pub vertices: Vec<FineVertex>,
    /// Per triangle: its vertices, those of the file first, then the new ones in their order.
    pub triangles: Vec<[u32; 3]>,
    /// Per triangle: the triangle of the file that it is a part of.
    pub parent: Vec<u32>,
    /// Number of pairs of triangles that intersect and whose triangles of the file do not.
    pub crossings: usize,
}

/// A point after the wear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FinePoint {
    /// Position [m].
    pub position: Vec3,
    /// Map that turns directions as the wear did; `None` where the worn surface has no place for it.
    pub turn: Option<Mat3>,
}

/// A new vertex: a mean of vertices of one triangle of the file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FineVertex {
    /// Its point.
    pub point: u32,
    /// Vertices of the file.
    pub of: [u32; 3],
    /// Their weights, whose sum is 1; those at the end are 0 for a vertex on an edge.
    pub weights: [f64; 3],
}

impl FineMesh {
    /// The mesh with edges of about `edge` [m] along the creases and in the wrinkles of `surface`.
    pub fn new(file: &FileMesh, surface: &WornSurface, edge: f64) -> Self {
        let mut mesh = SplitMesh::new(file);
        let creases = CreaseDistances::new(surface, TUNING.fine_reach.max(2.0 * edge));
        let mut places = refine::Places::new(&mesh, file, surface, &creases);
        refine::refine(&mut mesh, &mut places, edge);
        crease_rows::cut(&mut mesh, &mut places);
        let linear = mesh.carried(file.after);
        let worn = |(p, linear): (usize, &Vec3)| match places.at(p) {
            Some(place) => FinePoint { position: place.position, turn: Some(place.turn) },
            None => FinePoint { position: *linear, turn: None },
        };
        let mut points: Vec<FinePoint> = linear.iter().enumerate().map(worn).collect();
        let crossings = crossings::resolve(&mesh, file, &linear, &mut points);
        Self {
            points,
            vertices: mesh.fine_vertices(),
            triangles: mesh.triangles.iter().map(|t| t.vertices).collect(),
            parent: mesh.triangles.iter().map(|t| t.parent).collect(),
            crossings,
        }
    }
}

//! A fold transferred to a garment whose triangles do not follow it.

use crease::internal::transfer::{
    MatchBy, Transfer, TransferResult, TransferSource, mesh_along_creases, relax_carried,
};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::intersections::self_intersections;
use crease_model::fabric::{DEFAULT_FABRIC, Fabric};
use crease_model::garment::{Garment, MeshOptions, RestState, RigidParts, WornGarment};
use crease_model::remesh::GarmentSurface;

/// Side of every sheet [m].
const SIDE: f64 = 0.3;
/// Angle that the fold remembers [rad].
const FOLD: f64 = 2.0;

/// A sheet of squares of 12 mm with a fold along its ninth column; where `is_scattered`, along one edge
/// of every row, in columns apart from one another.
fn folded(is_scattered: bool) -> TransferSource {
    let sheet = Garment::sheet([SIDE; 2], [25; 2]).expect("is a sheet");
    let column = |p: crease_geometry::mesh::PointIndex| (sheet.points[p.at()].x / 0.012).round() as i64;
    let row = |p: crease_geometry::mesh::PointIndex| (sheet.points[p.at()].z / 0.012).round() as i64;
    let mut memory = RestState::flat(sheet.topology.hinges.len(), sheet.triangles.len());
    for (angle, hinge) in memory.rest_angle.iter_mut().zip(&sheet.topology.hinges) {
        let [a, b] = [hinge.points[0], hinge.points[1]];
        let on = if is_scattered { 4 + 7 * row(a).min(row(b)) % 17 } else { 9 };
        if column(a) == on && column(b) == on {
            *angle = FOLD;
        }
    }
    TransferSource {
        file: "fold".into(),
        surface: GarmentSurface::without_texture(&sheet),
        memory,
        joints: Vec::new(),
        simulated: None,
    }
}

/// A sheet of the size of the source, of edges of about 13 mm in no line with it, bent round a cylinder of 0.2 m whose axis is
/// along `axis` (0: x, across the fold; 2: z, along it).
fn curved(axis: usize) -> Garment {
    let (points, triangles) = curved_mesh(axis);
    Garment::from_mesh(&points, &triangles, MeshOptions::default().name("curved")).expect("is a garment")
}

/// Positions [m] and triangles of the same.
fn curved_mesh(axis: usize) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let n = 24u32;
    let (radius, skew) = (0.2, 0.3);
    let mut points = Vec::new();
    for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
        let inner = |k: u32| f64::from(u8::from(k > 0 && k + 1 < n));
        let place = |k: u32, other: u32| {
            SIDE * (f64::from(k) + skew * inner(k) * f64::from((7 * other + 3 * k) % 5) / 4.0)
                / f64::from(n - 1)
        };
        let (x, z) = (place(i, j), place(j, i));
        let round = |s: f64| {
            let (sin, cos) = ((s - 0.5 * SIDE) / radius).sin_cos();
            (0.5 * SIDE + radius * sin, radius * cos)
        };
        points.push(if axis == 0 {
            let (z, y) = round(z);
            [x, y, z]
        } else {
            let (x, y) = round(x);
            [x, y, z]
        });
    }
    let corners = (0..n - 1).flat_map(|j| (0..n - 1).map(move |i| j * n + i));
    let triangles: Vec<[u32; 3]> =
        corners.flat_map(|a| [[a, a + n, a + n + 1], [a, a + n + 1, a + 1]]).collect();
    (points, triangles)
}

fn transferred(source: &TransferSource, target: &Garment) -> TransferResult {
    let surface = GarmentSurface::without_texture(target);
    Transfer::between(std::slice::from_ref(source), &surface)
        .run_along_creases(target, &mesh_along_creases)
        .expect("fits")
}

/// Fraction of its memory that `target` shows.
fn shown(target: &Garment, carried: &TransferResult) -> f64 {
    let fabric = Fabric::preset(DEFAULT_FABRIC).expect("exists");
    let relaxed = relax_carried(target, &fabric, carried);
    assert_eq!(relaxed.unconverged_reason, None);
    let worn = WornGarment { displacement: relaxed.displacement, memory: carried.memory.clone() };
    worn.shown_fraction(target).expect("it remembers a fold")
}

#[test]
fn a_fold_shows_on_a_garment_whose_triangles_do_not_follow_it() {
    for axis in [0, 2] {
        let (source, target) = (folded(false), curved(axis));
        let carried = transferred(&source, &target);
        let on_mesh = carried.on_mesh.as_ref().expect("the fold is a crease line");
        // On the mesh the fold is one row of hinges.
        let sharp = |(rest, source): (&f64, &f64)| (rest - source).abs() > 0.8 * FOLD;
        let memory = &on_mesh.memory;
        let strong = memory.rest_angle.iter().zip(&memory.source_angle).filter(|pair| sharp(*pair)).count();
        assert!(strong >= 15, "axis {axis}: {strong} sharp hinges on the mesh");
        let surface = GarmentSurface::without_texture(&target);
        let unaligned = Transfer::between(std::slice::from_ref(&source), &surface).run().expect("fits");
        let [aligned, before] = [&carried, &unaligned].map(|carried| shown(&target, carried));
        println!(
            "axis {axis}: {aligned:.2} shown, {before:.2} on the garment's own triangles, {strong} sharp hinges"
        );
        // The pose limits how far a crease opens, on a mesh along it as across several hinges beside one another.
        assert!(aligned > 0.45 && aligned > 0.8 * before, "axis {axis}: {aligned:.2}, {before:.2}");
        // The fold keeps its angle on the file's triangles.
        let total: f64 = target
            .topology
            .hinges
            .iter()
            .enumerate()
            .map(|(h, hinge)| {
                let [a, b] = [hinge.points[0], hinge.points[1]].map(|p| target.points[p.at()]);
                let along: Vec3 = (b - a).try_normalize(0.0).expect("has a length");
                let line = if axis == 0 { 1.0 - along.x * along.x } else { along.z * along.z };
                (carried.memory.rest_angle[h] - carried.memory.source_angle[h]) * (b - a).norm() * line
            })
            .sum();
        assert!(
            (total / (FOLD * SIDE) - 1.0).abs() < 0.1,
            "axis {axis}: {:.2} of the angle",
            total / (FOLD * SIDE)
        );
    }
}

#[test]
fn memory_that_follows_no_line_stays_on_the_triangles_of_the_garment() {
    let carried = transferred(&folded(true), &curved(2));
    assert!(carried.on_mesh.is_none());
    assert!(
        carried.memory.rest_angle.iter().zip(&carried.memory.source_angle).any(|(r, s)| (r - s).abs() > 0.1)
    );
}

/// Buttons move with the cloth under them, and a patch that crosses the cloth in the file crosses it on any mesh: neither costs the
/// garment its edges along the fold.
#[test]
fn buttons_and_layers_that_cross_in_the_file_cost_no_fold() {
    let source = folded(false);
    let plain = curved(0);
    let of_plain = shown(&plain, &transferred(&source, &plain));
    // A cube of 8 mm over the middle of the garment, turned away from its fold.
    let centre = [0.22, 0.2 + 0.006, 0.15];
    let corner = |k: u32| {
        [0, 1, 2].map(|axis: usize| centre[axis] + 0.004 * f64::from(2 * (k as i32 >> axis & 1) - 1))
    };
    let mut points: Vec<[f64; 3]> = (0..8).map(corner).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut triangles: Vec<[u32; 3]> =
        faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    let (cloth, of_cloth) = curved_mesh(0);
    points.extend(cloth);
    triangles.extend(of_cloth.iter().map(|t| t.map(|v| 8 + v)));
    let buttoned = Garment::from_mesh(&points, &triangles, MeshOptions::default().name("buttoned"))
        .expect("is a garment");
    assert!(RigidParts::find(&buttoned).is_some());
    // Its own memory at half strength, entry by entry.
    let surface = GarmentSurface::without_texture(&buttoned);
    let own = TransferSource {
        file: "own".into(),
        memory: RestState::flat(surface.topology.hinges.len(), surface.triangles.len()),
        surface: surface.clone(),
        joints: Vec::new(),
        simulated: None,
    };
    let half = Transfer::between(std::slice::from_ref(&own), &surface).strength(0.5).match_by(MatchBy::Same);
    half.run_along_creases(&buttoned, &mesh_along_creases).expect("is the same mesh");
    // An upright patch of two triangles through the cloth, which stays where it is there, far from the fold: it holds the panel that it
    // crosses, and with it an eighth of the fold's opening.
    let (mut points, mut triangles) = curved_mesh(0);
    let first = points.len() as u32;
    points.extend([[0.265, 0.15, 0.02], [0.29, 0.15, 0.02], [0.29, 0.25, 0.02], [0.265, 0.25, 0.02]]);
    triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|v| first + v)));
    let crossing = Garment::from_mesh(&points, &triangles, MeshOptions::default().name("crossing"))
        .expect("is a garment");
    assert!(!self_intersections(&crossing.points, &crossing.triangles).is_empty());
    for (what, target) in [("button", buttoned), ("crossing", crossing)] {
        let carried = transferred(&source, &target);
        assert!(carried.on_mesh.is_some(), "{what}: no mesh along the fold");
        let own = shown(&target, &carried);
        println!("{what}: {own:.2} shown, {of_plain:.2} without");
        assert!(own > 0.8 * of_plain, "{what}: {own:.2} of {of_plain:.2}");
    }
}

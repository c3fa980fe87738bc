//! A sheet of coarse triangles in two islands of texture space, creased at any angle to them.

use super::*;
use crate::gltf::detail::tests::{SIDE, creased_sheet};
use crate::gltf::{FlatNormals, plain_glb, write_worn_glb};
use crate::read::{ReadOptions, read_asset};
use crease_geometry::mesh::intersections::self_intersections;
use crease_geometry::mesh::{Topology, triangle};
use crease_model::garment::{Garment, WornGarment};
use crease_model::remesh::WornSurface;

fn read(glb: &[u8]) -> SourceAsset {
    let options = ReadOptions { unit_m: Some(1.0), any_size: true, ..ReadOptions::default() };
    let mut alone = |name: &str| panic!("asks for {name}");
    read_asset("fine.glb", glb, &options, &mut alone).unwrap().0
}

fn fine(asset: &SourceAsset, coarse: &Garment, shown: &WornGarment, surface: &WornSurface) -> FineOutput {
    let displacement = &shown.displacement;
    let detail = DetailInput { coarse, displacement, surface, flat_normals: FlatNormals::default() };
    let glb = write_worn_glb(asset, coarse, shown, &json!({"crease": {}})).unwrap();
    write_fine_glb(&glb, asset, &detail, FINE_EDGE).unwrap()
}

/// Positions of the vertices before and after the wear, unit normals after it, triangles.
struct Shown {
    before: Vec<Vec3>,
    after: Vec<Vec3>,
    normals: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

fn shown(glb: &[u8]) -> Shown {
    let asset = read(glb);
    let (document, piece) = (asset.document.as_ref().unwrap(), &asset.pieces[0]);
    let target = crate::gltf::read_worn::worn_target(document, piece).unwrap();
    let column = |name: &str| -> Vec<Vec3> {
        let count = piece.positions.len();
        let rows = crate::gltf::read_worn::column(document, &target[name], 3, count, name).unwrap();
        rows.unwrap().chunks_exact(3).map(Vec3::from_row_slice).collect()
    };
    let sum = |rows: &[Vec3], shifts: Vec<Vec3>| rows.iter().zip(shifts).map(|(x, d)| x + d).collect();
    let normals: Vec<Vec3> = sum(piece.normals.as_ref().unwrap(), column("NORMAL"));
    Shown {
        before: piece.positions.clone(),
        after: sum(&piece.positions, column("POSITION")),
        normals: normals.iter().map(|n| n.normalize()).collect(),
        triangles: piece.triangles.clone(),
    }
}

/// Vertices of one place before the wear become one point.
fn welded(shown: &Shown) -> (Vec<u32>, Vec<[PointIndex; 3]>) {
    let mut places = FxHashMap::default();
    let points: Vec<u32> = shown
        .before
        .iter()
        .map(|x| {
            let next = places.len() as u32;
            *places.entry([x.x, x.y, x.z].map(|c| (c * 1e7).round() as i64)).or_insert(next)
        })
        .collect();
    let triangles = shown.triangles.iter().map(|t| t.map(|v| PointIndex(points[v as usize]))).collect();
    (points, triangles)
}

#[test]
fn a_crease_is_as_wide_as_it_is_and_nothing_else_is_refined() {
    for degrees in [0.0f64, 7.0, 17.0, 28.0, 45.0, 90.0, 163.0] {
        let angle = degrees.to_radians();
        let (asset, coarse, worn, surface) = creased_sheet(angle);
        let output = fine(&asset, &coarse, &worn, &surface);
        assert_eq!(output.crossings, 0);
        let shown = shown(&output.glb);
        assert_eq!((shown.before.len(), shown.triangles.len()), (output.vertices, output.triangles));
        let across = Vec3::new(-angle.sin(), 0.0, angle.cos());
        let level = |v: u32| (shown.before[v as usize] - Vec3::new(0.5 * SIDE, 0.0, 0.5 * SIDE)).dot(&across);
        let mut length = 0.0;
        for t in &shown.triangles {
            let levels = t.map(level);
            // No triangle reaches from the cloth on one side over the crease, which is 2 mm wide, into it.
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                let (low, high) = (levels[a].min(levels[b]), levels[a].max(levels[b]));
                for border in [-1e-3, 0.0, 1e-3] {
                    let over = (border - low).min(high - border);
                    assert!(over < 0.25e-3, "{degrees}: an edge reaches {over} m over a line");
                }
                let is_on_middle = levels[a].abs().max(levels[b].abs()) < 0.25e-3;
                length += f64::from(u8::from(is_on_middle))
                    * (shown.before[t[a] as usize] - shown.before[t[b] as usize]).norm();
            }
            for (v, level) in t.iter().zip(levels).filter(|(_, level)| level.abs() > 1e-3) {
                let side = Vec3::new(0.0, 0.5f64.sqrt(), 0.0) - across * (level.signum() * 0.5f64.sqrt());
                let n = shown.normals[*v as usize];
                assert!(n.dot(&side) > 0.999, "{degrees}: {n} at {level} m");
            }
        }
        assert!(length > 2.0 * 0.8 * SIDE, "{degrees}: {length} m of edges along the middle");
        let is_far = |v: usize| level(v as u32).abs() > 0.08;
        let file = coarse.source_point.len();
        assert!(!(file..shown.before.len()).any(is_far), "{degrees}: vertices far from the crease");
        assert!(output.vertices < 2500, "{degrees}: {} vertices", output.vertices);
    }
}

#[test]
fn the_vertices_of_the_file_come_first_and_the_mesh_stays_closed() {
    let (asset, coarse, worn, surface) = creased_sheet(0.3);
    let output = fine(&asset, &coarse, &worn, &surface);
    let shown = shown(&output.glb);
    let count = coarse.source_point.len();
    let plain = read(&plain_glb(&asset).unwrap());
    assert_eq!(shown.before[..count], plain.pieces[0].positions[..]);
    let uvs = read(&output.glb).pieces[0].uvs.clone().unwrap();
    assert_eq!(uvs[..count], plain.pieces[0].uvs.as_ref().unwrap()[..]);
    let (points, triangles) = welded(&shown);
    let point_count = points.iter().max().map_or(0, |last| *last as usize + 1);
    assert!(point_count < shown.before.len(), "there is a seam");
    // An open border off that of the sheet would be a T-junction or an open seam.
    let topology = Topology::new(point_count, &triangles);
    let mut place = vec![Vec3::zeros(); point_count];
    let mut moved: Vec<Option<Vec3>> = vec![None; point_count];
    for (v, p) in points.iter().enumerate() {
        place[*p as usize] = shown.before[v];
        let first = moved[*p as usize].get_or_insert(shown.after[v]);
        assert!((*first - shown.after[v]).norm() < 1e-6, "a seam opens");
    }
    for border in topology.boundary_loops(&triangles) {
        for p in border {
            let x = place[p.at()];
            let on_border = [x.x, x.z].iter().any(|c| c.min(SIDE - c).abs() < 1e-6);
            assert!(on_border, "a hole at {x}");
        }
    }
    let area: f64 = triangles.iter().map(|t| triangle::area(&t.map(|p| place[p.at()]))).sum();
    assert!((area - SIDE * SIDE).abs() < 1e-7, "{area}");
    let after: Vec<Vec3> = moved.into_iter().flatten().collect();
    assert!(self_intersections(&after, &triangles).is_empty());
    let again = fine(&asset, &coarse, &worn, &surface);
    assert!(again == output, "equal inputs give equal bytes");
}

/// The sheet as a glTF file with colours, a skin and a morph target of its own, all of them linear in the place.
fn rigged(asset: &SourceAsset) -> SourceAsset {
    let plain = read(&plain_glb(asset).unwrap());
    let mut appender = Appender::from_document("sheet", plain.document.as_ref().unwrap()).unwrap();
    let places = &plain.pieces[0].positions;
    let part = |x: &Vec3| (x.x / SIDE) as f32;
    let colours: Vec<[f32; 4]> = places.iter().map(|x| [part(x), (x.z / SIDE) as f32, 0.5, 1.0]).collect();
    let weights: Vec<[f32; 4]> = places.iter().map(|x| [part(x), 1.0 - part(x), 0.0, 0.0]).collect();
    let lifts: Vec<[f32; 3]> = places.iter().map(|x| [0.0, 0.1 * x.z as f32, 0.0]).collect();
    let colours = appender.vectors(&colours, Purpose::Vertex);
    let weights = appender.vectors(&weights, Purpose::Vertex);
    let joints = appender.joints(&vec![[1, 0, 0, 0]; places.len()]);
    let lift = appender.vectors(&lifts, Purpose::Position);
    let first = appender.push("nodes", json!({"name": "left"}));
    let second = appender.push("nodes", json!({"name": "right"}));
    appender.push("skins", json!({"joints": [first, second]}));
    appender.list("nodes")[0]["skin"] = json!(0);
    let nodes = appender.list("nodes").len();
    appender.list("scenes")[0]["nodes"] = json!((0..nodes).collect::<Vec<_>>());
    let mesh = &mut appender.list("meshes")[0];
    mesh["weights"] = json!([0.0]);
    mesh["extras"] = json!({"targetNames": ["lift"]});
    let primitive = &mut mesh["primitives"][0];
    primitive["targets"] = json!([{"POSITION": lift}]);
    primitive["attributes"]["COLOR_0"] = json!(colours);
    primitive["attributes"]["JOINTS_0"] = json!(joints);
    primitive["attributes"]["WEIGHTS_0"] = json!(weights);
    read(&appender.into_glb())
}

#[test]
fn what_a_file_has_at_its_vertices_is_interpolated() {
    let (asset, _, worn, surface) = creased_sheet(0.3);
    let asset = rigged(&asset);
    let coarse = Garment::from_asset(&asset).unwrap().0;
    let output = fine(&asset, &coarse, &worn, &surface);
    let fine = read(&output.glb);
    let (document, piece) = (fine.document.as_ref().unwrap(), &fine.pieces[0]);
    let primitive = &document.json["meshes"][0]["primitives"][0];
    let count = piece.positions.len();
    assert!(count > 2 * coarse.source_point.len());
    let column = |accessor: &Value, width: usize| {
        crate::gltf::read_worn::column(document, accessor, width, count, "a test").unwrap().unwrap()
    };
    let attribute = |name: &str| column(&primitive["attributes"][name], 4);
    let (colours, joints, weights) = (attribute("COLOR_0"), attribute("JOINTS_0"), attribute("WEIGHTS_0"));
    let lifts = column(&primitive["targets"][0]["POSITION"], 3);
    for (v, x) in piece.positions.iter().enumerate() {
        assert!((colours[4 * v] - x.x / SIDE).abs() < 1e-6 && (colours[4 * v + 1] - x.z / SIDE).abs() < 1e-6);
        assert!((lifts[3 * v + 1] - 0.1 * x.z).abs() < 1e-6);
        let of_second: f64 = (0..4).filter(|k| joints[4 * v + k] == 1.0).map(|k| weights[4 * v + k]).sum();
        assert!((of_second - x.x / SIDE).abs() < 1e-6, "{of_second} at {x}");
        let sum: f64 = weights[4 * v..4 * v + 4].iter().sum();
        assert!((sum - 1.0).abs() < 1e-6);
    }
    assert_eq!(document.json["meshes"][0]["extras"]["targetNames"], json!(["lift", "worn"]));
    assert_eq!(document.json["meshes"][0]["weights"], json!([0.0, 1.0]));
}

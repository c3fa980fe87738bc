//! A coarse sheet with fine ripples: rendering of mesh and map against the fine surface itself.

use super::*;
use crate::gltf::detail::painter::SurfaceCorners;
use crate::gltf::{FlatNormals, write_worn_glb};
use crease_geometry::math::Vec2;
use crease_geometry::mesh::PointIndex;
use crease_geometry::mesh::distance::barycentric;
use crease_model::garment::{Garment, RestState, WornGarment};
use crease_model::remesh::{GarmentSurface, WornSurface};
use rustc_hash::FxHashMap;
use serde_json::json;
use std::fmt::Write;

/// Quads a side of the coarse sheet, and its side [m].
const QUADS: usize = 6;
pub(in crate::gltf) const SIDE: f64 = 0.3;

/// A level sheet in two islands of texture space, the second turned by a quarter, with a seam between the two halves.
fn sheet() -> SourceAsset {
    let mut obj = String::new();
    let step = SIDE / QUADS as f64;
    for k in 0..(QUADS + 1) * (QUADS + 1) {
        let (i, j) = (k % (QUADS + 1), k / (QUADS + 1));
        writeln!(obj, "v {} 0 {}", i as f64 * step, j as f64 * step).unwrap();
    }
    // Two sets of texture coordinates for every point: left island upright, right island turned.
    for turned in [false, true] {
        for k in 0..(QUADS + 1) * (QUADS + 1) {
            let [u, v] = [(k % (QUADS + 1)) as f64, (k / (QUADS + 1)) as f64].map(|x| x / QUADS as f64);
            let (u, v) =
                if turned { (0.05 + 0.45 * v, 0.95 - 0.45 * u) } else { (0.05 + 0.45 * u, 0.5 - 0.45 * v) };
            writeln!(obj, "vt {u} {v}").unwrap();
        }
    }
    writeln!(obj, "vn 0 1 0").unwrap();
    let count = (QUADS + 1) * (QUADS + 1);
    for (j, i) in (0..QUADS).flat_map(|j| (0..QUADS).map(move |i| (j, i))) {
        let a = j * (QUADS + 1) + i + 1;
        let set = if i < QUADS / 2 { 0 } else { count };
        let corner = |p: usize| format!("{p}/{}/1", p + set);
        let [a, b, c, d] = [a, a + QUADS + 1, a + QUADS + 2, a + 1].map(corner);
        writeln!(obj, "f {a} {b} {c}\nf {a} {c} {d}").unwrap();
    }
    let mut alone = |name: &str| panic!("asks for {name}");
    read_asset("sheet.obj", obj.as_bytes(), &ReadOptions::default(), &mut alone).unwrap().0
}

/// Divides every triangle into four, `times` times; also returns the parents.
fn finer(coarse: &Garment, times: usize) -> (Garment, Vec<u32>) {
    let (mut points, mut triangles) = (coarse.points.clone(), coarse.triangles.clone());
    let mut parent: Vec<u32> = (0..triangles.len() as u32).collect();
    for _ in 0..times {
        let mut halfway = FxHashMap::default();
        let mut middle = |a: PointIndex, b: PointIndex| {
            let key = if a < b { [a, b] } else { [b, a] };
            *halfway.entry(key).or_insert_with(|| {
                points.push((points[a.at()] + points[b.at()]) * 0.5);
                PointIndex(points.len() as u32 - 1)
            })
        };
        let cut = |[a, b, c]: [PointIndex; 3],
                   middle: &mut dyn FnMut(PointIndex, PointIndex) -> PointIndex| {
            let (x, y, z) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, x, z], [x, b, y], [z, y, c], [x, y, z]]
        };
        triangles = triangles.iter().flat_map(|t| cut(*t, &mut middle)).collect();
        parent = parent.iter().flat_map(|k| [*k; 4]).collect();
    }
    let triangles: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|p| p.0)).collect();
    let source_point = coarse.source_point.clone();
    let material = vec![[Vec2::zeros(), Vec2::x(), Vec2::y()]; triangles.len()];
    let fine = Garment { material, source_point, ..Garment::of_triangles(points, &triangles) };
    (fine, parent)
}

/// Ripples much finer than the coarse mesh: height [m] at a position.
fn ripple(x: &Vec3) -> f64 {
    0.0025 * (x.x * 180.0).sin() + 0.002 * (x.z * 140.0 + x.x * 60.0).cos()
}

struct RippledSheet {
    asset: SourceAsset,
    coarse: Garment,
    fine: Garment,
    parent: Vec<u32>,
    worn: WornGarment,
    surface: WornSurface,
}

impl RippledSheet {
    fn new(height: &dyn Fn(&Vec3) -> f64) -> Self {
        let asset = sheet();
        let coarse = Garment::from_asset(&asset).unwrap().0;
        let (fine, parent) = finer(&coarse, 5);
        let displacement = fine.points.iter().map(|x| Vec3::y() * height(x)).collect();
        let memory = RestState::flat(fine.topology.hinges.len(), fine.triangles.len());
        let worn = WornGarment { displacement, memory };
        let surface = WornSurface::new(&GarmentSurface::without_texture(&fine), &worn, 2e-3);
        Self { asset, coarse, worn, fine, parent, surface }
    }

    fn detail(&self) -> DetailInput<'_> {
        DetailInput {
            coarse: &self.coarse,
            displacement: &self.worn.displacement,
            surface: &self.surface,
            flat_normals: FlatNormals::default(),
        }
    }

    fn worn_glb(&self) -> Vec<u8> {
        let count = self.coarse.points.len();
        let worn = WornGarment {
            displacement: self.worn.displacement[..count].to_vec(),
            memory: RestState::flat(self.coarse.topology.hinges.len(), self.coarse.triangles.len()),
        };
        write_worn_glb(&self.asset, &self.coarse, &worn, &json!({"crease": {"sidecar": "x"}})).unwrap()
    }

    fn detailed(&self) -> DetailOutput {
        add_detail_map(
            &self.worn_glb(),
            &self.asset,
            &self.detail(),
            MapOptions::new(1024, MapDepth::Sixteen),
        )
        .unwrap()
    }
}

/// Returns the direction a viewer shows in the middle of every fine triangle, and the fine surface's smooth normal there.
fn shown_and_true(scene: &RippledSheet, detailed: &DetailOutput) -> Vec<(Vec3, Vec3, Vec3)> {
    let options = ReadOptions { unit_m: Some(1.0), any_size: true, ..ReadOptions::default() };
    let mut alone = |name: &str| panic!("asks for {name}");
    let mut asset = read_asset("worn.glb", &detailed.glb, &options, &mut alone).unwrap().0;
    assert!(keep_worn_pieces(&mut asset));
    let document = asset.document.as_ref().unwrap();
    let detail = scene.detail();
    let surfaces = surfaces(&asset, document, &detail, DetailOf::Rest, &mut Vec::new()).unwrap();
    assert!(surfaces.iter().all(|s| s.added.is_none()), "the file has tangents now");
    let creases = CreaseDistances::new(&scene.surface, 0.0);
    let painter = Painter::new(&detail, &surfaces, Some(&creases), DetailOf::Rest);
    let own = own_normal_map(document, surfaces[0].materials[0]).unwrap().expect("the material has the map");
    let mut smooth = vec![Vec3::zeros(); scene.fine.points.len()];
    let position = |p: PointIndex| scene.fine.points[p.at()] + scene.worn.displacement[p.at()];
    for t in &scene.fine.triangles {
        let n = (position(t[1]) - position(t[0])).cross(&(position(t[2]) - position(t[0])));
        t.iter().for_each(|p| smooth[p.at()] += n);
    }
    let mut all = Vec::new();
    for (t, &k) in scene.fine.triangles.iter().zip(&scene.parent) {
        let SurfaceCorners { surface, vertices } = painter.corners[k as usize][0];
        let corners = scene.coarse.triangles[k as usize].map(|p| scene.coarse.points[p.at()]);
        let centre = t.iter().map(|p| scene.fine.points[p.at()]).sum::<Vec3>() / 3.0;
        let weights = barycentric(&centre, &corners);
        let mix =
            |of: &dyn Fn(usize) -> Vec3| weights.iter().zip(vertices).map(|(w, v)| of(v) * *w).sum::<Vec3>();
        let surface = &surfaces[surface];
        let n = mix(&|v| surface.worn[v].normal).normalize();
        let along = mix(&|v| surface.worn[v].tangent.direction).normalize();
        let uv = weights.iter().zip(vertices).map(|(w, v)| surface.uvs[v] * *w).sum();
        let d = own.texels.sample(uv);
        let shown =
            along * d.x + n.cross(&along) * (surface.worn[vertices[0]].tangent.handedness * d.y) + n * d.z;
        let truth = t.iter().map(|p| smooth[p.at()].normalize()).sum::<Vec3>().normalize();
        all.push((shown.normalize(), truth, n));
    }
    all
}

fn angle_deg(a: &Vec3, b: &Vec3) -> f64 {
    a.dot(b).clamp(-1.0, 1.0).acos().to_degrees()
}

#[test]
fn coarse_mesh_and_map_look_like_the_fine_mesh_from_three_lights() {
    let scene = RippledSheet::new(&ripple);
    let detailed = scene.detailed();
    assert!(detailed.notes.is_empty(), "{:?}", detailed.notes);
    let pixels = shown_and_true(&scene, &detailed);
    let lights = [Vec3::new(0.0, 1.0, 0.0), Vec3::new(1.0, 0.5, 0.2), Vec3::new(-0.3, 0.4, -1.0)];
    for light in lights.map(|l| l.normalize()) {
        let lit: Vec<_> = pixels.iter().filter(|(_, truth, _)| truth.dot(&light) > 0.0).collect();
        let mean =
            lit.iter().map(|(shown, truth, _)| angle_deg(shown, truth)).sum::<f64>() / lit.len() as f64;
        let bare = lit.iter().map(|(_, truth, n)| angle_deg(n, truth)).sum::<f64>() / lit.len() as f64;
        println!(
            "lit from {light:?}: {mean:.2} degrees with the map, {bare:.2} without, {} places",
            lit.len()
        );
        assert!(mean < 5.0 && bare > 15.0, "{mean} {bare}");
        // The triangles along the seam between the islands are no worse than five times the mean.
        let worst = lit.iter().map(|(shown, truth, _)| angle_deg(shown, truth)).fold(0.0, f64::max);
        println!("  worst {worst:.2}");
        assert!(worst < 10.0, "a seam shows: {worst}");
    }
    let map = &detailed.maps[0];
    assert!(map.in_material && map.conflicting_fraction < 0.01, "{}", map.conflicting_fraction);
    assert!(map.height_range_m[1] > 0.003 && map.height_range_m[1] < 0.012, "{:?}", map.height_range_m);
}

#[test]
fn cloth_without_wear_has_a_flat_map() {
    let detailed = RippledSheet::new(&|_| 0.0).detailed();
    assert!(detailed.maps[0].mean_tilt_deg < 1e-3, "{}", detailed.maps[0].mean_tilt_deg);
}

/// The map that a first run left in the material is the weave that a second run rotates: on flat cloth it stays.
#[test]
fn a_normal_map_that_is_there_is_kept_under_the_wrinkles() {
    let scene = RippledSheet::new(&ripple);
    let first = scene.detailed();
    let mut alone = |name: &str| panic!("asks for {name}");
    let options = ReadOptions { unit_m: Some(1.0), any_size: true, ..ReadOptions::default() };
    let asset = read_asset("first.glb", &first.glb, &options, &mut alone).unwrap().0;
    let flat = RippledSheet::new(&|_| 0.0);
    let coarse = Garment::from_asset(&asset).unwrap().0;
    let (fine, _) = finer(&coarse, 5);
    let memory = RestState::flat(fine.topology.hinges.len(), fine.triangles.len());
    let worn = WornGarment { displacement: vec![Vec3::zeros(); fine.points.len()], memory };
    let surface = WornSurface::new(&GarmentSurface::without_texture(&fine), &worn, 2e-3);
    let detail = DetailInput {
        coarse: &coarse,
        displacement: &worn.displacement,
        surface: &surface,
        flat_normals: FlatNormals::default(),
    };
    // Worn again, so that the worn target is that of the flat sheet.
    let unworn = WornGarment { displacement: vec![Vec3::zeros(); coarse.points.len()], ..flat.worn.clone() };
    let unworn = WornGarment {
        memory: RestState::flat(coarse.topology.hinges.len(), coarse.triangles.len()),
        ..unworn
    };
    let glb = write_worn_glb(&asset, &coarse, &unworn, &json!({"crease": {"sidecar": "x"}})).unwrap();
    let second = add_detail_map(&glb, &asset, &detail, MapOptions::new(1024, MapDepth::Sixteen)).unwrap();
    assert!(second.notes.is_empty(), "{:?}", second.notes);
    let [a, b] = [&first, &second].map(|d| Texels::from_png(&d.maps[0].normal_png).unwrap());
    let off: f64 = a.direction.iter().zip(&b.direction).map(|(a, b)| angle_deg(a, b)).sum::<f64>();
    let mean = off / a.direction.len() as f64;
    println!("mean change of the weave {mean:.3} degrees");
    assert!(mean < 0.5, "{mean}");
}

#[test]
fn parts_that_do_not_belong_together_are_rejected() {
    let scene = RippledSheet::new(&ripple);
    let glb = scene.worn_glb();
    let short = DetailInput { displacement: &scene.worn.displacement[..3], ..scene.detail() };
    assert!(add_detail_map(&glb, &scene.asset, &short, MapOptions::new(1024, MapDepth::Sixteen)).is_err());
    assert!(
        add_detail_map(&glb, &scene.asset, &scene.detail(), MapOptions::new(7, MapDepth::Sixteen)).is_err()
    );
    assert!(
        add_detail_map(b"no glTF", &scene.asset, &scene.detail(), MapOptions::new(1024, MapDepth::Sixteen))
            .is_err()
    );
}

/// A sheet with edges of some 20 mm, one of them along the line through the middle at `angle` [rad], bent there by 90 degrees.
pub(in crate::gltf) fn creased_sheet(angle: f64) -> (SourceAsset, Garment, WornGarment, WornSurface) {
    let asset = sheet();
    let coarse = Garment::from_asset(&asset).unwrap().0;
    let (centre, along) = (Vec3::new(0.5 * SIDE, 0.0, 0.5 * SIDE), Vec3::new(angle.cos(), 0.0, angle.sin()));
    let across = Vec3::new(-angle.sin(), 0.0, angle.cos());
    let rows: Vec<f64> = vec![-0.25, -0.13, -0.06, -0.02, 0.0, 0.02, 0.06, 0.13, 0.25];
    let columns = 26;
    let mut points = Vec::new();
    for row in &rows {
        points.extend((0..columns).map(|i| centre + along * (0.02 * i as f64 - 0.25) + across * *row));
    }
    let mut triangles = Vec::new();
    for j in 0..rows.len() as u32 - 1 {
        for i in 0..columns - 1 {
            let [a, b] = [j * columns + i, (j + 1) * columns + i];
            triangles.push([a, b, a + 1]);
            triangles.push([a + 1, b, b + 1]);
        }
    }
    let mesh = GarmentSurface::without_texture(&Garment::of_triangles(points, &triangles));
    // Both halves rise by 45 degrees from the line.
    let rise = |x: &Vec3| {
        let level = (x - centre).dot(&across);
        across * (0.5f64.sqrt() * level - level) + Vec3::y() * (0.5f64.sqrt() * level.abs())
    };
    let mut memory = RestState::flat(mesh.topology.hinges.len(), mesh.triangles.len());
    for (h, hinge) in mesh.topology.hinges.iter().enumerate() {
        let on_line = |p: &PointIndex| (mesh.points[p.at()] - centre).dot(&across).abs() < 1e-9;
        memory.rest_angle[h] = if hinge.points[..2].iter().all(on_line) { 1.5 } else { 0.0 };
    }
    let worn = WornGarment { displacement: mesh.points.iter().map(rise).collect(), memory };
    let surface = WornSurface::new(&mesh, &worn, 2e-3);
    let hinges = coarse.topology.hinges.len();
    let memory = RestState::flat(hinges, coarse.triangles.len());
    let shown = WornGarment { displacement: vec![Vec3::zeros(); coarse.points.len()], memory };
    (asset, coarse, shown, surface)
}

#[test]
fn a_crease_comes_out_of_the_map_with_its_angle_and_width_on_its_line() {
    for degrees in [0.0f64, 7.0, 17.0, 28.0, 163.0] {
        let angle = degrees.to_radians();
        let (asset, coarse, shown, surface) = creased_sheet(angle);
        let detail = DetailInput {
            coarse: &coarse,
            displacement: &shown.displacement,
            surface: &surface,
            flat_normals: FlatNormals::default(),
        };
        let extras = json!({"crease": {"sidecar": "x"}});
        let glb = write_worn_glb(&asset, &coarse, &shown, &extras).unwrap();
        let detailed =
            add_detail_map(&glb, &asset, &detail, MapOptions::new(2048, MapDepth::Sixteen)).unwrap();
        let map = Texels::from_png(&detailed.maps[0].normal_png).unwrap();
        // In the left island u of the picture is x and v is z.
        let tilt = |level: f64, part: f64| {
            let x = Vec3::new(0.09, 0.0, 0.15) + Vec3::new(-angle.sin(), 0.0, angle.cos()) * level;
            let x = x + Vec3::new(angle.cos(), 0.0, angle.sin()) * part;
            let uv = Vec2::new(0.05 + 0.45 * x.x / SIDE, 0.5 + 0.45 * x.z / SIDE);
            let d = map.sample(uv);
            (d.x.hypot(d.y)).atan2(d.z).to_degrees()
        };
        // The line runs through the middle of the sheet: seen from here, this much farther off.
        let shift = (Vec3::new(0.5 * SIDE, 0.0, 0.5 * SIDE) - Vec3::new(0.09, 0.0, 0.15)).dot(&Vec3::new(
            -angle.sin(),
            0.0,
            angle.cos(),
        ));
        if shift.abs() > 0.03 {
            continue;
        }
        for part in [-0.02, -0.011, 0.0, 0.007, 0.02] {
            let total = tilt(shift - 0.004, part) + tilt(shift + 0.004, part);
            assert!((total - 90.0).abs() < 2.0, "{degrees}: {total} degrees");
            let steps: Vec<f64> = (-400..=400).map(|k| 1e-5 * f64::from(k)).collect();
            let bent: Vec<f64> =
                steps.iter().copied().filter(|level| tilt(shift + level, part) < 43.0).collect();
            let (low, high) = (bent[0], bent[bent.len() - 1]);
            assert!((high - low - 0.002).abs() < 0.6e-3, "{degrees}: width {} m", high - low);
            assert!((0.5 * (low + high)).abs() < 0.3e-3, "{degrees}: beside the line {}", 0.5 * (low + high));
        }
    }
}

#[test]
fn a_map_of_all_of_the_wear_is_for_the_mesh_without_it() {
    let scene = RippledSheet::new(&ripple);
    let options = MapOptions { of: DetailOf::All, ..MapOptions::new(1024, MapDepth::Sixteen) };
    let detailed = add_detail_map(&scene.worn_glb(), &scene.asset, &scene.detail(), options).unwrap();
    assert!(!detailed.maps[0].in_material && detailed.notes.len() == 1, "{:?}", detailed.notes);
    let map = Texels::from_png(&detailed.maps[0].normal_png).unwrap();
    // The left island shows x and z of the level sheet as u and v of the picture.
    for (i, j) in (2..9).flat_map(|i| (2..9).map(move |j| (i, j))) {
        let x = Vec3::new(0.013 * f64::from(i), 0.0, 0.027 * f64::from(j));
        let slope = |d: Vec3| (ripple(&(x + d)) - ripple(&(x - d))) / (2.0 * d.norm());
        let (along, down) = (slope(Vec3::x() * 1e-5), slope(Vec3::z() * 1e-5));
        let truth = Vec3::new(-along, down, 1.0).normalize();
        let shown = map.sample(Vec2::new(0.05 + 0.45 * x.x / SIDE, 0.5 + 0.45 * x.z / SIDE));
        assert!(angle_deg(&truth, &shown) < 4.0, "{shown} for {truth}");
    }
}

#[test]
fn the_mask_of_creases_has_their_angles() {
    let (asset, coarse, shown, surface) = creased_sheet(0.0);
    let detail = DetailInput {
        coarse: &coarse,
        displacement: &shown.displacement,
        surface: &surface,
        flat_normals: FlatNormals::default(),
    };
    let glb = write_worn_glb(&asset, &coarse, &shown, &json!({"crease": {"sidecar": "x"}})).unwrap();
    let options = MapOptions { creases: true, ..MapOptions::new(1024, MapDepth::Eight) };
    let detailed = add_detail_map(&glb, &asset, &detail, options).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(detailed.maps[0].crease_png.as_ref().unwrap()))
        .read_info()
        .unwrap();
    let mut grey = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut grey).unwrap();
    // In the left island the crease of 90 degrees lies at v = 0.725, 2 mm wide.
    let at = |level: f64| {
        let [u, v] = [0.05 + 0.45 * 0.09 / SIDE, 0.5 + 0.45 * (0.5 * SIDE + level) / SIDE];
        grey[(v * 1024.0) as usize * 1024 + (u * 1024.0) as usize]
    };
    assert!(at(0.0).abs_diff(127) <= 4, "{}", at(0.0));
    assert!((20..115).contains(&at(0.0015)), "{}", at(0.0015));
    assert_eq!((at(0.004), at(-0.004)), (0, 0));
}

//! Cloth that was exported with its thickness: one side is simulated, the other follows it. Where the sides cannot be told apart, this
//! is told with the cure.

#[path = "common/glb.rs"]
mod glb;

use crease::{GarmentFile, RestState, Vec3, WornGarment};
use crease_io::ReadOptions;
use crease_model::error::Message;
use crease_model::garment::{RigidParts, content_warnings};
use glb::{Part, glb as file};
use std::collections::HashMap;

/// `part` as a solid: a second side at the places that `inner` gives, and a rim along its borders.
fn solid(part: &Part, inner: impl Fn([f64; 3]) -> [f64; 3]) -> Part {
    let count = part.positions.len() as u32;
    let mut solid = part.clone();
    solid.positions.extend(part.positions.iter().map(|x| inner(*x)));
    solid.uvs.extend(part.uvs.clone());
    solid.triangles.extend(part.triangles.iter().map(|[a, b, c]| [count + a, count + c, count + b]));
    let mut sides: HashMap<[u32; 2], i32> = HashMap::new();
    for t in &part.triangles {
        for k in 0..3 {
            let [a, b] = [t[k], t[(k + 1) % 3]];
            *sides.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
        }
    }
    let mut rim: Vec<([u32; 2], i32)> = sides.into_iter().filter(|(_, count)| *count != 0).collect();
    rim.sort_unstable();
    for ([a, b], turn) in rim {
        let [a, b] = if turn > 0 { [a, b] } else { [b, a] };
        solid.triangles.extend([[b, a, count + a], [b, count + a, count + b]]);
    }
    solid
}

/// A tube without ends: a skirt.
fn skirt() -> Part {
    let mut tube = Part::can(24, 0.2, 0.5, [0.0; 3]);
    tube.triangles.retain(|t| t.iter().all(|v| *v < 48));
    tube.positions.truncate(48);
    tube.uvs.truncate(48);
    tube
}

/// A panel of a skirt of radius 0.2 m and height 0.55 m: `columns` of `around` from the column `first`, and `rows` of squares.
fn panel(first: u32, columns: u32, around: u32, rows: u32) -> Part {
    let (mut part, row) = (Part::default(), columns + 1);
    for k in 0..row * (rows + 1) {
        let [u, v] = [(first + k % row, around), (k / row, rows)].map(|(i, n)| f64::from(i) / f64::from(n));
        let (sin, cos) = (std::f64::consts::TAU * u).sin_cos();
        part.positions.push([0.2 * sin, 0.55 * v, 0.2 * cos]);
        part.uvs.push([u, v]);
    }
    for (i, j) in (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j))) {
        let a = j * row + i;
        part.triangles.extend([[a, a + 1, a + row + 1], [a, a + row + 1, a + row]]);
    }
    part
}

/// A skirt of 11 rows of 24 squares in two panels with vertices of their own along the side seams.
fn panels() -> [Part; 2] {
    [0, 12].map(|first| panel(first, 12, 24, 11))
}

/// Moves a position away from the y axis by `shift` metres.
fn outwards(shift: f64) -> impl Fn([f64; 3]) -> [f64; 3] {
    move |[x, y, z]| {
        let factor = 1.0 + shift / f64::hypot(x, z);
        [x * factor, y, z * factor]
    }
}

/// Both parts as one.
fn joined([mut a, b]: [Part; 2]) -> Part {
    let count = a.positions.len() as u32;
    a.positions.extend(b.positions);
    a.uvs.extend(b.uvs);
    a.triangles.extend(b.triangles.iter().map(|t| t.map(|v| count + v)));
    a
}

fn parse(part: &Part) -> GarmentFile {
    let bytes = file(&[("shirt", vec![part.clone()])], |_| {});
    GarmentFile::parse("a.glb", &bytes, &ReadOptions::default()).expect("is a garment")
}

/// Warnings about sides that cannot be told apart.
fn doubts(mesh: &GarmentFile) -> Vec<Message> {
    let warnings = content_warnings(&mesh.asset, &mesh.garment).into_iter();
    warnings.filter(|warning| warning.contains("without any opening")).collect()
}

/// Distances of the points of `a` from those of `b` with the same number.
fn distances(a: &[Vec3], b: &[Vec3]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).collect()
}

#[test]
fn of_cloth_with_a_thickness_one_side_is_simulated() {
    for thickness in [0.0005, 0.0012, 0.003] {
        let narrower = outwards(-thickness);
        let lower = |[x, y, z]: [f64; 3]| [x, y, z - thickness];
        for (one, thick) in [
            (skirt(), solid(&skirt(), narrower)),
            (Part::sheet(10, 0.5, [0.0; 3]), solid(&Part::sheet(10, 0.5, [0.0; 3]), lower)),
        ] {
            let mesh = parse(&thick);
            assert!(doubts(&mesh).is_empty(), "{:?}", doubts(&mesh));
            let garment = mesh.garment;
            let layers = RigidParts::find(&garment).expect("two sides");
            assert_eq!(layers.cloth().triangles.len(), one.triangles.len(), "{thickness}");
            assert_eq!(layers.cloth().topology.hinges.len(), parse(&one).garment.topology.hinges.len());
            assert!(layers.notes()[0].contains("exported with its thickness"), "{:?}", layers.notes());
            // Rolled up, both sides keep their distance.
            let roll = |x: &Vec3| {
                let (sin, cos) = (x.y / 0.1).sin_cos();
                Vec3::new(x.x, (0.1 + x.z) * sin, (0.1 + x.z) * cos)
            };
            let rolled: Vec<Vec3> = layers.cloth().points.iter().map(roll).collect();
            let whole = layers.positions(&rolled);
            let half = garment.points.len() / 2;
            let before = distances(&garment.points[..half], &garment.points[half..]);
            let after = distances(&whole[..half], &whole[half..]);
            let worst = before.iter().zip(&after).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(worst < 0.2 * thickness, "{worst} of {thickness}");
        }
    }
    // One side, a pillow and a can are what they were.
    for other in [
        skirt(),
        Part::sheet(10, 0.5, [0.0; 3]),
        solid(&Part::sheet(10, 0.5, [0.0; 3]), |[x, y, z]| [x, y, z - 0.08]),
        Part::can(24, 0.2, 0.5, [0.0; 3]),
    ] {
        let mesh = parse(&other);
        assert!(doubts(&mesh).is_empty(), "{:?}", doubts(&mesh));
        assert!(RigidParts::find(&mesh.garment).is_none());
    }
}

#[test]
fn both_sides_of_cloth_with_a_thickness_remember_a_fold() {
    let thick = solid(&Part::sheet(16, 0.4, [0.0; 3]), |[x, y, z]| [x, y, z - 0.001]);
    let mesh = parse(&thick);
    let garment = &mesh.garment;
    let layers = RigidParts::find(garment).expect("two sides");
    // Every hinge of the simulated side along y = 0 remembers half a right angle.
    let angle = |h: &crease_geometry::mesh::Hinge| {
        crease_geometry::mesh::hinge_angle(&h.points.map(|p| layers.cloth().points[p.at()]))
    };
    let angles = layers.cloth().topology.hinges.iter().map(angle).collect();
    let mut cloth = WornGarment {
        displacement: vec![Vec3::zeros(); layers.cloth().points.len()],
        memory: RestState::new(angles, layers.cloth().triangles.len()),
    };
    let turn = std::f64::consts::FRAC_PI_4;
    for (h, hinge) in layers.cloth().topology.hinges.iter().enumerate() {
        if hinge.points[..2].iter().all(|p| layers.cloth().points[p.at()].y.abs() < 1e-9) {
            cloth.memory.rest_angle[h] += turn;
        }
    }
    let worn = layers.worn(&cloth);
    let of = |front: bool| {
        let on_side = |h: &&crease_geometry::mesh::Hinge| {
            h.points.iter().all(|p| (garment.points[p.at()].z > -1e-4) == front)
        };
        let hinges = garment.topology.hinges.iter().zip(0..).filter(|(h, _)| on_side(h));
        let length = |h: &crease_geometry::mesh::Hinge| {
            (garment.points[h.points[0].at()] - garment.points[h.points[1].at()]).norm()
        };
        hinges
            .map(|(h, i)| length(h) * (worn.memory.rest_angle[i] - worn.memory.source_angle[i]))
            .sum::<f64>()
    };
    // What a fold remembers: its angle times its length; seen from the other side it bends in the other direction.
    let (front, back) = (of(true).abs().max(of(false).abs()), of(true) + of(false));
    assert!((front - 0.4 * turn).abs() < 0.05 * turn, "{front}");
    assert!(back.abs() < 0.15 * front, "{back} beside {front}");
}

#[test]
fn two_sides_without_a_rim_are_one_cloth() {
    for thickness in [0.0005, 0.0015, 0.003] {
        let narrower = outwards(-thickness);
        let one = joined(panels());
        // The inner side faces inwards, or as the outer one does.
        for inner in [one.clone().reversed().moved(&narrower), one.clone().moved(&narrower)] {
            let mesh = parse(&joined([inner, one.clone()]));
            let layers = RigidParts::find(&mesh.garment).expect("two sides");
            assert_eq!(layers.cloth().triangles.len(), one.triangles.len(), "{thickness}");
            let radius = |p: &Vec3| p.x.hypot(p.z);
            assert!(
                layers.cloth().points.iter().all(|p| radius(p) > 0.2 - 1e-6),
                "the outer side is simulated"
            );
        }
    }
    // A lining at a distance, flat layers, and a lining that is not everywhere under the cloth.
    let moved = |map: &dyn Fn([f64; 3]) -> [f64; 3]| joined([joined(panels()), joined(panels()).moved(map)]);
    for (what, two) in [
        ("8 mm apart", moved(&|[x, y, z]| [0.96 * x, y, 0.96 * z])),
        ("shorter", moved(&|[x, y, z]| [0.993 * x, 0.7 * y, 0.993 * z])),
        ("a flat front and back", {
            let sheet = Part::sheet(10, 0.5, [0.0; 3]);
            joined([sheet.clone(), sheet.reversed().moved(|[x, y, z]| [x, y, z - 0.0015])])
        }),
    ] {
        assert!(RigidParts::find(&parse(&two).garment).is_none(), "{what}");
    }
}

#[test]
fn panels_with_a_thickness_of_their_own_are_sewn() {
    let thickness = 0.0015;
    let thin = parse(&joined(panels()));
    let area = crease::inspect(&thin.asset, &thin.garment, &thin.diagnostics).area_m2;
    let one = thin.garment;
    assert_eq!(one.topology.boundary_loops(&one.triangles).len(), 2, "sewn at the sides");
    // Rims that coincide along the seams; rims that stand apart there, as each panel got its thickness across its own middle.
    let across = |sign: f64, shift: f64| {
        move |[x, y, z]: [f64; 3]| {
            let [out_x, out_z] = [x + 0.3 * sign, z];
            let length = f64::hypot(out_x, out_z);
            [x + shift * out_x / length, y, z + shift * out_z / length]
        }
    };
    let [a, b] = panels();
    let coincident = joined([a.clone(), b.clone()].map(|part| solid(&part, outwards(-thickness))));
    let half = 0.5 * thickness;
    let apart = |part: &Part, sign: f64| {
        // `solid` takes the other side's place from the middle's: it is twice as far.
        let outer = part.clone().moved(across(sign, half));
        let inner: Vec<[f64; 3]> = part.positions.iter().map(|x| across(sign, -half)(*x)).collect();
        let mut thick = solid(&outer, |x| x);
        thick.positions.truncate(outer.positions.len());
        thick.positions.extend(inner);
        thick
    };
    let wedged = joined([apart(&a, 1.0), apart(&b, -1.0)]);
    for (what, thick) in [("coincident", coincident), ("apart", wedged)] {
        let mesh = parse(&thick);
        assert!(doubts(&mesh).is_empty(), "{what}: {:?}", doubts(&mesh));
        let layers = RigidParts::find(&mesh.garment).expect("two sides");
        let cloth = layers.cloth();
        assert_eq!(cloth.triangles.len(), one.triangles.len(), "{what}");
        assert_eq!(cloth.points.len(), one.points.len(), "{what}: the side seams are sewn");
        assert_eq!(cloth.topology.hinges.len(), one.topology.hinges.len(), "{what}");
        let shown = crease::inspect(&mesh.asset, &mesh.garment, &mesh.diagnostics);
        assert_eq!(shown.boundary_loops_m.len(), 2, "{what}: one side counts");
        assert!((shown.area_m2 / area - 1.0).abs() < 0.02, "{what}: {} m2", shown.area_m2);
        // Where vertices were joined over a distance, the sidecar still knows its mesh.
        let worn = layers.worn(&WornGarment {
            displacement: vec![Vec3::zeros(); cloth.points.len()],
            memory: RestState::flat(cloth.topology.hinges.len(), cloth.triangles.len()),
        });
        let null = serde_json::Value::Null;
        let sidecar =
            crease_io::Sidecar::new(&mesh.asset, &mesh.garment, &worn, null.clone(), null.clone(), null);
        assert_eq!(sidecar.expect("fits").mesh_mismatch(&mesh.asset), None, "{what}");
    }
}

#[test]
fn cloth_with_openings_is_no_body_however_fine_it_is() {
    // A skirt of 28,800 triangles: its two borders are 1 % of its edges.
    let fine = panel(0, 240, 240, 60);
    let pocket = Part::sheet(4, 0.1, [0.0, 0.25, 0.25]);
    let told = |cloth: Part| {
        let bytes = file(&[("skirt", vec![cloth]), ("pocket", vec![pocket.clone()])], |_| {});
        let mesh = GarmentFile::parse("a.glb", &bytes, &ReadOptions::default()).expect("is a garment");
        Message::join(content_warnings(&mesh.asset, &mesh.garment), "\n")
    };
    assert!(!told(fine).contains("looks like a body"));
    assert!(told(Part::can(240, 0.2, 0.5, [0.0; 3])).contains("looks like a body"));
}

#[test]
fn front_and_back_of_a_garment_that_lies_are_no_sides_of_a_shell() {
    // A flat tube and a flat bag, open at the ends or at one, whose layers lie 1.2 mm apart: as thin as cloth, but with openings.
    for ends in [2, 1] {
        let mut flat = skirt();
        for [_, _, z] in &mut flat.positions {
            *z *= 0.003;
        }
        if ends == 1 {
            flat.triangles.extend((1..23u32).map(|k| [k + 1, k, 0]));
        }
        let mesh = parse(&flat);
        assert!(RigidParts::find(&mesh.garment).is_none(), "{ends} openings");
        assert!(doubts(&mesh).is_empty(), "{:?}", doubts(&mesh));
    }
}

#[test]
fn sides_that_cannot_be_told_apart_are_warned_about() {
    // Both sides meet at a sharp border: there is no rim. A lens, and a pillow that lies flat.
    let sheet = Part::sheet(8, 0.4, [0.0; 3]);
    for shape in [|x: f64| 1.0 - (x / 0.2).powi(2), |x: f64| (20.0 * (1.0 - x.abs() / 0.2)).min(1.0)] {
        let lens = solid(&sheet, |[x, y, z]| [x, y, z - (0.003 * shape(x) * shape(y)).max(0.0)]);
        let mesh = parse(&lens);
        assert!(RigidParts::find(&mesh.garment).is_none());
        let doubts = doubts(&mesh);
        assert!(doubts.len() == 1 && doubts[0].contains("Solidify"), "{doubts:?}");
    }
}

//! Transfers where textures and positions disagree, joints under exporters' names, and doubts that are told.

use crate::glb::{Part, glb};
use crease::internal::transfer::{
    Align, AlignedBy, MatchBy, TransferOptions, TransferResult, TransferSource, transfer,
};
use crease::{GarmentFile, ReadOptions};
use crease_geometry::math::{Mat3, Vec3};
use crease_model::error::Message;
use crease_model::garment::{RestState, SourceJoint};
use crease_model::remesh::GarmentSurface;

fn surface(parts: Vec<Part>) -> GarmentSurface {
    let bytes = glb(&[("cloth", parts)], |_| {});
    let file = GarmentFile::parse("a.glb", &bytes, &ReadOptions::default()).expect("is a garment");
    GarmentSurface::from_garment(&file.garment, &file.asset)
}

fn source(surface: GarmentSurface, is_crease: impl Fn(Vec3) -> bool) -> TransferSource {
    let mut memory = RestState::new(vec![0.0; surface.topology.hinges.len()], surface.triangles.len());
    for (angle, hinge) in memory.rest_angle.iter_mut().zip(&surface.topology.hinges) {
        let middle = (surface.points[hinge.points[0].at()] + surface.points[hinge.points[1].at()]) * 0.5;
        *angle = if is_crease(middle) { 0.5 } else { 0.0 };
    }
    TransferSource { file: "from".into(), surface, memory, joints: Vec::new(), simulated: None }
}

/// Sum of the changes [rad] of hinges whose middle is where `at` says, relative to all.
fn fraction_at(carried: &TransferResult, target: &GarmentSurface, at: impl Fn(Vec3) -> bool) -> f64 {
    let (mut there, mut all) = (0.0, 0.0);
    for (h, hinge) in target.topology.hinges.iter().enumerate() {
        let change = (carried.memory.rest_angle[h] - carried.memory.source_angle[h]).abs();
        let middle = (target.points[hinge.points[0].at()] + target.points[hinge.points[1].at()]) * 0.5;
        all += change;
        there += if at(middle) { change } else { 0.0 };
    }
    there / all
}

/// A half pipe of another texture at every place, deep enough to have a front.
fn pipe(cells: u32) -> Part {
    Part::sheet(cells, 1.0, [0.0; 3]).moved(|[x, y, _]| {
        let angle = 2.5 * x;
        [0.2 * angle.sin(), 0.6 * y, 0.2 * angle.cos()]
    })
}

#[test]
fn textures_that_agree_one_to_one_win_over_boxes() {
    let from = source(surface(vec![pipe(16)]), |p| (0.1..0.14).contains(&p.x));
    let scaled = |[x, y, z]: [f64; 3]| [0.02 - 1.3 * x, 1.3 * y + 0.4, -1.3 * z];
    let tilted = |[x, y, z]: [f64; 3]| [x, 0.8 * y - 0.6 * z, 0.6 * y + 0.8 * z + 0.5];
    type Place = fn(Vec3) -> bool;
    let turned: Place = |p| (0.06..0.18).contains(&((0.02 - p.x) / 1.3));
    let same_x: Place = |p| (0.06..0.18).contains(&p.x);
    let cases: [(Part, Place); 2] = [(pipe(20).moved(scaled), turned), (pipe(20).moved(tilted), same_x)];
    for (part, place) in cases {
        let target = surface(vec![part]);
        let carried =
            transfer(std::slice::from_ref(&from), &target, &TransferOptions::full(target.points.len()))
                .expect("works");
        assert_eq!(carried.sources[0].matched_by, MatchBy::Uv);
        assert_eq!(carried.sources[0].aligned_by, Some(AlignedBy::Texture));
        assert!(fraction_at(&carried, &target, place) > 0.8, "{}", fraction_at(&carried, &target, place));
        assert!(carried.warnings.is_empty(), "{:?}", carried.warnings);
    }
    // Turned about the middle of a closed tube, which then lies where it lay before.
    let tube = |cells: u32| {
        Part::sheet(cells, 1.0, [0.0; 3]).moved(|[x, y, _]| {
            let angle = std::f64::consts::TAU * x;
            [0.25 * angle.sin(), 0.6 * y, 0.1 * angle.cos()]
        })
    };
    let from_tube = source(surface(vec![tube(24)]), |p| (0.1..0.14).contains(&p.x) && p.z > 0.0);
    let target = surface(vec![tube(28).moved(|[x, y, z]| [-x, y, -z])]);
    let carried =
        transfer(&[from_tube], &target, &TransferOptions::full(target.points.len())).expect("works");
    let there = fraction_at(&carried, &target, |p| (0.02..0.22).contains(&-p.x) && p.z < 0.0);
    assert!(there > 0.8, "{there} {:?}", carried.sources);
    // A texture that says something else at every place is no map.
    let other = pipe(20).moved(scaled).textured(|[u, v]| [u * u, v]);
    let target = surface(vec![other]);
    let carried = transfer(&[from], &target, &TransferOptions::full(target.points.len())).expect("works");
    assert_eq!(carried.sources[0].matched_by, MatchBy::Surface);
}

#[test]
fn islands_that_lie_on_one_another_are_told_apart_by_place() {
    let pair = |cells: u32| {
        let right = Part::sheet(cells, 0.3, [0.3, 0.0, 0.0]);
        vec![Part::sheet(cells, 0.3, [-0.3, 0.0, 0.0]), right.textured(|[u, v]| [1.0 - u, v])]
    };
    let target = surface(pair(17));
    for side in [-1.0, 1.0] {
        let from = source(surface(pair(12)), |p| (0.3..0.35).contains(&(side * p.x)));
        for match_by in [MatchBy::Auto, MatchBy::Uv] {
            let options = TransferOptions { match_by, ..TransferOptions::full(target.points.len()) };
            let carried = transfer(std::slice::from_ref(&from), &target, &options).expect("works");
            let there = fraction_at(&carried, &target, |p| side * p.x > 0.0);
            assert!(there > 0.99, "{side} {match_by:?}: {there}");
            assert!(carried.sources[0].ambiguous_fraction > 0.9);
            assert!(
                carried.warnings.iter().any(|told| told.contains("several places")),
                "{:?}",
                carried.warnings
            );
        }
    }
}

#[test]
fn joints_are_compared_without_the_prefixes_of_exporters() {
    let joint = |name: &str, x: f64, shift: f64| SourceJoint {
        name: name.into(),
        position: Vec3::new(x + shift, 0.01 * x, 0.0),
        axes: Mat3::identity(),
        parent: None,
    };
    let joints = |prefix: &str, shift: f64| -> Vec<SourceJoint> {
        ["Hips", "Spine", "LeftArm", "LeftHand"]
            .iter()
            .zip([-0.2, -0.1, 0.1, 0.3])
            .map(|(name, x)| {
                joint(&format!("{prefix}{name}"), if *name == "Spine" { x * x } else { x }, shift)
            })
            .collect()
    };
    let sheet = |x: f64| surface(vec![Part::sheet(10, 0.4, [x, 0.0, 0.0]).textured(|_| [0.0, 0.0])]);
    let mut from = source(sheet(0.0), |p| p.x > 0.0);
    let target = sheet(3.0);
    for (own, other) in [("mixamorig:", ""), ("Armature|", "Rig:"), ("", "character:mixamorig:")] {
        from.joints = joints(own, 0.0);
        let options = TransferOptions {
            align: Align::Joints,
            match_by: MatchBy::Surface,
            joints: joints(other, 3.0),
            ..TransferOptions::full(target.points.len())
        };
        let carried = transfer(std::slice::from_ref(&from), &target, &options).expect("has common joints");
        assert_eq!(carried.sources[0].aligned_by, Some(AlignedBy::Joints));
    }
}

#[test]
fn little_confidence_and_nothing_at_all_are_told() {
    let from = source(surface(vec![Part::sheet(8, 0.4, [0.0; 3])]), |_| true);
    let target = surface(vec![Part::sheet(9, 0.4, [0.3, 0.0, 0.0]).textured(|_| [0.0, 0.0])]);
    let options = TransferOptions { align: Align::InPlace, ..TransferOptions::full(target.points.len()) };
    let carried = transfer(std::slice::from_ref(&from), &target, &options).expect("works");
    let told = Message::join(carried.warnings.clone(), "\n");
    assert!(told.contains("low confidence") && told.contains("of its creases lie on cloth"), "{told}");
    assert_eq!(carried.empty_reason, None);
    let target = surface(vec![Part::sheet(9, 0.4, [3.0, 0.0, 0.0]).textured(|_| [0.0, 0.0])]);
    let carried = transfer(&[from], &target, &options).expect("works");
    assert!(carried.empty_reason.is_some_and(|reason| reason.contains("Transfer::align")));
}

/// A tube upright along y, open at both ends, with two arms of `arm` metres that point sideways: four openings.
fn shirt(arm: f64, cells: u32) -> Part {
    // Sleeves are tubes of their own, joined at the positions of a square hole on either side.
    let mut part = Part::default();
    let mut add = |a: [f64; 3], b: [f64; 3], c: [f64; 3], d: [f64; 3]| {
        let n = f64::from(cells);
        let first = part.positions.len() as u32;
        for k in 0..(cells + 1) * (cells + 1) {
            let [s, t] = [k % (cells + 1), k / (cells + 1)].map(|i| f64::from(i) / n);
            let mix =
                |k: usize| (a[k] * (1.0 - s) + b[k] * s) * (1.0 - t) + (d[k] * (1.0 - s) + c[k] * s) * t;
            part.positions.push([mix(0), mix(1), mix(2)]);
            part.uvs.push([0.0, 0.0]);
        }
        for (i, j) in (0..cells).flat_map(|j| (0..cells).map(move |i| (i, j))) {
            let p = first + j * (cells + 1) + i;
            part.triangles.extend([[p, p + 1, p + cells + 2], [p, p + cells + 2, p + cells + 1]]);
        }
    };
    let (w, z, low, mid, top) = (0.25, 0.1, 0.0, 0.45, 0.65);
    for side in [1.0, -1.0] {
        // Front and back of the torso, below and beside the sleeves, then the four sides of a sleeve.
        let at = |x: f64, y: f64| [side * x, y, side * z];
        for (y0, y1) in [(low, mid), (mid, top)] {
            add(at(-w, y0), at(w, y0), at(w, y1), at(-w, y1));
        }
        let flank = |y: f64, depth: f64| [side * w, y, depth];
        add(flank(low, side * z), flank(low, -side * z), flank(mid, -side * z), flank(mid, side * z));
        let ring = [[mid, -z], [mid, z], [top, z], [top, -z]];
        for k in 0..4 {
            let ([y0, z0], [y1, z1]) = (ring[k], ring[(k + 1) % 4]);
            let (inner, outer) = (side * w, side * (w + arm));
            let corners = [[outer, y0, z0], [outer, y1, z1], [inner, y1, z1], [inner, y0, z0]];
            let [a, b, c, d] =
                if side > 0.0 { corners } else { [corners[1], corners[0], corners[3], corners[2]] };
            add(a, b, c, d);
        }
    }
    // Wider at the hem than at the neck.
    part.moved(|[x, y, z]| [x, y, z * (1.0 + 0.5 * (top - y))])
}

/// The torso of a long-sleeved shirt comes to the torso of a short-sleeved one, whatever the sleeves do to the boxes.
#[test]
fn other_lengths_of_sleeves_do_not_stretch_the_torso() {
    for (from_arm, to_arm) in [(0.6, 0.15), (0.15, 0.6)] {
        let near = |p: Vec3| (p.x - 0.2).abs() < 0.03 && p.y < 0.4;
        let from = source(surface(vec![shirt(from_arm, 16)]), near);
        // Not in place: the target is another size, and elsewhere.
        let target = surface(vec![shirt(to_arm, 14).moved(|x| x.map(|x| 1.2 * x + 1.0))]);
        let carried = transfer(&[from], &target, &TransferOptions::full(target.points.len())).expect("works");
        assert_eq!(carried.sources[0].aligned_by, Some(AlignedBy::Limbs), "{from_arm}");
        let there = fraction_at(&carried, &target, |p| {
            let own = (p - Vec3::repeat(1.0)) / 1.2;
            (own.x - 0.2).abs() < 0.09 && own.y < 0.48
        });
        assert!(there > 0.9, "{from_arm}: {there}");
    }
}

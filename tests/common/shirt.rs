//! A shirt in the shape of a body, made of squares.

use crease_model::garment::{Garment, MeshOptions};
use std::collections::BTreeMap;

/// Edge of the squares a shirt is made of [m].
const CELL: f64 = 0.03;
/// Half width of the torso and reach of the sleeves, in squares.
const TORSO: i32 = 8;
const SLEEVE: i32 = 17;

/// Whether the square with its lower corner at (i, j) belongs to the outline of the shirt.
fn is_inside(i: i32, j: i32) -> bool {
    let out = if i >= 0 { i } else { -i - 1 };
    let is_neck = j >= 18 && out < 3;
    (0..20).contains(&j) && !is_neck && (out < TORSO || (out < SLEEVE && j >= 14))
}

/// A shirt of a front and a back, bulged like the body in it. The sleeve on +x is bent down by `bend` [rad]; with `collar` the
/// front of the neck lies behind its back.
pub fn shirt(bend: f64, collar: bool) -> Garment {
    let squares: Vec<[i32; 2]> = (0..20)
        .flat_map(|j| (-SLEEVE..SLEEVE).map(move |i| [i, j]))
        .filter(|[i, j]| is_inside(*i, *j))
        .collect();
    let mut edges: BTreeMap<[[i32; 2]; 2], u32> = BTreeMap::new();
    for [i, j] in &squares {
        let corner = |di: i32, dj: i32| [i + di, j + dj];
        for edge in [
            [corner(0, 0), corner(1, 0)],
            [corner(0, 1), corner(1, 1)],
            [corner(0, 0), corner(0, 1)],
            [corner(1, 0), corner(1, 1)],
        ] {
            *edges.entry(edge).or_default() += 1;
        }
    }
    // Front and back are sewn together along the outline, but for hem, cuffs and neck.
    let is_open = |[a, b]: &[[i32; 2]; 2]| {
        let is_hem = a[1] == 0 && b[1] == 0;
        let is_cuff = a[0] == b[0] && a[0].abs() == SLEEVE;
        let is_neck = a[1].min(b[1]) >= 18 && a[0].abs().max(b[0].abs()) <= 3;
        is_hem || is_cuff || is_neck
    };
    let outline = edges.iter().filter(|(edge, count)| **count == 1 && !is_open(edge));
    let sewn: Vec<[i32; 2]> = outline.flat_map(|(edge, _)| *edge).collect();
    let mut points: Vec<[f64; 3]> = Vec::new();
    let mut number: BTreeMap<([i32; 2], i32), u32> = BTreeMap::new();
    let mut triangles = Vec::new();
    for [i, j] in &squares {
        for side in [1, -1] {
            let corners = [[*i, *j], [i + 1, *j], [i + 1, j + 1], [*i, j + 1]].map(|at| {
                let side = if sewn.contains(&at) { 0 } else { side };
                *number.entry((at, side)).or_insert_with(|| {
                    points.push(position(at, side, bend, collar));
                    points.len() as u32 - 1
                })
            });
            let [a, b, c, d] = corners;
            triangles.extend(if side > 0 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
        }
    }
    Garment::from_mesh(&points, &triangles, MeshOptions::default().name("shirt")).expect("is a garment")
}

fn position([i, j]: [i32; 2], side: i32, bend: f64, collar: bool) -> [f64; 3] {
    let (out, up) = (f64::from(i.abs()), f64::from(j));
    let arc = |part: f64| (1.0 - part * part).max(0.0).sqrt();
    let depth = match (i.abs() <= TORSO, j < 14) {
        (true, true) => 0.1 * arc(out / f64::from(TORSO)),
        (true, false) => 0.1 * arc((up - 14.0) / 6.0),
        (false, _) => 0.05 * arc((up - 17.0) / 3.0),
    };
    let mut z = f64::from(side) * depth.max(0.01);
    if collar && side > 0 && j >= 18 && i.abs() <= 3 {
        z = -z - 0.03;
    }
    let (x, y) = (CELL * f64::from(i), CELL * up);
    let along = x - CELL * f64::from(TORSO);
    if along <= 1e-9 {
        return [x, y, z];
    }
    let above = y - CELL * 14.0;
    let (sin, cos) = (bend * (along / (4.0 * CELL)).min(1.0)).sin_cos();
    [CELL * f64::from(TORSO) + along * cos + above * sin, CELL * 14.0 - along * sin + above * cos, z]
}

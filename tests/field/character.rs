//! A small character as games have them: a skeleton, a body of which the skin under the clothes is cut away, and clothes that
//! are bound to the same skeleton; a clip in which it walks, turns its chest and swings its arms.

// Each test uses a part of them.
#![allow(dead_code)]

use crate::document::Document;
use crate::shapes::{add_node, empty};
use serde_json::{Value, json};
use std::f32::consts::{PI, TAU};

/// Centre and radius of a ring [m], and its binding: two joints, and the weight of the second.
pub type Ring = ([f32; 3], f32, (u8, u8, f32));

/// A mesh with one joint per vertex, or two.
#[derive(Clone, Default)]
pub struct Bound {
    pub positions: Vec<[f32; 3]>,
    pub corners: Vec<u16>,
    /// Per vertex: two joints, and the weight of the second.
    pub weights: Vec<(u8, u8, f32)>,
}

impl Bound {
    /// A tube of `around` points through rings of centre, radius and binding.
    pub fn tube(around: u16, rings: &[Ring]) -> Self {
        let mut bound = Self::default();
        for (centre, radius, weight) in rings {
            for k in 0..around {
                let angle = TAU * f32::from(k) / f32::from(around);
                let [x, y, z] = *centre;
                bound.positions.push([x + radius * angle.sin(), y, z + radius * angle.cos()]);
                bound.weights.push(*weight);
            }
        }
        for j in 0..rings.len() as u16 - 1 {
            for k in 0..around {
                let at = |j: u16, k: u16| j * around + k % around;
                let [a, b, c, d] = [at(j, k), at(j, k + 1), at(j + 1, k + 1), at(j + 1, k)];
                bound.corners.extend([a, b, c, a, c, d]);
            }
        }
        // Rings go up: seen from outside the corners run counter-clockwise.
        bound
    }

    /// Closes the tube at its first and last ring.
    pub fn closed(mut self, around: u16) -> Self {
        let rings = self.positions.len() as u16 / around;
        for (ring, is_last) in [(0, false), (rings - 1, true)] {
            let first = ring * around;
            let centre: [f32; 3] = std::array::from_fn(|k| {
                let own = &self.positions[usize::from(first)..usize::from(first + around)];
                own.iter().map(|p| p[k]).sum::<f32>() / f32::from(around)
            });
            let middle = self.positions.len() as u16;
            self.positions.push(centre);
            self.weights.push(self.weights[usize::from(first)]);
            for k in 0..around {
                let (a, b) = (first + k, first + (k + 1) % around);
                self.corners.extend(if is_last { [a, b, middle] } else { [b, a, middle] });
            }
        }
        self
    }

    /// The parts as one mesh.
    pub fn joined(parts: &[Self]) -> Self {
        let mut all = Self::default();
        for part in parts {
            let first = all.positions.len() as u16;
            all.positions.extend(&part.positions);
            all.weights.extend(&part.weights);
            all.corners.extend(part.corners.iter().map(|c| first + c));
        }
        all
    }
}

/// Joints of the character, in the order of its skin: name, parent, position [m].
pub const JOINTS: [(&str, Option<usize>, [f32; 3]); 8] = [
    ("hips", None, [0.0, 1.0, 0.0]),
    ("chest", Some(0), [0.0, 1.3, 0.0]),
    ("head", Some(1), [0.0, 1.55, 0.0]),
    ("arm.L", Some(1), [0.26, 1.45, 0.0]),
    ("arm.R", Some(1), [-0.26, 1.45, 0.0]),
    ("leg.L", Some(0), [0.1, 0.95, 0.0]),
    ("leg.R", Some(0), [-0.1, 0.95, 0.0]),
    ("foot.L", Some(5), [0.1, 0.1, 0.0]),
];
pub const HIPS: u8 = 0;
pub const CHEST: u8 = 1;
pub const HEAD: u8 = 2;

fn on(joint: u8) -> (u8, u8, f32) {
    (joint, joint, 0.0)
}

/// The body: head, arms and legs; its trunk from the hips to the neck was cut away.
pub fn body() -> Bound {
    let limb = |x: f32, from: f32, to: f32, radius: f32, joint: u8| {
        let ring = |k: u16| ([x, from + (to - from) * f32::from(k) / 6.0, 0.0], radius, on(joint));
        Bound::tube(10, &(0..7).map(ring).collect::<Vec<_>>()).closed(10)
    };
    let ball = |k: u16| {
        let angle = PI * (f32::from(k) + 0.5) / 8.0;
        ([0.0, 1.68 - 0.11 * angle.cos(), 0.0], 0.11 * angle.sin(), on(HEAD))
    };
    let head = Bound::tube(12, &(0..8).map(ball).collect::<Vec<_>>()).closed(12);
    let arms = [(0.3, 3), (-0.3, 4)].map(|(x, joint)| limb(x, 0.82, 1.42, 0.035, joint));
    let legs = [(0.1, 5), (-0.1, 6)].map(|(x, joint)| limb(x, 0.05, 0.9, 0.06, joint));
    Bound::joined(&[vec![head], arms.to_vec(), legs.to_vec()].concat())
}

/// A skirt from the hips to the knees, of rings of `around` points; it follows hips and legs.
pub fn skirt(around: u16, rings: u16) -> Bound {
    let ring = |k: u16| {
        let down = 1.0 - f32::from(k) / f32::from(rings - 1);
        ([0.0, 1.0 - 0.45 * down, 0.0], 0.15 + 0.09 * down, on(HIPS))
    };
    Bound::tube(around, &(0..rings).map(ring).collect::<Vec<_>>())
}

/// A hat: a cap over the upper half of the head with a brim.
pub fn hat(around: u16) -> Bound {
    let mut rings = vec![([0.0, 1.70, 0.0], 0.2, on(HEAD)), ([0.0, 1.71, 0.0], 0.16, on(HEAD))];
    for k in 0..5_u16 {
        let angle = 0.5 * PI * f32::from(k) / 5.0;
        rings.push(([0.0, 1.72 + 0.1 * angle.sin(), 0.0], 0.125 * angle.cos(), on(HEAD)));
    }
    let mut bound = Bound::tube(around, &rings);
    let top = bound.positions.len() as u16;
    bound.positions.push([0.0, 1.82, 0.0]);
    bound.weights.push(on(HEAD));
    (0..around).for_each(|k| bound.corners.extend([top - around + k, top - around + (k + 1) % around, top]));
    bound
}

/// A cape behind the back, from the shoulders down, of `columns` times `rows` squares.
pub fn cape(columns: u16, rows: u16) -> Bound {
    let mut bound = Bound::default();
    for (j, i) in (0..=rows).flat_map(|j| (0..=columns).map(move |i| (j, i))) {
        let (u, v) = (f32::from(i) / f32::from(columns) - 0.5, f32::from(j) / f32::from(rows));
        bound.positions.push([0.4 * u, 1.45 - 0.6 * v, -0.2 - 0.1 * v + 0.1 * u * u]);
        bound.weights.push(on(CHEST));
    }
    let row = columns + 1;
    for (j, i) in (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i))) {
        let a = j * row + i;
        let (b, c, d) = (a + 1, a + row + 1, a + row);
        bound.corners.extend([a, b, c, a, c, d]);
    }
    bound
}

/// A shirt around the trunk that is not there.
pub fn shirt(around: u16, rings: u16) -> Bound {
    let ring = |k: u16| {
        let up = f32::from(k) / f32::from(rings - 1);
        ([0.0, 0.95 + 0.5 * up, 0.0], 0.16 - 0.02 * up, (HIPS, CHEST, up))
    };
    Bound::tube(around, &(0..rings).map(ring).collect::<Vec<_>>())
}

/// Adds a mesh and the node that shows it, bound to `skin`.
pub fn add_bound(document: &mut Document, name: &str, bound: &Bound, skin: usize) -> usize {
    let position = document.positions(&bound.positions);
    let indices = document.indices(&bound.corners);
    let weights: Vec<f32> = bound.weights.iter().flat_map(|(_, _, w)| [1.0 - w, *w, 0.0, 0.0]).collect();
    let weights = document.floats("VEC4", 4, &weights);
    let joints: Vec<u8> = bound.weights.iter().flat_map(|(a, b, _)| [*a, *b, 0, 0]).collect();
    let view = document.view(&joints, None);
    let joints = document.push(
        "accessors",
        json!({"bufferView": view, "componentType": 5121, "count": bound.weights.len(), "type": "VEC4"}),
    );
    let attributes = json!({"POSITION": position, "JOINTS_0": joints, "WEIGHTS_0": weights});
    let mesh = json!({"name": name, "primitives": [{"attributes": attributes, "indices": indices}]});
    let mesh = document.push("meshes", mesh);
    add_node(document, json!({"name": name, "mesh": mesh, "skin": skin}))
}

/// Adds the skeleton under a node called `above`; returns its skin and the node of its first joint.
pub fn add_skeleton(document: &mut Document, above: &str) -> (usize, usize) {
    let first = document.json["nodes"].as_array().map_or(0, Vec::len);
    for (number, (name, parent, at)) in JOINTS.iter().enumerate() {
        let origin = parent.map_or([0.0; 3], |parent| JOINTS[parent].2);
        let local: Vec<f32> = at.iter().zip(origin).map(|(a, o)| a - o).collect();
        let children: Vec<usize> =
            (0..JOINTS.len()).filter(|k| JOINTS[*k].1 == Some(number)).map(|k| first + k).collect();
        let mut node = json!({"name": name, "translation": local});
        if !children.is_empty() {
            node["children"] = json!(children);
        }
        document.push("nodes", node);
    }
    add_node(document, json!({"name": above, "children": [first]}));
    let matrix = |(_, _, [x, y, z]): &(&str, Option<usize>, [f32; 3])| {
        [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -x, -y, -z, 1.0]
    };
    let inverse: Vec<f32> = JOINTS.iter().flat_map(matrix).collect();
    let inverse = document.floats("MAT4", 16, &inverse);
    let joints: Vec<usize> = (first..first + JOINTS.len()).collect();
    (document.push("skins", json!({"joints": joints, "inverseBindMatrices": inverse})), first)
}

/// Adds the clip "walk" of `seconds`: two steps a second over the ground along z, with swinging arms.
pub fn add_walk(document: &mut Document, first: usize, seconds: f32) {
    let count = (seconds * 8.0) as u16;
    let times: Vec<f32> = (0..=count).map(|k| seconds * f32::from(k) / f32::from(count)).collect();
    let input = document.floats("SCALAR", 1, &times);
    let (mut samplers, mut channels): (Vec<Value>, Vec<Value>) = (Vec::new(), Vec::new());
    let mut add = |document: &mut Document, node: usize, path: &str, width: usize, values: Vec<f32>| {
        let output = document.floats(if width == 3 { "VEC3" } else { "VEC4" }, width, &values);
        samplers.push(json!({"input": input, "output": output}));
        channels.push(json!({"sampler": samplers.len() - 1, "target": {"node": node, "path": path}}));
    };
    // About x, by the swing of the step.
    let swings = |degrees: f32| -> Vec<f32> {
        let at = |t: &f32| {
            let (sin, cos) = (0.5 * degrees.to_radians() * (TAU * t).sin()).sin_cos();
            [sin, 0.0, 0.0, cos]
        };
        times.iter().flat_map(at).collect()
    };
    // The chest turns about y.
    let turns = times.iter().flat_map(|t| {
        let (sin, cos) = (0.05 * (TAU * t).sin()).sin_cos();
        [0.0, sin, 0.0, cos]
    });
    let turns: Vec<f32> = turns.collect();
    add(document, first + 1, "rotation", 4, turns);
    for (joint, degrees) in [(3, 35.0), (4, -35.0), (5, -25.0), (6, 25.0)] {
        add(document, first + joint, "rotation", 4, swings(degrees));
    }
    let path = times.iter().flat_map(|t| [0.0, 1.0 + 0.02 * (2.0 * TAU * t).sin(), 1.2 * t]).collect();
    add(document, first, "translation", 3, path);
    document.push("animations", json!({"name": "walk", "samplers": samplers, "channels": channels}));
}

/// The character with `clothes` of these names.
pub fn character(clothes: &[(&str, Bound)], seconds: f32) -> Vec<u8> {
    let mut document = empty();
    let (skin, first) = add_skeleton(&mut document, "Armature");
    add_bound(&mut document, "body", &body(), skin);
    for (name, bound) in clothes {
        add_bound(&mut document, name, bound, skin);
    }
    add_walk(&mut document, first, seconds);
    document.glb()
}

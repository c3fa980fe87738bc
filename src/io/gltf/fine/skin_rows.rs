//! Joints and weights of new vertices: those of the vertices that they are means of, the largest of them.

use crate::gltf::fine::FinePiece;
use crate::gltf::fine::rows::AttributeRows;
use crease_model::remesh::FineVertex;

/// Influences in one set.
const SET_SIZE: usize = 4;

/// Sets the rows of `JOINTS_n` and `WEIGHTS_n` of the new `vertices` of `piece`.
pub(super) fn mix_influences(attributes: &mut [AttributeRows], piece: &FinePiece, vertices: &[&FineVertex]) {
    let place = |name: String| attributes.iter().position(|rows| rows.name == name && rows.width == SET_SIZE);
    let mut sets = Vec::new();
    while let Some(set) =
        place(format!("JOINTS_{}", sets.len())).zip(place(format!("WEIGHTS_{}", sets.len())))
    {
        sets.push(set);
    }
    for (k, vertex) in vertices.iter().enumerate() {
        let mut merged: Vec<(f64, f64)> = Vec::new();
        for (v, part) in vertex.of.iter().zip(vertex.weights).filter(|(_, part)| *part > 0.0) {
            let start = SET_SIZE * (*v as usize - piece.first);
            let entries = sets.iter().flat_map(|(joints, weights)| {
                let [joints, weights] =
                    [joints, weights].map(|rows| &attributes[*rows].values[start..start + SET_SIZE]);
                joints.iter().copied().zip(weights.iter().copied())
            });
            let entries: Vec<(f64, f64)> = entries.filter(|(_, weight)| *weight > 0.0).collect();
            let sum: f64 = entries.iter().map(|(_, weight)| weight).sum();
            for (joint, weight) in entries {
                match merged.iter_mut().find(|(own, _)| *own == joint) {
                    Some((_, own)) => *own += part * weight / sum,
                    None => merged.push((joint, part * weight / sum)),
                }
            }
        }
        merged.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.total_cmp(&b.0)));
        merged.truncate(SET_SIZE * sets.len());
        let sum: f64 = merged.iter().map(|(_, weight)| weight).sum();
        merged.resize(SET_SIZE * sets.len(), (0.0, 0.0));
        let start = SET_SIZE * (piece.points.len() + k);
        for (n, (joint, weight)) in merged.into_iter().enumerate() {
            let (joints, weights) = sets[n / SET_SIZE];
            attributes[joints].values[start + n % SET_SIZE] = joint;
            attributes[weights].values[start + n % SET_SIZE] = if sum > 0.0 { weight / sum } else { 0.0 };
        }
    }
}

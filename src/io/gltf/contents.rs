//! Reads the contents of a glTF document beside its triangles, for `crease inspect`.

use crate::gltf::json_cursor::Cursor;
use crate::gltf::rig::read_rig;
use crease_geometry::math::{Mat4, Vec3};
use crease_model::body::rig::Rig;
use crease_model::error::Result;
use crease_model::garment::{
    ClipReport, FileContents, JointReport, MorphReport, PieceAttributes, SourceAsset, SourcePiece,
};

/// Returns the contents of `asset`; those of an OBJ file are empty.
pub fn file_contents(asset: &SourceAsset) -> Result<FileContents> {
    let pieces: Vec<&SourcePiece> = asset.pieces.iter().collect();
    let (Some(document), Some(rig)) = (&asset.document, read_rig(asset, &pieces)?) else {
        return Ok(FileContents::default());
    };
    let root = Cursor::root(&document.json);
    let name = |piece: usize| pieces.get(piece).map(|piece| piece.name.clone()).unwrap_or_default();
    let clip = |(number, clip): (usize, &crease_model::body::clip::Clip)| {
        let mut moves: Vec<String> = rig.pieces_moved_by(clip).into_iter().map(name).collect();
        moves.dedup();
        ClipReport {
            number,
            name: clip.name.clone(),
            length_s: clip.length(),
            moves,
            damage: clip.damage.clone(),
        }
    };
    Ok(FileContents {
        joints: joint_reports(&rig),
        clips: rig.clips.iter().enumerate().map(clip).collect(),
        piece_attributes: pieces.iter().map(|piece| piece_attributes(&root, piece)).collect(),
    })
}

fn joint_reports(rig: &Rig) -> Vec<JointReport> {
    let (nodes, moves) = (rig.skeleton.nodes(), rig.moving_nodes());
    let worlds: Vec<Mat4> =
        rig.skeleton.world_transforms(&rig.skeleton.rest()).iter().map(|w| rig.to_scene * w).collect();
    let position = |node: usize| worlds[node].column(3).xyz();
    let mut children = vec![Vec::new(); nodes.len()];
    for (number, node) in nodes.iter().enumerate() {
        if let Some(parent) = node.parent {
            children[parent].push(number);
        }
    }
    let report = |number: usize| {
        let axes = [0, 1, 2].map(|k| {
            let column: Vec3 = worlds[number].column(k).xyz();
            column.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vec3::zeros)
        });
        // Of several joints below it the one that is farthest away shows the direction of the chain.
        let arms = children[number].iter().map(|&node| position(node) - position(number));
        let arm = arms.max_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap_or_else(Vec3::zeros);
        JointReport {
            number,
            name: nodes[number].name.clone(),
            position_m: position(number).into(),
            axes: axes.map(Into::into),
            turns_next: axes.map(|axis| axis.cross(&arm).into()),
        }
    };
    (0..nodes.len()).filter(|&node| moves[node]).map(report).collect()
}

fn piece_attributes(root: &Cursor, piece: &SourcePiece) -> PieceAttributes {
    let mesh = root.entry("meshes", piece.mesh);
    let primitive = mesh.entry("primitives", piece.primitive);
    let attributes = primitive.member("attributes").keys();
    let uv_sets = attributes.into_iter().filter(|key| key.starts_with("TEXCOORD_")).map(str::to_owned);
    let node = piece.node.map(|node| root.entry("nodes", node)).filter(|n| n.member("weights").exists());
    let weights = node.unwrap_or_else(|| mesh.clone()).number_list("weights");
    let names = mesh.member("extras").entries("targetNames");
    let target = |k: usize| MorphReport {
        name: names.get(k).and_then(Cursor::as_text).map_or_else(|| format!("target {k}"), str::to_owned),
        weight: weights.get(k).copied().unwrap_or(0.0),
    };
    let morph_targets = (0..primitive.length("targets")).map(target).collect();
    PieceAttributes { uv_sets: uv_sets.collect(), morph_targets }
}

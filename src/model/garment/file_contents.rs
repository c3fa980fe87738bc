//! Contents of a mesh file beside its triangles, by the names and numbers that scripts and options use: joints, clips, morph
//! targets, sets of texture coordinates. `io` fills it in; `crease inspect` prints it.

use crate::printable::printable;
use serde::Serialize;
use std::borrow::Cow;
use std::fmt::Write;

/// Entries of each kind listed in the text.
const MAX_LISTED: usize = 80;

/// Contents of a mesh file.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct FileContents {
    /// Joints that move meshes of the file.
    pub joints: Vec<JointReport>,
    /// Animation clips.
    pub clips: Vec<ClipReport>,
    /// Attributes of the pieces, one entry per piece.
    pub piece_attributes: Vec<PieceAttributes>,
}

/// Joint, in the pose of the file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointReport {
    /// Number, as in `joint#14`.
    pub number: usize,
    /// Name; empty when it has none.
    pub name: String,
    /// Position in the scene \[m\], y up.
    pub position_m: [f64; 3],
    /// Own axes x, y, z in the scene, of unit length.
    pub axes: [[f64; 3]; 3],
    /// Per own axis: direction in the scene into which the next joint goes when this one turns by a small positive angle about
    /// the axis, in metres per radian; zero for a joint at the end of a chain.
    pub turns_next: [[f64; 3]; 3],
}

/// Animation clip.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClipReport {
    /// Number, as in `clip#2`.
    pub number: usize,
    /// Name.
    pub name: String,
    /// Duration \[s\].
    pub length_s: f64,
    /// Names of the pieces that it moves.
    pub moves: Vec<String>,
    /// Reason why it cannot be played.
    pub damage: Option<String>,
}

/// Attributes of a piece.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct PieceAttributes {
    /// Names of the sets of texture coordinates.
    pub uv_sets: Vec<String>,
    /// Morph targets.
    pub morph_targets: Vec<MorphReport>,
}

/// Morph target.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MorphReport {
    /// Name, or its number.
    pub name: String,
    /// Default weight \[-\].
    pub weight: f64,
}

impl FileContents {
    /// Writes the contents as lines for a person; `pieces` are the names of the pieces, printable.
    pub(super) fn write_text(&self, out: &mut String, pieces: &[Cow<str>]) -> std::fmt::Result {
        for (name, piece) in pieces.iter().zip(&self.piece_attributes).take(MAX_LISTED) {
            if piece.uv_sets.len() > 1 {
                writeln!(out, "  UV sets    \"{name}\": {}", printable(&piece.uv_sets.join(", ")))?;
            }
            if !piece.morph_targets.is_empty() {
                let label = |target: &MorphReport| format!("{} {}", target.name, target.weight);
                let list: Vec<String> = piece.morph_targets.iter().take(MAX_LISTED).map(label).collect();
                writeln!(out, "  morphs     \"{name}\": {} (name and weight)", printable(&list.join(", ")))?;
            }
        }
        for clip in self.clips.iter().take(MAX_LISTED) {
            let moves = match &clip.damage {
                Some(damage) => format!("damaged: {damage}"),
                None if clip.moves.is_empty() => "moves nothing".to_owned(),
                None => format!("moves {}", clip.moves.join(", ")),
            };
            let (name, moves) = (printable(&clip.name), printable(&moves));
            writeln!(out, "  clip#{:<5} \"{name}\": {:.2} s, {moves}", clip.number, clip.length_s)?;
        }
        for joint in self.joints.iter().take(MAX_LISTED) {
            let [x, y, z] = joint.position_m;
            let name = printable(&joint.name);
            write!(out, "  joint#{:<4} \"{name}\" at ({x:.3}, {y:.3}, {z:.3}) m", joint.number)?;
            for (axis, (own, moved)) in ["x", "y", "z"].iter().zip(joint.axes.iter().zip(&joint.turns_next)) {
                write!(out, "; {axis} is {}", direction(own))?;
                if norm(moved) > 1e-3 {
                    write!(out, ", bends to {}", direction(moved))?;
                }
            }
            writeln!(out)?;
        }
        for (kind, count) in [("clips", self.clips.len()), ("joints", self.joints.len())] {
            if count > MAX_LISTED {
                writeln!(out, "  {kind:<10} and {} more", count - MAX_LISTED)?;
            }
        }
        Ok(())
    }
}

fn norm(v: &[f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Returns the direction of the scene that is nearest to `v`.
fn direction(v: &[f64; 3]) -> &'static str {
    let names = [["right (+x)", "left (-x)"], ["up (+y)", "down (-y)"], ["front (+z)", "back (-z)"]];
    let longest = (0..3).fold(0, |best, k| if v[k].abs() > v[best].abs() { k } else { best });
    names[longest][usize::from(v[longest] < 0.0)]
}

//! Lookup of joints and clips of a rig by name or by number.
//!
//! Files repeat names (two armatures with equal bones, clips of one name) or have none. A name is looked up among what
//! moves the meshes of the rig; where that leaves several, the error lists all of them with their numbers, and the number
//! (`joint#14`, `clip#2`, counted from 0 as in the file) chooses one.

use crate::body::clip::{AnimatedProperty, Channel, Clip};
use crate::body::rig::{Rig, RigPiece, SkinBinding};
use crate::json::nearest;

/// A joint moves a vertex if its weight is above this [-].
const MIN_WEIGHT: f64 = 0.01;
/// Change of a value of a channel above which it moves something [units of the value].
const MIN_CHANGE: f64 = 1e-6;
/// Candidates listed in a message.
const MAX_LISTED: usize = 40;

/// Error of a lookup.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LookupError {
    /// What the file has, to follow "FILE has".
    pub message: String,
    /// Advice with the candidates.
    pub help: String,
}

impl LookupError {
    /// The error of a body that has nothing of this `kind`.
    pub fn nothing(kind: &str, wanted: &str) -> Self {
        Self {
            message: format!("no {kind} called \"{wanted}\""),
            help: format!("it has no {kind}s: leave the action out"),
        }
    }
}

impl Rig {
    /// Returns the nodes that move vertices directly.
    pub fn influencing_nodes(&self) -> Vec<bool> {
        let mut moves = vec![false; self.skeleton.nodes().len()];
        for node in self.pieces.iter().flat_map(RigPiece::influencing_nodes) {
            if let Some(slot) = moves.get_mut(node) {
                *slot = true;
            }
        }
        moves
    }

    /// Returns the numbers of the pieces that `clip` moves, by nodes or by morph targets.
    pub fn pieces_moved_by(&self, clip: &Clip) -> Vec<usize> {
        let changing = || clip.channels.iter().filter(|channel| channel.range() > MIN_CHANGE);
        let is_animated = |node: usize| {
            changing().any(|channel| channel.node == node && channel.target != AnimatedProperty::Weights)
        };
        let is_moved = |piece: &RigPiece| {
            let morphs =
                changing().any(|c| c.target == AnimatedProperty::Weights && piece.is_morphed_at(c.node));
            morphs
                || piece
                    .influencing_nodes()
                    .into_iter()
                    .any(|node| is_animated(node) || self.skeleton.ancestors(node).any(is_animated))
        };
        (0..self.pieces.len()).filter(|&k| is_moved(&self.pieces[k])).collect()
    }

    /// Returns the nodes that move vertices, themselves or through nodes below them.
    pub fn moving_nodes(&self) -> Vec<bool> {
        let direct = self.influencing_nodes();
        let mut moves = direct.clone();
        for node in (0..direct.len()).filter(|&node| direct[node]) {
            // Those above a marked node are marked, or will be.
            for up in self.skeleton.ancestors(node) {
                if std::mem::replace(&mut moves[up], true) {
                    break;
                }
            }
        }
        moves
    }

    /// Returns the joint called `wanted`, or numbered so, that moves vertices.
    pub fn find_joint(&self, wanted: &str) -> Result<usize, LookupError> {
        let nodes = self.skeleton.nodes();
        let moves = self.moving_nodes();
        let mut found: Vec<usize> = (0..nodes.len()).filter(|&node| nodes[node].name == wanted).collect();
        if found.is_empty() {
            found.extend(number_in(wanted, "joint").filter(|number| *number < nodes.len()));
        }
        let moving: Vec<usize> = found.iter().copied().filter(|&node| moves[node]).collect();
        match (&found[..], &moving[..]) {
            (_, &[one]) => Ok(one),
            ([], _) => Err(LookupError {
                message: format!("no joint called \"{wanted}\""),
                help: self.joint_help(wanted, &moves),
            }),
            (_, []) => Err(LookupError {
                message: format!("a joint \"{wanted}\" that moves no vertex of the body"),
                help: self.joint_help("", &moves),
            }),
            _ => Err(LookupError {
                message: format!("{} joints called \"{wanted}\"", moving.len()),
                help: format!("choose one by its number: {}", self.list_joints(&moving)),
            }),
        }
    }

    fn joint_help(&self, wanted: &str, moves: &[bool]) -> String {
        let nodes = self.skeleton.nodes();
        let moving: Vec<usize> = (0..nodes.len()).filter(|&node| moves[node]).collect();
        if moving.is_empty() {
            return "it has no joints that move it".to_owned();
        }
        let names = moving.iter().map(|&node| nodes[node].name.as_str()).filter(|name| !name.is_empty());
        let meant =
            nearest(wanted, names).map(|name| format!("did you mean \"{name}\"? ")).unwrap_or_default();
        format!("{meant}joints: {}", self.list_joints(&moving))
    }

    /// Returns a list of joints with what chooses each: its name, or its number where that is not enough.
    fn list_joints(&self, joints: &[usize]) -> String {
        let nodes = self.skeleton.nodes();
        let label = |&node: &usize| {
            let name = &nodes[node].name;
            let is_unique = joints.iter().filter(|&&other| nodes[other].name == *name).count() == 1;
            if is_unique && !name.is_empty() {
                return name.clone();
            }
            // The top of the tree tells two armatures apart.
            let above = match self.skeleton.ancestors(node).filter(|&up| !nodes[up].name.is_empty()).last() {
                Some(up) => format!(" under \"{}\"", nodes[up].name),
                None => String::new(),
            };
            let name = if name.is_empty() { "without a name".to_owned() } else { format!("\"{name}\"") };
            format!("joint#{node} (nodes[{node}], {name}{above})")
        };
        listed(joints.iter().map(label))
    }

    /// Returns whether `clip` moves vertices: it changes a node that moves some, or their morph targets.
    pub fn is_moved_by(&self, clip: &Clip) -> bool {
        let moves = self.moving_nodes();
        let of_piece = |channel: &Channel| match channel.target {
            AnimatedProperty::Weights => self.pieces.iter().any(|piece| piece.is_morphed_at(channel.node)),
            _ => moves.get(channel.node).copied().unwrap_or(false),
        };
        clip.channels.iter().any(|channel| of_piece(channel) && channel.range() > MIN_CHANGE)
    }

    /// Returns whether `clip` changes morph targets of the meshes.
    pub fn is_morphed_by(&self, clip: &Clip) -> bool {
        let morphs = |channel: &Channel| {
            channel.target == AnimatedProperty::Weights
                && channel.range() > MIN_CHANGE
                && self.pieces.iter().any(|piece| piece.is_morphed_at(channel.node))
        };
        clip.channels.iter().any(morphs)
    }

    /// Returns the clip called `wanted`, or numbered so; of several of that name the one that moves vertices
    /// ([`Rig::is_moved_by`]).
    pub fn find_clip(&self, wanted: &str) -> Result<usize, LookupError> {
        let mut found: Vec<usize> =
            (0..self.clips.len()).filter(|&clip| self.clips[clip].name == wanted).collect();
        if found.is_empty() {
            found.extend(number_in(wanted, "clip").filter(|&number| number < self.clips.len()));
        }
        let moving = || found.iter().copied().filter(|&c| self.is_moved_by(&self.clips[c]));
        let chosen = match &found[..] {
            &[one] => one,
            [] => {
                let names = self.clips.iter().map(|clip| clip.name.as_str());
                let meant = nearest(wanted, names)
                    .map(|name| format!("did you mean \"{name}\"? "))
                    .unwrap_or_default();
                let all: Vec<usize> = (0..self.clips.len()).collect();
                return Err(LookupError {
                    message: format!("no clip called \"{wanted}\""),
                    help: match all.is_empty() {
                        true => "it has no clips".to_owned(),
                        false => format!("{meant}clips: {}", self.list_clips(&all)),
                    },
                });
            }
            _ => match moving().collect::<Vec<_>>()[..] {
                [one] => one,
                _ => {
                    return Err(LookupError {
                        message: format!("{} clips called \"{wanted}\"", found.len()),
                        help: format!("choose one by its number: {}", self.list_clips(&found)),
                    });
                }
            },
        };
        match &self.clips[chosen].damage {
            None => Ok(chosen),
            Some(damage) => Err(LookupError {
                message: format!(
                    "a clip \"{wanted}\" (animations[{chosen}]) that cannot be played: {damage}"
                ),
                help: "export the file again".to_owned(),
            }),
        }
    }

    fn list_clips(&self, clips: &[usize]) -> String {
        let label = |&number: &usize| {
            let clip = &self.clips[number];
            if clips.iter().filter(|&&other| self.clips[other].name == clip.name).count() == 1 {
                return clip.name.clone();
            }
            let moves = if self.is_moved_by(clip) { "moves it" } else { "moves nothing of it" };
            format!("clip#{number} (\"{}\", {:.2} s, {moves})", clip.name, clip.length())
        };
        listed(clips.iter().map(label))
    }
}

impl RigPiece {
    /// Returns the nodes that move its vertices directly.
    fn influencing_nodes(&self) -> Vec<usize> {
        match &self.binding {
            SkinBinding::Static => Vec::new(),
            SkinBinding::Node(node) => vec![*node],
            SkinBinding::Skin { joints, influences } => {
                let mut is_used = vec![false; joints.len()];
                for influence in influences.iter().flatten().filter(|i| i.weight > MIN_WEIGHT) {
                    if let Some(slot) = is_used.get_mut(influence.joint as usize) {
                        *slot = true;
                    }
                }
                joints.iter().zip(is_used).filter(|(_, used)| *used).map(|(joint, _)| joint.node).collect()
            }
        }
    }

    /// Returns the nodes of the joints that it is bound to, whatever their weights.
    pub(super) fn joint_nodes(&self) -> Vec<usize> {
        match &self.binding {
            SkinBinding::Static => Vec::new(),
            SkinBinding::Node(node) => vec![*node],
            SkinBinding::Skin { joints, .. } => joints.iter().map(|joint| joint.node).collect(),
        }
    }

    /// Returns whether the weights of its morph targets are those of `node`.
    fn is_morphed_at(&self, node: usize) -> bool {
        self.morph.as_ref().is_some_and(|morph| morph.node == node)
    }
}

/// Returns N of `KIND#N`.
fn number_in(wanted: &str, kind: &str) -> Option<usize> {
    wanted.strip_prefix(kind)?.strip_prefix('#')?.parse().ok()
}

fn listed(labels: impl ExactSizeIterator<Item = String>) -> String {
    let count = labels.len();
    let mut list: Vec<String> = labels.take(MAX_LISTED).collect();
    if count > MAX_LISTED {
        list.push("and more".to_owned());
    }
    list.join(", ")
}

//! Jumps of a clip, taken slowly: where a clip moves the body at once, the body takes the time of a transition, as cloth cannot
//! follow a jump.

use crate::wear::motion::body_motion::transition_time;
use crate::wear::motion::motion_profile::smoothstep;
use crease_model::body::{AnimatedBody, ClipJump, RootMotion};

/// Jumps of a clip in order, each with the time that the body takes for it [s].
#[derive(Clone)]
pub(crate) struct SlowedJumps(Vec<(ClipJump, f64)>);

/// A moment of a clip whose jumps are slowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ClipMoment {
    /// At a time of the clip [s].
    At(f64),
    /// On the way between two times of the clip [s], at a fraction of it.
    Between { from: f64, to: f64, fraction: f64 },
}

impl SlowedJumps {
    /// The jumps of `clip` of `body`, with the motion of the `root` removed if one is given.
    pub fn new(body: &AnimatedBody, clip: usize, root: Option<&RootMotion>) -> Self {
        let slowed = |jump: ClipJump| {
            let [from, to] = [jump.start, jump.end].map(|t| body.clip_pose(clip, t, root));
            let time = transition_time(body, &from, &to);
            (jump, time)
        };
        Self(body.clip_jumps(clip, root).into_iter().map(slowed).collect())
    }

    /// Time by which the clip becomes longer [s].
    pub fn added_time(&self) -> f64 {
        self.0.iter().map(|(jump, time)| time - (jump.end - jump.start)).sum()
    }

    /// The moment of the clip at `t` [s] after its beginning.
    pub fn moment(&self, t: f64) -> ClipMoment {
        let mut own = t;
        for (jump, time) in &self.0 {
            if own < jump.start {
                break;
            }
            if own < jump.start + time {
                let fraction = smoothstep((own - jump.start) / time);
                return ClipMoment::Between { from: jump.start, to: jump.end, fraction };
            }
            own += jump.end - jump.start - time;
        }
        ClipMoment::At(own)
    }

    /// What the user should know about them.
    pub fn note(&self, body: &AnimatedBody) -> Option<String> {
        let largest = self.0.iter().max_by(|(a, _), (b, _)| a.distance.total_cmp(&b.distance));
        let (jump, time) = largest?;
        let what = match jump.joint {
            Some((joint, turn)) if turn > 1e-3 => {
                let turn = turn.to_degrees();
                format!("the joint \"{}\" turns by {turn:.0} degrees at once", body.node_name(joint))
            }
            Some((joint, _)) => format!("the joint \"{}\" moves at once", body.node_name(joint)),
            None => "the body moves at once".to_owned(),
        };
        let others = match self.0.len() {
            1 => String::new(),
            count => format!(", the largest of {count} jumps"),
        };
        Some(format!(
            "at {:.3} s {what}, points of the body by {:.2} m{others}. No cloth can follow a jump: the body is moved there in {time:.1} s; \
             give the clip more keys, or interpolated ones",
            jump.end, jump.distance
        ))
    }
}

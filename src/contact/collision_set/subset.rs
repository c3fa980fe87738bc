//! While only some points move: contact of those with one another and with all that rests.

use crate::contact::broad_phase::{Candidates, PointSubset};
use crate::contact::collision_set::{CANDIDATE_MARGIN, Pair, PairContact, sleeps};
use crate::math::Vec3;

/// What is set aside meanwhile.
pub(super) struct Focus {
    moving: PointSubset,
    /// Pairs of points that all rest.
    others: Vec<Pair>,
    /// Who sleeps else.
    asleep: Vec<bool>,
}

impl PairContact {
    /// From here on only the points for which `moving` is set move, one flag per point; pairs of others do not count.
    pub fn restrict_to(&mut self, x: &[Vec3], moving: &[bool]) {
        self.forget_touches();
        self.rested = None;
        let reach = CANDIDATE_MARGIN * self.distance;
        let portion = self.finder.portion(moving, x, reach);
        let moves = |pair: &Pair| pair.points.iter().any(|p| moving.get(*p as usize).is_some_and(|m| *m));
        let (pairs, others) = std::mem::take(&mut self.pairs).into_iter().partition(moves);
        self.pairs = pairs;
        let asleep = std::mem::replace(&mut self.asleep, moving.iter().map(|moving| !moving).collect());
        self.focus = Some(Focus { moving: portion, others, asleep });
    }

    /// All points move again. Values may be asked for where they are now.
    pub fn unrestrict(&mut self) {
        if let Some(Focus { mut others, asleep, .. }) = self.focus.take() {
            self.forget_touches();
            others.append(&mut self.pairs);
            self.pairs = others;
            self.asleep = asleep;
        }
    }

    /// Takes up who may come near of those that move, while they go by `d` and all else rests. Whether layers of the cloth do.
    pub(super) fn look_around(&mut self, x: &[Vec3], d: &[Vec3], together: bool) -> bool {
        let Some(focus) = self.focus.take() else { return false };
        let end: Vec<Vec3> = x.iter().zip(d).map(|(x, d)| x + d).collect();
        let reach = CANDIDATE_MARGIN * self.distance;
        let moving = &focus.moving;
        let own = if self.self_contact {
            self.finder.find_around(moving, x, &end, reach, together, &sleeps(&self.asleep))
        } else {
            Candidates::default()
        };
        self.focus = Some(focus);
        self.take(own)
    }
}

//! Positions of cloth and body as one numbering: the body's points follow those of the cloth.

use crate::math::Vec3;

/// Where the points of the cloth and those of the body are [m].
#[derive(Clone, Copy)]
pub(super) struct Places<'a> {
    pub cloth: &'a [Vec3],
    pub body: &'a [Vec3],
}

impl Places<'_> {
    /// Position of point `p` [m].
    #[inline(always)]
    pub fn at(&self, p: u32) -> &Vec3 {
        let p = p as usize;
        if p < self.cloth.len() { &self.cloth[p] } else { &self.body[p - self.cloth.len()] }
    }

    /// The four points of a pair [m].
    #[inline(always)]
    pub fn four(&self, points: &[u32; 4]) -> [Vec3; 4] {
        points.map(|p| *self.at(p))
    }

    /// All positions in one array [m].
    pub fn joined(&self) -> Vec<Vec3> {
        [self.cloth, self.body].concat()
    }
}

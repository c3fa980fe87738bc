//! Cloth against cloth: point-triangle and edge-edge pairs within the contact distance, and the bound on motion.

mod subset;

use crate::contact::ContactSettings;
use crate::contact::barrier;
use crate::contact::broad_phase::{CandidateFinder, Candidates, PairKind, PrimitivePair};
use crate::contact::collision_set::subset::Focus;
use crate::contact::initial_intersections::{InitialIntersections, Mesh};
use crate::contact::step_bounds::{local_step_fractions, stay_apart, swept_boxes};
use crate::contact::uncovered_area::UncoveredArea;
use crate::math::Vec3;
use crate::mesh::distance::ClosestPoints;
use crate::mesh::{PointIndex, Topology};
use rayon::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};

/// A pair within its contact distance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    pub kind: PairKind,
    pub points: [u32; 4],
    /// Signed: distance vector = sum w_i x_i.
    pub weights: [f64; 4],
    /// Unit vector along the distance vector.
    pub normal: Vec3,
    /// [m].
    pub distance: f64,
    /// Contact distance of this pair [m].
    pub reach: f64,
    /// [N/m].
    pub stiffness: f64,
}

/// What touches at one place.
struct TouchesAt {
    /// [m].
    x: Vec<Vec3>,
    touches: Arc<Vec<Touch>>,
}

/// A pair that may come near.
#[derive(Debug, Clone, Copy)]
struct Pair {
    points: [u32; 4],
    kind: PairKind,
    /// Contact distance [m]: shorter for pairs that are near by construction (beside a seam) or were at the start.
    reach: f64,
    /// Area the pair stands for [m²].
    area: f64,
    /// Whether it is left alone because it crosses.
    free: bool,
}

pub(super) struct PairContact {
    distance: f64,
    stiffness: f64,
    self_contact: bool,
    rest: Vec<Vec3>,
    triangles: Vec<[PointIndex; 3]>,
    triangle_edges: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    point_area: Vec<f64>,
    edge_area: Vec<f64>,
    finder: CandidateFinder,
    pairs: Vec<Pair>,
    /// What touched when last asked, if that still holds.
    last_touches: Mutex<Option<TouchesAt>>,
    /// Points that stay where they are during the step, one flag per point; empty for none.
    asleep: Vec<bool>,
    /// Set while only some points move.
    focus: Option<Focus>,
    /// Per point: contact distance at most [m]; less than the thickness where something was nearer at the start.
    room: Vec<f64>,
    /// Where the cloth was [m] and who slept when the pairs were taken up, where everything rested; none
    /// once they are those of a motion.
    rested: Option<(Vec<Vec3>, Vec<bool>)>,
    uncovered: UncoveredArea,
    /// When nothing was near in a wide search, where the points were then [m], and how wide it was [m].
    clear: Option<(Vec<Vec3>, f64)>,
    /// Steps until a wide search is worth trying again.
    search_after: u32,
    /// What crosses since the start; none before the first step.
    entangled: Option<InitialIntersections>,
}

/// How a move is tested.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Rule {
    /// Every point by its own share; what crosses at the start may pass.
    Single,
    /// All points by the same share; what crosses at the start may pass.
    SingleTogether,
    /// All points by the same share, and nothing may pass.
    Together,
    /// Each by its own share, and no layer is pressed below the inner part of the contact distance.
    Led,
    /// The same, and nothing may pass.
    LedFrozen,
    /// Led by the same share, and nothing may pass.
    LedTogether,
}

impl Rule {
    fn together(self) -> bool {
        matches!(self, Self::Together | Self::SingleTogether | Self::LedTogether)
    }

    fn nothing_passes(self) -> bool {
        matches!(self, Self::Together | Self::LedFrozen | Self::LedTogether)
    }

    fn led(self) -> bool {
        matches!(self, Self::Led | Self::LedFrozen | Self::LedTogether)
    }
}

/// Pairs that are this near in the rest shape push apart only below this share of their rest distance.
const REST_SHARE: f64 = 0.9;
/// Candidates reach this many contact distances, so that the pattern of the linear system can look ahead.
const CANDIDATE_MARGIN: f64 = 1.5;
/// Cloth that is led presses layers together to this share of the contact distance and no further.
const SQUEEZED: f64 = 0.3;
/// Where they are nearer already it takes up to this share of the gap: nothing, but that they must be free to part.
const BARELY: f64 = 0.02;
/// Share of its way by which a point that is led may get ahead of its neighbour.
const BEHIND: f64 = 0.1;
/// A wide search reaches this many times as far as the others.
const WIDE: f64 = 4.0;
/// A move of more than this many search distances is first tested as a whole.
const FAR: f64 = 4.0;
/// Where all can go this share of a long way together they do: single points cut short hold up all around them, most of all
/// where layers go along with one another.
const ALIKE: f64 = 0.3;
/// After a wide search that found something the next waits this many steps.
const WAIT: u32 = 16;
/// A contact distance that had to start small reaches the thickness in this time [s].
const ROOM_TIME: f64 = 0.25;

impl PairContact {
    pub fn new(
        settings: &ContactSettings,
        rest: &[Vec3],
        triangles: &[[PointIndex; 3]],
        topology: &Topology,
        area: &[f64],
    ) -> Self {
        let edges: Vec<[u32; 2]> = topology.edges.iter().map(|e| e.map(|p| p.0)).collect();
        Self {
            distance: settings.dhat,
            stiffness: settings.stiffness,
            self_contact: settings.self_contact,
            rest: rest.to_vec(),
            triangles: triangles.to_vec(),
            triangle_edges: topology.triangle_edges.clone(),
            edge_area: edge_area(&edges, area),
            edges,
            point_area: area.to_vec(),
            finder: CandidateFinder::new(rest, triangles, topology),
            pairs: Vec::new(),
            last_touches: Mutex::default(),
            asleep: Vec::new(),
            focus: None,
            room: vec![settings.dhat; rest.len()],
            rested: None,
            uncovered: UncoveredArea::new(rest, triangles),
            clear: None,
            search_after: 0,
            entangled: None,
        }
    }

    /// See [`crate::contact::Contact::freeze_initial_intersections`].
    pub fn freeze_initial_intersections(&mut self) {
        self.forget_touches();
        self.rested = None;
        self.entangled = Some(InitialIntersections::default());
        self.room.fill(self.distance);
    }

    /// See [`crate::contact::Contact::forget`].
    pub fn clear_caches(&mut self) {
        self.rested = None;
        self.finder.clear_caches();
    }

    fn mesh<'a>(&'a self, x: &'a [Vec3]) -> Mesh<'a> {
        Mesh {
            x,
            triangles: &self.triangles,
            triangle_edges: &self.triangle_edges,
            edge_count: self.edges.len(),
        }
    }

    // ---- Who is near ----

    /// Starts a step in which the points that are `held` do not move: what crosses, and who is near.
    pub fn begin(&mut self, x: &[Vec3], held: &[bool]) {
        self.forget_touches();
        self.asleep.clear();
        self.asleep.extend_from_slice(held);
        let first = self.entangled.is_none();
        let still = vec![Vec3::zeros(); x.len()];
        if self.entangled.as_ref().is_some_and(|e| !e.is_empty()) {
            self.look(x, &still, true);
            let before: Vec<bool> = self.pairs.iter().map(|pair| pair.free).collect();
            self.count_crossings(x);
            self.look(x, &still, true);
            // The same pairs in the same order: those that have come apart start with the distance they have.
            let parted = self.pairs.iter().zip(before).filter(|(pair, was_free)| *was_free && !pair.free);
            let parted: Vec<Pair> = parted.map(|(pair, _)| *pair).collect();
            self.start_from_where_they_are(x, &parted);
            return;
        }
        if first {
            self.count_crossings(x);
        }
        // In a hold next to nothing moves, and often nothing at all.
        let rests = |(at, asleep): &(Vec<Vec3>, Vec<bool>)| at == x && asleep == held;
        if !first && self.rested.as_ref().is_some_and(rests) {
            return;
        }
        let layers_near = self.look(x, &still, true);
        self.look_wide(x, layers_near);
        self.rested = Some((x.to_vec(), held.to_vec()));
    }

    /// Looks wide, now and then, unless `layers_near`: cloth of which no two parts are near needs no other search until it has
    /// bent.
    fn look_wide(&mut self, x: &[Vec3], layers_near: bool) {
        let still = vec![Vec3::zeros(); x.len()];
        let reach = CANDIDATE_MARGIN * self.distance;
        if !self.self_contact || self.stays_clear(x, &still, reach, true) {
            return;
        }
        self.clear = None;
        self.search_after = self.search_after.saturating_sub(1);
        if self.search_after == 0 {
            if !layers_near && self.finder.find(x, x, WIDE * reach, true, &|_| false).is_empty() {
                self.clear = Some((x.to_vec(), WIDE * reach));
            } else {
                self.search_after = WAIT;
            }
        }
    }

    /// Whether the wide search shows that no pair can come within `reach` [m] on the way from `x` by `d`: then neither
    /// point of a pair has come nearer than by its own way since, common motion left out.
    fn stays_clear(&self, x: &[Vec3], d: &[Vec3], reach: f64, together: bool) -> bool {
        let Some((at, wide)) = &self.clear else { return false };
        let ways: Vec<Vec3> = x.iter().zip(at).map(|(x, at)| x - at).collect();
        let ends: Vec<Vec3> = ways.iter().zip(d).map(|(way, d)| way + d).collect();
        let farthest = |ways: &[Vec3]| {
            let common = mean(ways);
            // Written so that what is not finite is far.
            ways.iter().map(|way| (way - common).norm()).fold(0.0, |a: f64, b| if b <= a { a } else { b })
        };
        let way = if together {
            farthest(&ways).max(farthest(&ends))
        } else {
            farthest(&ways) + d.iter().map(|d| d.norm()).fold(0.0, |a: f64, b| if b <= a { a } else { b })
        };
        (reach + 2.0 * way) * (1.0 + 1e-9) <= *wide
    }

    fn count_crossings(&mut self, x: &[Vec3]) {
        let found = InitialIntersections::find(self.mesh(x), self.entangled.as_ref());
        self.entangled = Some(found);
    }

    /// The contact distance of the points of these pairs starts below their gap, and grows.
    fn start_from_where_they_are(&mut self, x: &[Vec3], pairs: &[Pair]) {
        let room = &mut self.room;
        for pair in pairs {
            let near = REST_SHARE * gap(x, &pair.points, pair.kind).distance;
            for p in pair.points {
                room[p as usize] = room[p as usize].min(near);
            }
        }
        let room = &self.room;
        let most = |points: &[u32; 4]| points.iter().map(|p| room[*p as usize]).fold(f64::INFINITY, f64::min);
        self.pairs.iter_mut().for_each(|pair| pair.reach = pair.reach.min(most(&pair.points)));
    }

    /// The step of `h` seconds is over at `x`.
    pub fn accept(&mut self, x: &[Vec3], h: f64) {
        self.forget_touches();
        if self.room.iter().any(|room| *room < self.distance) {
            self.let_room_grow(x, h);
        }
    }

    /// Contact distances that had to start small grow: with time, and never beyond where they push gently.
    fn let_room_grow(&mut self, x: &[Vec3], h: f64) {
        self.rested = None;
        let mut nearest = vec![f64::INFINITY; x.len()];
        for pair in self.pairs.iter().filter(|pair| !pair.free) {
            if pair.points.iter().any(|p| self.room[*p as usize] < self.distance) {
                let near = gap(x, &pair.points, pair.kind).distance;
                for p in pair.points {
                    nearest[p as usize] = nearest[p as usize].min(near);
                }
            }
        }
        let growth = self.distance * h / ROOM_TIME;
        for (room, near) in self.room.iter_mut().zip(nearest) {
            *room = room.max((*room + growth).min(2.0 * near).min(self.distance));
        }
    }

    /// Takes up who may come near while the cloth goes by `d`. Whether any do.
    fn look(&mut self, x: &[Vec3], d: &[Vec3], together: bool) -> bool {
        if self.focus.is_some() {
            return self.look_around(x, d, together);
        }
        // Going together, only what moves against one another matters: cloth that falls as a whole sweeps nothing.
        let common = if together { mean(d) } else { Vec3::zeros() };
        let end: Vec<Vec3> = x.iter().zip(d).map(|(x, d)| x + (d - common)).collect();
        let reach = CANDIDATE_MARGIN * self.distance;
        let own = if self.self_contact && !self.stays_clear(x, d, reach, together) {
            self.finder.find_again(x, &end, reach, together, &sleeps(&self.asleep))
        } else {
            Candidates::default()
        };
        self.take(own)
    }

    /// Makes candidates the pairs that count. Whether there are any of the cloth's own.
    fn take(&mut self, own: Candidates) -> bool {
        self.rested = None;
        let corners = |f: u32| self.triangles[f as usize].map(|c| c.0);
        let edge = |e: u32| self.edges[e as usize];
        let entangled = self.entangled.as_ref().filter(|e| !e.is_empty());
        let pair = |kind: PairKind, points: [u32; 4], area, free: &dyn Fn(&InitialIntersections) -> bool| {
            let mut reach = points.iter().map(|p| self.room[*p as usize]).fold(self.distance, f64::min);
            // Few pairs are near at rest, and their boxes say so.
            let rest = points.map(|p| self.rest[p as usize]);
            if !kind.apart_on_an_axis(&rest, reach / REST_SHARE) {
                reach = reach.min(REST_SHARE * kind.gap(&rest).distance);
            }
            Pair { points, kind, reach, area, free: entangled.is_some_and(free) }
        };
        let point = |&[p, f]: &[u32; 2]| {
            let [a, b, c] = corners(f);
            let area = 0.5 * self.point_area[p as usize];
            pair(PairKind::PointTriangle, [p, a, b, c], area, &|entangled| entangled.frees_point(p, f))
        };
        let edges = |&[e, f]: &[u32; 2]| {
            let ([a, b], [c, d]) = (edge(e), edge(f));
            let area = 0.25 * (self.edge_area[e as usize] + self.edge_area[f as usize]);
            pair(PairKind::EdgeEdge, [a, b, c, d], area, &|entangled| entangled.frees_edges(e, f))
        };
        let pairs: Vec<Pair> =
            own.point_triangle.par_iter().map(point).chain(own.edge_edge.par_iter().map(edges)).collect();
        self.pairs = pairs;
        !own.is_empty()
    }

    // ---- Response ----

    /// All pairs within their contact distance at `x`, in a fixed order. Those of the last place asked for are kept:
    /// value, gradient and Hessian of one place are asked for one by one.
    pub fn touches(&self, x: &[Vec3]) -> Arc<Vec<Touch>> {
        let last = || self.last_touches.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = last().as_ref().filter(|known| known.x == x) {
            return Arc::clone(&known.touches);
        }
        // Not under the lock: a thread that waits for others here may be given work that wants it, too.
        let touches = Arc::new(self.touches_within(x, 1.0));
        *last() = Some(TouchesAt { x: x.to_vec(), touches: Arc::clone(&touches) });
        touches
    }

    /// The touches kept are those of other pairs or other distances.
    fn forget_touches(&mut self) {
        *self.last_touches.get_mut().unwrap_or_else(PoisonError::into_inner) = None;
    }

    /// The same for pairs within `margin` times their contact distance (as far as they are candidates).
    pub fn touches_within(&self, x: &[Vec3], margin: f64) -> Vec<Touch> {
        self.pairs
            .par_iter()
            .filter(|pair| !pair.free)
            .filter_map(|pair| {
                let four = pair.points.map(|p| x[p as usize]);
                // Most candidates are not near, and their boxes say so.
                if pair.kind.apart_on_an_axis(&four, margin * pair.reach) {
                    return None;
                }
                let gap = pair.kind.gap(&four);
                (gap.distance < margin * pair.reach).then(|| Touch {
                    kind: pair.kind,
                    points: pair.points,
                    weights: gap.weights,
                    normal: if gap.distance > 0.0 { gap.vector / gap.distance } else { Vec3::y() },
                    distance: gap.distance.max(1e-12),
                    reach: pair.reach,
                    stiffness: self.stiffness * pair.area,
                })
            })
            .collect()
    }

    /// Whether more crosses at `x` than when the step began.
    pub fn is_worse_at(&self, x: &[Vec3]) -> bool {
        self.entangled.as_ref().is_some_and(|e| e.is_worse_at(self.mesh(x)))
    }

    /// See [`crate::contact::Contact::uncovered_area`].
    pub fn uncovered_area(&mut self, x: &[Vec3]) -> Vec<f64> {
        self.uncovered.at(x)
    }

    // ---- Bound ----

    /// See [`crate::contact::Contact::limit_displacement`].
    ///
    /// Most long moves bring nobody together: they are found free with all points going by the same share, which needs
    /// only the pairs that come near in that motion, or go together as far as they can, if that is far enough ([`ALIKE`]).
    /// Else candidates hold for any fractions of the moves; every point then gets the fraction that keeps its pairs apart
    /// (`bound`). A pair may use up most of its gap in one go but not all of it: the barrier must have a say before layers
    /// come really near, or a gain elsewhere would squeeze them to nothing.
    pub fn limit_displacement(&mut self, x: &[Vec3], d: &mut [Vec3]) {
        let far = FAR * CANDIDATE_MARGIN * self.distance;
        let goes_far = self.clear.is_some() || d.iter().any(|d| d.norm_squared() > far * far);
        if goes_far {
            let share = self.on_the_way(x, d, Rule::SingleTogether).common_share();
            if share >= ALIKE {
                d.iter_mut().for_each(|d| *d *= share);
                return;
            }
        }
        let way = self.on_the_way(x, d, Rule::Single);
        let bounded =
            local_step_fractions(&way.quads, &way.floors, &way.from, &way.motion).apply(&way.motion);
        d.copy_from_slice(&bounded);
    }

    /// See [`crate::contact::Contact::limit_displacement_uniform`].
    pub fn limit_displacement_uniform(&mut self, x: &[Vec3], d: &mut [Vec3]) {
        let least = self.on_the_way(x, d, Rule::Together).common_share();
        d.iter_mut().for_each(|d| *d *= least);
    }

    /// Moves the cloth by `d`, each point as far as all stay apart, and presses no layer any farther: first all by the same share, so that layers
    /// that go along with one another do, then each by what is left of its way, and those around a point that is held up
    /// stay behind with it: alone it would be drawn out of them.
    pub fn carry(&mut self, x: &mut [Vec3], d: &[Vec3]) {
        self.forget_touches();
        let mut d = d.to_vec();
        let share = self.on_the_way(x, &d, Rule::LedTogether).common_share();
        x.iter_mut().zip(&d).for_each(|(x, d)| *x += d * share);
        d.iter_mut().for_each(|d| *d *= 1.0 - share);
        if share >= 1.0 {
            return;
        }
        for rule in [Rule::Led, Rule::LedFrozen] {
            let way = self.on_the_way(x, &d, rule);
            let share = |motion: &[Vec3]| local_step_fractions(&way.quads, &way.floors, &way.from, motion);
            let spread = self.spread(share(&way.motion).fraction);
            let motion: Vec<Vec3> = way.motion.iter().zip(spread).map(|(d, f)| d * f).collect();
            let moves = share(&motion).apply(&motion);
            let end: Vec<Vec3> = x.iter().zip(&moves).map(|(x, d)| x + d).collect();
            if rule == Rule::LedFrozen || !self.is_worse_at(&end) {
                x.copy_from_slice(&end);
                return;
            }
        }
    }

    /// Shares of a way, one per point, that differ by no more than a step from point to point: the lesser ones spread.
    fn spread(&self, mut share: Vec<f64>) -> Vec<f64> {
        for _ in 0..(1.0 / BEHIND).ceil() as usize {
            let before = share.clone();
            for &[a, b] in &self.edges {
                let [a, b] = [a as usize, b as usize];
                share[a] = share[a].min(before[b] + BEHIND);
                share[b] = share[b].min(before[a] + BEHIND);
            }
        }
        share
    }

    /// Takes up the candidates for a way: the pairs, and how near each may come.
    fn on_the_way(&mut self, x: &[Vec3], d: &[Vec3], rule: Rule) -> Way {
        self.look(x, d, rule.together());
        let nothing_passes = rule.nothing_passes();
        let led = rule.led();
        let boxes = swept_boxes(x, d);
        let (quads, floors) = self
            .pairs
            .par_iter()
            .filter(|pair| nothing_passes || !pair.free)
            .filter_map(|pair| {
                let quad = PrimitivePair { kind: pair.kind, points: pair.points.map(PointIndex) };
                // Most pairs stay farther apart than any floor, and their boxes say so.
                if stay_apart(&quad, &boxes, barrier::HIGHEST_FLOOR * pair.reach) {
                    return None;
                }
                let near = gap(x, &pair.points, pair.kind).distance;
                let mut floor = barrier::floor(near, pair.reach);
                if led {
                    floor = floor.max((SQUEEZED * pair.reach).min((1.0 - BARELY) * near));
                }
                Some((quad, floor))
            })
            .unzip();
        Way { quads, floors, from: x.to_vec(), motion: d.to_vec() }
    }
}

/// A motion to be bounded: pairs with their floors [m], positions and moves [m].
struct Way {
    quads: Vec<PrimitivePair>,
    floors: Vec<f64>,
    from: Vec<Vec3>,
    motion: Vec<Vec3>,
}

impl Way {
    /// The share of the motion that all points may go alike.
    fn common_share(&self) -> f64 {
        let pairs = self.quads.par_iter().zip(&self.floors);
        let safe: Vec<f64> = pairs.map(|(quad, floor)| quad.step(&self.from, &self.motion, *floor)).collect();
        safe.into_iter().fold(1.0, f64::min)
    }
}

/// Mean of moves [m]; none when not all are finite.
fn mean(d: &[Vec3]) -> Vec3 {
    let mean = d.iter().sum::<Vec3>() / d.len().max(1) as f64;
    if mean.sum().is_finite() { mean } else { Vec3::zeros() }
}

/// Whether nothing of a pair of the cloth can move.
fn sleeps(asleep: &[bool]) -> impl Fn(PrimitivePair) -> bool + Sync + '_ {
    |quad| !asleep.is_empty() && quad.points.iter().all(|p| asleep[p.at()])
}

#[inline]
fn gap(x: &[Vec3], points: &[u32; 4], kind: PairKind) -> ClosestPoints {
    kind.gap(&points.map(|p| x[p as usize]))
}

/// An edge stands for its share of the area of its two ends: summed over edges as much as over points.
fn edge_area(edges: &[[u32; 2]], point_area: &[f64]) -> Vec<f64> {
    let mut degree = vec![0.0f64; point_area.len()];
    edges.iter().flatten().for_each(|&p| degree[p as usize] += 1.0);
    let share = |p: u32| point_area[p as usize] / degree[p as usize].max(1.0);
    edges.iter().map(|e| share(e[0]) + share(e[1])).collect()
}

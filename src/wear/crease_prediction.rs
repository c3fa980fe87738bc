//! Where a script will crease a garment, told before anything is solved: sheets without thickness, folded along lines.
//!
//! Every action of the list is asked in turn ([`WearAction::sketch`]). A fold marks what lies along its line, in all layers,
//! and lays the flap over. A garment that lies is marked along its sides, where the upper layer goes over into the lower one,
//! and a weight marks what lies on such a side: it bends over that step. What an action cannot tell beforehand it says: then any
//! place may crease.
//!
//! Does not say how sharp a crease will be, and lines lie where sheets without thickness have them.

use crate::garment::Garment;
use crate::math::Vec3;
use crate::wear::action_runner::{ActionContext, PersistentState};
use crate::wear::{GarmentFrame, Lay, WearAction, WearScript};
use rustc_hash::FxHashMap;

/// Steepness (|normal . y|, mean over the area) from which a garment that is laid down is flat already: others are pressed flat, and
/// wrinkle anywhere.
const FLAT: f64 = 0.9;
/// Layers through which a step shows.
const THROUGH: usize = 2;

/// Distances of a point from what creases it [m]; infinite beyond the reach of a sketch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CreaseDistance {
    /// From the nearest line of a fold.
    pub fold: f64,
    /// From the nearest side of the garment, its own or one that it is pressed on.
    pub side: f64,
}

/// A garment on which lines are drawn.
#[derive(Debug, Clone)]
pub struct FoldLayout<'a> {
    garment: &'a Garment,
    /// How far from a line things count [m].
    reach: f64,
    /// Positions without thickness, one per point [m].
    x: Vec<Vec3>,
    /// Per point: its layer, counted from below.
    layer: Vec<u32>,
    /// Positions and layers before every fold that has not been opened, oldest first.
    before: Vec<(Vec<Vec3>, Vec<u32>)>,
    persistent: PersistentState,
    /// Edges between the upper layer and the lower one.
    sides: Vec<[u32; 2]>,
    near: Vec<CreaseDistance>,
    /// Whether an action creases the cloth where nobody can tell beforehand.
    anywhere: bool,
}

/// Places [m] with their layers, by cell.
type Places = FxHashMap<[i32; 2], Vec<(Vec3, u32)>>;

impl<'a> FoldLayout<'a> {
    /// How near each point of `garment` is to what creases it when `script` is worn, up to a distance of `reach` [m]; `None` where
    /// it may be creased anywhere.
    pub fn crease_distances(
        garment: &'a Garment,
        script: &WearScript,
        reach: f64,
    ) -> Option<Vec<CreaseDistance>> {
        let count = garment.points.len();
        let mut sketch = Self {
            garment,
            reach,
            x: garment.points.clone(),
            layer: vec![0; count],
            before: Vec::new(),
            persistent: PersistentState::default(),
            sides: Vec::new(),
            near: vec![CreaseDistance { fold: f64::INFINITY, side: f64::INFINITY }; count],
            anywhere: false,
        };
        for action in script.flatten() {
            action.as_wear_action().sketch(&mut sketch);
            if sketch.anywhere {
                return None;
            }
        }
        Some(sketch.near)
    }

    /// Leaves the cloth as it lies; what does not lie falls, and may wrinkle anywhere.
    pub(super) fn rest(&mut self) {
        if self.ground_frame().is_none() {
            self.anywhere();
        }
    }

    /// Says that an action may crease the cloth anywhere.
    pub(super) fn anywhere(&mut self) {
        self.anywhere = true;
    }

    /// What fractions refer to, if the cloth lies.
    pub(super) fn ground_frame(&self) -> Option<GarmentFrame> {
        self.persistent.ground_frame()
    }

    /// Lays the cloth down as `action` does.
    pub(super) fn lay(&mut self, action: &Lay) {
        let source = &self.garment.points;
        let context = ActionContext {
            positions: &self.x,
            source_positions: source,
            masses: &[],
            thickness: 0.0,
            script_file: "",
            location: "",
        };
        let placed =
            action.start_action(&context, &mut self.persistent).ok().and_then(|start| start.start_positions);
        let Some(placed) = placed else { return self.anywhere() };
        self.x = placed;
        self.before.clear();
        let normals: Vec<Vec3> = self.garment.triangles.iter().map(|t| normal(&self.x, t)).collect();
        let [steep, area] = normals.iter().fold([0.0, 0.0], |[s, a], n| [s + n.y.abs(), a + n.norm()]);
        if steep < FLAT * area {
            return self.anywhere();
        }
        self.x.iter_mut().for_each(|p| p.y = 0.0);
        self.find_sides(&normals);
        let own = self.places_on_sides();
        for p in 0..self.x.len() {
            self.mark_side(p, &own, |_| true);
        }
    }

    /// Turns what lies beyond a line over: `a` on it [m], `out` away from it (unit).
    pub(super) fn fold(&mut self, a: Vec3, out: Vec3) {
        self.before.push((self.x.clone(), self.layer.clone()));
        let top = self.layer.iter().copied().max().unwrap_or(0);
        for ((p, near), layer) in self.x.iter_mut().zip(&mut self.near).zip(&mut self.layer) {
            let beyond = (*p - a).dot(&out);
            if beyond.abs() < self.reach {
                near.fold = near.fold.min(beyond.abs());
            }
            if beyond > 0.0 {
                *p -= out * (2.0 * beyond);
                *layer = (2 * top + 1).saturating_sub(*layer);
            }
        }
    }

    /// Opens the last `count` folds, or all.
    pub(super) fn unfold(&mut self, count: Option<usize>) {
        let left = count.map_or(0, |count| self.before.len().saturating_sub(count));
        if let Some((x, layer)) = self.before.drain(left..).next() {
            self.x = x;
            self.layer = layer;
        }
    }

    /// Presses all that lies there down.
    pub(super) fn press(&mut self) {
        self.rest();
        let steps = self.places_on_sides();
        let mut stacks: FxHashMap<[i32; 2], Vec<u32>> = FxHashMap::default();
        for (p, layer) in self.x.iter().zip(&self.layer) {
            stacks.entry(self.cell(p)).or_default().push(*layer);
        }
        for stack in stacks.values_mut() {
            stack.sort_unstable();
            stack.dedup();
        }
        for p in 0..self.x.len() {
            let Some(stack) = stacks.get(&self.cell(&self.x[p])) else { continue };
            let own = self.layer[p];
            // Layers there between the step and this one.
            let between = |step: u32| stack.iter().filter(|&&layer| step < layer && layer < own).count();
            self.mark_side(p, &steps, |step| step < own && between(step) < THROUGH);
        }
    }

    /// Notes which points are of the upper layer, and where it goes over into the lower one.
    fn find_sides(&mut self, normals: &[Vec3]) {
        self.layer.fill(0);
        for (t, _) in self.garment.triangles.iter().zip(normals).filter(|(_, normal)| normal.y > 0.0) {
            t.iter().for_each(|p| self.layer[p.at()] = 1);
        }
        let turns = self.garment.topology.hinges.iter().filter(|hinge| {
            let [a, b] = hinge.triangles.map(|f| normals[f as usize].y > 0.0);
            a != b
        });
        self.sides = turns.map(|hinge| [hinge.points[0].0, hinge.points[1].0]).collect();
    }

    fn cell(&self, p: &Vec3) -> [i32; 2] {
        [p.x, p.z].map(|c| (c / self.reach).floor() as i32)
    }

    fn places_on_sides(&self) -> Places {
        let mut places = Places::default();
        for &[a, b] in &self.sides {
            let [xa, xb] = [a, b].map(|p| self.x[p as usize]);
            let layer = self.layer[a as usize].max(self.layer[b as usize]);
            for place in [xa, 0.5 * (xa + xb)] {
                places.entry(self.cell(&place)).or_default().push((place, layer));
            }
        }
        places
    }

    /// Marks a point that is near places of layers that count.
    fn mark_side(&mut self, p: usize, places: &Places, counts: impl Fn(u32) -> bool) {
        let [i, j] = self.cell(&self.x[p]);
        let around = (i - 1..=i + 1).flat_map(|i| (j - 1..=j + 1).map(move |j| [i, j]));
        let near = around.filter_map(|cell| places.get(&cell)).flatten().filter(|(_, layer)| counts(*layer));
        let distance = near.map(|(place, _)| (place - self.x[p]).norm()).fold(f64::INFINITY, f64::min);
        if distance < self.reach {
            self.near[p].side = self.near[p].side.min(distance);
        }
    }
}

/// Twice the area times the unit normal of a triangle [m²].
fn normal(x: &[Vec3], t: &[crate::mesh::PointIndex; 3]) -> Vec3 {
    let [a, b, c] = t.map(|p| x[p.at()]);
    (b - a).cross(&(c - a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::garment::Garment;
    use crate::math::Vec2;
    use crate::mesh::{PointIndex, Topology};

    const STEP: f64 = 0.01;

    /// Two level sheets of 0.2 x 0.2 m, one 1 mm over the other, joined along the left and the right side.
    fn sleeve() -> Garment {
        let row = 21u32;
        let mut points = Vec::new();
        for height in [0.0, 1e-3] {
            for k in 0..row * row {
                points.push(Vec3::new(STEP * f64::from(k % row), height, STEP * f64::from(k / row)));
            }
        }
        // The side points of the upper sheet are those of the lower one.
        let name = |sheet: u32, i: u32, j: u32| {
            let side = i == 0 || i == row - 1;
            PointIndex(if side { 0 } else { sheet * row * row } + j * row + i)
        };
        let mut triangles = Vec::new();
        for sheet in [0, 1] {
            for (i, j) in (0..row - 1).flat_map(|i| (0..row - 1).map(move |j| (i, j))) {
                let corner = |di: u32, dj: u32| name(sheet, i + di, j + dj);
                let two =
                    [[corner(0, 0), corner(0, 1), corner(1, 1)], [corner(0, 0), corner(1, 1), corner(1, 0)]];
                triangles.extend(two.map(|[a, b, c]| if sheet == 1 { [a, b, c] } else { [a, c, b] }));
            }
        }
        Garment {
            material: vec![[Vec2::zeros(); 3]; triangles.len()],
            material_from_uv: false,
            source_point: Vec::new(),
            memory_mask: vec![1.0; points.len()],
            triangle_part: vec![0; triangles.len()],
            topology: Topology::new(points.len(), &triangles),
            triangles,
            points,
        }
    }

    fn near(actions: &str) -> Option<Vec<CreaseDistance>> {
        let text = format!(r#"{{"format": "crease-wear/1", "name": "", "actions": [{actions}]}}"#);
        FoldLayout::crease_distances(
            &sleeve(),
            &WearScript::parse("wear.json", &text).expect("is a script"),
            0.03,
        )
    }

    /// Columns (0 to 20) and sheet (0 below, 1 above) of the points that are nearer than half a step to what `pick` looks at.
    fn marked(near: &[CreaseDistance], pick: fn(&CreaseDistance) -> f64) -> Vec<(usize, usize)> {
        let hit = |p: &usize| pick(&near[*p]) < 0.5 * STEP;
        let mut found: Vec<(usize, usize)> = (0..near.len()).filter(hit).map(|p| (p % 21, p / 441)).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    const LAY: &str = r#"{"lay": {"facing": "up"}}"#;
    const LEFT: &str = r#"{"fold": {"line": [[0.25, 0.0], [0.25, 1.0]], "side": "left"}}"#;

    #[test]
    fn a_later_fold_goes_through_all_layers() {
        // The left quarter over the second; then what is left of 0.4 (of the whole width) over the rest.
        let second = LEFT.replace("0.25", "0.4");
        let near = near(&format!("{LAY}, {LEFT}, {second}")).expect("can be told");
        // The second line lies at column 8, and on the flap at column 2.
        assert_eq!(marked(&near, |n| n.fold), [(2, 0), (2, 1), (5, 0), (5, 1), (8, 0), (8, 1)]);
    }

    #[test]
    fn what_was_opened_is_flat_again() {
        let unfold = r#"{"unfold": {"all": true}}"#;
        let second = LEFT.replace("0.25", "0.4");
        let near = near(&format!("{LAY}, {LEFT}, {unfold}, {second}")).expect("can be told");
        assert_eq!(marked(&near, |n| n.fold), [(5, 0), (5, 1), (8, 0), (8, 1)]);
    }

    #[test]
    fn sides_show_in_what_is_pressed_on_them() {
        let press = r#"{"press": {"pressure": 200, "for": 1}}"#;
        let sides = |actions: String| marked(&near(&actions).expect("can be told"), |n| n.side);
        let own = [(0, 0), (0, 1), (20, 0), (20, 1)];
        assert_eq!(sides(format!("{LAY}, {LEFT}")), own);
        // Folded, the left side lies on columns 10 of the rest: what is under a side stays flat.
        assert_eq!(sides(format!("{LAY}, {LEFT}, {press}")), own);
        // The other way round the rest is turned onto the narrower part, whose side then lies under columns 10.
        let right = LEFT.replace("left", "right");
        assert_eq!(
            sides(format!("{LAY}, {right}, {press}")),
            [(0, 0), (0, 1), (10, 0), (10, 1), (20, 0), (20, 1)]
        );
    }

    #[test]
    fn what_cannot_be_told_is_not() {
        for action in [
            r#"{"crumple": {"to": 0.3}}"#,
            r#"{"hang": {}}"#,
            r#"{"fold": {"line": [[0.25, 0.0], [0.25, 1.0]], "side": "left", "angle": 90}}"#,
        ] {
            assert_eq!(near(&format!("{LAY}, {action}")), None, "{action}");
        }
        assert_eq!(near(LEFT), None, "nothing lies yet");
    }
}

//! The choice of models before the run, from script and garment, with the number behind each decision.
//!
//! A model that is off costs nothing. With `BakeOptions::full_fidelity` every model is on and at full size, for comparison:
//! `crease chart plan` shows the cost and the error of the choice.

use crate::bake::BakeOptions;
use crate::bake::bend_reach::{BendReach, ReachedBand, ReachedCloth};
use crate::bake::tuning::TUNING;
use crate::wear::{Action, LayoutQuality, WearScript};
use crease_geometry::math::{Vec3, bounds};
use crease_geometry::mesh::{PointIndex, triangle};
use crease_model::body::AnimatedBody;
use crease_model::error::Message;
use crease_model::fabric::Fabric;
use crease_model::garment::Garment;
use crease_solver::contact::ContactSettings;
use crease_solver::sim::{GRAVITY, Sewing, SewnStrips};
use std::borrow::Cow;

/// Decision on one model.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ModelDecision {
    /// Name of the model.
    pub name: &'static str,
    /// Whether it is on.
    pub on: bool,
    /// Reason, with the number behind it.
    pub why: Message,
}

/// Models of a bake and their stiffnesses.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ModelPlan {
    /// Stretch stiffness along warp and weft, shear stiffness [N/m].
    pub stretch: [f64; 3],
    /// Activation distance of contact, d-hat [m].
    pub contact_distance: f64,
    /// Stiffness of contact per area [N/m³].
    pub contact_stiffness: f64,
    /// Whether cloth can meet cloth.
    pub layers_meet: bool,
    /// Whether the cloth can remember anything of the script.
    pub remembers: bool,
    /// Smallest bending length of an element in lengths of its edges [-]; 0 for the fabric's own bending everywhere.
    pub min_bending_edges: f64,
    /// Reference length of the memory law [m].
    pub reference_length: f64,
    /// Every decision, in the order of the report.
    pub decisions: Vec<ModelDecision>,
}

impl ModelPlan {
    /// The plan for a bake of `garment`, made of `fabric`, through `script`, without a body.
    pub fn new(garment: &Garment, fabric: &Fabric, script: &WearScript, options: &BakeOptions) -> Self {
        let actions: Vec<Cow<Action>> = script.flatten().collect();
        let scene = PlannedScene { garment, fabric, actions: &actions, options };
        let mut decisions = Vec::new();
        let stretch = scene.stretch(&mut decisions);
        scene.bending(&mut decisions);
        decisions.push(scene.sewing());
        let reference_length = reference_length(garment, fabric);
        let memory = scene.memory(reference_length);
        let remembers = memory.on;
        decisions.push(memory);
        let (layers_meet, contact_distance) = scene.self_contact(&mut decisions);
        decisions.push(scene.friction(layers_meet));
        decisions.push(ModelDecision { name: "body", on: false, why: "no body was given".into() });
        decisions.extend(steps(options));
        let contact_stiffness = scene.contact_stiffness(stretch, contact_distance);
        Self {
            stretch,
            contact_distance,
            contact_stiffness,
            layers_meet,
            remembers,
            min_bending_edges: 0.0,
            reference_length,
            decisions,
        }
    }

    /// Settings of the contact of cloth with itself, the ground and a body.
    pub(super) fn contact_settings(&self, fabric: &Fabric) -> ContactSettings {
        let (dhat, stiffness) = (self.contact_distance, self.contact_stiffness);
        ContactSettings::for_fabric(fabric, dhat, stiffness, self.layers_meet)
    }

    /// Adapts the plan to a body that wears the garment, with the points that are `inactive` (empty for none): the body
    /// stretches the cloth more than its own weight does, so the cloth has the fabric's own stiffness, and compresses it in its
    /// crooks, so that wrinkles shorter than the mesh can show would crumple its elements.
    pub(super) fn apply_body(
        &mut self,
        fabric: &Fabric,
        animated: &AnimatedBody,
        inactive: &[bool],
        full_fidelity: bool,
    ) {
        let full = [fabric.stretch_warp(), fabric.stretch_weft(), fabric.shear()];
        self.min_bending_edges = if full_fidelity { 0.0 } else { TUNING.models.min_bending_edges_on_body };
        let stiffer = full[0].max(full[1]) / self.stretch[0].max(self.stretch[1]);
        self.contact_stiffness *= stiffer.max(1.0);
        self.stretch = full;
        let mut decide = |name, why: String, on| {
            let why = Message::from(why);
            if let Some(decision) = self.decisions.iter_mut().find(|decision| decision.name == name) {
                *decision = ModelDecision { name, on, why };
            } else {
                self.decisions.push(ModelDecision { name, on, why });
            }
        };
        let bending = format!(
            "bending length {:.1} mm, at least {:.1} edges of every element: wrinkles that the mesh cannot show do not form",
            1e3 * fabric.bending_length(),
            self.min_bending_edges
        );
        decide("bending", bending, true);
        let stretch = full[0].min(full[1]);
        decide("stretch", format!("{stretch:.0} N/m, the fabric's own: a body stretches it"), true);
        decide(
            "body",
            format!(
                "{}: {} points, {} triangles",
                animated.file,
                animated.rest_points().len(),
                animated.triangles().len()
            ),
            true,
        );
        let fixed = inactive.iter().filter(|inactive| **inactive).count();
        decide(
            "static region",
            format!("{fixed} of {} points out of reach of moving parts of the body", inactive.len()),
            fixed > 0,
        );
    }
}

impl ModelPlan {
    /// Adapts the plan to cloth that begins with what it remembers: that reopens and goes into the result whatever the script reaches.
    pub(super) fn apply_earlier(&mut self, options: &BakeOptions) {
        self.remembers = options.memory;
        let memory = self.decisions.iter_mut().find(|decision| decision.name == "memory");
        if let Some(decision) = memory.filter(|decision| options.memory && !decision.on) {
            decision.on = true;
            let why = std::mem::take(&mut decision.why);
            decision.why = why + "; what it remembers already is carried on";
        }
    }

    /// Factors on the bending rigidity, one per triangle [-], with which no element of `garment` bends more easily than its edges can show.
    pub(super) fn bending_factors(&self, garment: &Garment, fabric: &Fabric) -> Vec<f64> {
        let own = fabric.bending_length();
        let factor = |triangle: &[PointIndex; 3]| {
            let x = triangle::corners(&garment.points, triangle);
            let edge = triangle::mean_side(&x);
            (self.min_bending_edges * edge / own).powi(3).max(1.0)
        };
        garment.triangles.iter().map(factor).collect()
    }
}

/// Reference length of the memory law on `garment`, made of `fabric` [m]: the fabric's, and no less than what the meshes of every
/// quality resolve, so that a fold leaves the same crease on each of them.
pub(super) fn reference_length(garment: &Garment, fabric: &Fabric) -> f64 {
    let (low, high) = bounds(&garment.points);
    let resolved = TUNING.models.crease_length.min(TUNING.models.crease_extent_fraction * (high - low).max());
    fabric.memory.reference_length().max(resolved)
}

/// Inputs of a plan.
struct PlannedScene<'a> {
    garment: &'a Garment,
    fabric: &'a Fabric,
    actions: &'a [Cow<'a, Action>],
    options: &'a BakeOptions,
}

impl PlannedScene<'_> {
    /// Stretch stiffness along warp and weft, shear stiffness [N/m].
    fn stretch(&self, decisions: &mut Vec<ModelDecision>) -> [f64; 3] {
        let fabric = self.fabric;
        let (low, high) = bounds(&self.garment.points);
        let size = (high - low).max();
        let weight = fabric.area_density() * GRAVITY * size;
        let ridges =
            self.options.body.is_some() || self.actions.iter().any(|a| matches!(**a, Action::Crumple(_)));
        let strain = self.options.max_weight_strain();
        let strain = if ridges { strain.max(TUNING.models.ridge_weight_strain) } else { strain };
        let sufficient = weight / strain;
        let softest = fabric.stretch_warp().min(fabric.stretch_weft());
        let scale = if self.options.full_fidelity { 1.0 } else { (sufficient / softest).min(1.0) };
        let stretch = [fabric.stretch_warp() * scale, fabric.stretch_weft() * scale, fabric.shear()];
        let instead = if scale < 1.0 {
            format!("instead of {:.0}", fabric.stretch_warp())
        } else {
            "the fabric's own".into()
        };
        let why = format!(
            "{:.0} N/m, {instead}: own weight over {:.2} m stretches it {:.2} % at most{}",
            stretch[0],
            size,
            100.0 * weight / stretch[0].min(stretch[1]),
            if ridges { ", as ridges finer than the mesh need" } else { "" }
        );
        decisions.push(ModelDecision { name: "stretch", on: true, why: why.into() });
        stretch
    }

    fn bending(&self, decisions: &mut Vec<ModelDecision>) {
        let (length, element) = (self.fabric.bending_length(), self.garment.mean_edge());
        let why =
            format!("bending length {:.1} mm against elements of {:.1} mm", 1e3 * length, 1e3 * element);
        decisions.push(ModelDecision { name: "bending", on: true, why: why.into() });
        let needed = TUNING.models.free_wrinkle_edge * length;
        let fine = element <= needed;
        let why = format!(
            "{:.1} mm; free wrinkles need {:.1} mm (a quarter of the bending length){}",
            1e3 * element,
            1e3 * needed,
            if fine { "" } else { ": narrower ones come from creases of the script only" }
        );
        decisions.push(ModelDecision { name: "elements", on: fine, why: why.into() });
    }

    /// Hems and allowances of seams.
    fn sewing(&self) -> ModelDecision {
        let (garment, Sewing { hems, seams }) = (self.garment, self.options.sewing);
        let [hem, seam] = SewnStrips::new(garment, self.options.sewing).fractions(garment);
        let masked = garment.sewing_mask.iter().any(|mask| *mask < 1.0);
        let part = |on: bool, name: &str, fraction: f64| {
            if on {
                format!("{name} on {:.1} % of the cloth", 100.0 * fraction)
            } else {
                format!("no {name}")
            }
        };
        let mut why = format!("{}, {}", part(hems, "hems", hem), part(seams, "allowances of seams", seam));
        if masked {
            why += ", where the sewing mask has them";
        }
        ModelDecision { name: "hems and seams", on: hem + seam > 0.0, why: why.into() }
    }

    fn memory(&self, reference_length: f64) -> ModelDecision {
        let name = "memory";
        if !self.options.memory {
            return ModelDecision { name, on: false, why: "switched off".into() };
        }
        let memory = &self.fabric.memory;
        let thresholds = [memory.gradual_threshold(), memory.critical_threshold()];
        let is_worn = self.options.body.is_some();
        let cloth = ReachedCloth { is_one_layer: is_one_flat_layer(self.garment), is_worn, reference_length };
        let reach = BendReach::new(self.actions, cloth);
        let on = reach.band(thresholds) > ReachedBand::Neither || is_worn || self.options.full_fidelity;
        let [gradual, critical] = thresholds.map(f64::to_degrees);
        let why = format!(
            "gradual beyond {gradual:.0} degrees within {:.0} mm, critical beyond {critical:.0}: {}",
            1e3 * reference_length,
            reach.describe(thresholds)
        );
        ModelDecision { name, on, why: why.into() }
    }

    /// Whether layers can meet, and the activation distance of their contact [m].
    fn self_contact(&self, decisions: &mut Vec<ModelDecision>) -> (bool, f64) {
        let element = self.garment.mean_edge();
        let distance = self.fabric.thickness().min(TUNING.models.max_contact_edge_fraction * element);
        let count = |kind: fn(&Action) -> bool| self.actions.iter().filter(|action| kind(action)).count();
        let turning = count(|action| {
            matches!(
                action,
                Action::Fold(_) | Action::Roll(_) | Action::Crumple(_) | Action::Bend(_) | Action::Play(_)
            )
        });
        // Cloth that hangs or is let go in the air takes a shape of its own, whose folds can touch; on the ground it stays as it lies.
        let lies = matches!(self.actions.first().map(Cow::as_ref), Some(Action::Lay(_)));
        let draping = count(|action| matches!(action, Action::Hang(_)))
            + if lies { 0 } else { count(|action| matches!(action, Action::Release(_))) };
        let one_layer = is_one_flat_layer(self.garment);
        let moving = turning + draping;
        let meet =
            self.garment.triangles.len() > 1 && (self.options.full_fidelity || moving > 0 || !one_layer);
        let layers = if one_layer { "one flat layer" } else { "more than one layer" };
        let all = self.actions.len();
        let why = if moving == 0 && one_layer {
            format!("{layers}, and none of {all} actions folds it or lets it drape")
        } else {
            let drape = if draping > 0 {
                format!(", {draping} let it drape, where folds of it can touch")
            } else {
                String::new()
            };
            format!(
                "layers {:.2} mm apart: {layers} at the start, {turning} of {all} actions lay it on itself{drape}",
                1e3 * distance
            )
        };
        decisions.push(ModelDecision { name: "self-contact", on: meet, why: why.into() });
        (meet, distance)
    }

    fn friction(&self, layers_meet: bool) -> ModelDecision {
        let fabric = self.fabric;
        let degrees = |coefficient: f64| coefficient.atan().to_degrees();
        let on = fabric.friction > 0.0 || fabric.friction_ground > 0.0;
        let surfaces = if layers_meet { "layers and the ground" } else { "the ground" };
        let why = format!(
            "coefficient {} on cloth, {} on the ground: holds slopes up to {:.0} and {:.0} degrees, and {surfaces} are met",
            fabric.friction,
            fabric.friction_ground,
            degrees(fabric.friction),
            degrees(fabric.friction_ground)
        );
        ModelDecision { name: "friction", on, why: why.into() }
    }

    /// Stiffness of contact per area [N/m³].
    fn contact_stiffness(&self, stretch: [f64; 3], distance: f64) -> f64 {
        let pressed = self
            .actions
            .iter()
            .map(|action| match action.as_ref() {
                Action::Press(press) => press.pressure_pa,
                Action::Iron(iron) => iron.pressure_pa,
                _ => 0.0,
            })
            .fold(0.0, f64::max);
        let load = pressed + TUNING.models.expected_layers * self.fabric.area_density() * GRAVITY;
        // Layers must also resist the forces of the membrane: contact is at least as stiff, point for point.
        let material = &self.garment.material;
        let area: f64 = material.iter().map(|m| 0.5 * (m[1] - m[0]).perp(&(m[2] - m[0])).abs()).sum();
        let area_per_point = area / self.garment.points.len().max(1) as f64;
        (load / (TUNING.models.max_contact_compression * distance))
            .max(stretch[0].max(stretch[1]) / area_per_point)
    }
}

/// The decision to lay the garment out in its layers.
pub(super) fn laid_out(quality: &LayoutQuality) -> ModelDecision {
    ModelDecision { name: "laid out flat", on: true, why: quality.to_string().into() }
}

/// Decisions on the time steps.
fn steps(options: &BakeOptions) -> [ModelDecision; 3] {
    let step = options.effective_step();
    let method = ModelDecision { name: "method", on: true, why: step.method.description().into() };
    let by_error = step.min_dt < step.max_dt;
    let why = if by_error {
        format!(
            "{:.1} ms to {:.1} s, as long as each errs by less than {:.2} mm root mean square",
            1e3 * step.min_dt,
            step.max_dt,
            1e3 * step.local_error_tol
        )
    } else {
        format!("{:.1} ms, all of them but those in which the body would pass the cloth", 1e3 * step.min_dt)
    };
    let adaptive = ModelDecision { name: "steps by error", on: by_error, why: why.into() };
    let sleeping = ModelDecision {
        name: "local Newton",
        on: !options.full_fidelity,
        why: Message::from(format!(
            "after the first global iteration of a step only points above the energy tolerance, {:.1} micrometres of lift, are solved for",
            1e6 * options.effective_energy_tol()
        )),
    };
    [method, adaptive, sleeping]
}

/// Whether the source shape is a single piece whose triangles all face the same direction: no part overlaps another.
fn is_one_flat_layer(garment: &Garment) -> bool {
    let normal = |t: &[PointIndex; 3]| triangle::area_vector(&triangle::corners(&garment.points, t));
    let whole = garment.triangles.iter().map(normal).sum::<Vec3>();
    garment.triangles.iter().all(|t| normal(t).dot(&whole) > 0.5 * normal(t).norm() * whole.norm())
        && garment.triangle_part.iter().all(|part| Some(part) == garment.triangle_part.first())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::Quality;

    use crease_model::fabric::DEFAULT_FABRIC;

    /// `layers` squares over one another, each of two triangles.
    fn squares(layers: u32) -> Garment {
        let corners = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]];
        let points =
            (0..layers).flat_map(|k| corners.map(|c| Vec3::new(c[0], 0.01 * f64::from(k), -c[1]))).collect();
        let flat = [[0, 1, 2], [0, 2, 3]];
        let triangles: Vec<[u32; 3]> = (0..layers).flat_map(|k| flat.map(|t| t.map(|p| p + 4 * k))).collect();
        Garment::of_triangles(points, &triangles)
    }

    fn plan(garment: &Garment, script: &str, full_fidelity: bool) -> ModelPlan {
        let fabric = Fabric::preset(DEFAULT_FABRIC).expect("exists");
        let text = format!(r#"{{"format": "crease-wear/1", "name": "", "actions": [{script}]}}"#);
        let script = WearScript::parse("wear.json", &text).expect("is a script");
        ModelPlan::new(garment, &fabric, &script, &BakeOptions { full_fidelity, ..BakeOptions::default() })
    }

    const FOLD: &str = r#"{"fold": {"line": [[0.5, 0.0], [0.5, 1.0]], "side": "left", "angle": 180, "over": 2.0, "hold": 5.0}}"#;
    const SETTLE: &str = r#"{"settle": {"for": 3.0}}"#;

    #[test]
    fn self_contact_is_modelled_only_where_layers_can_meet() {
        assert!(!plan(&squares(1), SETTLE, false).layers_meet);
        assert!(plan(&squares(1), FOLD, false).layers_meet);
        assert!(plan(&squares(2), SETTLE, false).layers_meet);
        assert!(plan(&squares(1), SETTLE, true).layers_meet);
    }

    /// The decision `name` of a plan.
    fn decision(plan: &ModelPlan, name: &str) -> (bool, String) {
        let found = plan.decisions.iter().find(|decision| decision.name == name).expect("is decided");
        (found.on, found.why.to_string())
    }

    #[test]
    fn memory_is_off_where_the_script_reaches_no_threshold_of_the_fabric() {
        const LAY: &str = r#"{"lay": {}}"#;
        let lies = plan(&squares(1), &format!("{LAY}, {SETTLE}"), false);
        let (on, why) = decision(&lies, "memory");
        assert!(!on && !lies.remembers && why.contains("no action of the script bends the cloth"), "{why}");
        let small = plan(&squares(1), &format!("{LAY}, {}", FOLD.replace("180", "3")), false);
        let (on, why) = decision(&small, "memory");
        assert!(!on && why.contains("`fold` bends by up to 3 degrees (below both)"), "{why}");
        let folded = plan(&squares(1), &format!("{LAY}, {FOLD}"), false);
        let (on, why) = decision(&folded, "memory");
        assert!(
            on && folded.remembers && why.contains("`fold` bends by up to 180 degrees (critical)"),
            "{why}"
        );
        assert!(plan(&squares(1), SETTLE, true).remembers, "every model is on with full fidelity");
        let mut worn = lies;
        worn.apply_earlier(&BakeOptions::default());
        assert!(worn.remembers && decision(&worn, "memory").0);
    }

    #[test]
    fn hanging_lays_no_layers_on_one_another() {
        let hung = plan(&squares(1), r#"{"hang": {}}"#, false);
        let (on, why) = decision(&hung, "self-contact");
        assert!(on && why.contains("0 of 1 actions lay it on itself, 1 let it drape"), "{why}");
    }

    #[test]
    fn stretch_is_as_soft_as_allowed_and_full_with_full_fidelity() {
        let fabric = Fabric::preset(DEFAULT_FABRIC).expect("exists");
        let soft = plan(&squares(1), FOLD, false).stretch;
        let weight = fabric.area_density() * GRAVITY * 0.1;
        let softest = soft[0].min(soft[1]);
        assert!(softest < fabric.stretch_warp());
        assert!(weight / softest <= Quality::Standard.max_weight_strain() * (1.0 + 1e-12));
        assert_eq!(plan(&squares(1), FOLD, true).stretch[0], fabric.stretch_warp());
    }

    #[test]
    fn every_decision_has_a_reason_and_nearly_all_a_number() {
        let plan = plan(&squares(1), FOLD, false);
        assert!(plan.decisions.iter().all(|c| !c.why.is_empty()));
        let numbers = plan.decisions.iter().filter(|c| c.why.contains(|d: char| d.is_ascii_digit())).count();
        assert!(numbers + 2 >= plan.decisions.len(), "{:?}", plan.decisions);
    }

    #[test]
    fn the_reference_length_is_that_of_garments_and_no_shorter_than_that_of_the_fabric() {
        let jersey = Fabric::preset(DEFAULT_FABRIC).expect("is a preset");
        let mut coarse = jersey.clone();
        coarse.memory.reference_length_mm = 30.0;
        let mut garment = squares(1);
        let mut length = |extent: f64, fabric: &Fabric| {
            garment.points[1].x = extent;
            reference_length(&garment, fabric)
        };
        for (extent, fabric, expected) in
            [(0.6, &jersey, 0.02), (0.3, &jersey, 0.015), (0.6, &coarse, 0.03), (0.1, &coarse, 0.03)]
        {
            assert!((length(extent, fabric) - expected).abs() < 1e-12, "{extent} m");
        }
    }
}

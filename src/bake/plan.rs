//! What a scene needs, decided before the run from the script and the garment, with the number behind each choice.

use crate::body::Wearer;
use crate::fabric::Fabric;
use crate::garment::Garment;
use crate::math::bounds;
use crate::wear::{Action, GRAVITY, WearScript};

/// One decision.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// The model.
    pub name: &'static str,
    /// Whether it is on.
    pub on: bool,
    /// Why, with the number.
    pub why: String,
}

/// What is modelled, and how stiff.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Stretch stiffness along warp and weft, shear stiffness [N/m].
    pub stretch: [f64; 3],
    /// Distance within which layers push apart [m].
    pub contact_distance: f64,
    /// Stiffness of contact per area [N/m³].
    pub contact_stiffness: f64,
    /// Whether cloth can meet cloth.
    pub layers_meet: bool,
    /// Every decision, in the order of the report.
    pub choices: Vec<Choice>,
}

/// Strain that lowered stretch stiffness may cost under the garment's own weight.
const MOST_SAG: f64 = 0.005;
/// Layers that the ground layer is expected to carry.
const EXPECTED_LAYERS: f64 = 16.0;
/// Share of the contact distance that the expected load may use up.
const CONTACT_GIVE: f64 = 0.3;
/// Contact distance is at most this share of the mean edge: nearer points of one layer must not meet.
const MOST_OF_EDGE: f64 = 0.2;

impl Plan {
    /// The plan for wearing `garment` of `fabric` through `script`.
    pub fn new(garment: &Garment, fabric: &Fabric, script: &WearScript, memory: bool) -> Self {
        let mut choices = Vec::new();
        let mut say = |name, on, why: String| choices.push(Choice { name, on, why });
        let (low, high) = bounds(&garment.points);
        let size = (high - low).max();

        let weight = fabric.area_density() * GRAVITY * size;
        let enough = weight / MOST_SAG;
        let scale = (enough / fabric.stretch_warp().min(fabric.stretch_weft())).min(1.0);
        let stretch = [fabric.stretch_warp() * scale, fabric.stretch_weft() * scale, fabric.shear()];
        say(
            "stretch",
            true,
            format!(
                "{:.0} N/m instead of {:.0}: own weight over {:.2} m stretches it {:.2} % at most",
                stretch[0],
                fabric.stretch_warp(),
                size,
                100.0 * weight / stretch[0].min(stretch[1])
            ),
        );
        say(
            "bending",
            true,
            format!(
                "bending length {:.1} mm against elements of {:.1} mm",
                1e3 * fabric.bending_length(),
                1e3 * mean_edge(garment)
            ),
        );
        say("memory", memory, if memory { "the script wears".into() } else { "switched off".into() });

        let actions: Vec<&Action> = script.flatten().collect();
        let layers_meet = garment.triangles.len() > 1;
        let contact_distance = fabric.thickness().min(MOST_OF_EDGE * mean_edge(garment));
        say(
            "self-contact",
            layers_meet,
            format!(
                "layers {:.2} mm apart; the script has {} actions",
                1e3 * contact_distance,
                actions.len()
            ),
        );
        let pressed = actions
            .iter()
            .map(|a| if let Action::Press(press) = a { press.pressure_pa } else { 0.0 })
            .fold(0.0, f64::max);
        let load = pressed + EXPECTED_LAYERS * fabric.area_density() * GRAVITY;
        // Layers must also hold against what the membrane can push: no softer than it is, point for point.
        let area: f64 = garment.material.iter().map(|m| 0.5 * (m[1] - m[0]).perp(&(m[2] - m[0])).abs()).sum();
        let area_per_point = area / garment.points.len().max(1) as f64;
        let contact_stiffness =
            (load / (CONTACT_GIVE * contact_distance)).max(stretch[0].max(stretch[1]) / area_per_point);
        say(
            "friction",
            fabric.friction > 0.0,
            format!("coefficient {} on cloth, {} on the ground", fabric.friction, fabric.friction_ground),
        );
        say("body", false, "no body was given".into());
        Self { stretch, contact_distance, contact_stiffness, layers_meet, choices }
    }
}

impl Plan {
    /// The same on a body, with the points that are `asleep` (empty for none): what pulls at the cloth then is the body
    /// and not its own weight, so it keeps the stiffness it has.
    pub(super) fn wear_on(&mut self, fabric: &Fabric, wearer: &Wearer, asleep: &[bool]) {
        let full = [fabric.stretch_warp(), fabric.stretch_weft(), fabric.shear()];
        let stiffer = full[0].max(full[1]) / self.stretch[0].max(self.stretch[1]);
        self.contact_stiffness *= stiffer.max(1.0);
        self.stretch = full;
        let mut say = |name, why: String, on| {
            if let Some(choice) = self.choices.iter_mut().find(|choice| choice.name == name) {
                *choice = Choice { name, on, why };
            } else {
                self.choices.push(Choice { name, on, why });
            }
        };
        let stretch = full[0].min(full[1]);
        say("stretch", format!("{stretch:.0} N/m, the fabric's own: a body stretches it"), true);
        say(
            "body",
            format!(
                "{}: {} points, {} triangles",
                wearer.file,
                wearer.start().len(),
                wearer.triangles().len()
            ),
            true,
        );
        let still = asleep.iter().filter(|asleep| **asleep).count();
        say("sleep", format!("{still} of {} points out of reach of what moves", asleep.len()), still > 0);
    }
}

/// Mean edge length of the source shape [m].
fn mean_edge(garment: &Garment) -> f64 {
    let length =
        |e: &[crate::mesh::PointIndex; 2]| (garment.points[e[0].at()] - garment.points[e[1].at()]).norm();
    garment.topology.edges.iter().map(length).sum::<f64>() / garment.topology.edges.len().max(1) as f64
}

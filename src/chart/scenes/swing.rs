//! A strip that hangs from its upper edge and is released from a deflection: a planar chain of 20 links, as cloth.
//!
//! 0.5 m long, one row of 20 quads, 0.2 kg/m², Y = 200 N/m, B = 1e-4 N·m, no damping, no air. `swing30` starts 30
//! degrees from the vertical, `release90` horizontally: its free end whips, which is demanding for every integrator.

use crate::scenes::scene::{ClothMaterial, Scene, SceneState, spaced};
use crate::test_sheet::TestSheet;
use crease_geometry::math::Vec3;
use crease_model::error::Result;
use crease_solver::contact::Contact;
use crease_solver::sim::{GRAVITY, Loads};

/// Length of the strip [m].
const LENGTH: f64 = 0.5;

/// The swinging strip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing {
    /// Name in tables.
    pub name: &'static str,
    /// Angle from the vertical at the start [degrees].
    pub degrees: f64,
    /// Stretch stiffness [N/m].
    pub stretch: f64,
    /// Bending stiffness of every second hinge line over that of the others [-].
    pub contrast: f64,
    /// Length of the quad in the middle over that of the others [-].
    pub sliver: f64,
    /// Number of quads.
    pub quads: usize,
    /// Bending stiffness [N·m].
    pub bend: f64,
    /// Time at the end [s].
    pub until: f64,
    /// Strain beyond which a run has failed [-]; `None` for the bound of the physical one
    /// ([`Self::physical_strain`]).
    pub max_strain: Option<f64>,
}

impl Swing {
    /// Released 30 degrees from the vertical.
    pub const SWING_30: Self = Self {
        name: "swing30",
        degrees: 30.0,
        stretch: 200.0,
        contrast: 1.0,
        sliver: 1.0,
        quads: 20,
        bend: 1e-4,
        until: 0.5,
        max_strain: None,
    };
    /// Released horizontally.
    pub const RELEASE_90: Self = Self { name: "release90", degrees: 90.0, ..Self::SWING_30 };

    fn sheet(&self) -> TestSheet {
        let (length, count) = (LENGTH, self.quads);
        let mut along = spaced(0.0, length, count);
        // One line across moves close to its neighbour.
        let middle = count / 2;
        along[middle] = along[middle - 1] + self.sliver * (along[middle] - along[middle - 1]);
        TestSheet::strip(&along, length / count as f64, 1)
    }

    /// Bound of the strain that the motion itself causes: five times that of hanging at rest [-].
    pub fn physical_strain(&self) -> f64 {
        5.0 * 0.2 * GRAVITY * LENGTH / self.stretch
    }
}

impl Scene for Swing {
    fn name(&self) -> &'static str {
        self.name
    }

    fn until(&self) -> f64 {
        self.until
    }

    fn size(&self) -> f64 {
        LENGTH
    }

    fn max_strain(&self) -> f64 {
        self.max_strain.unwrap_or_else(|| self.physical_strain().max(0.02))
    }

    fn initial_state(&self) -> Result<SceneState> {
        let sheet = self.sheet();
        let (sin, cos) = self.degrees.to_radians().sin_cos();
        let position = |p: &crease_geometry::math::Vec2| Vec3::new(p.x * sin, -p.x * cos, p.y);
        let garment = sheet.garment(sheet.flat.iter().map(position).collect());
        let material = ClothMaterial {
            density: 0.2,
            stretch: self.stretch,
            bend: self.bend,
            stretch_damping: 0.0,
            bend_damping: 0.0,
        };
        let cloth = material.cloth(&sheet, &garment);
        let contact = Contact::none(garment.points.len());
        let mut scene_state = SceneState::new(garment, cloth, contact);
        if self.contrast != 1.0 {
            let quad = LENGTH / self.quads as f64;
            let is_even = |x: f64| ((x / quad).round() as usize).is_multiple_of(2);
            let hinges = &scene_state.garment.topology.hinges;
            let stiff = |h: &crease_geometry::mesh::Hinge| {
                let [a, b] = [h.points[0], h.points[1]].map(|p| sheet.flat[p.at()].x);
                (a - b).abs() < 1e-9 && is_even(a)
            };
            let ratio: Vec<f64> = hinges.iter().map(|h| if stiff(h) { self.contrast } else { 1.0 }).collect();
            scene_state.memory.rest.stiffness_ratio.clone_from(&ratio);
            scene_state.memory.effective_rest.stiffness_ratio = ratio;
        }
        Ok(scene_state)
    }

    fn loads(&self, _t: f64, x: &[Vec3]) -> Loads {
        let fixed = (0..x.len()).map(|p| p < 2).collect();
        Loads { fixed, drag: 0.0, ..Loads::gravity_only(None) }
    }
}

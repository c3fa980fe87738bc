//! The memory law of a fabric with the constant parameters of the elements of one garment.

use crate::memory::bend_window::BendWindow;
use crate::memory::{ElementParams, EventCount, MemoryLaw};
use crease_model::fabric::Fabric;
use crease_model::garment::Garment;

/// The memory law of a fabric on one garment, constant during a run.
///
/// In another simulator than this crate's it needs only the angles of the hinges, before and after every step:
///
/// ```
/// use crease_model::fabric::Fabric;
/// use crease_model::garment::RestState;
/// use crease_solver::memory::{Memory, MemoryModel, Strains};
/// // Two hinges, 20 mm wide: the dihedral angles of the mesh as modelled [rad], 0 for flat.
/// let initial = vec![0.0, 0.1];
/// let model = MemoryModel::for_hinges(&Fabric::preset("kow-tshirt")?, &[0.02, 0.02]);
/// let mut memory = Memory::new(RestState::new(initial.clone(), 0));
/// // The first hinge is folded to 2.8 rad within a second and held for ten, in your time steps.
/// let (dt, mut before) = (0.1, initial);
/// for k in 1..=110 {
///     let after = vec![2.8 * f64::min(0.1 * f64::from(k), 1.0), 0.1];
///     memory.commit(&model, &Strains::of_angles(&before), &Strains::of_angles(&after), dt);
///     // For your bending energy: the rest angle [rad], and the factor on the bending stiffness [-].
///     let (_rest, _ratio) = (&memory.effective_rest.rest_angle, &memory.effective_rest.stiffness_ratio);
///     before = after;
/// }
/// assert!(memory.rest.rest_angle[0] > 1.0 && memory.rest.stiffness_ratio[0] > 1.0);
/// assert_eq!(memory.rest.rest_angle[1], 0.1);
/// # Ok::<(), crease_model::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct MemoryModel {
    pub(super) angle: MemoryLaw,
    pub(super) length: Option<MemoryLaw>,
    /// Per hinge: L / min(w, L), the bend within L over the angle of a hinge where the cloth bends evenly.
    max_gain: Vec<f64>,
    /// Bend within L across each hinge; without it the cloth bends evenly.
    window: Option<BendWindow>,
    /// Per hinge: factor on the changes by events, from 0 to 1.
    hinge_mask: Vec<f64>,
    /// Per triangle: the same.
    triangle_mask: Vec<f64>,
}

/// Strains of an accepted state: angles of hinges and stretches of triangles.
#[derive(Debug, Clone, Copy)]
pub struct Strains<'a> {
    /// One per hinge: unwrapped angle [rad].
    pub angle: &'a [f64],
    /// One per triangle: |w_u|, |w_v|, w_u.w_v [-] of the deformation gradient columns w along warp and weft; may be empty
    /// when lengths are not remembered.
    pub stretch: &'a [[f64; 3]],
}

impl<'a> Strains<'a> {
    /// Angles alone [rad], one per hinge, for a model that does not remember lengths.
    pub fn of_angles(angle: &'a [f64]) -> Self {
        Self { angle, stretch: &[] }
    }
}

impl MemoryModel {
    /// The law of `fabric` on `garment`, whose hinges stand for `width` [m] of cloth each, with the length `reference` [m] within which
    /// a bend counts as one crease: the fabric's where the mesh resolves that, and a longer one where it does not.
    pub fn new(garment: &Garment, fabric: &Fabric, width: &[f64], reference: f64) -> Self {
        let min_mask = |points: &mut dyn Iterator<Item = usize>| {
            points.map(|p| garment.memory_mask[p]).fold(1.0, f64::min).clamp(0.0, 1.0)
        };
        let hinges = &garment.topology.hinges;
        Self {
            length: MemoryLaw::for_lengths(&fabric.memory),
            window: Some(BendWindow::new(&garment.points, &garment.topology, width, reference)),
            hinge_mask: hinges.iter().map(|h| min_mask(&mut h.points[..2].iter().map(|p| p.at()))).collect(),
            triangle_mask: garment
                .triangles
                .iter()
                .map(|t| min_mask(&mut t.iter().map(|p| p.at())))
                .collect(),
            ..Self::evenly_bent(fabric, width, reference)
        }
    }

    /// The law of `fabric`, with its own reference length, for the angles of hinges that stand for `width` [m] of cloth each, without
    /// masks and without memory of lengths. Hinges narrower than the reference length count as parts of cloth that bends evenly, because nothing is
    /// known of those around them.
    pub fn for_hinges(fabric: &Fabric, width: &[f64]) -> Self {
        Self::evenly_bent(fabric, width, fabric.memory.reference_length())
    }

    fn evenly_bent(fabric: &Fabric, width: &[f64], reference: f64) -> Self {
        Self {
            angle: MemoryLaw::for_angles(&fabric.memory),
            length: None,
            window: None,
            max_gain: width.iter().map(|w| reference / w.min(reference)).collect(),
            hinge_mask: vec![1.0; width.len()],
            triangle_mask: Vec::new(),
        }
    }

    /// The longest step [s] after one with these `events`: a `fraction` of the time to the next event, infinite after none.
    /// Where an element had an event more will follow, and the cloth must respond to one before the next is due.
    pub fn max_dt_after_events(&self, events: EventCount, fraction: f64) -> f64 {
        let laws = [Some(&self.angle), self.length.as_ref()].into_iter().flatten();
        let bands = laws.flat_map(|law| [(events.gradual, law.gradual), (events.critical, law.critical)]);
        let due = bands.filter(|(count, _)| *count > 0).map(|(_, band)| band.duration);
        fraction * due.fold(f64::INFINITY, f64::min)
    }

    /// Whether lengths are remembered.
    pub fn remembers_length(&self) -> bool {
        self.length.is_some()
    }

    /// Returns the bend within the reference length over that of a hinge alone [-], where the hinges have the bends `bend` [rad] from
    /// their source angles: from 1 for a lone crease to that of cloth that bends evenly.
    pub(super) fn gain(&self, hinge: usize, bend: impl Fn(usize) -> f64) -> f64 {
        let max = self.max_gain[hinge];
        let concentration = self.window.as_ref().and_then(|window| window.concentration(hinge, bend));
        concentration.map_or(max, |concentration| concentration.clamp(1.0, max))
    }

    /// Parameters of the angle of a hinge whose initial angle is `initial_rest` [rad] and whose condition is `gain` times its excess angle.
    pub(super) fn hinge_params(&self, hinge: usize, initial_rest: f64, gain: f64) -> ElementParams {
        ElementParams { initial_rest, gain, mask: self.hinge_mask[hinge] }
    }

    /// Parameters of the rest stretch of a triangle.
    pub(super) fn stretch_params(&self, triangle: usize) -> ElementParams {
        ElementParams { initial_rest: 1.0, gain: 1.0, mask: self.triangle_mask[triangle] }
    }
}

//! The tuning constants of the bake, each with quantity, unit, default and reason.
//!
//! Numbers that a user may choose stand in [`crate::bake::BakeOptions`]; those of the solver in `sim`.

/// All tuning constants of this folder, by subject.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BakeTuning {
    /// Steps and frames.
    pub stepping: BakeStepTuning,
    /// The choice of models.
    pub models: ModelTuning,
    /// The simulation mesh.
    pub simulation_mesh: SimulationMeshTuning,
    /// The region that a moving body can affect.
    pub active_region: ActiveRegionTuning,
    /// Where a body creases the cloth.
    pub body_creases: BodyCreaseTuning,
    /// Coupling to a body, and depenetration.
    pub body: BodyCouplingTuning,
    /// The leash of a garment that is skinned in its file.
    pub leash: LeashTuning,
    /// The watch over a garment on its body.
    pub body_watch: BodyWatchTuning,
    /// Relaxation to the source pose.
    pub relax: RelaxTuning,
    /// Triangles of the garment that follow the simulated mesh.
    pub follow: FollowTuning,
    /// Warnings.
    pub warnings: WarningTuning,
    pub findings: FindingTuning,
}

/// Steps and frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BakeStepTuning {
    /// First step after anything starts or stops [s]: two frames of a film of 60 Hz, before the error is known.
    pub first_dt: f64,
    /// Smallest request for the next step that a checkpoint may hold [s]: smaller ones are never made.
    pub min_dt_request: f64,
    /// Interval between frames below which every step is shown [s].
    pub min_frame_interval: f64,
    /// Root mean square speed below which a garment whose action may end early counts as at rest [m/s].
    pub max_rest_speed: f64,
    /// Time under constant loads from which steps grow with it [s]: shorter holds follow every event.
    pub long_hold: f64,
    /// Growth of the longest step with the time beyond that [-].
    pub hold_dt_growth: f64,
    /// Factor on the step after a memory event for cloth on a body [-]: the body, not the last event, decides how far cloth bends.
    pub body_event_dt_factor: f64,
    /// Length of every step with `BakeOptions::full_fidelity` [s].
    pub full_fidelity_dt: f64,
    /// Factor on the energy tolerance with `BakeOptions::full_fidelity` [-]: so small that every solve is global.
    pub full_fidelity_energy_factor: f64,
}

/// The choice of models ([`crate::bake::ModelPlan`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ModelTuning {
    /// Strain under its own weight [-] that sets the stretch stiffness of cloth that is crumpled or worn on a body: its
    /// ridges are finer than its elements, and it follows only by stretching.
    pub ridge_weight_strain: f64,
    /// Layers that the lowest layer is expected to carry.
    pub expected_layers: f64,
    /// Fraction of the contact distance that the expected load may compress [-].
    pub max_contact_compression: f64,
    /// Largest contact distance as a fraction of the mean edge [-]: nearer points of one layer must not meet.
    pub max_contact_edge_fraction: f64,
    /// Longest elements for wrinkles that form by themselves, in bending lengths; bending says nothing beyond twice the
    /// bending length.
    pub free_wrinkle_edge: f64,
    /// Smallest bending length of an element of cloth on a body, in lengths of its edges [-].
    pub min_bending_edges_on_body: f64,
    /// Smallest reference length of the memory law on a garment [m], default 0.02: what edges of every quality resolve.
    pub crease_length: f64,
    /// The same at most, as a fraction of the garment's extent [-], default 0.05: a doll's garment is creased like a person's.
    pub crease_extent_fraction: f64,
}

/// The simulation mesh ([`crate::bake::MeshChoice`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SimulationMeshTuning {
    /// Largest edge along fold lines as a fraction of the garment's extent [-], default 0.04: a doll's garment gets as many edges
    /// as a person's.
    pub max_extent_fraction: f64,
    /// Finest edge where the cloth may crease anywhere, as a fraction of the garment's extent [-] and at least that along fold
    /// lines, default 0.02: a crumpled T-shirt has 3,000 points and not 8,000.
    pub anywhere_extent_fraction: f64,
    /// Longest edges across creases and where fold lines cross [m], default 0.008: wider ones spread the bend of a crease, and stretch
    /// in the corner of many layers, which then lies otherwise in every run.
    pub max_crease_edge: f64,
    /// Length of edges where fold lines cross relative to that along the lines [-] and at most, default 0.75.
    pub crossing_factor: f64,
    /// Length of edges along borders, seams and sides relative to that along fold lines [-], default 1.5.
    pub side_factor: f64,
    /// Longest edges relative to those along fold lines [-], default 3.4.
    pub max_factor: f64,
    /// Longest edges [m], default 0.04.
    pub max_edge: f64,
    /// Longest edges of a garment with excess cloth, relative to those along fold lines [-], default 2: the excess is folded into the
    /// stack, where longer edges stand up like tents that no pressure flattens.
    pub max_factor_of_crumpled: f64,
    /// Fraction of the cloth that does not fit into the plane, beyond which it counts as excess [-], default 0.03.
    pub max_excess: f64,
    /// Growth of edges per metre of distance from lines and sides [-], default 1.
    pub edge_growth: f64,
    /// Edges where a body bends the cloth relative to those along fold lines [-], default 2/3: on edges of 12, 8 and 6 mm the cloth of an elbow
    /// remembers 0.83, 1.00 and 1 times as much.
    pub finest_factor_on_body: f64,
    /// Points at most where a body bends the cloth, default 3000: edges are longer where that is much of it, as of trousers that sit down.
    pub max_creased_points: usize,
    /// Longest edges on a body relative to those along fold lines [-]: straight edges of cloth cut into limbs.
    pub max_factor_on_body: f64,
    /// Growth of the edge length with the distance from where a body creases the cloth [-].
    pub edge_growth_on_body: f64,
    /// Angle of a hinge beyond which its triangles are bisected during the wear [degrees], default 45.
    pub max_hinge_deg: f64,
    /// Longest edge of a triangle that is not bisected, relative to the finest [-], default 1.4: halves and wholes lie around it.
    pub max_finest_factor: f64,
    /// Steps between two refinements during the wear, default 4: each costs a new linear system.
    pub refinement_steps: u64,
    /// Fraction of the triangles that must ask for a refinement before it is made [-], default 0.01.
    pub min_refined_fraction: f64,
}

/// The region that a moving body can affect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ActiveRegionTuning {
    /// Displacement below which a part of the body counts as static [m].
    pub min_body_motion: f64,
    /// Distance from a moving part of the body within which cloth is active [m].
    pub max_body_distance: f64,
    /// Distance along the cloth from such points within which cloth is active, too [m].
    pub geodesic_margin: f64,
}

/// Where a body creases the cloth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BodyCreaseTuning {
    /// Relative change of an edge from which a part of the body deforms [-].
    pub min_body_strain: f64,
    /// Distance from such a part within which cloth creases [m].
    pub max_body_distance: f64,
}

/// Coupling to a body, and depenetration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BodyCouplingTuning {
    /// Rounds of averaging of the carried displacement with that of neighbours.
    pub smoothing_rounds: usize,
    /// Stiffness of contact with the body per area [Pa/m], default 3e6: flesh of 30 kPa, 10 mm deep. A tight sleeve presses
    /// with some hundred pascals, which is less than a millimetre.
    pub contact_stiffness: f64,
    /// Radius of a limb [m], for the depth by which straight edges of cloth cut into it.
    pub limb_radius: f64,
    /// Depth inside the body that is reported [m].
    pub min_reported_depth: f64,
    /// Depth inside the body beyond which a garment does not fit and is refused [m].
    pub max_fit_depth: f64,
    /// Pairs of triangles of cloth and body that may intersect after a step where none did before \[-\]; a step with more is made in
    /// halves ([`BodyCouplingTuning::max_pairs_after`]).
    pub max_pairs: usize,
    /// Depth inside the body beyond which depenetration warns [m].
    pub max_usual_depth: f64,
    /// Search distance for the depth of a point inside the body [m].
    pub depth_search: f64,
    /// Fraction of the points of a garment that may lie deeper than it may fit [-], default 0.05: single points of a file are
    /// often inside, a garment that does not fit has many there.
    pub max_deep_fraction: f64,
    /// Rounds of leading deep points out at most.
    pub lead_out_rounds: usize,
    /// Positions on the way of such a point that are tried.
    pub lead_out_steps: u32,
    /// Equilibria of depenetration at most, each with the contacts of where the last ended.
    pub max_dressing_rounds: usize,
    /// Newton iterations of each at most.
    pub dressing_iterations: usize,
    /// Stiffness of the tether to the positions of the file during depenetration over that of contact [-], default 1e-4: it
    /// yields to contact and keeps the rest of the garment in place.
    pub dressing_tether: f64,
}

impl BodyCouplingTuning {
    /// Returns how many pairs may intersect after a step before which `before` did: a quarter more, as contact wavers.
    pub fn max_pairs_after(&self, before: usize) -> usize {
        self.max_pairs.max(before) + before / 4
    }
}

/// The leash of a garment that is skinned in its file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LeashTuning {
    /// Growth of a leash with the distance along the cloth from what is held [-], default 0.5: cloth that hangs from there swings by
    /// 30 degrees before it is stopped, more farther down.
    pub growth: f64,
    /// Distance along the cloth from what is held at which a leash would be endless [m], default 0.6. Cloth is free from three quarters of
    /// it on, where the leash is twice as long as that distance.
    pub free_distance: f64,
    /// Value of a mask above which a point is held [-].
    pub min_held_value: f64,
    /// Height below the highest border of a part, as a fraction of the height of the part, down to which borders are upper
    /// ones [-], default 0.1.
    pub top_band: f64,
    /// Largest height of a border that is held as a whole, as a fraction of the height of its part [-], default 0.25.
    pub level_border: f64,
    /// Distance within which a body is under cloth, as a fraction of the width of the cloth [-], default 0.6: a body in the
    /// middle of a tube lies within half of it.
    pub width_reach: f64,
    /// The same for cloth without another side [m], default 0.5.
    pub open_reach: f64,
    /// The same at least [m], default 0.08.
    pub min_reach: f64,
    /// Smallest width [m]: layers of one garment are nearer to each other.
    pub min_width: f64,
    /// Largest width that is looked for [m].
    pub max_width: f64,
    /// Cosine of the angle to the outward normal above which a body lies beside or outside closed cloth [-], default -0.3.
    pub max_inner_cosine: f64,
    /// Distance along the cloth from cloth with a body under it up to which it is not held [m], default 0.05.
    pub uncovered_margin: f64,
    /// Fraction of held points from which memory from the animation is enough [-], default 0.8.
    pub min_remembered: f64,
    /// Length of a leash up to which points off the body are carried along with their skin [m], default 0.3.
    pub following_length: f64,
    /// The same for points that the surface of the body carries [m], default 0.02.
    pub carried_length: f64,
}

/// The watch over a garment on its body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BodyWatchTuning {
    /// Distance from the bounding box of the body beyond which a part has fallen off [m], default 0.15.
    pub margin: f64,
    /// Pairs of triangles through which the body breaks that are too many at least, beyond those of the start, default 200.
    pub min_pairs: usize,
    /// The same as a fraction of the triangles of the garment [-], default 0.1.
    pub max_pair_fraction: f64,
    /// Pairs that may be left after the last step, beyond those of the start, default 20: corners of the body between points of the
    /// cloth make a few.
    pub max_pairs_at_end: usize,
    /// Time for which there may be so many [s], default 0.5: a fast motion recovers within that.
    pub max_time: f64,
}

/// Relaxation to the source pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RelaxTuning {
    /// Equal load increments of the memory: a crease of 170 degrees at once would be a jump.
    pub load_increments: u32,
    /// Further rounds on a body, with its contacts where the last round ended.
    pub body_rounds: u32,
    /// Energy tolerance as the height by which it would lift the garment [m]: a tenth of what a step asks for, far below
    /// what is visible.
    pub energy_tol_m: f64,
    /// Displacement tolerance [m].
    pub displacement_tol: f64,
    /// Newton iterations of an increment at most.
    pub max_iterations: usize,
    /// Tether of a rest mesh as a factor on that of a garment [-]: it only fixes the position in space.
    pub rest_mesh_tether: f64,
    /// Decay length of a crease in the relaxed shape, at least [m], default 0.055: of the kink 0.6 are undone within 60 mm, on either side
    /// of a fold of a shirt (0.03: 0.95, a groove between two bulges; 0.08: 0.44, but the shirt moves out of its pose).
    pub min_decay: f64,
    /// Decay length of a crease in the relaxed shape, in mean edges of the garment [-], default 1.5, and at
    /// least the bending length: what decays within a triangle cannot be read off at its corners.
    pub decay_edges: f64,
    /// Displacement up to which the tether is a linear spring [m], default 0.01: the distance by which a crease that opens to 29 degrees moves
    /// its line.
    pub free_shift: f64,
    /// Growth of the tether beyond that [-], default 9: 2.5 times as stiff at 15 mm, 5.5 times at 20 mm.
    pub tether_growth: f64,
    /// Width of the panels beside a crease [m], default 0.1, and at least a mean edge of the garment.
    pub panel_width: f64,
    /// Radius of a surface across which such panels can bend [m], default 0.2, a torso: the cloth gets the ratio of bending to stretch
    /// stiffness of a sheet of the thickness width²/radius, below which curved shells do not crease (Pogorelov 1967).
    pub surface_radius: f64,
    /// Stretch stiffness of a rest mesh as a factor on that of a bake [-]: a memory is seldom the angles of a surface
    /// that exists, and lengths may change by parts of a per cent before angles do.
    pub rest_mesh_stretch: f64,
}

/// Layers kept apart where the garment's own triangles would cross.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FollowTuning {
    /// Distance within which layers push one another apart [m], default 3e-4: layers of thin cloth lie no nearer on the simulated mesh.
    pub contact_distance: f64,
    /// The same at most, as a fraction of the mean edge [-], default 0.05: a doll's garment is thin.
    pub max_contact_edge_fraction: f64,
    /// Stiffness of contact over that of the tether [-], default 1000: a chord that cuts 5 mm off a fold takes half of the distance.
    pub contact_stiffness: f64,
    /// Stiffness of an edge over that of the tether of a point of the mean area [-], default 1: a shift decays over one to two edges.
    pub edge_stiffness: f64,
    /// Least area of a point for its tether, as a fraction of the mean [-], default 1e-3.
    pub min_area_fraction: f64,
    /// Motion that is followed at once at most [m], default 0.02: layers on one another get stuck in longer ones.
    pub max_step: f64,
    /// The same where the garment was put elsewhere [m], default 0.01: its layers pass one another.
    pub max_step_elsewhere: f64,
    /// Steps of a motion at most, default 200.
    pub max_steps: f64,
    /// Motion that is followed at least [m], default 2e-5; what moves less stays where it is.
    pub min_motion: f64,
    /// Rings of points that move along with those that do, default 2.
    pub free_rings: usize,
    /// Iterations of a step at most, default 10; what is left is made up for in the next.
    pub max_iterations: usize,
    /// Displacement of an iteration at which a step ends [m], default 1e-4.
    pub displacement_tol: f64,
    /// Decrease of the energy at which a step ends, per stiffness [m^4], default 1e-11: 0.2 mm at a point of 4 cm²; 1e-10 leaves single points 4 mm behind.
    pub energy_tol: f64,
    /// Distance between the garment's points and the simulated mesh from which on a warning counts the frame [m], default 0.01.
    pub max_distance: f64,
    /// Rounds in which the displacement of a result is held back from the body at most, default 60.
    pub max_hold_back_rounds: usize,
    /// Factor per round on the displacement of triangles that still cross the body [-], default 0.6.
    pub hold_back_factor: f64,
}

/// Warnings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WarningTuning {
    /// Pause between two violations of one kind up to which they are one warning [s].
    pub max_pause: f64,
    /// Time for which cloth may be stretched beyond what it bears [s], default 0.25.
    pub max_torn_time: f64,
    /// Steps in a row without any motion and without convergence after which a run ends, default 5.
    pub max_stuck_steps: u64,
    /// Warnings of one kind at most; the rest are counted.
    pub max_violations: usize,
    /// Pairs of parts named in the warning on initial intersections at most; the rest are counted.
    pub max_part_pairs: usize,
}

/// Findings on a bake without effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FindingTuning {
    /// Change of a rest angle below which a hinge counts as unchanged [rad], half a degree.
    pub min_angle_change: f64,
    /// Change of a rest stretch below which a triangle counts as unchanged [-].
    pub min_stretch_change: f64,
    /// Distance from the body within which a garment is worn on it [m].
    pub near_body: f64,
    /// Sum of the changes of rest angles times lengths from which a wear left a crease [rad m].
    pub min_crease_sum: f64,
    /// Fraction of that sum which the mesh of the file has to keep [-].
    pub min_kept_fraction: f64,
    /// Coarsest resolution that is advised [mm].
    pub max_advised_resolution_mm: f64,
    /// Actions without effect that are told at most.
    pub max_idle_actions: usize,
}

impl BakeTuning {
    /// The values that every bake uses.
    const DEFAULT: Self = Self {
        stepping: BakeStepTuning {
            first_dt: 1.0 / 120.0,
            min_dt_request: 1e-6,
            min_frame_interval: 1e-5,
            max_rest_speed: 1e-4,
            long_hold: 120.0,
            hold_dt_growth: 0.1,
            body_event_dt_factor: 2.5,
            full_fidelity_dt: 1.0 / 60.0,
            full_fidelity_energy_factor: 0.01,
        },
        models: ModelTuning {
            ridge_weight_strain: 5e-3,
            expected_layers: 16.0,
            max_contact_compression: 0.3,
            max_contact_edge_fraction: 0.2,
            free_wrinkle_edge: 0.25,
            min_bending_edges_on_body: 2.0,
            crease_length: 0.02,
            crease_extent_fraction: 0.05,
        },
        simulation_mesh: SimulationMeshTuning {
            max_extent_fraction: 0.04,
            anywhere_extent_fraction: 0.02,
            max_crease_edge: 0.008,
            crossing_factor: 0.75,
            side_factor: 1.5,
            max_factor: 3.4,
            max_edge: 0.04,
            max_factor_of_crumpled: 2.0,
            max_excess: 0.03,
            edge_growth: 1.0,
            finest_factor_on_body: 2.0 / 3.0,
            max_creased_points: 3000,
            max_factor_on_body: 2.0,
            edge_growth_on_body: 0.5,
            max_hinge_deg: 45.0,
            max_finest_factor: 1.4,
            refinement_steps: 4,
            min_refined_fraction: 0.01,
        },
        active_region: ActiveRegionTuning {
            min_body_motion: 2e-4,
            max_body_distance: 0.03,
            geodesic_margin: 0.10,
        },
        body_creases: BodyCreaseTuning { min_body_strain: 0.15, max_body_distance: 0.02 },
        body: BodyCouplingTuning {
            smoothing_rounds: 6,
            contact_stiffness: 3e6,
            limb_radius: 0.04,
            min_reported_depth: 1e-3,
            max_fit_depth: 0.030,
            max_pairs: 5,
            max_usual_depth: 0.015,
            depth_search: 0.3,
            max_deep_fraction: 0.05,
            lead_out_rounds: 8,
            lead_out_steps: 8,
            max_dressing_rounds: 12,
            dressing_iterations: 15,
            dressing_tether: 1e-4,
        },
        leash: LeashTuning {
            growth: 0.5,
            free_distance: 0.6,
            min_held_value: 0.5,
            top_band: 0.1,
            level_border: 0.25,
            width_reach: 0.6,
            open_reach: 0.5,
            min_reach: 0.08,
            min_width: 0.01,
            max_width: 1.5,
            max_inner_cosine: -0.3,
            uncovered_margin: 0.05,
            min_remembered: 0.8,
            following_length: 0.3,
            carried_length: 0.02,
        },
        body_watch: BodyWatchTuning {
            margin: 0.15,
            min_pairs: 200,
            max_pairs_at_end: 20,
            max_pair_fraction: 0.1,
            max_time: 0.5,
        },
        relax: RelaxTuning {
            load_increments: 6,
            body_rounds: 3,
            energy_tol_m: 3e-7,
            displacement_tol: 1e-5,
            max_iterations: 60,
            rest_mesh_tether: 1e-4,
            rest_mesh_stretch: 0.02,
            min_decay: 0.055,
            decay_edges: 1.5,
            free_shift: 0.01,
            tether_growth: 9.0,
            panel_width: 0.1,
            surface_radius: 0.2,
        },
        follow: FollowTuning {
            contact_distance: 3e-4,
            max_contact_edge_fraction: 0.05,
            contact_stiffness: 1e3,
            edge_stiffness: 1.0,
            min_area_fraction: 1e-3,
            max_step: 0.02,
            max_step_elsewhere: 0.01,
            max_steps: 200.0,
            min_motion: 2e-5,
            free_rings: 2,
            max_iterations: 10,
            displacement_tol: 1e-4,
            energy_tol: 1e-11,
            max_distance: 0.01,
            max_hold_back_rounds: 60,
            hold_back_factor: 0.6,
        },
        warnings: WarningTuning {
            max_pause: 0.25,
            max_torn_time: 0.25,
            max_stuck_steps: 5,
            max_violations: 5,
            max_part_pairs: 6,
        },
        findings: FindingTuning {
            min_angle_change: 0.5 * std::f64::consts::PI / 180.0,
            min_stretch_change: 1e-3,
            near_body: 0.05,
            min_crease_sum: 0.02,
            min_kept_fraction: 0.25,
            max_advised_resolution_mm: 10.0,
            max_idle_actions: 5,
        },
    };
}

/// The values in use.
pub(super) const TUNING: BakeTuning = BakeTuning::DEFAULT;

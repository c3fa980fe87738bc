//! Tuning constants of the wear actions, all in one place, by subject.

/// Springs that move and hold points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SpringTuning {
    /// Deflection of a spring along its normal under the weight of its point [m], default 5e-4: it sets the stiffness.
    pub sag: f64,
    /// Tangential stiffness relative to the normal one [-], default 0.02: the cloth may slide in its own plane.
    pub tangential_fraction: f64,
}

/// Motions of the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BodyMotionTuning {
    /// Largest step while the body moves [s], default 1/30: a frame of usual clips.
    pub max_dt_moving: f64,
    /// Speed of the fastest point in a transition between two poses [m/s], default 0.4: an arm that moves without haste.
    pub max_transition_speed: f64,
    /// Largest distance between the points of two poses that count as the same [m], default 1e-4.
    pub same_pose_distance: f64,
    /// Poses sampled over a `bend` to find what moves, default 12.
    pub bend_samples: u32,
    /// Poses sampled per second of a clip to find what moves [1/s], default 10.
    pub clip_sample_rate: f64,
    /// Largest number of poses sampled over a clip, default 200.
    pub max_clip_samples: u32,
}

/// Folding and unfolding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FoldTuning {
    /// Angle above which a flap counts as laid flat on the rest [degrees], default 150: its crease can be predicted.
    pub flat_fold_deg: f64,
    /// Distance from the line [m], default 0.05, within which a fold is smoothed, layers make the height of the stack, and the rest is
    /// free while a fold is opened.
    pub strip_width: f64,
    /// Distance from the line [m], default 0.025, within which springs hold the resting part while the flap turns; beyond, it is
    /// fixed. A wider strip is lifted with the flap where layers bulge, and bends beside the line.
    pub held_width: f64,
    /// Distance from the line and from the bend of the stack [m], default 0.03, twice that for a garment that was laid out, beyond which flat
    /// cloth stays where the map of the fold has it once the flap is turned over.
    pub band_width: f64,
    /// Largest slope of cloth that counts as flat [rad], default 0.35.
    pub max_panel_tilt: f64,
    /// Largest angle that the flap turns per step [rad], default 0.12.
    pub max_turn_per_step: f64,
    /// Fraction of the points along the line that lie no higher than the stack [-], default 0.9: the others are bulges of
    /// older folds.
    pub stack_quantile: f64,
    /// Height of the fold axis above the stack, in layers [-], default 0.75.
    pub axis_clearance: f64,
    /// Duration of the release of a flap that lies [s], default 0.4.
    pub release_time: f64,
    /// Steps over the release, default 4.
    pub release_steps: f64,
    /// Least fraction of its path at which hands still reach a flap that springs back to where its fold fails [-], default 0.3.
    pub min_reached_fraction: f64,
    /// Pressure that smooths a fold along its line while it is held [Pa], default 2000: a hand.
    pub smoothing_pressure: f64,
    /// Pressure that smooths the whole stack of a garment that was laid out while a fold is held [Pa], default 500: flat hands.
    pub stroking_pressure: f64,
    /// Additional drag during the release [1/s], default 20.
    pub release_drag: f64,
    /// Angle above which a fold stays by itself [rad], default 3; others are held until they are opened or released.
    pub self_supporting_angle: f64,
    /// Distance from the bend over which the flap is raised above what lies below it [m], default 0.03.
    pub rise_ramp: f64,
    /// Fraction of points that may lie out of order when the height between flap and rest is chosen [-], default 0.02.
    pub max_outlier_fraction: f64,
    /// Distance beyond the line from which points count for that height [m], default 0.01.
    pub height_sample_offset: f64,
    /// Distance from the line over which an opening flap is lifted [m], default 0.03: the crease itself is not pulled.
    pub lift_ramp: f64,
}

/// Rolling up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RollTuning {
    /// Thickness of a winding over that of the stack and one layer [-], default 1.1: layers slide past one another.
    pub winding_clearance: f64,
    /// Smallest radius of the core over that with which the inmost layers have room [-], default 1.1.
    pub core_clearance: f64,
    /// Distance before the roll [m], default 0.025, within which the stack is held; beyond, it is fixed.
    pub held_length: f64,
    /// Angle by which the roll turns in one step [rad], default 0.25.
    pub max_turn_per_step: f64,
}

/// Height field under a flap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HeightFieldTuning {
    /// Width of a cell [m], default 0.01.
    pub cell: f64,
    /// Cells around its own that a point raises, default 2: a mesh has no points between its points.
    pub dilation: i32,
    /// Cells on each side over which heights are averaged, default 2: a flap must not get steps.
    pub smoothing: i32,
}

/// Laying a garment down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LayTuning {
    /// Height up to which a garment lies already [layer thicknesses], default 12.
    pub flat_layers: f64,
    /// Fraction of the duration in which a garment that was laid out slides without friction, pressed by hands [-], default 0.7.
    pub smoothing_fraction: f64,
    /// Fraction of the duration in which the pressure of hands rises on it [-], default 0.3.
    pub smoothing_rise: f64,
    /// Largest step relative to the duration [-], default 0.1.
    pub max_free_dt_fraction: f64,
    /// Air drag meanwhile [1/s], default 10.
    pub drag: f64,
    /// Distance over which the direction of the surface is averaged before it is told which layer it will lie in, relative to the
    /// garment's extent [-], default 0.03.
    pub side_smoothing: f64,
    /// Area of a patch of one side, relative to the garment's, below which it joins the other side [-], default 0.02.
    pub min_side_fraction: f64,
    /// Mean of |level| up to which such a patch joins it [-], default 0.3.
    pub min_side_level: f64,
    /// Length of an edge over a triangle, and square root of the area of an overlap, from which they count [m], default 1e-6.
    pub min_overlap: f64,
    /// Weight of the direction up beside the two normals of a pair when it is told which lies above [-], default 0.1.
    pub upward_weight: f64,
    /// Random displacement in the plane that sets copies of a sheet apart [m], default 1e-5.
    pub shift: f64,
    /// Bounds of cotangents in the layout [-], defaults 0.02 and 50.
    pub min_cotangent: f64,
    pub max_cotangent: f64,
    /// Weight of the place before the layout, against that of the shapes [-], default 1e-6.
    pub place_weight: f64,
    /// Iterations of the layout at most, default 300.
    pub max_layout_iterations: usize,
    /// Rounds of the layout at most, default 10: after each, triangles that are folded over are stiffened.
    pub max_layout_rounds: usize,
    /// Factor on the weight of such triangles per round [-], default 3.
    pub stiffening: f64,
    /// Largest change of a position at which the layout ends [m], default 1e-5.
    pub layout_tol: f64,
    /// Distance of the layers of the layout [layer thicknesses], default 2.
    pub layout_gap: f64,
    /// Rounds in which what is folded over is drawn out, default 40.
    pub draw_out_rounds: usize,
    /// Slope at which layers rise from a fold to that distance [-], default 0.2.
    pub rim_slope: f64,
    /// Least distance of layers next to folds, relative to that distance [-], default 0.1.
    pub min_gap_fraction: f64,
    /// Rounds in which layers are moved apart in height, at most, default 300.
    pub max_gap_rounds: usize,
    /// Missing distance at which that ends, relative to the distance of layers [-], default 0.01.
    pub gap_tol: f64,
}

/// Pressing, crumpling, hanging and settling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OtherActionTuning {
    /// Time in which the pressure of a `press` rises [s], default 0.4, or half of the press if that is shorter: applied at
    /// once it would accelerate whatever stands up.
    pub press_ramp_time: f64,
    /// Smallest number of steps over that time, default 4.
    pub press_ramp_steps: f64,
    /// Height of the closed `crumple` sphere over the ground [m], default 0.02.
    pub sphere_clearance: f64,
    /// Pressure on cloth outside the sphere [Pa], default 400: 320 N on a T-shirt's 0.8 m² at most. With half of it stiff
    /// garments stay up to a fifth too large; with 1 kPa and above layers are pressed to nothing, and cloth is stretched by
    /// half.
    pub sphere_pressure: f64,
    /// Largest step while the sphere closes, relative to the time that takes [-], default 0.01.
    pub sphere_dt_fraction: f64,
    /// Size of the grip of a hanging garment relative to its box diagonal [-], default 0.01.
    pub hang_grip_fraction: f64,
    /// Largest distance of points from a plane in which they count as lying, relative to the diagonal of their box [-], default 1e-6:
    /// single precision rounds by less.
    pub planar_fraction: f64,
    /// Largest distance off that plane at which cloth begins that lies in it [m], default 1e-5.
    pub imperfection: f64,
    /// Largest step while a garment begins to hang [s], default 0.1.
    pub hang_max_dt: f64,
    /// Time after which a garment hangs still [s], default 10: steps grow from then on, and a longer action is not ended early,
    /// since its memory changes with time.
    pub hang_swing_time: f64,
    /// Growth of the largest step with the time after that [-], default 0.1.
    pub hang_dt_growth: f64,
    /// Width of a hanger [m], default 0.42.
    pub hanger_width: f64,
    /// Part of each half of a hanger, from its end inwards, that bears the garment [-], default 0.5: the rest spans its neck.
    pub hanger_support_fraction: f64,
    /// Air drag while a garment settles [1/s], default 3.
    pub settle_drag: f64,
}

/// Ironing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct IronTuning {
    /// Half of the width of the soleplate [m], default 0.05.
    pub half_width: f64,
    /// Rate at which hot moist cloth gives up its memory [1/s], default 0.5: in 10 s all but 1 %.
    pub setting_rate: f64,
    /// Largest step as a fraction of the time in which that happens [-], default 0.25: the cloth flattens meanwhile.
    pub max_set_per_step: f64,
}

/// Wet cloth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WetTuning {
    /// Rate at which it gives up its memory [1/s], default 0.5.
    pub setting_rate: f64,
    /// Fraction of the present bend that it sets without pressure [-], default 0.8: cotton without a finish dries full of wrinkles.
    pub set_fraction: f64,
    /// How often memory would be replaced while it dries as it hangs [-], default 0.3: three quarters of it remain.
    pub drying_dose: f64,
}

/// Actions that did not do what they should.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FailureTuning {
    /// Fraction of its path that a flap has to cover [-], default 0.5.
    pub min_turned_fraction: f64,
    /// Mean path of a flap below which nothing is told of it [m], default 0.02.
    pub min_judged_path: f64,
    /// Fraction of its path to the ball that a crumpled garment has to cover [-], default 0.5.
    pub min_crumpled_fraction: f64,
    /// Mean distance of points from their places in a roll over the radius of its core [-], default 0.5.
    pub max_roll_distance: f64,
    /// Fraction of the points that may stand up from a garment that lies [-], default 0.02.
    pub max_standing_fraction: f64,
}

/// Prediction of creases.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PredictionTuning {
    /// Mean |normal . y| over the area from which a garment that is laid down is flat already [-], default 0.9: others are
    /// pressed flat and may wrinkle anywhere.
    pub min_flat_normal_y: f64,
    /// Distance from another line below which a row of edges beside a fold line is left out, as a fraction of the row's
    /// own distance [-], default 0.6.
    pub row_clearance: f64,
    /// Distance from a line within which it runs through the points of other curves, relative to that of its rows [-],
    /// default 0.15.
    pub snap_rows: f64,
    /// The same for points of no curve [-], default 0.04: next to them a line makes triangles that are too small for anything.
    pub snap_free: f64,
    /// Height of the lowest layer above the ground, in layers [-], default 0.8.
    pub lowest_layer_height: f64,
    /// Cells in which layers that lie on one another are looked up [m], default 0.02.
    pub layer_cell: f64,
}

/// Constants of the wear actions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WearTuning {
    pub springs: SpringTuning,
    pub body: BodyMotionTuning,
    pub fold: FoldTuning,
    pub roll: RollTuning,
    pub height_field: HeightFieldTuning,
    pub lay: LayTuning,
    pub other: OtherActionTuning,
    pub iron: IronTuning,
    pub wet: WetTuning,
    pub failure: FailureTuning,
    pub prediction: PredictionTuning,
}

/// The constants in use.
pub(super) const TUNING: WearTuning = WearTuning {
    springs: SpringTuning { sag: 5e-4, tangential_fraction: 0.02 },
    body: BodyMotionTuning {
        max_dt_moving: 1.0 / 30.0,
        max_transition_speed: 0.4,
        same_pose_distance: 1e-4,
        bend_samples: 12,
        clip_sample_rate: 10.0,
        max_clip_samples: 200,
    },
    fold: FoldTuning {
        flat_fold_deg: 150.0,
        strip_width: 0.05,
        held_width: 0.025,
        band_width: 0.03,
        max_panel_tilt: 0.35,
        max_turn_per_step: 0.12,
        stack_quantile: 0.9,
        axis_clearance: 0.75,
        release_time: 0.4,
        release_steps: 4.0,
        min_reached_fraction: 0.3,
        smoothing_pressure: 2000.0,
        stroking_pressure: 500.0,
        release_drag: 20.0,
        self_supporting_angle: 3.0,
        rise_ramp: 0.03,
        max_outlier_fraction: 0.02,
        height_sample_offset: 0.01,
        lift_ramp: 0.03,
    },
    roll: RollTuning {
        winding_clearance: 1.1,
        core_clearance: 1.1,
        held_length: 0.025,
        max_turn_per_step: 0.25,
    },
    height_field: HeightFieldTuning { cell: 0.01, dilation: 2, smoothing: 2 },
    lay: LayTuning {
        flat_layers: 12.0,
        smoothing_fraction: 0.7,
        smoothing_rise: 0.3,
        max_free_dt_fraction: 0.1,
        drag: 10.0,
        side_smoothing: 0.03,
        min_side_fraction: 0.02,
        min_side_level: 0.3,
        min_overlap: 1e-6,
        upward_weight: 0.1,
        shift: 1e-5,
        min_cotangent: 0.02,
        max_cotangent: 50.0,
        place_weight: 1e-6,
        max_layout_iterations: 300,
        max_layout_rounds: 10,
        stiffening: 3.0,
        layout_tol: 1e-5,
        layout_gap: 2.0,
        draw_out_rounds: 40,
        rim_slope: 0.2,
        min_gap_fraction: 0.1,
        max_gap_rounds: 300,
        gap_tol: 0.01,
    },
    other: OtherActionTuning {
        press_ramp_time: 0.4,
        press_ramp_steps: 4.0,
        sphere_clearance: 0.02,
        sphere_pressure: 400.0,
        sphere_dt_fraction: 0.01,
        hang_grip_fraction: 0.01,
        planar_fraction: 1e-6,
        imperfection: 1e-5,
        hang_max_dt: 0.1,
        hang_swing_time: 10.0,
        hang_dt_growth: 0.1,
        hanger_width: 0.42,
        hanger_support_fraction: 0.5,
        settle_drag: 3.0,
    },
    iron: IronTuning { half_width: 0.05, setting_rate: 0.5, max_set_per_step: 0.25 },
    wet: WetTuning { setting_rate: 0.5, set_fraction: 0.8, drying_dose: 0.3 },
    failure: FailureTuning {
        min_turned_fraction: 0.5,
        min_judged_path: 0.02,
        min_crumpled_fraction: 0.5,
        max_roll_distance: 0.5,
        max_standing_fraction: 0.02,
    },
    prediction: PredictionTuning {
        min_flat_normal_y: 0.9,
        row_clearance: 0.6,
        snap_rows: 0.15,
        snap_free: 0.04,
        lowest_layer_height: 0.8,
        layer_cell: 0.02,
    },
};

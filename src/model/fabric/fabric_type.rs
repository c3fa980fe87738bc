//! The parameters of cloth, with units and provenance, as they stand in `crease-fabric/1` files.
//!
//! Fields carry their unit in the name, as in the file; the methods give SI. Stiffnesses are those of
//! `docs/theory/method.md`: stretch and shear per width [N/m] and bending per width [N·m], the B of a plate. The memory
//! numbers follow KOW's ten parameters, with thresholds in percent of a right angle. Does not do: the memory law itself ([`crease_solver::memory::MemoryLaw`]).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

/// Gravity [m/s²], for the bending length.
const GRAVITY: f64 = 9.81;

/// The format of a fabric file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum FabricFormat {
    /// Version 1.
    #[default]
    #[serde(rename = "crease-fabric/1")]
    V1,
}

/// A fabric: mechanical parameters, and the parameters of its memory.
///
/// ```
/// use crease_model::fabric::Fabric;
/// let denim = Fabric::preset("denim")?;
/// assert!((denim.area_density() - 0.421).abs() < 1e-12, "kg/m²");
/// // A variant of a preset, as in a fabric file.
/// let stiff = Fabric::parse("stiff.json", r#"{"format": "crease-fabric/1", "name": "stiff denim",
///     "based_on": "denim", "bend_warp_un_m": 150}"#)?;
/// assert!(stiff.bending_length() > denim.bending_length());
/// # Ok::<(), crease_model::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "crease fabric")]
#[non_exhaustive]
pub struct Fabric {
    /// Format of the file: crease-fabric/1.
    pub format: FabricFormat,
    /// Name of the fabric.
    #[schemars(length(min = 1))]
    pub name: String,
    /// Preset that supplies the fields that the file leaves out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub based_on: Option<String>,
    /// Description in a few words.
    #[serde(default)]
    pub description: String,
    /// Mass per area [g/m²].
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 10000))]
    pub area_density_g_m2: f64,
    /// Thickness of one layer [mm].
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 50))]
    pub thickness_mm: f64,
    /// Stretch stiffness along warp [N/m]: force per width for a strain of 1.
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 10_000_000))]
    pub stretch_warp_n_per_m: f64,
    /// Stretch stiffness along weft [N/m].
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 10_000_000))]
    pub stretch_weft_n_per_m: f64,
    /// Shear stiffness [N/m]: force per width for a shear of 1 rad.
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 10_000_000))]
    pub shear_n_per_m: f64,
    /// Bending stiffness along warp [µN·m = 1e-6 N·m].
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1_000_000))]
    pub bend_warp_un_m: f64,
    /// Bending stiffness along weft [µN·m].
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1_000_000))]
    pub bend_weft_un_m: f64,
    /// Relaxation time of stretch and shear [s]: damping stiffness over stiffness.
    #[schemars(range(min = 0, max = 10))]
    pub stretch_damping_s: f64,
    /// Relaxation time of bending [s].
    #[schemars(range(min = 0, max = 10))]
    pub bend_damping_s: f64,
    /// Friction coefficient of the fabric on itself [-].
    #[schemars(range(min = 0, max = 10))]
    pub friction: f64,
    /// Friction coefficient of the fabric on the ground or a table [-].
    #[schemars(range(min = 0, max = 10))]
    pub friction_ground: f64,
    /// Parameters of the memory law.
    #[serde(default)]
    pub memory: FabricMemory,
    /// Origin of the numbers.
    #[serde(default)]
    pub provenance: Provenance,
}

/// Quantity of an element that an event of the memory law must not raise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EventGuard {
    /// The stored energy, `s C²`: memory does no work on the cloth.
    #[default]
    Energy,
    /// The torque, `s C`, and with it the energy: memory does not make the cloth spring back harder.
    Torque,
}

/// Parameters of the memory law. Defaults are those of KOW's T-shirt.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FabricMemory {
    /// Gradual change starts above this bend [percent of a right angle].
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 10000))]
    pub gradual_threshold_percent: f64,
    /// Critical change starts above this bend [percent of a right angle].
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 10000))]
    pub critical_threshold_percent: f64,
    /// Time in the gradual band until an event [s], KOW's tau_a.
    #[schemars(range(min = 0.001, max = 1_000_000_000))]
    pub gradual_duration_s: f64,
    /// Time in the critical band until an event [s], KOW's tau_b.
    #[schemars(range(min = 0.001, max = 1_000_000_000))]
    pub critical_duration_s: f64,
    /// Stiffening by a gradual event [-], KOW's rho_ak.
    #[schemars(range(min = 0, max = 100))]
    pub gradual_stiffness_ratio: f64,
    /// Change of the rest angle by a gradual event, as a fraction of the gradual threshold [-], KOW's rho_at.
    #[schemars(range(min = 0, max = 1))]
    pub gradual_angle_ratio: f64,
    /// Stiffening by a critical event [-], KOW's rho_bk.
    #[schemars(range(min = 0, max = 100))]
    pub critical_stiffness_ratio: f64,
    /// Change of the rest angle by a critical event, as a fraction of the critical threshold [-], KOW's rho_bt.
    #[schemars(range(min = 0, max = 1))]
    pub critical_angle_ratio: f64,
    /// Gradual change of rest length starts above this strain [percent].
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1000))]
    pub gradual_stretch_threshold_percent: f64,
    /// Critical change of rest length starts above this strain [percent].
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1000))]
    pub critical_stretch_threshold_percent: f64,
    /// Change of the rest stretch by a gradual event, as a fraction of the gradual stretch threshold [-], KOW's rho_al.
    #[schemars(range(min = 0, max = 1))]
    pub gradual_length_ratio: f64,
    /// Change of the rest stretch by a critical event, as a fraction of the critical stretch threshold [-], KOW's rho_bl.
    #[schemars(range(min = 0, max = 1))]
    pub critical_length_ratio: f64,
    /// Rest stretch that events approach and do not reach: an event is scaled by the fraction of it that is left [percent].
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1000))]
    pub rest_stretch_ceiling_percent: f64,
    /// Reference length within which the bend of the cloth counts: a lone crease by its angle, cloth that bends evenly by its
    /// curvature [mm]. A bake uses at least 20 mm, or a twentieth of a garment's extent where that is less.
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1000))]
    pub reference_length_mm: f64,
    /// Largest ratio of the stiffness of a hinge to its initial stiffness [-].
    #[schemars(range(min = 1, max = 10000))]
    pub stiffness_ceiling: f64,
    /// Fraction of a remembered angle that recovers per decade of time after release, counted from 1 s [percent].
    #[schemars(range(min = 0, max = 100))]
    pub reopening_percent_per_decade: f64,
    /// What an event must not raise: a choice of the law for comparisons, which no file states.
    #[serde(skip)]
    pub guard: EventGuard,
}

impl Default for FabricMemory {
    fn default() -> Self {
        Self {
            gradual_threshold_percent: 27.0,
            critical_threshold_percent: 85.0,
            gradual_duration_s: 4.3,
            critical_duration_s: 1.0,
            gradual_stiffness_ratio: 1.1,
            gradual_angle_ratio: 0.4,
            critical_stiffness_ratio: 2.5,
            critical_angle_ratio: 1.0,
            gradual_stretch_threshold_percent: 2.0,
            critical_stretch_threshold_percent: 6.0,
            gradual_length_ratio: 0.0,
            critical_length_ratio: 0.0,
            rest_stretch_ceiling_percent: 10.0,
            reference_length_mm: 10.0,
            stiffness_ceiling: 30.0,
            reopening_percent_per_decade: 0.0,
            guard: EventGuard::default(),
        }
    }
}

/// Origin of each group of numbers, in words.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Provenance {
    /// Of `area_density_g_m2` and `thickness_mm`.
    pub mass: String,
    /// Of `stretch_warp_n_per_m` and `stretch_weft_n_per_m`.
    pub stretch: String,
    /// Of `shear_n_per_m`.
    pub shear: String,
    /// Of `bend_warp_un_m` and `bend_weft_un_m`.
    pub bend: String,
    /// Of `stretch_damping_s` and `bend_damping_s`.
    pub damping: String,
    /// Of `friction` and `friction_ground`.
    pub friction: String,
    /// Of `memory`.
    pub memory: String,
}

impl Default for Provenance {
    fn default() -> Self {
        let unstated = || "not stated".to_owned();
        Self {
            mass: unstated(),
            stretch: unstated(),
            shear: unstated(),
            bend: unstated(),
            damping: unstated(),
            friction: unstated(),
            memory: unstated(),
        }
    }
}

impl Fabric {
    /// Mass per area [kg/m²].
    pub fn area_density(&self) -> f64 {
        self.area_density_g_m2 * 1e-3
    }

    /// Thickness of one layer [m].
    pub fn thickness(&self) -> f64 {
        self.thickness_mm * 1e-3
    }

    /// Width of cloth over which a fold bends [m]: the half circle at the depth of one thickness below the axis of the fold, the mean of the
    /// two innermost layers of a stack. The depth is an assumption.
    pub fn crease_width(&self) -> f64 {
        std::f64::consts::PI * self.thickness()
    }

    /// Stretch stiffness along warp [N/m].
    pub fn stretch_warp(&self) -> f64 {
        self.stretch_warp_n_per_m
    }

    /// Stretch stiffness along weft [N/m].
    pub fn stretch_weft(&self) -> f64 {
        self.stretch_weft_n_per_m
    }

    /// Shear stiffness [N/m].
    pub fn shear(&self) -> f64 {
        self.shear_n_per_m
    }

    /// Bending stiffness along warp [N·m].
    pub fn bend_warp(&self) -> f64 {
        self.bend_warp_un_m * 1e-6
    }

    /// Bending stiffness along weft [N·m].
    pub fn bend_weft(&self) -> f64 {
        self.bend_weft_un_m * 1e-6
    }

    /// Bending stiffness of the fabric as a whole [N·m]: the geometric mean of warp and weft.
    pub fn bend_mean(&self) -> f64 {
        (self.bend_warp() * self.bend_weft()).sqrt()
    }

    /// Bending length [m]: (B / (rho g))^(1/3), the length scale of wrinkles under own weight.
    pub fn bending_length(&self) -> f64 {
        (self.bend_mean() / (self.area_density() * GRAVITY)).cbrt()
    }
}

impl FabricMemory {
    /// Gradual threshold C^a [rad].
    pub fn gradual_threshold(&self) -> f64 {
        self.gradual_threshold_percent * 0.01 * FRAC_PI_2
    }

    /// Critical threshold C^b [rad].
    pub fn critical_threshold(&self) -> f64 {
        self.critical_threshold_percent * 0.01 * FRAC_PI_2
    }

    /// Gradual threshold of strain [-].
    pub fn gradual_stretch_threshold(&self) -> f64 {
        self.gradual_stretch_threshold_percent * 0.01
    }

    /// Critical threshold of strain [-].
    pub fn critical_stretch_threshold(&self) -> f64 {
        self.critical_stretch_threshold_percent * 0.01
    }

    /// Reference length L [m]: hinges at least as wide are measured by their angle.
    pub fn reference_length(&self) -> f64 {
        self.reference_length_mm * 1e-3
    }
}

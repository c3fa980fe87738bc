//! [`Bake`]: the front door of the library.

use crate::bake::body::leash::GarmentLeash;
use crate::bake::body::start::body_at_first_key;
use crate::bake::checkpoint::Checkpoint;
use crate::bake::plan::laid_out;
use crate::bake::relax::garment_reading::GarmentReading;
use crate::bake::relax::relax_to_source::{RelaxOptions, relax_to_source_pose};

use crate::bake::run::findings::add_findings;
use crate::bake::run::lay_first::mesh_for;
use crate::bake::run::setup::BakeSetup;
use crate::bake::run::simulate::{SimulationResult, simulate};
use crate::bake::run::trims::bake_cloth;
use crate::bake::tuning::TUNING;
use crate::bake::{
    BakeOptions, BakeResult, MeshChoice, ModelDecision, ModelPlan, Observer, Quality, SimulatedGarment,
    active_points,
};
use crate::wear::{Action, WearScript};
use crease_geometry::math::Vec3;
use crease_model::body::{AnimatedBody, GarmentSkin};
use crease_model::error::{Error, Result};
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, RestState, RigidParts, WornGarment};
use crease_model::remesh::{SimulationMesh, prolongate, resolved_memory};
use std::sync::Arc;
use std::time::Instant;

/// A bake to be run: the script is simulated on the garment, and the garment is relaxed to its source pose with the memory
/// that it earned. The methods that set something may be called in any order.
///
/// ```
/// use crease::{Bake, Fabric, GarmentFile, Quality, WearScript};
/// let sheet = GarmentFile::sheet([0.2, 0.2], [4, 4])?;
/// let script = WearScript::parse("fold.json", r#"{"format": "crease-wear/1", "actions": [
///     {"lay": {"facing": "front", "over": 0.2}},
///     {"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left", "over": 0.5, "hold": 3}},
///     {"unfold": {"all": true, "over": 0.5}}]}"#)?;
/// let fabric = Fabric::preset("kow-tshirt")?;
/// let result = Bake::new(&sheet.garment, &fabric, &script).quality(Quality::Draft).run()?;
/// let sharpest = result.worn.memory.rest_angle.iter().fold(0.0, |max: f64, angle| max.max(angle.abs()));
/// assert!(sharpest > 0.3, "a crease of {sharpest} rad");
/// # Ok::<(), crease::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Bake<'a> {
    garment: &'a Garment,
    fabric: &'a Fabric,
    script: &'a WearScript,
    script_name: &'a str,
    options: BakeOptions,
    chosen: ChosenOptions,
    earlier: Option<&'a RestState>,
    resume_from: Option<(&'a str, Checkpoint)>,
}

/// Options set by methods of [`Bake`]; they stand over those of [`Bake::options`].
#[derive(Debug, Clone, Default)]
struct ChosenOptions {
    quality: Option<Quality>,
    body: Option<Arc<AnimatedBody>>,
    skin: Option<Arc<GarmentSkin>>,
    memory: Option<bool>,
    strength: Option<f64>,
    frames_per_second: Option<f64>,
}

impl ChosenOptions {
    /// Returns `options` with those that are chosen here instead.
    fn over(&self, options: BakeOptions) -> BakeOptions {
        let Self { quality, body, skin, memory, strength, frames_per_second } = self.clone();
        BakeOptions {
            quality: quality.unwrap_or(options.quality),
            body: body.or(options.body),
            skin: skin.or(options.skin),
            memory: memory.unwrap_or(options.memory),
            strength: strength.unwrap_or(options.strength),
            frames_per_second: frames_per_second.unwrap_or(options.frames_per_second),
            ..options
        }
    }
}

impl<'a> Bake<'a> {
    /// A bake of `garment`, made of `fabric`, through `script`, with the default options.
    pub fn new(garment: &'a Garment, fabric: &'a Fabric, script: &'a WearScript) -> Self {
        Self {
            garment,
            fabric,
            script,
            script_name: "the script",
            options: BakeOptions::default(),
            chosen: ChosenOptions::default(),
            earlier: None,
            resume_from: None,
        }
    }

    /// Sets the memory that the garment begins with, one entry per hinge and triangle of it: that of an earlier bake, to be
    /// worn on. The result has both.
    pub fn earlier_memory(self, memory: &'a RestState) -> Self {
        Self { earlier: Some(memory), ..self }
    }

    /// Sets the options that the other methods do not set.
    pub fn options(self, options: BakeOptions) -> Self {
        Self { options, ..self }
    }

    /// Sets the compromise between speed and accuracy: the preset of all options that are not set otherwise.
    ///
    /// ```
    /// use crease::{Bake, BakeOptions, Fabric, GarmentFile, Quality, WearScript};
    /// # let (sheet, fabric) = (GarmentFile::sheet([0.2, 0.2], [2, 2])?, Fabric::preset("denim")?);
    /// # let script = WearScript::parse("", r#"{"format": "crease-wear/1", "actions": [{"settle": {"for": 1}}]}"#)?;
    /// let options = BakeOptions { finest_edge: Some(0.015), ..BakeOptions::default() };
    /// let bake = Bake::new(&sheet.garment, &fabric, &script).strength(0.5).options(options).quality(Quality::Draft);
    /// let result = bake.run()?; // A draft at half strength, with edges of 15 mm along fold lines.
    /// # assert_eq!(result.end.len(), 9);
    /// # Ok::<(), crease::Error>(())
    /// ```
    pub fn quality(mut self, quality: Quality) -> Self {
        self.chosen.quality = Some(quality);
        self
    }

    /// Sets the body that wears the garment.
    pub fn body(mut self, body: Arc<AnimatedBody>) -> Self {
        self.chosen.body = Some(body);
        self
    }

    /// Sets the skin of the garment in its file: on a body, points stay within a distance of where it would carry them.
    pub fn skin(mut self, skin: Arc<GarmentSkin>) -> Self {
        self.chosen.skin = Some(skin);
        self
    }

    /// Sets whether the cloth has memory; it has by default.
    pub fn memory(mut self, memory: bool) -> Self {
        self.chosen.memory = Some(memory);
        self
    }

    /// Sets the factor on everything the garment comes to remember, in the result: 1 for what the wear left, 0 for nothing.
    pub fn strength(mut self, strength: f64) -> Self {
        self.chosen.strength = Some(strength);
        self
    }

    /// Sets the number of frames per simulated second for [`Observer::frame`]; 0, the default, for none.
    pub fn frames_per_second(mut self, frames: f64) -> Self {
        self.chosen.frames_per_second = Some(frames);
        self
    }

    /// Sets the name of the script in messages, usually its file.
    pub fn script_name(self, script_name: &'a str) -> Self {
        Self { script_name, ..self }
    }

    /// Resumes from a checkpoint of the same bake; `file` is its name in messages. The result is bit for bit that of an
    /// uninterrupted bake.
    ///
    /// ```
    /// use crease::{Bake, Checkpoint, Fabric, GarmentFile, Observer, Result, WearScript};
    /// #[derive(Default)]
    /// struct Keep(Option<Checkpoint>);
    /// impl Observer for Keep {
    ///     fn wants_checkpoints(&self) -> bool {
    ///         true
    ///     }
    ///     fn checkpoint(&mut self, now: Checkpoint) -> Result<()> {
    ///         self.0.get_or_insert(now);
    ///         Ok(())
    ///     }
    /// }
    /// let (sheet, fabric) = (GarmentFile::sheet([0.2, 0.2], [2, 2])?, Fabric::preset("denim")?);
    /// let script = WearScript::parse("", r#"{"format": "crease-wear/1", "actions": [{"settle": {"for": 0.1}}]}"#)?;
    /// let bake = Bake::new(&sheet.garment, &fabric, &script);
    /// let mut keep = Keep::default();
    /// let whole = bake.clone().run_with(&mut keep)?;
    /// let checkpoint = keep.0.expect("there is one before every action");
    /// let resumed = bake.resume("in memory", checkpoint).run()?;
    /// assert_eq!(resumed.end, whole.end);
    /// # Ok::<(), crease::Error>(())
    /// ```
    pub fn resume(self, file: &'a str, checkpoint: Checkpoint) -> Self {
        Self { resume_from: Some((file, checkpoint)), ..self }
    }

    /// The models and the mesh that the bake would use, with the reasons.
    ///
    /// ```
    /// # use crease::{Bake, Fabric, GarmentFile, WearScript};
    /// # let (sheet, fabric) = (GarmentFile::sheet([0.2, 0.2], [2, 2])?, Fabric::preset("denim")?);
    /// # let script = WearScript::parse("", r#"{"format": "crease-wear/1", "actions": [{"settle": {"for": 1}}]}"#)?;
    /// let plan = Bake::new(&sheet.garment, &fabric, &script).plan();
    /// assert!(!plan.layers_meet, "one flat layer that nothing folds");
    /// assert!(plan.decisions.iter().any(|decision| decision.name == "stretch" && decision.on));
    /// # Ok::<(), crease::Error>(())
    /// ```
    pub fn plan(&self) -> ModelPlan {
        let Self { garment, fabric, script, .. } = *self;
        let options = &self.options_on_body();
        let rigid = RigidParts::find(garment);
        let garment = rigid.as_ref().map_or(garment, RigidParts::cloth);
        let choice = MeshChoice::new(garment, fabric, script, None, options);
        let mut plan = ModelPlan::new(&choice.mesh.garment, fabric, script, options);
        if let Some(animated) = &options.body {
            let active = active_points(&choice.mesh.garment, script, options);
            let inactive: Vec<bool> = active.iter().map(|active| !active).collect();
            plan.apply_body(fabric, animated, &inactive, options.full_fidelity);
        }
        plan.decisions.push(choice.decision);
        plan.decisions.extend(choice.layout.as_ref().map(laid_out));
        if let Some(earlier) = self.earlier {
            plan.apply_earlier(options);
            plan.decisions.push(earlier_decision(earlier));
        }
        if let Some(leash) = GarmentLeash::new(garment, options) {
            plan.decisions.push(leash.decision());
            plan.decisions.extend(leash.memory_from_motion().filter(|_| is_played(script)));
        }
        plan
    }

    /// The options in use, with the body in the pose that a garment without a skin was modelled on.
    fn options_on_body(&self) -> BakeOptions {
        let mut options = self.chosen.over(self.options.clone());
        let body = options.body.as_deref().filter(|_| options.skin.is_none());
        if let Some(started) = body.and_then(|body| body_at_first_key(body, self.garment, self.script)) {
            options.body = Some(Arc::new(started));
        }
        options
    }

    /// Runs the bake.
    ///
    /// # Errors
    /// [`crease_model::error::Error::Input`] for an action that cannot be done with this garment, for a body that does not fit it, and for a
    /// checkpoint of another run.
    pub fn run(self) -> Result<BakeResult> {
        self.run_with(&mut ())
    }

    /// Runs the bake and reports progress, frames and checkpoints to `observer`.
    ///
    /// # Errors
    /// Those of [`Bake::run`], those of the observer, and [`crease_model::error::Error::Interrupted`] when the observer asks to stop.
    pub fn run_with(self, observer: &mut dyn Observer) -> Result<BakeResult> {
        let options = self.options_on_body();
        let Self { garment, script, earlier, .. } = self;
        if !earlier.is_none_or(|memory| memory.fits(garment.topology.hinges.len(), garment.triangles.len())) {
            let what = "has other hinges or triangles than the garment";
            return Err(Error::input("the earlier memory", "", what, "give the memory of this garment"));
        }
        if !(options.strength >= 0.0 && options.strength.is_finite()) {
            let what = "the strength is no number from 0 up";
            return Err(Error::input("the options", "", what, "give 1 for the memory as it was earned"));
        }
        let mut baked = match RigidParts::find(garment) {
            Some(rigid) => {
                let of_cloth = earlier.map(|memory| rigid.cloth_memory(memory));
                bake_cloth(garment, &rigid, options.frames_of_simulated, observer, |cloth, observer| {
                    self.run_on_cloth(cloth, &options, of_cloth.as_ref(), observer)
                })
            }
            None => self.run_on_cloth(garment, &options, earlier, observer),
        }?;
        baked.report.decisions.extend(earlier.map(earlier_decision));
        add_findings(garment, script, &options, earlier, &mut baked);
        Ok(baked)
    }

    /// Runs the bake with `options` on `garment`, all of which is simulated, and which begins with the memory `earlier`.
    fn run_on_cloth(
        self,
        garment: &Garment,
        options: &BakeOptions,
        earlier: Option<&RestState>,
        observer: &mut dyn Observer,
    ) -> Result<BakeResult> {
        let Self { fabric, script, script_name, resume_from, .. } = self;
        let setup = BakeSetup { fabric, script, script_name, options, garment, earlier };
        let choice = mesh_for(&setup, observer)?;
        let decision = choice.decision.clone();
        observer.on_mesh(if options.frames_of_simulated { &choice.mesh.garment } else { garment });
        let reading = GarmentReading::new(garment, options.body.as_deref());
        let simulated = simulate(resume_from, choice, &setup, observer)?;
        let SimulationResult { mesh, positions, rest, start, mut report, mut seconds, mut stepper } =
            simulated;
        report.decisions.push(decision);

        let clock = Instant::now();
        let ResultMemory { rest, shown, decision } = ResultMemory::new(&mesh, rest, start.as_ref(), options);
        report.decisions.extend(decision);
        let relax_options = RelaxOptions::visible_on(garment, fabric, options.strength);
        let body = options.body.as_deref();
        let relaxed = relax_to_source_pose(
            &mesh.garment,
            fabric,
            &mut stepper,
            shown.as_ref().unwrap_or(&rest),
            &relax_options,
            body,
        );
        let moved = |points: &[Vec3], by: &[Vec3]| points.iter().zip(by).map(|(x, d)| x + d).collect();
        let shape: Vec<Vec3> = moved(&mesh.garment.points, &relaxed.displacement);
        let (displacement, held) = reading.displacement(&mesh, &relaxed.displacement);
        report.decisions.extend(held);
        // Of cloth that was worn before, only the change goes from mesh to mesh: the rest of its memory stays as it is.
        let memory = match (earlier, start) {
            (Some(earlier), Some(start)) if !mesh.is_source => {
                earlier.with_change(&prolongate(&mesh, &rest.change_since(&start), garment))
            }
            _ => prolongate(&mesh, &rest, garment),
        };
        report.decisions.extend(reading.body_decision(&displacement));
        let last: Vec<Vec3> =
            if options.frames_of_simulated { shape } else { moved(&garment.points, &displacement) };
        seconds.relax += clock.elapsed().as_secs_f64();
        if options.frames_per_second > 0.0 {
            observer.frame(&last)?;
        }

        report.solves += relaxed.solves;
        report.local_solves += relaxed.local_solves;
        report.warn(relaxed.warnings);
        report.unconverged_reason = relaxed.unconverged_reason.or(report.unconverged_reason);
        report.stages = seconds.named();
        let end = mesh.to_source(&positions);
        let worn = WornGarment { displacement, memory };
        let on_mesh = WornGarment { displacement: relaxed.displacement, memory: rest };
        let simulated = SimulatedGarment { garment: mesh.garment, worn: on_mesh };
        Ok(BakeResult { worn, end, simulated, report })
    }
}

/// Memory of a result.
struct ResultMemory {
    /// As it was earned, at the strength that was asked for.
    rest: RestState,
    /// As far as the mesh can show it, if that is less.
    shown: Option<RestState>,
    /// How the two differ from what was earned.
    decision: Option<ModelDecision>,
}

impl ResultMemory {
    /// That of the memory `rest`, which was `start` before the wear.
    fn new(mesh: &SimulationMesh, rest: RestState, start: Option<&RestState>, options: &BakeOptions) -> Self {
        let resolves = !options.own_triangles && !options.full_fidelity;
        let is_scaled = options.strength != 1.0;
        if !resolves && !is_scaled {
            return Self { rest, shown: None, decision: None };
        }
        let earned = start.map_or_else(|| rest.clone(), |start| rest.change_since(start));
        let on_start = |start: Option<RestState>, change: RestState| match start {
            Some(start) => start.with_change(&change),
            None => change,
        };
        let whole = on_start(start.cloned(), earned.strengthened(options.strength));
        let shown = resolves.then(|| {
            let change = resolved_memory(mesh, &earned).strengthened(options.strength);
            on_start(start.map(|start| resolved_memory(mesh, start)), change)
        });
        let rms = |memory: &RestState| {
            let squares = memory.angle_changes().map(|change| change * change).sum::<f64>();
            (squares / memory.rest_angle.len().max(1) as f64).sqrt().to_degrees()
        };
        let mut why = format!("angles of {:.1} degrees root mean square", rms(&whole));
        if is_scaled {
            why += &format!(", {} times what was earned", options.strength);
        }
        if let Some(shown) = &shown {
            why += &format!(
                "; shown with {:.1}: curvature too sharp for the mesh is averaged over a ring of triangles away from fold lines",
                rms(shown)
            );
        }
        let decision = Some(ModelDecision { name: "memory in result", on: true, why: why.into() });
        Self { rest: if is_scaled { whole } else { rest }, shown, decision }
    }
}

/// Describes the memory that a garment begins with.
fn earlier_decision(memory: &RestState) -> ModelDecision {
    let changed =
        memory.angle_changes().filter(|change| change.abs() > TUNING.findings.min_angle_change).count();
    let why = format!("{changed} of {} hinges begin with what they remember", memory.rest_angle.len());
    ModelDecision { name: "earlier memory", on: true, why: why.into() }
}

/// Whether a script is nothing but clips and rests between them.
fn is_played(script: &WearScript) -> bool {
    let is_clip = |action: &Action| matches!(action, Action::Play(_));
    let is_rest = |action: &Action| matches!(action, Action::Hold(_) | Action::Settle(_));
    script.flatten().any(|action| is_clip(&action))
        && script.flatten().all(|action| is_clip(&action) || is_rest(&action))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::GarmentFile;
    use crease_io::{ReadOptions, read_garment_skin};
    use crease_solver::sim::{Sewing, StepOptions};

    type Worn = (GarmentFile, Arc<AnimatedBody>, Arc<GarmentSkin>);

    fn sleeve_on_arm() -> Worn {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/garments/sleeve.glb");
        let reading = ReadOptions { garment: Some("sleeve".into()), ..ReadOptions::default() };
        let file = GarmentFile::load(path, &reading).expect("is a garment");
        let body = crate::files::load_body(path, &reading).expect("is a body");
        let skin = read_garment_skin(&file.asset, None, &body).expect("is skinned");
        (file, Arc::new(body), Arc::new(skin))
    }

    /// Every option but the quality at a value that is neither the default nor that of any quality. A new option does not compile
    /// without a line here.
    fn every_option((_, body, skin): &Worn, quality: Quality) -> BakeOptions {
        BakeOptions {
            quality,
            memory: false,
            step: Some(StepOptions { min_dt: 0.01, ..StepOptions::default() }),
            energy_tol_m: Some(2e-5),
            max_weight_strain: Some(2e-3),
            event_dt_fraction: Some(0.2),
            full_fidelity: true,
            frames_per_second: 5.0,
            body: Some(body.clone()),
            skin: Some(skin.clone()),
            deactivate_static: false,
            own_triangles: true,
            sewing: Sewing::NONE,
            finest_edge: Some(0.015),
            frames_of_simulated: true,
            strength: 0.0,
            checkpoint_steps: 5,
        }
    }

    /// Runs `check` with a bake that has nothing set, and the options that it has after a change.
    fn with_bake(worn: &Worn, check: impl Fn(&Bake)) {
        let fabric = Fabric::preset("denim").expect("is a preset");
        let script = r#"{"format": "crease-wear/1", "actions": [{"settle": {"for": 1}}]}"#;
        let script = WearScript::parse("wear.json", script).expect("is a script");
        check(&Bake::new(&worn.0.garment, &fabric, &script));
    }

    #[test]
    fn a_quality_stands_under_every_option_before_and_after_it() {
        let worn = sleeve_on_arm();
        with_bake(&worn, |bake| {
            for quality in Quality::ALL {
                let set = every_option(&worn, Quality::Standard);
                let expected = every_option(&worn, quality);
                assert_eq!(expected.resolved(), expected, "nothing is left to the quality");
                let before = bake.clone().options(set.clone()).quality(quality).options_on_body();
                let after = bake.clone().quality(quality).options(set).options_on_body();
                assert_eq!((&before, &after), (&expected, &expected));
                // What is not set is the quality's, also beside other options.
                let preset = bake.clone().strength(0.0).quality(quality).options_on_body().resolved();
                assert_eq!(preset.step, Some(quality.step_options()));
                assert_eq!(preset.energy_tol_m, Some(quality.energy_tol()));
                assert_eq!(preset.max_weight_strain, Some(quality.max_weight_strain()));
                assert_eq!(preset.event_dt_fraction, Some(quality.event_dt_fraction()));
                assert_eq!(preset.finest_edge, Some(quality.finest_edge()));
                assert_eq!(preset.strength, 0.0);
            }
        });
    }

    #[test]
    fn the_methods_of_a_bake_may_be_called_in_any_order() {
        let worn = sleeve_on_arm();
        let set = every_option(&worn, Quality::Draft);
        let methods: [&dyn for<'a> Fn(Bake<'a>) -> Bake<'a>; 6] = [
            &|bake| bake.quality(Quality::Draft),
            &|bake| bake.body(worn.1.clone()),
            &|bake| bake.skin(worn.2.clone()),
            &|bake| bake.memory(false),
            &|bake| bake.strength(0.0),
            &|bake| bake.frames_per_second(5.0),
        ];
        with_bake(&worn, |bake| {
            let forwards = methods.iter().fold(bake.clone(), |bake, method| method(bake));
            let backwards = methods.iter().rev().fold(bake.clone(), |bake, method| method(bake));
            // A new method does not compile without a line here.
            let ChosenOptions { quality, body, skin, memory, strength, frames_per_second } = &forwards.chosen;
            assert_eq!((*quality, *memory), (Some(Quality::Draft), Some(false)));
            assert_eq!((*strength, *frames_per_second), (Some(0.0), Some(5.0)));
            assert!(body.is_some() && skin.is_some());
            let (of_quality, of_methods) = (BakeOptions::default(), forwards.options_on_body());
            assert_eq!(of_methods, backwards.options_on_body());
            assert_eq!(of_methods.resolved(), forwards.quality(Quality::Draft).options_on_body().resolved());
            // Options given as a whole stand under the methods, before and after them.
            let before = methods.iter().fold(bake.clone().options(of_quality.clone()), |bake, set| set(bake));
            let after = methods.iter().fold(bake.clone(), |bake, set| set(bake)).options(of_quality);
            assert_eq!((&before.options_on_body(), &after.options_on_body()), (&of_methods, &of_methods));
            let all = methods.iter().fold(bake.clone(), |bake, method| method(bake)).options(set.clone());
            assert_eq!(all.options_on_body(), set);
        });
    }
}

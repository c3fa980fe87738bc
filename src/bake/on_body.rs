//! A bake on a body: what has to be known before it begins, and the moment the garment is put on.

use super::awake::awake;
use super::dressing;
use super::{BakeOptions, Observer, Run};
use crate::body::{Standing, Wearer};
use crate::error::{Error, Result};
use crate::garment::Garment;
use crate::wear::WearScript;
use std::sync::Arc;
use std::time::Instant;

/// A body, checked against garment and script.
pub(super) struct OnBody {
    pub wearer: Arc<Wearer>,
    /// Per point of the garment: how deep inside the body it lies [m].
    depths: Vec<f64>,
    /// Per point: whether the body cannot stir it; empty when all can be stirred.
    pub asleep: Vec<bool>,
}

impl OnBody {
    /// The body of `options`, if there is one. Refuses joints and clips that it has not, garments that do not fit it,
    /// and a run that is to be taken up: what cloth and body have come to is not in a checkpoint.
    pub fn prepare(
        garment: &Garment,
        script: &WearScript,
        script_file: &str,
        options: &BakeOptions,
        taken_up: bool,
    ) -> Result<Option<Self>> {
        let Some(wearer) = &options.body else { return Ok(None) };
        let mut faults = script.faults_with_body(script_file, wearer);
        if taken_up {
            let what = "a run with a body cannot be taken up";
            faults.push(crate::error::Fault::new("--resume", "", what, "leave it out: the run begins anew"));
        }
        let depths = match dressing::depths(&garment.points, wearer) {
            Ok(depths) => depths,
            Err(Error::Input(more)) => {
                faults.extend(more);
                Vec::new()
            }
            Err(other) => return Err(other),
        };
        if !faults.is_empty() {
            return Err(Error::Input(faults));
        }
        let asleep = stirred(garment, script, options).iter().map(|stirred| !stirred).collect();
        Ok(Some(Self { wearer: wearer.clone(), depths, asleep }))
    }
}

/// The points of `garment` that the body of `options` stirs on its way through `script`, one flag per point. Empty when all
/// are to be taken as stirred: without a body, with one that only stands, or when a script does more than move it.
pub fn stirred(garment: &Garment, script: &WearScript, options: &BakeOptions) -> Vec<bool> {
    let Some(wearer) = options.body.as_ref().filter(|_| options.sleep) else { return Vec::new() };
    let awake = awake(garment, wearer, &script.postures(wearer));
    if awake.contains(&true) { awake } else { Vec::new() }
}

impl Run<'_> {
    /// The garment is put on.
    pub(super) fn put_on(&mut self, on_body: OnBody, observer: &mut dyn Observer) -> Result<()> {
        let clock = Instant::now();
        let OnBody { wearer, depths, asleep } = on_body;
        self.asleep = asleep;
        let dressed = self.dress(&wearer, &depths)?;
        self.report.warnings.extend(dressed.warnings());
        self.posture.body = Some(Standing::new(&wearer, wearer.rest()));
        self.dressing_s = clock.elapsed().as_secs_f64();
        self.frame(observer)
    }
}

//! Doubts about a transfer: low confidence, lost creases, texture coordinates used twice, nothing transferred.

use crate::transfer::options::{AlignedBy, SourceOutcome, TransferOptions, TransferSource};
use crate::transfer::tuning::TUNING;
use crease_model::error::{Message, Setting};
use crease_model::garment::RestState;
use crease_model::remesh::Channels;

/// Returns the warnings on a transfer of `sources` with `outcomes` and the mean `confidence`.
pub(super) fn transfer_warnings(
    sources: &[TransferSource],
    outcomes: &[SourceOutcome],
    options: &TransferOptions,
    confidence: f64,
) -> Vec<Message> {
    let mut warnings = repeated_sources(sources);
    warnings.extend(strength_warning(sources, options));
    if confidence < TUNING.min_confidence {
        let by_box = outcomes.iter().any(|outcome| {
            matches!(outcome.aligned_by, Some(AlignedBy::Box | AlignedBy::Openings | AlignedBy::Limbs))
        });
        let how = if by_box { ", laid over one another by their openings and bounding boxes" } else { "" };
        let what = format!(
            "low confidence ({confidence:.2}): the garments are of different cut or place{how}; mark points of both with "
        );
        warnings.push(
            Message::from(what)
                + Setting::Landmarks
                + ", or choose "
                + Setting::Align
                + " and "
                + Setting::Match,
        );
    }
    for (source, outcome) in sources.iter().zip(outcomes) {
        let lost = outcome.losses.lost_crease_fraction;
        if lost > TUNING.max_lost_crease_fraction {
            let what = format!(
                "{}: {:.0} % of its creases lie on cloth that the target does not have",
                source.file,
                100.0 * lost
            );
            warnings.push(what.into());
        }
        if outcome.ambiguous_fraction > TUNING.max_ambiguous_fraction {
            let what = format!(
                "{}: texture coordinates of {:.0} % of the target belong to several places of the source, which lie on one \
                 another in the texture; the place nearest to the target was taken",
                source.file,
                100.0 * outcome.ambiguous_fraction
            );
            warnings.push(what.into());
        }
    }
    warnings
}

/// Returns the warnings on memories that are given several times: they add up.
fn repeated_sources(sources: &[TransferSource]) -> Vec<Message> {
    let is_same =
        |a: &TransferSource, b: &TransferSource| a.memory == b.memory && a.surface.is_same_mesh(&b.surface);
    let mut warnings = Vec::new();
    for (k, source) in sources.iter().enumerate() {
        if sources[..k].iter().any(|earlier| is_same(earlier, source)) {
            continue;
        }
        let count = 1 + sources[k + 1..].iter().filter(|later| is_same(source, later)).count();
        if count > 1 {
            let what = format!(
                "{}: the same memory is given {count} times, and its angles add up to {count} times those that were worn; give it \
                 once",
                source.file
            );
            warnings.push(Message::from(what));
        }
    }
    warnings
}

/// Returns the warning on a strength far beyond what was worn.
fn strength_warning(sources: &[TransferSource], options: &TransferOptions) -> Option<Message> {
    let TransferOptions { strength, .. } = *options;
    let largest =
        |source: &TransferSource| source.memory.angle_changes().fold(0.0, |max: f64, a| max.max(a.abs()));
    let angle = sources.iter().map(largest).fold(0.0, f64::max).to_degrees();
    let what = format!(
        "a strength of {strength} multiplies every change by it: the largest angle of the sources, {angle:.0} degrees, would be \
         {:.0} degrees, and angles end at 180; give ",
        strength * angle
    );
    (strength > TUNING.max_usual_strength)
        .then(|| Message::from(what) + Setting::Strength.to_number("1") + " for the memory as it was worn")
}

/// Returns the reason why nothing was transferred, if `memory` is none: that of a target with no earlier memory.
pub(super) fn empty_reason(
    sources: &[TransferSource],
    memory: &RestState,
    options: &TransferOptions,
) -> Option<Message> {
    let has_creases = sources.iter().any(|source| has_creases(&source.memory));
    let has_bagging = sources.iter().any(|source| has_bagging(&source.memory));
    let is_empty = !self::has_creases(memory) && !self::has_bagging(memory);
    if !is_empty || options.strength == 0.0 {
        return None;
    }
    let Channels { creases, bagging } = options.channels;
    let cure = if !(has_creases || has_bagging) {
        "the source remembers nothing: wear it first".into()
    } else if options.mask.iter().all(|m| *m == 0.0) {
        "the mask is 0 everywhere".into()
    } else if !creases && !has_bagging {
        Message::from("no rest length of the source has changed: leave out ")
            + Setting::Only.to("bagging")
            + ", or wear it in a fabric that bags"
    } else if !bagging && !has_creases {
        Message::from("no rest angle of the source has changed: leave out ") + Setting::Only.to("creases")
    } else {
        Message::from("no worn cloth of the source belongs to cloth of the target: choose ")
            + Setting::Align
            + " or "
            + Setting::Match
            + ", or mark "
            + Setting::Landmarks
    };
    Some(Message::from("nothing was transferred: ") + cure)
}

fn has_creases(memory: &RestState) -> bool {
    memory.angle_changes().any(|change| change.abs() > TUNING.min_change)
}

fn has_bagging(memory: &RestState) -> bool {
    let mut stretches = memory.rest_stretch_warp.iter().chain(&memory.rest_stretch_weft);
    stretches.any(|stretch| (stretch - 1.0).abs() > TUNING.min_change)
}

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
    confidence: f64,
) -> Vec<Message> {
    let mut warnings = Vec::new();
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

//! Doubts about a transfer: low confidence, lost creases, texture coordinates used twice, nothing transferred.

use crate::garment::RestState;
use crate::transfer::options::{AlignedBy, SourceOutcome, TransferOptions, TransferSource};
use crate::transfer::tuning::TUNING;

/// Returns the warnings on a transfer of `sources` with `outcomes` and the mean `confidence`.
pub(super) fn transfer_warnings(
    sources: &[TransferSource],
    outcomes: &[SourceOutcome],
    confidence: f64,
) -> Vec<String> {
    let mut warnings = Vec::new();
    if confidence < TUNING.min_confidence {
        let by_box = outcomes.iter().any(|outcome| {
            matches!(outcome.aligned_by, Some(AlignedBy::Box | AlignedBy::Openings | AlignedBy::Limbs))
        });
        let how = if by_box { ", laid over one another by their openings and bounding boxes" } else { "" };
        warnings.push(format!(
            "low confidence ({confidence:.2}): the garments are of different cut or place{how}; mark points of both with \
             --landmarks, or choose --align and --match"
        ));
    }
    for (source, outcome) in sources.iter().zip(outcomes) {
        let lost = outcome.losses.lost_crease_fraction;
        if lost > TUNING.max_lost_crease_fraction {
            warnings.push(format!(
                "{}: {:.0} % of its creases lie on cloth that the target does not have",
                source.file,
                100.0 * lost
            ));
        }
        if outcome.ambiguous_fraction > TUNING.max_ambiguous_fraction {
            warnings.push(format!(
                "{}: texture coordinates of {:.0} % of the target belong to several places of the source, which lie on one \
                 another in the texture; the place nearest to the target was taken",
                source.file,
                100.0 * outcome.ambiguous_fraction
            ));
        }
    }
    warnings
}

/// Returns the reason why nothing was transferred, if the sources have memory and `memory` has none.
pub(super) fn empty_reason(
    sources: &[TransferSource],
    memory: &RestState,
    options: &TransferOptions,
) -> Option<String> {
    let worn = sources.iter().any(|source| has_changes(&source.memory));
    if !worn || has_changes(memory) || options.strength == 0.0 {
        return None;
    }
    let cure = match options.mask.iter().all(|m| *m == 0.0) {
        true => "the mask is 0 everywhere",
        false => {
            "no worn cloth of the source belongs to cloth of the target: choose --align or --match, or mark --landmarks"
        }
    };
    Some(format!("nothing was transferred: {cure}"))
}

fn has_changes(memory: &RestState) -> bool {
    let mut stretches = memory.rest_stretch_warp.iter().chain(&memory.rest_stretch_weft);
    memory.angle_changes().any(|change| change.abs() > TUNING.min_change)
        || stretches.any(|stretch| (stretch - 1.0).abs() > TUNING.min_change)
}

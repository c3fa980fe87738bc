//! The pose that a body starts in: that of its file, or the first key of a clip that the garment was modelled on.

use crate::wear::{Action, WearScript};
use crease_model::body::AnimatedBody;
use crease_model::garment::Garment;

/// Returns `body` in the first key of the clip that `script` plays first, with a note, where `garment`, which has no skin, fits that key and
/// not the pose of the body's file.
pub fn body_at_first_key(
    body: &AnimatedBody,
    garment: &Garment,
    script: &WearScript,
) -> Option<AnimatedBody> {
    let play = script.flatten().find_map(|action| match action.as_ref() {
        Action::Play(play) => Some(play.clone()),
        _ => None,
    })?;
    let first = play.first_pose(body)?;
    let [at_start, at_first] = body.fits_better_in(&garment.points, &first)?;
    let mut started = body.starting_in(first);
    started.add_note(format!(
        "{}: {:.0} % of the garment lie inside the pose of the file and {:.0} % inside the first key of the clip \"{}\": the wear begins in \
         that key",
        body.file,
        100.0 * at_start,
        100.0 * at_first,
        play.clip
    ));
    Some(started)
}

//! Sizes of a garment, its body and its frames: the most common error of these files is the unit, and it would still run, with
//! wrong results.

use crate::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_model::error::{Error, Message, Result, Setting};
use crease_model::garment::{
    GarmentSize, ImportDiagnostic, LENGTH_UNITS, Severity, SourceAsset, usual_units,
};

/// Returns the length of the unit `text` [m]: m, dm, cm, mm, in, or a number of metres; `None` for what is none of these.
pub fn unit_length(text: &str) -> Option<f64> {
    match LENGTH_UNITS.iter().find(|(name, _)| *name == text) {
        Some((_, metres)) => Some(*metres),
        None => text.parse::<f64>().ok().filter(|metres| *metres > 0.0 && metres.is_finite()),
    }
}

/// Rejects a garment of a size that no garment has; returns a warning about one that is rare, unless its unit is known.
///
/// # Errors
/// [`Error::Input`] with the units that would make it a garment.
pub fn check_size(asset: &SourceAsset) -> Result<Option<ImportDiagnostic>> {
    let Some((low, high)) = asset.worn_bounds() else { return Ok(None) };
    let size = high - low;
    let units = size / asset.unit_m;
    let longest = units.max();
    let fits: Vec<Message> = usual_units(longest)
        .map(|(name, side)| Message::from(Setting::Unit.to(name)) + format!(" makes it {side:.2} m"))
        .collect();
    let hint =
        if fits.is_empty() { Message::default() } else { Message::from("; ") + Message::join(fits, ", ") };
    let plausibility = GarmentSize::of_longest_side(size.max());
    if plausibility != GarmentSize::Implausible {
        let is_questionable = !asset.unit_is_known && plausibility == GarmentSize::Rare;
        return Ok(is_questionable.then(|| ImportDiagnostic {
            severity: Severity::Warning,
            location: String::new(),
            message: Message::from(format!(
                "the garment is {:.2} x {:.2} x {:.2} m, which few garments are: if that is wrong, say the file's unit with ",
                size.x, size.y, size.z
            )) + Setting::Unit
                + hint,
        }));
    }
    Err(Error::input(
        &asset.file,
        "",
        format!(
            "the garment's box is {:.4} x {:.4} x {:.4} in file units, which would be {:.3} x {:.3} x {:.3} m",
            units.x, units.y, units.z, size.x, size.y, size.z
        ),
        Message::from("say the file's unit with ")
            + Setting::Unit
            + " cm, mm, dm, in, m or metres per unit"
            + hint
            + "; "
            + Setting::ForceSize
            + " takes any size",
    ))
}

/// Returns the unit in which a file read in units of `unit_m` [m] is smaller by about `ratio`.
fn unit_that_divides(unit_m: f64, ratio: f64) -> Option<&'static str> {
    let wanted = unit_m / ratio;
    let distance = |(_, unit): &&(&str, f64)| (unit / wanted).ln().abs();
    let nearest = LENGTH_UNITS.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    (distance(&nearest) < TUNING.unit_ratio_tol.ln()).then_some(nearest.0)
}

/// Returns the unit in which a body is as large over its garment as bodies are; `ratio` is that in units of `unit_m` [m].
fn unit_of_body(unit_m: f64, ratio: f64) -> Option<&'static str> {
    let in_unit = |unit: f64| ratio * unit / unit_m;
    let distance = |unit: f64| (in_unit(unit) / TUNING.usual_body_ratio).ln().abs();
    let possible = LENGTH_UNITS.iter().filter(|(_, unit)| TUNING.body_ratio.contains(&in_unit(*unit)));
    possible.min_by(|a, b| distance(a.1).total_cmp(&distance(b.1))).map(|(name, _)| *name)
}

/// Returns the settings that state another unit, with which far more of a garment would lie on its body, with the fractions without and
/// with it. `units_m` are those in which garment and body were read [m].
fn unit_that_fits(units_m: [f64; 2], worn_fraction: impl Fn(f64) -> f64) -> Option<(Message, f64, f64)> {
    let own = worn_fraction(1.0);
    if own > TUNING.max_misfit_fraction {
        return None;
    }
    let [garment, body] = units_m;
    let of_body =
        LENGTH_UNITS.iter().map(|(name, unit)| (Message::from(Setting::BodyUnit.to(*name)), unit / body));
    // The unit of the garment is that of the body where the body has none of its own.
    let own_name = LENGTH_UNITS
        .iter()
        .find(|(_, unit)| *unit == body)
        .map_or(format!("{body}"), |(name, _)| name.to_string());
    let of_both = |name: &str| Message::from(Setting::Unit.to(name)) + " " + Setting::BodyUnit.to(&own_name);
    let of_garment = LENGTH_UNITS.iter().map(|(name, unit)| (of_both(name), garment / unit));
    let is_other = |(_, scale): &(Message, f64)| scale.ln().abs() > TUNING.min_unit_ratio.ln();
    let (settings, fitting) = of_body
        .chain(of_garment)
        .filter(is_other)
        .map(|(settings, scale)| (settings, worn_fraction(scale)))
        .reduce(|best, next| if next.1 > best.1 { next } else { best })?;
    (fitting >= TUNING.min_fitting_fraction).then_some((settings, own, fitting))
}

/// Returns an error message and its help if frames are `ratio` times as large as their garment by the length of edges;
/// `unit_m` is the unit in which they were read.
pub fn compare_frame_size(ratio: f64, unit_m: f64) -> Option<(String, Message)> {
    if TUNING.frame_ratio.contains(&ratio) {
        return None;
    }
    let advice = match unit_that_divides(unit_m, ratio) {
        Some(unit) => Message::from("; ") + Setting::FramesUnit.to(unit) + " makes them fit",
        None => Message::default(),
    };
    Some((
        format!(
            "its frames are {ratio:.4} times as large as the garment: one of them has another unit than it was read in"
        ),
        Message::from("give the unit of the frames with ")
            + Setting::FramesUnit
            + ", that of the garment with "
            + Setting::Unit
            + advice,
    ))
}

/// Returns a warning if a body does not fit a garment in size or axis. `garment` and `body` are the corners of their boxes [m];
/// `units_m` are the units in which garment and body were read [m]; `worn_fraction` gives the fraction of the garment that lies on the
/// body if that is so many times as large.
pub fn compare_body_size(
    garment: (Vec3, Vec3),
    body: (Vec3, Vec3),
    units_m: [f64; 2],
    worn_fraction: impl Fn(f64) -> f64,
) -> Option<Message> {
    let (own, other) = (garment.1 - garment.0, body.1 - body.0);
    let ratio = other.max() / own.max();
    if !TUNING.body_ratio.contains(&ratio) {
        let advice = match unit_of_body(units_m[1], ratio) {
            Some(unit) => Message::from(format!("its unit may be {unit}: ")) + Setting::BodyUnit.to(unit),
            None => "check the unit of both".into(),
        };
        let what = format!(
            "the body is {:.2} m long and the garment {:.2} m: one of them has another unit than it was read in; ",
            other.max(),
            own.max()
        );
        return Some(Message::from(what) + advice);
    }
    if let Some((settings, own, fitting)) = unit_that_fits(units_m, worn_fraction) {
        let what = format!(
            "{:.0} % of the garment lie on the body, and {:.0} % would with ",
            100.0 * own,
            100.0 * fitting
        );
        let doubt = ": one of them may have another unit than it was read in";
        return Some(Message::from(what) + settings + doubt);
    }
    let centre = (garment.0 + garment.1) / 2.0;
    let margin = 0.25 * other.max();
    let holds = |p: Vec3| (0..3).all(|k| body.0[k] - margin <= p[k] && p[k] <= body.1[k] + margin);
    // The body's (x, y, z) would be (x, z, -y) if its z axis were up, and the reverse.
    let turned =
        [("z", Vec3::new(centre.x, -centre.z, centre.y)), ("y", Vec3::new(centre.x, centre.z, -centre.y))];
    if holds(centre) {
        return None;
    }
    let axis = turned.iter().find(|(_, p)| holds(*p)).map(|(axis, _)| *axis);
    let advice = axis.map_or("check the unit and the up axis of both".into(), |axis| {
        Message::from(format!("its {axis} axis may be up: ")) + Setting::BodyUp.to(axis)
    });
    Some(Message::from("the garment lies beside the body: ") + advice)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_of_a_wrong_size_is_found() {
        assert_eq!(unit_that_divides(1.0, 98.0), Some("cm"));
        assert_eq!(unit_that_divides(0.01, 0.012), Some("m"));
        assert_eq!(unit_that_divides(1.0, 41.0), Some("in"));
        assert_eq!(unit_that_divides(1.0, 1e6), None);
    }

    #[test]
    fn a_body_of_another_unit_or_axis_is_told() {
        let shirt = (Vec3::new(-0.3, 0.8, -0.1), Vec3::new(0.3, 1.5, 0.1));
        let person = (Vec3::new(-0.8, 0.0, -0.2), Vec3::new(0.8, 1.75, 0.2));
        let worn = |_: f64| 0.5;
        assert_eq!(compare_body_size(shirt, person, [1.0; 2], worn), None);
        let message = compare_body_size(shirt, (person.0 * 100.0, person.1 * 100.0), [1.0; 2], worn)
            .expect("too large");
        assert!(message.contains("of the body (cm)"), "{message}");
        let message = compare_body_size(shirt, (person.0 * 0.01, person.1 * 0.01), [1.0, 0.01], worn)
            .expect("too small");
        assert!(message.contains("of the body (m)"), "{message}");
        let lying = (Vec3::new(-0.8, -0.2, -1.75), Vec3::new(0.8, 0.2, 0.0));
        let upright = compare_body_size(shirt, lying, [1.0; 2], worn).expect("another axis");
        assert!(upright.contains("ReadOptions::up of the body"), "{upright}");
        // Boxes alone cannot tell inches from centimetres: a short garment on a person looks the same.
        let fits_at =
            |fitting: f64| move |scale: f64| if (scale / fitting - 1.0).abs() < 0.01 { 0.8 } else { 0.0 };
        for (fitting, option) in
            [(2.54, "of the body (in)"), (1.0 / 2.54, "unit_m (in) ReadOptions::unit_m of the body (cm)")]
        {
            let message =
                compare_body_size(shirt, person, [0.01; 2], fits_at(fitting)).expect("another unit");
            assert!(message.contains(option), "{message}");
        }
    }
}

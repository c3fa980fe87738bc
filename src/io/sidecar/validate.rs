//! Validation of a sidecar: everything the rest of the crate relies on (version, lengths, index ranges, finite numbers).
//!
//! Does not check that the hinges are those of the triangles (`transfer` does), nor that texture coordinates make sense.

use crate::sidecar::format::{SIDECAR_FORMAT, Sidecar};
use crease_model::error::{Diagnostic, Error, Message, Operation, Result};

/// Help for a sidecar that contradicts itself.
pub(super) const REWRITE_HELP: &str = "use the sidecar as crease wrote it, or bake again";

impl Sidecar {
    /// Checks the sidecar; fails with one diagnostic for each list that contradicts another. `file` names it.
    pub(super) fn validate(&self, file: &str) -> Result<()> {
        let mut check = Check { file, errors: Vec::new() };
        if self.format != SIDECAR_FORMAT {
            check.errors.push(wrong_format(file, &self.format));
        }
        check.unit(self.source.unit_m);
        self.validate_mesh(&mut check);
        self.validate_memory(&mut check);
        self.validate_creases(&mut check);
        if check.errors.is_empty() {
            check.errors.extend(self.checksum_errors(file));
        }
        if check.errors.is_empty() { Ok(()) } else { Err(Error::Input(check.errors)) }
    }

    fn validate_mesh(&self, check: &mut Check) {
        let (points, triangles) = (self.mesh.points_m.len(), self.mesh.triangles.len());
        let vertices = self.mesh.source_point.len();
        check.finite("mesh.points_m", &self.mesh.points_m);
        check.indices("mesh.triangles", &self.mesh.triangles, points);
        check.indices("mesh.source_point", self.mesh.source_point.as_chunks::<1>().0, points);
        if let Some(uv) = &self.mesh.source_uv {
            check.length("mesh.source_uv", uv.len(), vertices, "source vertices");
            check.finite("mesh.source_uv", uv);
        }
        if let Some(corners) = &self.mesh.triangle_vertices {
            check.length("mesh.triangle_vertices", corners.len(), triangles, "triangles");
            check.indices("mesh.triangle_vertices", corners, vertices);
        }
        if let Some(on_line) = &self.mesh.fold_line_points {
            check.indices("mesh.fold_line_points", on_line.as_chunks::<1>().0, points);
        }
        for (i, joint) in self.mesh.joints.iter().flatten().enumerate() {
            check.finite(&format!("mesh.joints[{i}].position_m"), &[joint.position_m]);
            check.finite(&format!("mesh.joints[{i}].axes"), &joint.axes);
        }
    }

    fn validate_creases(&self, check: &mut Check) {
        for (i, crease) in self.creases.iter().flatten().enumerate() {
            let name = |field: &str| format!("creases[{i}].{field}");
            let (places, between) = (crease.triangles.len(), crease.triangles.len().saturating_sub(1));
            check.indices(&name("triangles"), crease.triangles.as_chunks::<1>().0, self.mesh.triangles.len());
            check.length(&name("weights"), crease.weights.len(), places, "places");
            check.finite(&name("weights"), &crease.weights);
            check.length(&name("angle_rad"), crease.angle_rad.len(), between, "stretches");
            check.finite(&name("angle_rad"), crease.angle_rad.as_chunks::<1>().0);
            check.length(&name("stiffness_ratio"), crease.stiffness_ratio.len(), between, "stretches");
            check.positive(&name("stiffness_ratio"), &crease.stiffness_ratio);
            check.positive(&name("width_m"), &[crease.width_m]);
        }
    }

    fn validate_memory(&self, check: &mut Check) {
        let (points, triangles) = (self.mesh.points_m.len(), self.mesh.triangles.len());
        let hinges = self.hinges.points.len();
        for (location, values) in [
            ("triangles.warp_angle_rad", &self.triangles.warp_angle_rad),
            ("triangles.confidence", &self.triangles.confidence),
        ] {
            if let Some(values) = values {
                check.length(location, values.len(), triangles, "triangles");
                check.finite(location, values.as_chunks::<1>().0);
            }
        }
        check.indices("hinges.points", &self.hinges.points, points);
        for (location, angles) in [
            ("hinges.source_angle_rad", &self.hinges.source_angle_rad),
            ("hinges.rest_angle_rad", &self.hinges.rest_angle_rad),
        ] {
            check.length(location, angles.len(), hinges, "hinges");
            check.finite(location, angles.as_chunks::<1>().0);
        }
        check.length("hinges.stiffness_ratio", self.hinges.stiffness_ratio.len(), hinges, "hinges");
        check.positive("hinges.stiffness_ratio", &self.hinges.stiffness_ratio);
        for (location, stretch) in [
            ("triangles.rest_stretch_warp", &self.triangles.rest_stretch_warp),
            ("triangles.rest_stretch_weft", &self.triangles.rest_stretch_weft),
        ] {
            check.length(location, stretch.len(), triangles, "triangles");
            check.positive(location, stretch);
        }
        check.length("points.displacement_m", self.points.displacement_m.len(), points, "points");
        check.finite("points.displacement_m", &self.points.displacement_m);
    }
}

/// Creates the diagnostic of a file of another format or version.
pub(super) fn wrong_format(file: &str, format: &str) -> Diagnostic {
    let help = if format.starts_with("crease-sidecar/") {
        "use the version of crease that wrote it".into()
    } else {
        sidecar_help()
    };
    Diagnostic::new(file, "format", format!("is {format:?}, not {SIDECAR_FORMAT:?}"), help)
}

/// Cure of another file in the place of a sidecar.
pub(super) fn sidecar_help() -> Message {
    Message::from("give the OUT.crease.json that `") + Operation::Bake + "` wrote beside OUT.glb"
}

/// Collector of errors; each list is reported once, at its first bad entry.
struct Check<'a> {
    file: &'a str,
    errors: Vec<Diagnostic>,
}

impl Check<'_> {
    fn add(&mut self, location: String, message: String) {
        self.errors.push(Diagnostic::new(self.file, location, message, REWRITE_HELP));
    }

    fn length(&mut self, location: &str, found: usize, wanted: usize, of: &str) {
        if found != wanted {
            self.add(location.to_owned(), format!("has {found} entries for {wanted} {of}"));
        }
    }

    fn finite<const N: usize>(&mut self, location: &str, rows: &[[f64; N]]) {
        if let Some(i) = rows.iter().position(|row| row.iter().any(|x| !x.is_finite())) {
            self.add(format!("{location}[{i}]"), "is not a finite number".to_owned());
        }
    }

    fn unit(&mut self, unit_m: f64) {
        if !(unit_m.is_finite() && unit_m > 0.0) {
            self.add("source.unit_m".to_owned(), format!("is {unit_m}, but must be a number above 0"));
        }
    }

    fn positive(&mut self, location: &str, values: &[f64]) {
        if let Some((i, x)) = values.iter().enumerate().find(|(_, x)| !(x.is_finite() && **x > 0.0)) {
            self.add(format!("{location}[{i}]"), format!("is {x}, but must be a number above 0"));
        }
    }

    fn indices<const N: usize>(&mut self, location: &str, rows: &[[u32; N]], count: usize) {
        if let Some(i) = rows.iter().position(|row| row.iter().any(|&p| p as usize >= count)) {
            self.add(format!("{location}[{i}]"), format!("names one beyond the last of {count}"));
        }
    }
}

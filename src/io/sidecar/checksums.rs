//! Checksums of a sidecar, which detect numbers that were edited after writing.
//!
//! Computed over numbers and not over text, so that layout, the order of fields and other tools' fields do not matter;
//! mesh and memory separately, so that an error names the one that changed. Optional in the file: a tool that edits it on
//! purpose leaves them out. They protect against accidents, not against tampering.

use crate::sidecar::format::{Sidecar, SidecarChecksums};
use crease_model::error::Diagnostic;
use serde_json::Map;
use sha2::{Digest, Sha256};

/// Help for numbers that are not those that were written.
const EDITED_HELP: &str = "bring the file back, or, if the change is meant, delete \"checksums\" from it";

impl Sidecar {
    /// Computes the checksums of the present numbers.
    pub fn compute_checksums(&self) -> SidecarChecksums {
        let (hinges, triangles) = (&self.hinges, &self.triangles);
        let mut mesh = ListHash::default();
        mesh.floats(&self.mesh.points_m);
        mesh.indices(&self.mesh.triangles);
        let mut memory = ListHash::default();
        memory.indices(&hinges.points);
        for list in [
            &hinges.source_angle_rad,
            &hinges.rest_angle_rad,
            &hinges.stiffness_ratio,
            &triangles.rest_stretch_warp,
            &triangles.rest_stretch_weft,
        ] {
            memory.floats(list.as_chunks::<1>().0);
        }
        memory.floats(&self.points.displacement_m);
        SidecarChecksums { mesh_sha256: mesh.hex(), memory_sha256: memory.hex(), extra: Map::new() }
    }

    /// Returns the errors of the stated checksums, if there are any, against the numbers.
    pub(super) fn checksum_errors(&self, file: &str) -> Vec<Diagnostic> {
        let Some(stated) = &self.checksums else { return Vec::new() };
        let own = self.compute_checksums();
        [
            ("mesh", &stated.mesh_sha256, &own.mesh_sha256),
            ("memory", &stated.memory_sha256, &own.memory_sha256),
        ]
        .into_iter()
        .filter(|(_, stated, own)| stated != own)
        .map(|(part, _, _)| {
            let message = format!("does not fit: the {part} is not the one this sidecar was written with");
            Diagnostic::new(file, format!("checksums.{part}_sha256"), message, EDITED_HELP)
        })
        .collect()
    }
}

/// Hash over lists of numbers.
#[derive(Default)]
struct ListHash(Sha256);

impl ListHash {
    fn floats<const N: usize>(&mut self, rows: &[[f64; N]]) {
        self.0.update((rows.len() as u64).to_le_bytes());
        rows.iter().flatten().for_each(|x| self.0.update(x.to_le_bytes()));
    }

    fn indices<const N: usize>(&mut self, rows: &[[u32; N]]) {
        self.0.update((rows.len() as u64).to_le_bytes());
        rows.iter().flatten().for_each(|x| self.0.update(x.to_le_bytes()));
    }

    fn hex(self) -> String {
        self.0.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

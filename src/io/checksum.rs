//! Checksums of a sidecar: whether its numbers are those that were written.
//!
//! Over numbers and not over text, so that layout, the order of fields and other tools' fields do not matter; mesh and memory
//! apart, so that a fault says which of them changed. Optional in the file: who edits it on purpose leaves them out.
//! A protection against accidents, not against anybody.

use crate::Diagnostic;
use crate::io::Sidecar;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};

/// SHA-256 over numbers, lower-case hex. Each list goes in as its length (64 bits), then its numbers row by row: indices in
/// 32 bits, all others as 64-bit floats, little-endian. So spaces and the order of fields do not matter.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct SidecarChecksums {
    /// Over `mesh.points_m`, `mesh.triangles`.
    pub mesh_sha256: String,
    /// Over `hinges.points`, `.source_angle_rad`, `.rest_angle_rad`, `.stiffness_ratio`, `triangles.rest_stretch_warp`,
    /// `.rest_stretch_weft`, `points.displacement_m`.
    pub memory_sha256: String,
    /// Fields this version does not know.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}

/// Cure for numbers that are not those that were written.
const EDITED: &str = "bring the file back, or, if the change is meant, delete \"checksums\" from it";

impl Sidecar {
    /// The checksums of the numbers as they are now.
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

    /// What the stated checksums, if there are any, say against the numbers.
    pub(super) fn checksum_faults(&self, file: &str) -> Vec<Diagnostic> {
        let Some(stated) = &self.checksums else { return Vec::new() };
        let own = self.compute_checksums();
        [
            ("mesh", &stated.mesh_sha256, &own.mesh_sha256),
            ("memory", &stated.memory_sha256, &own.memory_sha256),
        ]
        .into_iter()
        .filter(|(_, stated, own)| stated != own)
        .map(|(part, _, _)| {
            let what = format!("does not fit: the {part} is not the one this sidecar was written with");
            Diagnostic::new(file, format!("checksums.{part}_sha256"), what, EDITED)
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

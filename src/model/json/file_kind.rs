//! What a file is that was given in the place of another: a script for a mesh, a report for a sidecar. Looks at the start of meshes and at
//! the stated format of JSON. Reads nothing else of them.

use serde::Deserialize;
use serde::de::IgnoredAny;
use std::fmt;

/// What a file is, by its content.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// A mesh in OBJ.
    ObjMesh,
    /// A mesh in glTF, text or binary.
    GltfMesh,
    /// A stage of USD, text or binary.
    UsdMesh,
    /// A wear script.
    WearScript,
    /// A sidecar.
    Sidecar,
    /// A fabric.
    Fabric,
    /// A job file of a batch.
    BatchFile,
    /// A record of a job of a batch.
    JobRecord,
    /// A list of landmarks.
    Landmarks,
    /// A checkpoint.
    Checkpoint,
    /// A report of a run.
    Report,
}

impl FileKind {
    /// Whether it is a mesh of any format.
    pub fn is_mesh(self) -> bool {
        matches!(self, Self::ObjMesh | Self::GltfMesh | Self::UsdMesh)
    }
}

impl fmt::Display for FileKind {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::ObjMesh => "an OBJ mesh",
            Self::GltfMesh => "a glTF mesh",
            Self::UsdMesh => "a USD mesh",
            Self::WearScript => "a wear script",
            Self::Sidecar => "the sidecar of a worn garment",
            Self::Fabric => "a fabric",
            Self::BatchFile => "a job file of a batch",
            Self::JobRecord => "the record of a job of a batch",
            Self::Landmarks => "a list of landmarks",
            Self::Checkpoint => "a checkpoint",
            Self::Report => "the report of a run",
        })
    }
}

/// Kinds of JSON files by the start of their `format`.
const FORMATS: [(&str, FileKind); 7] = [
    ("crease-wear/", FileKind::WearScript),
    ("crease-sidecar/", FileKind::Sidecar),
    ("crease-fabric/", FileKind::Fabric),
    ("crease-batch/", FileKind::BatchFile),
    ("crease-job/", FileKind::JobRecord),
    ("crease-landmarks/", FileKind::Landmarks),
    ("crease-checkpoint/", FileKind::Checkpoint),
];

/// What JSON of any of these kinds states.
#[derive(Deserialize)]
struct Stated {
    format: Option<String>,
    asset: Option<IgnoredAny>,
    simulated_s: Option<IgnoredAny>,
    crossings: Option<IgnoredAny>,
}

/// Returns the kind of mesh that `bytes` are; `None` if they are no mesh.
pub fn kind_of_mesh(bytes: &[u8]) -> Option<FileKind> {
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let is_vertex =
        |line: &[u8]| line.starts_with(b"v ") || line.starts_with(b"o ") || line.starts_with(b"mtllib ");
    let is_remark = |line: &&[u8]| line.first().is_none_or(|&first| first == b'#' || first == b'\r');
    match text {
        _ if text.starts_with(b"glTF") => Some(FileKind::GltfMesh),
        _ if text.starts_with(b"#usda ") || text.starts_with(b"PXR-USDC") => Some(FileKind::UsdMesh),
        _ => text
            .split(|&byte| byte == b'\n')
            .find(|line| !is_remark(line))
            .is_some_and(is_vertex)
            .then_some(FileKind::ObjMesh),
    }
}

/// Returns what the file with `bytes` is, if it is a mesh or one of the formats of this crate.
pub fn kind_of_file(bytes: &[u8]) -> Option<FileKind> {
    if let Some(kind) = kind_of_mesh(bytes) {
        return Some(kind);
    }
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let stated: Stated = serde_json::from_slice(text).ok()?;
    match stated.format {
        Some(format) => FORMATS.iter().find(|(start, _)| format.starts_with(start)).map(|(_, kind)| *kind),
        None if stated.asset.is_some() => Some(FileKind::GltfMesh),
        None => (stated.simulated_s.is_some() && stated.crossings.is_some()).then_some(FileKind::Report),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_by_their_content() {
        let kinds: [(&[u8], Option<&str>); 10] = [
            (b"# made by hand\r\n\nv 0 0 0\n", Some("an OBJ mesh")),
            (b"mtllib a.mtl\nv 0 0 0\n", Some("an OBJ mesh")),
            (b"glTF\x02\0\0\0", Some("a glTF mesh")),
            (b"#usda 1.0\n", Some("a USD mesh")),
            (b"{\"asset\": {\"version\": \"2.0\"}}", Some("a glTF mesh")),
            (b"{\"format\": \"crease-wear/1\", \"actions\": []}", Some("a wear script")),
            (b"\xEF\xBB\xBF{\"format\": \"crease-sidecar/9\"}", Some("the sidecar of a worn garment")),
            (b"{\"simulated_s\": 1.5, \"crossings\": 0}", Some("the report of a run")),
            (b"{\"format\": \"other/1\"}", None),
            (b"", None),
        ];
        for (bytes, kind) in kinds {
            assert_eq!(
                kind_of_file(bytes).map(|kind| kind.to_string()).as_deref(),
                kind,
                "{}",
                String::from_utf8_lossy(bytes)
            );
        }
    }
}

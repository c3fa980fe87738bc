//! What a file is that was given in the place of another: a script for a mesh, a report for a sidecar. Looks at the start of meshes and at
//! the stated format of JSON. Reads nothing else of them.

use serde::Deserialize;
use serde::de::IgnoredAny;

/// Kinds of JSON files by the start of their `format`.
const FORMATS: [(&str, &str); 7] = [
    ("crease-wear/", "a wear script"),
    ("crease-sidecar/", "the sidecar of a worn garment"),
    ("crease-fabric/", "a fabric"),
    ("crease-batch/", "a job file of a batch"),
    ("crease-job/", "the record of a job of a batch"),
    ("crease-landmarks/", "a list of landmarks"),
    ("crease-checkpoint/", "a checkpoint"),
];

/// What JSON of any of these kinds states.
#[derive(Deserialize)]
struct Stated {
    format: Option<String>,
    asset: Option<IgnoredAny>,
    simulated_s: Option<IgnoredAny>,
    crossings: Option<IgnoredAny>,
}

/// Returns the kind of mesh that `bytes` are, such as "an OBJ mesh"; `None` if they are no mesh.
pub fn kind_of_mesh(bytes: &[u8]) -> Option<&'static str> {
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let is_vertex =
        |line: &[u8]| line.starts_with(b"v ") || line.starts_with(b"o ") || line.starts_with(b"mtllib ");
    let is_remark = |line: &&[u8]| line.first().is_none_or(|&first| first == b'#' || first == b'\r');
    match text {
        _ if text.starts_with(b"glTF") => Some("a glTF mesh"),
        _ if text.starts_with(b"#usda ") || text.starts_with(b"PXR-USDC") => Some("a USD mesh"),
        _ => text
            .split(|&byte| byte == b'\n')
            .find(|line| !is_remark(line))
            .is_some_and(is_vertex)
            .then_some("an OBJ mesh"),
    }
}

/// Returns what the file with `bytes` is, such as "a wear script", if it is a mesh or one of the formats of this crate.
pub fn kind_of_file(bytes: &[u8]) -> Option<&'static str> {
    if let Some(kind) = kind_of_mesh(bytes) {
        return Some(kind);
    }
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let stated: Stated = serde_json::from_slice(text).ok()?;
    match stated.format {
        Some(format) => FORMATS.iter().find(|(start, _)| format.starts_with(start)).map(|(_, kind)| *kind),
        None if stated.asset.is_some() => Some("a glTF mesh"),
        None => (stated.simulated_s.is_some() && stated.crossings.is_some()).then_some("the report of a run"),
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
            assert_eq!(kind_of_file(bytes), kind, "{}", String::from_utf8_lossy(bytes));
        }
    }
}

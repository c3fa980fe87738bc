//! Prims of a USD file as text, and the text of their values.

use crease_geometry::math::{Mat4, Vec2, Vec3};
use std::fmt::Write;

/// A prim: type, name, API schemas, lines of properties, children.
#[derive(Debug, Clone, Default)]
pub(super) struct Prim {
    kind: &'static str,
    name: String,
    metadata: Vec<String>,
    lines: Vec<String>,
    children: Vec<Prim>,
}

impl Prim {
    pub(super) fn new(kind: &'static str, name: impl Into<String>) -> Self {
        Self { kind, name: name.into(), ..Self::default() }
    }

    /// Applies API schemas.
    pub(super) fn api(self, schemas: &[&str]) -> Self {
        let names: Vec<String> = schemas.iter().map(|name| format!("\"{name}\"")).collect();
        self.meta(format!("prepend apiSchemas = [{}]", names.join(", ")))
    }

    /// Adds a line of metadata.
    pub(super) fn meta(mut self, line: String) -> Self {
        self.metadata.push(line);
        self
    }

    /// Adds a property.
    pub(super) fn line(mut self, line: String) -> Self {
        self.lines.push(line);
        self
    }

    /// Adds a property if there is one.
    pub(super) fn maybe(mut self, line: Option<String>) -> Self {
        self.lines.extend(line);
        self
    }

    /// Adds a child.
    pub(super) fn child(mut self, child: Prim) -> Self {
        self.children.push(child);
        self
    }

    /// Writes the prim with its children.
    pub(super) fn write(&self, text: &mut String, depth: usize) {
        let pad = "    ".repeat(depth);
        // Writing to a string cannot fail.
        let _ = write!(text, "{pad}def {} \"{}\"", self.kind, self.name);
        if !self.metadata.is_empty() {
            let lines: Vec<String> = self.metadata.iter().map(|line| format!("{pad}    {line}\n")).collect();
            let _ = write!(text, " (\n{}{pad})", lines.concat());
        }
        let _ = writeln!(text, "\n{pad}{{");
        for line in &self.lines {
            let _ = writeln!(text, "{pad}    {line}");
        }
        for child in &self.children {
            child.write(text, depth + 1);
        }
        let _ = writeln!(text, "{pad}}}");
    }
}

/// Returns `text` as a name of a prim: letters, digits and underscores, no digit first.
pub(super) fn identifier(text: &str, otherwise: &str) -> String {
    let mut name: String = text.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if name.trim_matches('_').is_empty() {
        name = otherwise.to_owned();
    }
    if name.starts_with(|c: char| c.is_ascii_digit()) { format!("_{name}") } else { name }
}

pub(super) fn list(entries: impl Iterator<Item = String>) -> String {
    format!("[{}]", entries.collect::<Vec<_>>().join(", "))
}

/// Single precision without a negative zero.
pub(super) fn number(x: f64) -> f32 {
    x as f32 + 0.0
}

pub(super) fn vector(x: &Vec3) -> String {
    format!("({}, {}, {})", number(x.x), number(x.y), number(x.z))
}

pub(super) fn vectors(all: &[Vec3]) -> String {
    list(all.iter().map(vector))
}

/// Texture coordinates, whose v grows upward in USD and downward in glTF.
pub(super) fn texture_coordinates(all: &[Vec2]) -> String {
    list(all.iter().map(|uv| format!("({}, {})", number(uv.x), number(1.0 - uv.y))))
}

/// Returns a matrix as USD writes it: rows of the transpose.
pub(super) fn matrix(m: &Mat4) -> String {
    let row = |k: usize| {
        let c = m.column(k);
        format!("({}, {}, {}, {})", c[0] + 0.0, c[1] + 0.0, c[2] + 0.0, c[3] + 0.0)
    };
    format!("({}, {}, {}, {})", row(0), row(1), row(2), row(3))
}

/// Returns the corners of the box around all `shapes`.
pub(super) fn extent<'a>(shapes: impl IntoIterator<Item = &'a [Vec3]>) -> String {
    let mut corners: Option<(Vec3, Vec3)> = None;
    for x in shapes.into_iter().flatten() {
        let (low, high) = corners.unwrap_or((*x, *x));
        corners = Some((low.inf(x), high.sup(x)));
    }
    let (low, high) = corners.unwrap_or((Vec3::zeros(), Vec3::zeros()));
    format!("[{}, {}]", vector(&low), vector(&high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_identifiers() {
        assert_eq!(identifier("upper arm.L", "joint"), "upper_arm_L");
        assert_eq!(identifier("3 buttons", "piece"), "_3_buttons");
        assert_eq!(identifier("袖", "piece"), "piece");
    }

    #[test]
    fn matrices_are_transposed_and_zeros_have_no_sign() {
        let m = Mat4::new_translation(&Vec3::new(1.0, 2.0, 3.0));
        assert!(matrix(&m).ends_with("(1, 2, 3, 1))"));
        assert_eq!(vector(&Vec3::new(-0.0, 0.5, 0.0)), "(0, 0.5, 0)");
    }
}

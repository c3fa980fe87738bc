//! Text inside HTML pages.

/// Returns `text` with the characters escaped that HTML gives a meaning.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

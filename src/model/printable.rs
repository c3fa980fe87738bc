//! Text of files as it may be printed: a name can hold a terminal's escape sequences, line breaks, or marks that turn the direction of
//! writing, and would otherwise forge lines of the program.

use std::borrow::Cow;
use std::fmt::Write;

/// Returns `text` with every control character, line separator and mark of writing direction as its escape, such as `\u{1b}`.
///
/// ```
/// use crease_model::printable::printable;
/// assert_eq!(printable("sleeve\nerror: \u{1b}[31m"), "sleeve\\nerror: \\u{1b}[31m");
/// assert_eq!(printable("Ärmel 袖"), "Ärmel 袖");
/// ```
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::with_capacity(2 * text.len());
    for c in text.chars() {
        match c {
            _ if !is_hidden(c) => escaped.push(c),
            '\n' | '\r' | '\t' => escaped.extend(c.escape_default()),
            // Writing to a string cannot fail.
            _ => drop(write!(escaped, "{}", c.escape_unicode())),
        }
    }
    Cow::Owned(escaped)
}

/// Whether `c` shows nothing and changes how the text around it is shown.
fn is_hidden(c: char) -> bool {
    let turns_direction =
        matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || turns_direction || matches!(c, '\u{2028}' | '\u{2029}')
}

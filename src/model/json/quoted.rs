//! Text from files in messages.

/// Characters of a text that are shown.
const MAX_SHOWN_CHARS: usize = 60;

/// Returns a text from a file made safe and short enough for a message: quoted, control characters escaped, truncated.
pub fn quoted(text: &str) -> String {
    let mut out = String::from("`");
    for (count, c) in text.chars().enumerate() {
        if count == MAX_SHOWN_CHARS {
            out.push('…');
            break;
        }
        match c {
            '"' | '\'' | '`' => out.push(c),
            _ => out.extend(c.escape_debug()),
        }
    }
    out.push('`');
    out
}

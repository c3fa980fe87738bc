//! Comments in JSON: `// to the end of the line` and `/* to here */`.

/// Returns `text` with every comment replaced by blanks: characters keep their line and column.
pub(super) fn blank_comments(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut chars = text.chars().peekable();
    let mut within_string = false;
    while let Some(c) = chars.next() {
        match (within_string, c, chars.peek()) {
            (true, '\\', Some(_)) => {
                out.push(c);
                out.extend(chars.next());
            }
            (_, '"', _) => {
                within_string = !within_string;
                out.push(c);
            }
            (false, '/', Some('/')) => {
                out.push(' ');
                while let Some(c) = chars.next_if(|c| *c != '\n') {
                    out.push(if c == '\r' { c } else { ' ' });
                }
            }
            (false, '/', Some('*')) => {
                out.push_str("  ");
                chars.next();
                let mut last = ' ';
                for c in chars.by_ref() {
                    out.push(if c == '\n' { c } else { ' ' });
                    if last == '*' && c == '/' {
                        break;
                    }
                    last = c;
                }
            }
            _ => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_become_blanks_and_strings_stay() {
        let text = "{ // one\n \"a//b\": \"/* \\\" */\", /* two\n é */ \"c\": 1 }";
        let blanked = blank_comments(text);
        assert_eq!(blanked, "{       \n \"a//b\": \"/* \\\" */\",       \n      \"c\": 1 }");
        assert_eq!(blanked.chars().count(), text.chars().count());
        assert_eq!(blank_comments("/*/ 1 */2"), "        2");
        assert_eq!(blank_comments("1 /* open"), "1        ");
    }
}

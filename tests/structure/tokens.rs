//! Rust text as tokens: identifiers and punctuation with their lines, without comments and literals.

/// An identifier, a lifetime, `::`, or one character of punctuation.
#[derive(Debug, Clone, PartialEq)]
pub struct Token {
    /// As written.
    pub text: String,
    /// Line, from 1.
    pub line: usize,
}

impl Token {
    /// Whether it is a word.
    pub fn is_word(&self) -> bool {
        self.text.starts_with(|c: char| c.is_alphabetic() || c == '_')
    }
}

/// Reads all tokens of `text`.
pub fn tokens(text: &str) -> Vec<Token> {
    let bytes = text.as_bytes();
    let (mut at, mut line, mut found) = (0, 1, Vec::new());
    while at < bytes.len() {
        let end = match bytes[at] {
            b'/' if bytes[at..].starts_with(b"//") => end_of_line(bytes, at),
            b'/' if bytes[at..].starts_with(b"/*") => end_of_block_comment(bytes, at),
            b'"' => end_of_string(bytes, at),
            b'\'' => end_of_quote(bytes, at),
            b'r' | b'b' | b'c' if is_literal_prefix(bytes, at) => end_of_prefixed_literal(bytes, at),
            byte if byte.is_ascii_alphanumeric() || byte == b'_' => {
                let end = end_of_word(bytes, at);
                if !byte.is_ascii_digit() {
                    found.push(Token { text: text[at..end].to_owned(), line });
                }
                end
            }
            byte => {
                let end = if bytes[at..].starts_with(b"::") { at + 2 } else { at + 1 };
                if byte.is_ascii_punctuation() {
                    found.push(Token { text: text[at..end].to_owned(), line });
                }
                end
            }
        };
        line += bytes[at..end].iter().filter(|byte| **byte == b'\n').count();
        at = end;
    }
    found
}

fn end_of_line(bytes: &[u8], from: usize) -> usize {
    bytes[from..].iter().position(|byte| *byte == b'\n').map_or(bytes.len(), |length| from + length)
}

fn end_of_word(bytes: &[u8], from: usize) -> usize {
    let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'_';
    bytes[from..].iter().position(|byte| !is_part(byte)).map_or(bytes.len(), |length| from + length)
}

fn end_of_block_comment(bytes: &[u8], from: usize) -> usize {
    let (mut at, mut depth) = (from, 0);
    while at < bytes.len() {
        match &bytes[at..(at + 2).min(bytes.len())] {
            b"/*" => (depth, at) = (depth + 1, at + 2),
            b"*/" => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            break;
        }
    }
    at.min(bytes.len())
}

/// End of a string that opens at `from` and knows escapes.
fn end_of_string(bytes: &[u8], from: usize) -> usize {
    let mut at = from + 1;
    while at < bytes.len() && bytes[at] != b'"' {
        at += if bytes[at] == b'\\' { 2 } else { 1 };
    }
    (at + 1).min(bytes.len())
}

/// End of a character literal, or of a lifetime's tick.
fn end_of_quote(bytes: &[u8], from: usize) -> usize {
    if bytes.get(from + 1) == Some(&b'\\') {
        let rest = &bytes[(from + 3).min(bytes.len())..];
        return rest.iter().position(|byte| *byte == b'\'').map_or(bytes.len(), |length| from + length + 4);
    }
    // One character, of up to four bytes, and a closing tick; else a lifetime.
    (2..=5)
        .map(|length| from + length)
        .find(|end| bytes.get(*end) == Some(&b'\''))
        .filter(|end| {
            std::str::from_utf8(&bytes[from + 1..*end]).is_ok_and(|inner| inner.chars().count() == 1)
        })
        .map_or(from + 1, |end| end + 1)
}

/// Whether a literal such as `r"`, `br#"` or `b'` begins here, not a word.
fn is_literal_prefix(bytes: &[u8], at: usize) -> bool {
    if at > 0 && (bytes[at - 1].is_ascii_alphanumeric() || bytes[at - 1] == b'_') {
        return false;
    }
    let prefix = end_of_word(bytes, at);
    let raw_name =
        bytes[prefix..].starts_with(b"#") && bytes[prefix..].iter().find(|b| **b != b'#') != Some(&b'"');
    prefix - at <= 2 && matches!(bytes.get(prefix), Some(b'"' | b'\'' | b'#')) && !raw_name
}

fn end_of_prefixed_literal(bytes: &[u8], from: usize) -> usize {
    let prefix = end_of_word(bytes, from);
    if bytes[prefix] == b'\'' {
        return end_of_quote(bytes, prefix);
    }
    if !bytes[from..prefix].contains(&b'r') {
        return end_of_string(bytes, prefix);
    }
    let hashes = bytes[prefix..].iter().take_while(|byte| **byte == b'#').count();
    let close: Vec<u8> = [b"\"".as_slice(), &vec![b'#'; hashes]].concat();
    let body = prefix + hashes + 1;
    let length = bytes[body..].windows(close.len()).position(|window| window == close);
    length.map_or(bytes.len(), |length| body + length + close.len())
}

/// Index of the token that closes what opens at `open`: `{`, `(` or `[`.
pub fn closing(tokens: &[Token], open: usize) -> usize {
    let mut depth = 0;
    for (at, token) in tokens.iter().enumerate().skip(open) {
        match token.text.as_str() {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return at;
        }
    }
    tokens.len() - 1
}

/// The tokens without items under `#[cfg(test)]`.
pub fn without_tests(tokens: &[Token]) -> Vec<Token> {
    const TEST: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let (mut at, mut kept) = (0, Vec::new());
    while at < tokens.len() {
        let is_test = tokens[at..].iter().map(|t| t.text.as_str()).take(7).eq(TEST);
        if !is_test {
            kept.push(tokens[at].clone());
            at += 1;
            continue;
        }
        at += TEST.len();
        while tokens.get(at).is_some_and(|t| t.text == "#") {
            at = closing(tokens, at + 1) + 1;
        }
        // An item ends with its block, or with a semicolon.
        while at < tokens.len() && tokens[at].text != ";" && tokens[at].text != "{" {
            at = if matches!(tokens[at].text.as_str(), "(" | "[") { closing(tokens, at) + 1 } else { at + 1 };
        }
        at = if tokens.get(at).is_some_and(|t| t.text == "{") { closing(tokens, at) + 1 } else { at + 1 };
    }
    kept
}

#[test]
fn comments_and_literals_are_no_tokens() {
    let text = "fn a() { let r#b = r#\"fn c\"#; /* fn d /* */ */ let e = 'f'; let g: &'h str = \"\\\"fn i\"; } // fn j\n'\\'' '\\u{1F600}' k";
    let words: Vec<String> = tokens(text).into_iter().filter(Token::is_word).map(|t| t.text).collect();
    assert_eq!(words, ["fn", "a", "let", "r", "b", "let", "e", "let", "g", "h", "str", "k"]);
    assert_eq!(tokens(text).last().map(|t| t.line), Some(2));
}

#[test]
fn tests_are_left_out() {
    let text = "use a; #[cfg(test)] #[path = \"x\"] mod b; #[cfg(test)] fn c(d: [u8; 2]) { e } mod f {}";
    let kept = without_tests(&tokens(text));
    let words: Vec<&str> = kept.iter().filter(|t| t.is_word()).map(|t| t.text.as_str()).collect();
    assert_eq!(words, ["use", "a", "mod", "f"]);
}

//! Suggests the allowed name that a misspelt one was probably meant to be.

/// Longest part of a given name that is compared [characters]: the distance costs the product of the lengths.
const MAX_COMPARED_CHARS: usize = 64;

/// Returns the name of `allowed` closest to `given`, if it is close enough: one edit (a wrong, missing, extra or swapped
/// letter) for names of up to four letters, about one per three letters for longer ones. Ignores case.
pub fn nearest<'a>(given: &str, allowed: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let given: String = given.chars().take(MAX_COMPARED_CHARS).flat_map(char::to_lowercase).collect();
    let limit = ((given.chars().count() + 1) / 3).max(1);
    allowed
        .into_iter()
        .map(|name| (strsim::osa_distance(&given, &name.to_lowercase()), name))
        .filter(|(distance, _)| *distance <= limit)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn misspelt_names_are_recognised_and_others_are_not() {
        let names = ["fold", "unfold", "hold", "crumple", "denim"];
        assert_eq!(nearest("fodl", names), Some("fold"));
        assert_eq!(nearest("Crumpel", names), Some("crumple"));
        assert_eq!(nearest("demin", names), Some("denim"));
        assert_eq!(nearest("wash", names), None);
        assert_eq!(nearest("", names), None);
        assert_eq!(nearest(&"x".repeat(1_000_000), names), None);
    }
}

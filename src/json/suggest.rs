//! The allowed name a misspelt one was probably meant to be.

/// The name of `allowed` closest to `given`, if it is close enough to be worth asking: one slip (a wrong, missing,
/// extra or swapped letter) for names of up to four letters, about one in three letters for longer ones. Upper and lower case are equal.
pub fn nearest<'a>(given: &str, allowed: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // Longer words are no misspelling of ours, and the distance costs the product of the lengths.
    let given: String = given.chars().take(64).flat_map(char::to_lowercase).collect();
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
    fn slips_are_understood_and_strangers_are_not() {
        let names = ["fold", "unfold", "hold", "crumple", "denim"];
        assert_eq!(nearest("fodl", names), Some("fold"));
        assert_eq!(nearest("Crumpel", names), Some("crumple"));
        assert_eq!(nearest("demin", names), Some("denim"));
        assert_eq!(nearest("wash", names), None);
        assert_eq!(nearest("", names), None);
        assert_eq!(nearest(&"x".repeat(1_000_000), names), None);
    }
}

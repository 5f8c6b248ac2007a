//! Suggestions of the kind "did you mean …?": the closest of a few known names by optimal string alignment (Damerau 1964).
//! It counts letters that are inserted, deleted, replaced, or swapped with their neighbour.

/// The closest of `known` to `word`; `None` if no name is close enough to be a typing error.
pub(super) fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let far = word.chars().count().div_ceil(3);
    let scored = known.into_iter().map(|k| (strsim::osa_distance(&word.to_lowercase(), &k.to_lowercase()), k));
    scored.filter(|&(d, _)| d <= far).min_by_key(|&(d, _)| d).map(|(_, k)| k)
}

/// The help text `did you mean X? `, if a name is close, followed by the list of all names.
pub(super) fn suggest(word: &str, kind: &str, known: &[&str]) -> String {
    let list = if known.is_empty() { format!("there are no {kind}") } else { format!("{kind}: {}", known.join(", ")) };
    match nearest(word, known.iter().copied()) {
        Some(k) => format!("did you mean `{k}`? {list}"),
        None => list,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_slips_are_suggested() {
        let known = ["cornell", "furnace", "sphere", "shells"];
        assert_eq!(nearest("Cornel", known), Some("cornell"));
        assert_eq!(nearest("shere", known), Some("sphere"));
        assert_eq!(nearest("teapot", known), None);
    }
}

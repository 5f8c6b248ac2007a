//! Did you mean …? The closest of a few known names by optimal string alignment (Damerau 1964): the number of
//! letters inserted, deleted, replaced, or swapped with their neighbour.

/// The closest of `known` to `word`, if it is close enough to be a slip of the fingers.
pub(super) fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let far = word.chars().count().div_ceil(3);
    let scored = known.into_iter().map(|k| (strsim::osa_distance(&word.to_lowercase(), &k.to_lowercase()), k));
    scored.filter(|&(d, _)| d <= far).min_by_key(|&(d, _)| d).map(|(_, k)| k)
}

/// `did you mean X? ` followed by the whole list, for help lines.
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

//! Did you mean …? The closest of a few known names by optimal string alignment (Damerau 1964): the number of
//! letters inserted, deleted, replaced, or swapped with their neighbour.

/// The closest of `known` to `word`, if it is close enough to be a slip of the fingers.
pub(super) fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let far = word.chars().count().div_ceil(3);
    let scored = known.into_iter().map(|k| (distance(&word.to_lowercase(), &k.to_lowercase()), k));
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

/// Letters apart: d(i, j) between the first i letters of a and the first j of b, row by row.
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows: Vec<Vec<usize>> = vec![(0..=b.len()).collect()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replace = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replace.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            row.push(best);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_known_by_hand() {
        for (a, b, d) in [("", "", 0), ("", "ab", 2), ("whit", "white", 1), ("fvo", "fov", 1), ("kitten", "sitting", 3)]
        {
            assert_eq!(distance(a, b), d, "{a} {b}");
            assert_eq!(distance(b, a), d, "{b} {a}");
        }
    }

    #[test]
    fn only_slips_are_suggested() {
        let known = ["cornell", "furnace", "sphere", "shells"];
        assert_eq!(nearest("Cornel", known), Some("cornell"));
        assert_eq!(nearest("shere", known), Some("sphere"));
        assert_eq!(nearest("teapot", known), None);
    }
}

//! Values of a type by the names that [`Display`] gives them, and the known names nearest to a mistyped one.

use std::fmt::Display;

/// The value in `all` whose printed name is `name`.
///
/// # Errors
/// Lists the names that exist.
pub fn named<T: Copy + Display>(all: &[T], name: &str) -> Result<T, String> {
    let found = all.iter().find(|value| value.to_string() == name);
    found.copied().ok_or_else(|| format!("`{name}` is none of {}", list(all)))
}

/// All names, separated by commas.
pub fn list(all: impl IntoIterator<Item: Display>) -> String {
    all.into_iter().map(|value| value.to_string()).collect::<Vec<_>>().join(", ")
}

/// The closest of `known` to `word`, if it is close enough to be a slip of the fingers: by optimal string alignment (Damerau
/// 1964), which counts letters inserted, deleted, replaced, or swapped with their neighbour.
///
/// ```
/// use fredholm::math::names::nearest;
/// assert_eq!(nearest("Cornel", ["furnace", "cornell"]), Some("cornell"));
/// assert_eq!(nearest("teapot", ["furnace", "cornell"]), None);
/// ```
pub fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let far = word.chars().count().div_ceil(4);
    let scored = known.into_iter().map(|k| (strsim::osa_distance(&word.to_lowercase(), &k.to_lowercase()), k));
    scored.filter(|&(d, _)| d <= far).min_by_key(|&(d, _)| d).map(|(_, k)| k)
}

/// The names that `word` may stand for, at most four: first the [nearest] one, then those that contain `word` or begin with the
/// part of it before a hyphen.
///
/// ```
/// use fredholm::math::names::similar;
/// assert_eq!(similar("double", ["twice", "double-emission"]), ["double-emission"]);
/// assert_eq!(similar("sphere", ["cornell-spheres", "spheer"]), ["spheer", "cornell-spheres"]);
/// ```
pub fn similar<'a>(word: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> Vec<&'a str> {
    let lower = word.to_lowercase();
    let mut found: Vec<&str> = nearest(word, known.clone()).into_iter().collect();
    let contains = |k: &&str| lower.chars().count() >= 3 && k.to_lowercase().contains(&lower);
    let begins = |k: &&str| lower.split('-').next().is_some_and(|head| head.len() >= 3 && k.starts_with(head));
    for k in known.clone().into_iter().filter(contains).chain(known.into_iter().filter(begins)) {
        if found.len() < 4 && !found.contains(&k) {
            found.push(k);
        }
    }
    found
}

/// `` did you mean `X`? `` followed by the whole list, for help lines.
pub fn suggest(word: &str, kind: &str, known: &[&str]) -> String {
    let list = if known.is_empty() { format!("there are no {kind}") } else { format!("{kind}: {}", known.join(", ")) };
    match similar(word, known.iter().copied()).first() {
        Some(k) => format!("did you mean `{k}`? {list}"),
        None => list,
    }
}

/// Words as a list with `last` before the last one: `a`, `a or b`, `a, b or c`.
pub fn joined<S: AsRef<str>>(words: &[S], last: &str) -> String {
    match words {
        [] => String::new(),
        [one] => one.as_ref().to_owned(),
        [first @ .., end] => {
            let first: Vec<&str> = first.iter().map(AsRef::as_ref).collect();
            format!("{} {last} {}", first.join(", "), end.as_ref())
        }
    }
}

/// Names in code quotes with "or" before the last, as a question asks for them.
///
/// ```
/// assert_eq!(fredholm::math::names::either(&["a", "b", "c"]), "`a`, `b` or `c`");
/// ```
pub fn either(names: &[&str]) -> String {
    joined(&names.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>(), "or")
}

/// True for the characters that change the direction of writing (Unicode Standard Annex 9, table 2): with them a name looks like
/// another one.
pub fn turns(c: char) -> bool {
    matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// True for the characters that a terminal may obey, or that hide what a name says.
pub fn hides(c: char) -> bool {
    c.is_control() || turns(c)
}

/// The text with every control character, and every character that changes the direction of writing, as `\u{…}`.
///
/// ```
/// use fredholm::math::names::visible;
/// assert_eq!(visible("red\u{1b}[0m\n"), r"red\u{1b}[0m\u{a}");
/// ```
pub fn visible(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut out, c| {
        if hides(c) {
            out.extend(c.escape_unicode())
        } else {
            out.push(c)
        }
        out
    })
}

/// The same for a text with lines and tabs, which stay as they are: what a terminal may be sent.
pub fn printable(text: &str) -> std::borrow::Cow<'_, str> {
    if !text.contains(|c: char| !matches!(c, '\n' | '\t') && hides(c)) {
        return text.into();
    }
    let pieces = text.split_inclusive(['\n', '\t']).map(|piece| {
        let end = piece.len() - usize::from(piece.ends_with(['\n', '\t']));
        visible(&piece[..end]) + &piece[end..]
    });
    pieces.collect::<String>().into()
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
        assert_eq!(nearest("nowhere", known), None, "three wrong letters of seven are no slip");
        assert_eq!(suggest("x", "scenes", &[]), "there are no scenes");
    }
}

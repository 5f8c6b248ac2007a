//! Values of a type by the names that [`Display`] gives them.

use std::fmt::Display;

/// The value of that name.
///
/// # Errors
/// Says which names there are.
pub fn named<T: Copy + Display>(all: &[T], name: &str) -> Result<T, String> {
    let found = all.iter().find(|value| value.to_string() == name);
    found.copied().ok_or_else(|| format!("`{name}` is none of {}", list(all)))
}

/// All names, with commas.
pub fn list(all: impl IntoIterator<Item: Display>) -> String {
    all.into_iter().map(|value| value.to_string()).collect::<Vec<_>>().join(", ")
}

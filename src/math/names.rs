//! Lookup of an enum value by the name that its [`Display`] prints.

use std::fmt::Display;

/// The value in `all` whose printed name is `name`.
///
/// # Errors
/// If no value has that name; the message lists the names.
pub fn named<T: Copy + Display>(all: &[T], name: &str) -> Result<T, String> {
    let found = all.iter().find(|value| value.to_string() == name);
    found.copied().ok_or_else(|| format!("`{name}` is none of {}", list(all)))
}

/// All names, separated by commas.
pub fn list(all: impl IntoIterator<Item: Display>) -> String {
    all.into_iter().map(|value| value.to_string()).collect::<Vec<_>>().join(", ")
}

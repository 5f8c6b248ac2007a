//! Overrides `--set KEY=VALUE`: they replace one value of the parsed file before the file is interpreted.
//!
//! KEY is the dotted key of the error messages: `materials.white.reflectance`, `shapes[5].emission` or `shapes.5.emission`,
//! `camera.size[0]`. VALUE is TOML; a bare word counts as a string. All steps of KEY except the last must exist. A new last
//! step is added to its table, and is checked like any other key when the table is read.

use super::tree::{Node, Value, parse_override};
use crate::math::names::suggest;
use crate::scene::SceneError;

/// Replaces or adds the value of one override.
pub(super) fn apply(root: &mut Node, setting: &str) -> Result<(), SceneError> {
    let Some((path, text)) = setting.split_once('=') else {
        let help = "write KEY=VALUE, for example --set camera.fov=40";
        return Err(SceneError::new("an override needs a value").key(format!("--set {setting}")).help(help));
    };
    let path = path.trim();
    let fail = |what: String, help: String| Err(SceneError::new(what).key(format!("--set {path}")).help(help));
    let Some(steps) = steps(path) else {
        return fail(
            format!("`{path}` is not a key"),
            "write it like materials.white.reflectance or shapes[5].emission".into(),
        );
    };
    let new = match parse_override(text) {
        Ok(node) => node,
        Err(e) => {
            return fail(
                format!("`{}` is not a TOML value: {e}", text.trim()),
                "write a number, [a, b, c], or \"text\"".into(),
            );
        }
    };
    let mut at = root;
    let mut done = String::new();
    for (i, step) in steps.iter().enumerate() {
        let last = i + 1 == steps.len();
        let place = if done.is_empty() { "the scene".to_owned() } else { format!("`{done}`") };
        at = match &mut at.value {
            Value::Table(entries) => {
                let known: Vec<String> = entries.iter().map(|(k, _)| k.clone()).collect();
                let index = match known.iter().position(|k| k == step) {
                    Some(index) => index,
                    None if last => {
                        entries.push((step.clone(), new));
                        return Ok(());
                    }
                    None => {
                        let names: Vec<&str> = known.iter().map(String::as_str).collect();
                        return fail(format!("{place} has no `{step}`"), suggest(step, "keys there", &names));
                    }
                };
                &mut entries[index].1
            }
            Value::List(items) => {
                let count = items.len();
                match step.parse::<usize>().ok().and_then(|i| items.get_mut(i)) {
                    Some(item) => item,
                    None => {
                        return fail(
                            format!("{place} has no element [{step}], only {count} elements"),
                            "indices start at 0".into(),
                        );
                    }
                }
            }
            other => {
                return fail(
                    format!("{place} is {} and has no `{step}`", other.kind()),
                    "remove this part of the key".into(),
                );
            }
        };
        done = match step.parse::<usize>() {
            Ok(index) => format!("{done}[{index}]"),
            Err(_) if done.is_empty() => step.clone(),
            Err(_) => format!("{done}.{step}"),
        };
    }
    *at = new;
    Ok(())
}

/// The steps of a key: `shapes[5].emission` and `shapes.5.emission` both become `shapes`, `5`, `emission`.
fn steps(path: &str) -> Option<Vec<String>> {
    let mut steps = Vec::new();
    for part in path.split('.') {
        let (name, indices) = part.split_at(part.find('[').unwrap_or(part.len()));
        steps.push(name.trim().to_owned());
        for index in indices.split_terminator(']') {
            let index = index.trim().strip_prefix('[')?.trim();
            index.parse::<usize>().ok()?;
            steps.push(index.to_owned());
        }
        if !indices.is_empty() && !indices.ends_with(']') {
            return None;
        }
    }
    steps.iter().all(|s| !s.is_empty()).then_some(steps)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn both_spellings_of_an_index() {
        assert_eq!(steps("shapes[5].emission").unwrap(), ["shapes", "5", "emission"]);
        assert_eq!(steps("shapes.5.emission").unwrap(), ["shapes", "5", "emission"]);
        assert_eq!(steps("a[1][2]").unwrap(), ["a", "1", "2"]);
        for bad in ["", "a.", ".a", "a[", "a[x]", "a[1", "a]1[", "[1]"] {
            assert_eq!(steps(bad), None, "{bad}");
        }
    }
}
